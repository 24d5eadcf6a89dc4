"""
How often does it stop?
=======================

T Fig. 3.12: one mass with friction against a wall that moves with the base. Colours show the number of
stops per cycle; the black lines are the exact boundaries. On the left, static and kinetic friction are equal
(mu = 1); on the right, static friction is 50 % larger (mu = 1.5).
"""

# %%
# A configuration defines the system, the grid and the outputs. The same on the command line:
# ``frictionmap map configs/fig-3-12.toml && frictionmap plot fig-3-12.nc``.

from picture_data import CONFIGS, computed

import frictionmap as fm

config = fm.load_config(CONFIGS / "fig-3-12.toml")
ds = fm.sweep(config.system, config.r, config.beta, config.mu, solver=config.solver)
fm.plot_regimes(ds)

# %%
# The result is an ``xarray.Dataset``. Select a cell, row or column by its values:

cell = ds.sel(mu=1.5, r=0.5, beta=0.6)
print(f"{cell.stops_per_cycle.item():g} stop per cycle, z up to {cell.contact_amplitude.item():.3f} Y")

# %%
# T Fig. 3.13 shows low frequencies, which have many stops per cycle. Circles mark the rarest classes.

fm.plot_regimes(computed("fig-3-13"))
