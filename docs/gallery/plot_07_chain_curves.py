"""
Chains: amplitude and phase
===========================

Every mass has its own curve, and so has the contact.
"""

import numpy as np

import frictionmap as fm


def chain(masses, contact_mass):
    """A chain of equal masses and springs, with the load on the first mass."""
    equal = [1.0] * masses
    return fm.System(contact_masses=[contact_mass], load_mass=1, mass_ratios=equal, stiffness_ratios=equal)


def draw(system, beta):
    """Amplitude and phase of every mass."""
    fm.plot_curves(fm.curves(system, np.arange(251) / 100, beta, quantities=["amplitude", "phase"]))


# %%
# **T Fig. 6.6**, contact on the first of two masses; **6.13**, on the second.
draw(chain(2, 1), [0.0, 0.2, 0.4, 0.6, 0.8])
draw(chain(2, 2), [0.0, 0.2, 0.4, 0.5, 1.0, 1.5, 2.0, 5.0])

# %%
# Invariant points are marked.  All curves of a mass meet there, because friction does not affect the
# amplitude.
#
# **T Fig. 6.23**, contact between the masses; **6.25**, a wall joined to the base.
between = fm.System(
    contact="between-masses", contact_masses=[1, 2], mass_ratios=[1.0, 0.5], stiffness_ratios=[1.0, 0.5]
)
draw(between, [0.0, 0.1, 0.2, 0.4, 0.6, 0.8])
two = {"mass_ratios": [1.0, 1.0], "stiffness_ratios": [1.0, 1.0]}
draw(fm.System(contact="joined-base-wall", contact_masses=[1], **two), [0.0, 0.2, 0.4, 0.6, 0.8, 1.0])

# %%
# **T Fig. 6.2**, three masses, contact on the second. Each resonance becomes finite at its own
# friction ratio, T(6.2): 0.436, 1.765 and 0.630.
draw(chain(3, 2), [0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.5, 2.0])

# %%
# **T Fig. 6.8 and 6.9b**, five masses, contact and load on the first; **6.15 and 6.16b**, contact on the
# third.
draw(chain(5, 1), [0.0, 0.2, 0.4, 0.6, 0.8])
draw(chain(5, 3), [0.0, 0.2, 0.4, 0.5, 1.0, 1.5, 2.0])
