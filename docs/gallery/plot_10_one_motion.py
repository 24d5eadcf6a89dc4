"""
Motions in time
===============

Single cells over time: displacements, stops of the contact, and the energy that friction dissipates.
"""

import frictionmap as fm

# %%
# A mass that stops twice per cycle on a fixed wall. The contact sticks in the grey bands.
one = fm.response(fm.System(), 0.3, 0.5)
fm.plot_response(one)

# %%
# The same as phase portrait, friction loop and spectrum. The area of the loop is the energy that
# friction dissipates per cycle.
fm.plot_orbit(one)
print(f"work of friction per cycle: {one.work_friction.item():.4f}")

# %%
# **T Fig. 4.6**, a mass on a shaken base against a fixed wall, at r = 0.85. The friction is too small
# for stops.
fm.plot_response(fm.response(fm.System(excitation="base"), 0.85, 0.2))

# %%
# **T Fig. 6.9a**, five masses, contact on the first.
five = {"mass_ratios": [1.0] * 5, "stiffness_ratios": [1.0] * 5, "load_mass": 1}
fm.plot_response(fm.response(fm.System(contact_masses=[1], **five), 1.6, 0.6))

# %%
# **T Fig. 7.1**, the same at another frequency with modal damping ratios of 0.01 and of 0.1; **7.2**, with
# the contact on the third mass. With more damping the masses no longer move in phase or in antiphase.
for mass in (1, 3):
    for zeta in (0.01, 0.1):
        system = fm.System(contact_masses=[mass], damping_ratios=zeta, **five)
        fm.plot_response(fm.response(system, 0.9, 0.2))

# %%
# **T Fig. 7.10**, stick-slip at low frequency: four stops per cycle without or with little damping, two
# with a damping ratio of 0.1.
for zeta in (0.0, 0.01, 0.1):
    fm.plot_response(fm.response(fm.System(damping_ratios=zeta), 0.1, 0.2))
