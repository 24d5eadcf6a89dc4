"""
First harmonics, as they are measured
=====================================

Transmissibility and phase of the first harmonic, computed from closed-form integrals over the exact motion
instead of samples.
"""

import numpy as np

import frictionmap as fm

r = np.arange(251) / 100
measured = {"harmonics": 7, "quantities": ["first_harmonic", "harmonics"]}

# %%
# **T Fig. 4.7 and 4.8**, fixed wall, moving base. Above resonance the phase hardly depends on
# frequency, so friction can be measured from it.
fixed = fm.curves(fm.System(excitation="base"), np.arange(1, 251) / 100, [0.2, 0.4, 0.6], **measured)
fm.plot_curves(fixed)

# %%
# The other harmonics, in dB relative to the first. Only odd harmonics occur.
fm.plot_curves(fixed, "harmonics")

# %%
# **T Fig. 4.9 and 4.10**, wall joined to the base: all curves cross at r = 1.506.
joined = fm.System(contact="joined-base-wall")
fm.plot_curves(fm.curves(joined, r, [0.5, 0.75, 1.0, 1.5, 2.0], **measured))

# %%
# **T Fig. 6.20** and **6.21**, the two-storey rig with the wall on its first and on its second mass.
rig = {"mass_ratios": [1.0, 0.9772], "stiffness_ratios": [1.0, 1.1119], "excitation": "base"}
first, second = (fm.System(contact_masses=[mass], **rig) for mass in (1, 2))
fm.plot_curves(fm.curves(first, r, [0.2, 0.4, 0.6], **measured))
fm.plot_curves(fm.curves(second, r, [0.2, 0.5, 1.0, 1.5, 2.0], **measured))

# %%
# **T Fig. 6.28 and 6.29**, the wall joined to the rig's base.
joined = fm.System(contact="joined-base-wall", contact_masses=[1], **rig)
fm.plot_curves(fm.curves(joined, r, [0.5, 0.75, 1.0, 2.0], **measured))
