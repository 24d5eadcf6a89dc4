"""
One mass: amplitude and phase
=============================

Response curves through all regimes. Lines are solid for continuous motion, dashed for stick-slip and dotted
for permanent sticking.
"""

from picture_data import computed

import frictionmap as fm

# %%
# **T Fig. 2.4**, fixed wall. Friction below beta = pi/4 does not limit the resonance, T(2.30).
fm.plot_curves(computed("fig-2-4"))

# %%
# **T Fig. 2.7**, the same with additional viscous damping, which limits every resonance.
fm.plot_curves(computed("fig-2-7"))

# %%
# **T Fig. 3.2** (the contact), **3.7 and 3.8** (the mass), wall joined to the base. Above about
# r = 1.4 more friction increases the amplitude, so the curves cross.
fm.plot_curves(computed("fig-3-7"))

# %%
# **T Fig. 3.14**, more friction. For beta >= 1.06 there is no resonance, and the largest amplitudes
# occur at other frequencies.
fm.plot_curves(computed("fig-3-14"))

# %%
# **T Fig. 3.15**, static friction equal to, and up to twice, the kinetic friction.
fm.plot_curves(computed("fig-3-15"))
