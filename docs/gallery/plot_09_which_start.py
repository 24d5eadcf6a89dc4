"""
Where the initial state decides
===============================

If static friction exceeds kinetic friction, a cell can have several steady states. A map shows the outcome
for one initial state. ``also_reachable`` lists the regimes that other initial states lead to. Cells with
several regimes are hatched.
"""

from picture_data import computed

import frictionmap as fm

ds = computed("coexistence")
fm.plot_regimes(ds)

# %%
# One cell, from rest and from a large sliding motion.
system = fm.System()
for start in ("rest", "moving"):
    one = fm.response(system, 0.5, 0.9, 2.0, start=start)
    fm.plot_response(one)
