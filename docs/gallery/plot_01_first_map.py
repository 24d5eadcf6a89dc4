"""
How often does it stop?
=======================

T Fig. 3.12: one mass, friction against a wall that moves with the shaken base. Colours count the stops
in a cycle; the black lines are the exact boundaries. On the left friction is at rest as strong as in
motion (mu = 1), on the right half as strong again.
"""

# %%
# A configuration says which system, which grid and what is computed. On the command line the same is
# ``frictionmap map configs/fig-3-12.toml && frictionmap plot fig-3-12.nc``.

from picture_data import CONFIGS, computed

import frictionmap as fm

config = fm.load_config(CONFIGS / "fig-3-12.toml")
ds = fm.sweep(config.system, config.r, config.beta, config.mu, solver=config.solver)
fm.plot_regimes(ds)

# %%
# The result is an ``xarray.Dataset``: any cell, row or column of it by its values.

cell = ds.sel(mu=1.5, r=0.5, beta=0.6)
print(f"{cell.stops_per_cycle.item():g} stop in a cycle, z up to {cell.contact_amplitude.item():.3f} Y")

# %%
# T Fig. 3.13 looks closer at low frequency, where stops are many. The rarest classes are ringed.

fm.plot_regimes(computed("fig-3-13"))
