"""
Where the initial state decides
===============================

If static friction exceeds kinetic friction, a cell can have several steady states. A map shows the outcome
for one initial state. ``also_reachable`` lists the regimes that other initial states lead to. Cells with
several regimes are hatched.
"""

import numpy as np

import frictionmap as fm

outputs = ["regime", "stops_per_cycle", "also_reachable", "sliding_limit"]
r, beta = np.arange(2, 251, 2) / 100, np.arange(121) / 100
ds = fm.sweep(fm.System(), r, beta, mu=[1.2, 2.0], outputs=outputs)
fm.plot_regimes(ds)

# %%
# One cell, from rest and from a large sliding motion.
system = fm.System()
for start in ("rest", "moving"):
    one = fm.response(system, 0.5, 0.9, 2.0, start=start)
    fm.plot_response(one)
