"""
Figures for a publication
=========================

One picture of each kind, 85 mm wide like a column of a journal. The command above each picture draws it from
a file. The Python code below the command draws the same. The guide on figures lists all options.
"""

import numpy as np

import frictionmap as fm

# %%
# A map, with the working point of a machine and the box of its uncertainty:
#
# .. code-block:: sh
#
#    frictionmap plot fig-3-12.nc --size 85mm --panels 1 --point 1.6 1.2 --box 0.1 0.2 --no-caption -o map.pdf
shaken = fm.System(contact="joined-base-wall")
one = fm.sweep(shaken, np.arange(0, 251, 2) / 100, np.arange(401) / 100, mu=[1.0, 1.5])
fm.plot_regimes(one, size="85mm", panels=1, point=(1.6, 1.2), box=(0.1, 0.2), caption=False)

# %%
# Part of the same map:
#
# .. code-block:: sh
#
#    frictionmap plot fig-3-12.nc --size 85mm --panels 2 --xlim 0.2 0.9 --ylim 0 0.5 --no-caption -o part.pdf
fm.plot_regimes(one, size="85mm", panels=2, xlim=(0.2, 0.9), ylim=(0.0, 0.5), caption=False)

# %%
# The amplitude in the contact, an output of the map. Grey cells are stuck:
#
# .. code-block:: sh
#
#    frictionmap plot amplitudes.nc --size 85mm --quantity contact_amplitude --log -o amplitudes.pdf
damped = fm.System(damping_ratios=0.05)
r, beta = np.linspace(0.2, 2.0, 181), np.linspace(0.01, 1.2, 120)
amplitudes = fm.sweep(damped, r, beta, outputs=["regime", "contact_amplitude"])
fm.plot_quantity(amplitudes, "contact_amplitude", log=True, size="85mm")

# %%
# Boundaries:
#
# .. code-block:: sh
#
#    frictionmap plot boundaries.nc --size 85mm -o boundaries.pdf
fm.plot_boundaries(fm.boundaries(damped, r, [1.0]), size="85mm")

# %%
# A response curve of one of five masses, for two friction ratios:
#
# .. code-block:: sh
#
#    frictionmap plot fig-6-8-curves.nc --size 85mm --mass 1 --panels 1 -o curve.pdf
five = fm.System(contact_masses=[1], load_mass=1, mass_ratios=[1.0] * 5, stiffness_ratios=[1.0] * 5)
curves = fm.curves(five, np.arange(251) / 100, [0.0, 0.2, 0.4, 0.6, 0.8], quantities=["amplitude", "phase"])
fm.plot_curves(curves, size="85mm", mass=1, panels=1)

# %%
# A motion, and its phase portrait:
#
# .. code-block:: sh
#
#    frictionmap plot motion.nc --size 85mm -o motion.pdf
#    frictionmap plot motion.nc --size 85mm --quantity orbit --panels 1 --no-legend -o portrait.pdf
motion = fm.response(fm.System(), 0.3, 0.5)
fm.plot_response(motion, size="85mm")
fm.plot_orbit(motion, size="85mm", panels=1, legend=False)

# %%
# A fit to a free decay:
#
# .. code-block:: sh
#
#    frictionmap plot free-decay-identify.nc --size 85mm -o fit.pdf
#
# A mass of 3 Hz is pulled aside by 9.5 mm and let go. Friction moves the centre of each half cycle by 0.2 mm.
f_n, friction, start = 3.0, 0.2, 9.5
time = np.arange(0.0, 3.9, 0.01)
half = np.floor(2.0 * f_n * time)
sense = (-1.0) ** half
swing = np.maximum(start - (2.0 * half + 1.0) * friction, 0.0)
x = sense * swing * np.cos(np.pi * (2.0 * f_n * time - half)) + sense * friction
x += np.random.default_rng(1).normal(0.0, 0.05, x.size)
fm.plot_fit(fm.identify.free_decay(time, x), size="85mm")

# %%
# A design question: the peak response over friction, with the friction for which it is least.
#
# .. code-block:: sh
#
#    frictionmap plot brace-damper-design.nc --size 85mm --panels 1 -o design.pdf
frame = fm.System(
    contact="joined-base-wall",
    damping_reference="base",
    mass_ratios=[1.0, 1.0],
    stiffness_ratios=[1.0, 1.0],
    damping_ratios=0.02,
)
fm.plot_design(fm.design.least_peak(frame, [0.4, 2.0], mass=2, spread=0.2), size="85mm", panels=1)

# %%
# A motion in time, the ring-down of a carriage:
#
# .. code-block:: sh
#
#    frictionmap plot ring-down-history.nc --size 85mm -o ring-down.pdf
carriage = fm.System(damping_ratios=0.01)
scales = fm.Units(natural_frequency="4 Hz", stiffness="3158 N/m", load="3.158 N")
silence = fm.Record.pulse("rectangle", "0 N", "0.01 s", unit="N", quantity="force")
start = {"x": [20.0], "v": [0.0]}
ring_down = fm.history(carriage, silence, beta=["3.1 N"], units=scales, start=start, after=1.5)
fm.plot_history(ring_down, size="85mm")

# %%
# Friction response spectra, and an incremental dynamic analysis that is read from them:
#
# .. code-block:: sh
#
#    frictionmap plot spectra-spectrum.nc --size 85mm -o spectrum.pdf
#    frictionmap plot spectra-spectrum.nc --size 85mm --quantity incremental -o incremental.pdf
quakes = fm.Record.generate(
    "kanai-tajimi", "20 s", "0.01 s", frequency="2.5 Hz", damping=0.6, peak="0.4 g", unit="g", count=20
)
spectra = fm.spectrum(quakes, np.geomspace(0.05, 4.0, 100), ["0.02 g", "0.05 g", "0.1 g"], damping=0.05)
fm.plot_spectrum(spectra, size="85mm")
fm.plot_incremental(spectra, size="85mm")

# %%
# A structure with its contacts and load, and its modes:
#
# .. code-block:: sh
#
#    frictionmap plot configs/contacts/two-storey-frame.toml --size 85mm -o frame.pdf
#    frictionmap plot configs/contacts/two-storey-frame.toml --size 85mm --quantity modes -o modes.pdf
fm.plot_structure(frame, size="85mm")
fm.plot_modes(frame, size="85mm")
