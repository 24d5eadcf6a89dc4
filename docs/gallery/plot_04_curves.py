"""
One mass: amplitude and phase
=============================

Response curves through all regimes: solid where the motion is continuous, dashed where it sticks and
slips, dotted where it is stuck.
"""

from picture_data import computed

import frictionmap as fm

# %%
# **T Fig. 2.4**, fixed wall. Friction below beta = pi/4 does not bound the resonance, T(2.30).
fm.plot_curves(computed("fig-2-4"))

# %%
# **T Fig. 2.7**, the same with viscous damping beside the friction: no resonance without bounds.
fm.plot_curves(computed("fig-2-7"))

# %%
# **T Fig. 3.2** (the contact), **3.7 and 3.8** (the mass), wall joined to the base. Above r = 1.4 more
# friction means larger amplitudes: curves cross.
fm.plot_curves(computed("fig-3-7"))

# %%
# **T Fig. 3.14**, more friction. From beta = 1.06 on no resonance is left, and the largest motions lie
# elsewhere.
fm.plot_curves(computed("fig-3-14"))

# %%
# **T Fig. 3.15**, static friction from once to twice the kinetic friction.
fm.plot_curves(computed("fig-3-15"))
