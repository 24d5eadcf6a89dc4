"""
Two masses with modal damping
=============================

T Fig. 7.7 and 7.5: contact on the second mass, load on the first. The damping ratios are inversely
proportional to the natural frequencies.
"""

import numpy as np

import frictionmap as fm


def damped(zeta):
    """Two equal masses; zeta is the damping ratio of a mode with natural frequency 1."""
    golden = np.array([(5**0.5 - 1) / 2, (5**0.5 + 1) / 2])  # the natural frequencies
    equal = [1.0, 1.0]
    return fm.System(
        contact_masses=[2],
        load_mass=1,
        mass_ratios=equal,
        stiffness_ratios=equal,
        damping_ratios=zeta / golden,
    )


r = np.arange(251) / 100

# %%
# **T Fig. 7.7**, maps.
for zeta in (0.001, 0.01, 0.1):
    fm.plot_regimes(fm.sweep(damped(zeta), r, np.arange(401) / 100))

# %%
# **T Fig. 7.5 and 7.6**, amplitude and phase.
friction = [0.0, 0.2, 0.4, 0.5, 1.0, 1.5, 2.0]
for zeta in (0.001, 0.01, 0.1):
    fm.plot_curves(fm.curves(damped(zeta), r, friction, quantities=["amplitude", "phase"]))
