"""
How often does it stop?
=======================

T Fig. 3.12: one mass with friction against a wall that moves with the base. Colours show the number of
stops per cycle; the black lines are the exact boundaries. On the left, static and kinetic friction are equal
(mu = 1); on the right, static friction is 50 % larger (mu = 1.5).
"""

# %%
# A system, and the values of r, beta and mu. The same on the command line, with a configuration from the
# repository: ``frictionmap map configs/fig-3-12.toml && frictionmap plot fig-3-12.nc``.

import numpy as np

import frictionmap as fm

system = fm.System(contact="joined-base-wall")
ds = fm.sweep(system, r=np.arange(0, 251, 2) / 100, beta=np.arange(401) / 100, mu=[1.0, 1.5])
fm.plot_regimes(ds)

# %%
# The result is an ``xarray.Dataset``. Select a cell, row or column by its values:

cell = ds.sel(mu=1.5, r=0.5, beta=0.6)
print(f"{cell.stops_per_cycle.item():g} stop per cycle, z up to {cell.contact_amplitude.item():.3f} Y")

# %%
# T Fig. 3.13 shows low frequencies, which have many stops per cycle. Circles mark the rarest classes.

low = fm.sweep(system, np.arange(100, 701, 2) / 1000, np.arange(501) / 1000, mu=[1.0, 1.5, 2.0])
fm.plot_regimes(low)
