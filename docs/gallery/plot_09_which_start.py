"""
Where the start decides
=======================

With static friction above kinetic friction a cell may have several steady states. The map answers for
the start that was asked for; ``also_reachable`` lists what other starts end in, and where there are
several the picture is hatched.
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
