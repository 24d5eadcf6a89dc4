"""
Two masses with modal damping
=============================

T Fig. 7.7 and 7.5: contact on the second mass, load on the first. The damping ratios are inversely
proportional to the natural frequencies.
"""

from picture_data import computed

import frictionmap as fm

# %%
# **T Fig. 7.7**, maps.
for zeta in ("0.001", "0.01", "0.1"):
    fm.plot_regimes(computed(f"fig-7-7-zeta-{zeta}"))

# %%
# **T Fig. 7.5 and 7.6**, amplitude and phase.
for zeta in ("0.001", "0.01", "0.1"):
    fm.plot_curves(computed(f"fig-7-5-zeta-{zeta}"))
