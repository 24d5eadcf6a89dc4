"""
One mass: where it slides, and where it sticks
==============================================

The first three maps of the thesis. The motion sticks and slips only between the two boundaries. For mu = 1
only this strip is integrated.
"""

import numpy as np

import frictionmap as fm

r = np.arange(251) / 100

# %%
# **T Fig. 2.5**, friction against a fixed wall. For beta >= 1 the load cannot move the mass.
fm.plot_regimes(fm.sweep(fm.System(), r, beta=np.arange(241) / 200))

# %%
# **T Fig. 3.4**, friction against a wall that moves with the base. At high frequency the contact slides for
# any friction force.
shaken = fm.System(contact="joined-base-wall")
beta = np.arange(401) / 100
fm.plot_regimes(fm.sweep(shaken, r, beta))

# %%
# **T Fig. 3.5**, the same for four static-to-kinetic ratios. As the ratio increases, the stick-slip region
# between continuous motion and permanent sticking becomes smaller.
fm.plot_regimes(fm.sweep(shaken, r, beta, mu=[1.0, 1.2, 1.5, 2.0]))
