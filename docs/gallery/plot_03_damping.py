"""
One mass with viscous damping
=============================

T Fig. 7.4 and 7.3. A little damping hardly changes the boundaries, but it changes the amplitude at
resonance. A damping ratio of 0.1 changes both.
"""

import numpy as np

import frictionmap as fm

r = np.arange(251) / 100

# %%
# **T Fig. 7.4**, the map for zeta = 0, 0.001, 0.01 and 0.1. Without damping, the result at
# r = 1/2 depends on the initial state, T(3.33).
for zeta in (0.0, 0.001, 0.01, 0.1):
    ds = fm.sweep(fm.System(damping_ratios=zeta), r, beta=np.arange(241) / 200)
    fm.plot_regimes(ds, title=f"damping ratio {zeta}")

# %%
# **T Fig. 7.3**, amplitude and phase. Below beta = pi/4, friction alone does not limit an undamped
# resonance, T(2.30).
for zeta in (0.001, 0.01, 0.1):
    system = fm.System(damping_ratios=zeta)
    ds = fm.curves(system, r, [0.0, 0.2, 0.4, 0.6, 0.8], quantities=["amplitude", "phase"])
    fm.plot_curves(ds, title=f"damping ratio {zeta}")
