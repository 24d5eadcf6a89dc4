"""
One mass: amplitude and phase
=============================

Response curves through all regimes. Lines are solid for continuous motion, dashed for stick-slip and dotted
for permanent sticking.
"""

import numpy as np

import frictionmap as fm

r, quantities = np.arange(251) / 100, ["amplitude", "phase"]

# %%
# **T Fig. 2.4**, fixed wall. Friction below beta = pi/4 does not limit the resonance, T(2.30).
friction = [0.0, 0.2, 0.4, 0.6, 0.8]
fm.plot_curves(fm.curves(fm.System(), r, friction, quantities=quantities))

# %%
# **T Fig. 2.7**, the same with additional viscous damping, which limits every resonance.
fm.plot_curves(fm.curves(fm.System(damping_ratios=0.2), r, friction, quantities=quantities))

# %%
# **T Fig. 3.2** (the contact), **3.7 and 3.8** (the mass), wall joined to the base. Above about
# r = 1.4 more friction increases the amplitude, so the curves cross.
shaken = fm.System(contact="joined-base-wall")
fm.plot_curves(fm.curves(shaken, r, [0.0, 0.2, 0.5, 0.75, 1.0, 1.2], quantities=quantities))

# %%
# **T Fig. 3.14**, more friction. For beta >= 1.06 there is no resonance, and the largest amplitudes
# occur at other frequencies.
more = [0.2, 0.5, 0.8, 1.0, 1.25, 1.5, 2.0]
fm.plot_curves(fm.curves(shaken, r, more, quantities=quantities))

# %%
# **T Fig. 3.15**, static friction equal to, and up to twice, the kinetic friction.
fm.plot_curves(fm.curves(shaken, r, [1.0], mu=[1.0, 1.2, 1.3, 1.5, 2.0], quantities=quantities))
