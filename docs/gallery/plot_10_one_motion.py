"""
One motion in time
==================

A single cell in full: what moves, when the contact stops, and what friction takes.
"""

import frictionmap as fm

# %%
# A mass on a fixed wall that stops twice in a cycle. Grey: the contact sticks.
one = fm.response(fm.System(), 0.3, 0.5)
fm.plot_response(one)

# %%
# The same as phase portrait, friction loop and spectrum. The area of the loop is what friction takes in
# a cycle.
fm.plot_orbit(one)
print(f"work of friction in a cycle: {one.work_friction.item():.4f}")
