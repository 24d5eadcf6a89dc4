"""
Two and five masses
===================

In a chain every mode has its own resonance, in which the contact may or may not take part. The positions of
the contact and of the load matter more than the friction force.
"""

import numpy as np

import frictionmap as fm


def chain(masses, **where):
    """A chain of equal masses and springs, with the load on the first mass."""
    return fm.System(mass_ratios=[1.0] * masses, stiffness_ratios=[1.0] * masses, load_mass=1, **where)


r, coarse = np.arange(251) / 100, np.arange(0, 251, 2) / 100
low, high = np.arange(121) / 100, np.arange(401) / 100

# %%
# **T Fig. 6.7**, two masses, contact and load on the first. Undamped chains with mu > 1 have wide
# regions of irregular motion. Stops there are averages over the cycles followed.
first = chain(2, contact_masses=[1])
fm.plot_regimes(fm.sweep(first, coarse, low[::2], mu=[1.0, 1.5, 2.0]))

# %%
# **T Fig. 6.14**, contact on the second mass. It slides easily at both resonances.
second = chain(2, contact_masses=[2])
fm.plot_regimes(fm.sweep(second, coarse, high[::2], mu=[1.0, 1.5, 2.0]))

# %%
# **T Fig. 6.10** and **6.17**, five masses, contact on the first and on the third.
fm.plot_regimes(fm.sweep(chain(5, contact_masses=[1]), r, low))
fm.plot_regimes(fm.sweep(chain(5, contact_masses=[3]), r, high))

# %%
# **T Fig. 6.24**, contact between two masses, and **6.26**, between the first mass and the shaken base.
between = fm.System(
    contact="between-masses", contact_masses=[1, 2], mass_ratios=[1.0, 0.5], stiffness_ratios=[1.0, 0.5]
)
fm.plot_regimes(fm.sweep(between, r, low))
fm.plot_regimes(fm.sweep(chain(2, contact="joined-base-wall", contact_masses=[1]), r, high))

# %%
# The rig of T section 6.4.
rig = fm.System(contact_masses=[2], load_mass=1, mass_ratios=[1.0, 0.9772], stiffness_ratios=[1.0, 1.1119])
fm.plot_regimes(fm.sweep(rig, r, high))
