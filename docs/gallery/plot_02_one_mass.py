"""
One mass: where it slides, and where it sticks
==============================================

The first three maps of the thesis. The motion sticks and slips only between the two boundaries. For mu = 1
only this strip is integrated.
"""

from picture_data import computed

import frictionmap as fm

# %%
# **T Fig. 2.5**, friction against a fixed wall. For beta >= 1 the load cannot move the mass.
fm.plot_regimes(computed("fig-2-5"))

# %%
# **T Fig. 3.4**, friction against a wall that moves with the base. At high frequency the contact slides for
# any friction force.
fm.plot_regimes(computed("fig-3-4"))

# %%
# **T Fig. 3.5**, the same for four static-to-kinetic ratios. As the ratio increases, the stick-slip region
# between continuous motion and permanent sticking becomes smaller.
fm.plot_regimes(computed("fig-3-5"))
