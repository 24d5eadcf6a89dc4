"""
First harmonics, as they are measured
=====================================

Transmissibility and phase of the first harmonic, computed from closed-form integrals over the exact motion
instead of samples.
"""

from picture_data import computed

import frictionmap as fm

# %%
# **T Fig. 4.7 and 4.8**, fixed wall, moving base. Above resonance the phase hardly depends on
# frequency, so friction can be measured from it.
fixed = computed("fig-4-7")
fm.plot_curves(fixed)

# %%
# The other harmonics, in dB relative to the first. Only odd harmonics occur.
fm.plot_curves(fixed, "harmonics")

# %%
# **T Fig. 4.9 and 4.10**, wall joined to the base: all curves cross at r = 1.506.
fm.plot_curves(computed("fig-4-9"))

# %%
# **T Fig. 6.20** and **6.21**, the two-storey rig with the wall on its first and on its second mass.
fm.plot_curves(computed("fig-6-20"))
fm.plot_curves(computed("fig-6-21"))

# %%
# **T Fig. 6.28 and 6.29**, the wall joined to the rig's base.
fm.plot_curves(computed("fig-6-28"))
