"""
One mass with viscous damping
=============================

T Fig. 7.4 and 7.3. A little damping hardly changes the boundaries, but it changes the amplitude at
resonance. A damping ratio of 0.1 changes both.
"""

from picture_data import computed

import frictionmap as fm

# %%
# **T Fig. 7.4**, the map for zeta = 0, 0.001, 0.01 and 0.1. Without damping, the result at
# r = 1/2 depends on the initial state, T(3.33).
for zeta in ("0", "0.001", "0.01", "0.1"):
    fm.plot_regimes(computed(f"fig-7-4-zeta-{zeta}"))

# %%
# **T Fig. 7.3**, amplitude and phase. Below beta = pi/4, friction alone does not limit an undamped
# resonance, T(2.30).
for zeta in ("0.001", "0.01", "0.1"):
    fm.plot_curves(computed(f"fig-7-3-zeta-{zeta}"))
