"""
One mass: where it slides, and where it sticks
==============================================

The three maps with which the thesis begins. Between the two boundaries, and only there, the motion
sticks and slips; for mu = 1 nothing but this strip is ever integrated.
"""

from picture_data import computed

import frictionmap as fm

# %%
# **T Fig. 2.5**, friction against a fixed wall. From beta = 1 on the load is too weak to move the mass.
fm.plot_regimes(computed("fig-2-5"))

# %%
# **T Fig. 3.4**, friction against a wall that moves with the shaken base: at high frequency it slides
# whatever the friction.
fm.plot_regimes(computed("fig-3-4"))

# %%
# **T Fig. 3.5**, the same for four ratios of static to kinetic friction. Sticking loses, and stick-slip
# is squeezed out between continuous motion and permanent sticking.
fm.plot_regimes(computed("fig-3-5"))
