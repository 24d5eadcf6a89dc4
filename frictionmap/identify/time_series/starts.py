"""Starting values for a record: natural frequency, damping and mu from lists, friction from the energy.

Over a cycle the base's work is that of damping and friction, whatever the natural frequency does:

    <g q'> = 2 zeta r <q'^2> + x_F <|q'|>
"""

from collections.abc import Mapping
from itertools import product

import numpy as np

from ..signals.phasors import Phasors, harmonics_at
from .motion import Shaken, contact_harmonics, load_harmonics, motion, shaken

#: Frequency ratios, damping ratios and mu that are tried.
_RATIOS = np.geomspace(0.1, 4.0, 37)
_DAMPINGS = (0.0, 0.003, 0.01, 0.03, 0.1, 0.3)
_STATIC = (1.0, 1.1, 1.3, 1.7)

#: Places in a cycle at which motions are compared.
_PLACES = 128


def starts(
    contact: str, damping_reference: str, phasors: Phasors, known: Mapping[str, float]
) -> list[np.ndarray]:
    """Parameters near the record, the best first, each with another natural frequency."""
    angle = 2.0 * np.pi * np.arange(_PLACES) / _PLACES
    time = phasors.middle + angle / (2.0 * np.pi * phasors.frequency)
    mass = shaken(contact, damping_reference, phasors, time)
    measured = harmonics_at(phasors.values[1], angle)
    best: dict[float, tuple[float, np.ndarray]] = {}
    frequencies = [known["f_n"]] if "f_n" in known else list(phasors.frequency / _RATIOS)
    dampings = [known["zeta"]] if "zeta" in known else _DAMPINGS
    static = [known["mu"]] if "mu" in known else _STATIC
    for f_n, zeta, mu in product(frequencies, dampings, static):
        friction = known.get("x_F", balance(mass, phasors.values[1], f_n, zeta))
        places = motion(mass, np.array([f_n, zeta, friction, mu, 0.0])).places
        offset = known.get("offset_x", float(np.mean(measured - places)))
        square = float(np.sum((measured - places - offset) ** 2))
        if f_n not in best or square < best[f_n][0]:
            best[f_n] = square, np.array([f_n, zeta, friction, mu, offset])
    return [values for _, values in sorted(best.values(), key=lambda found: found[0])]


def balance(mass: Shaken, x: np.ndarray, f_n: float, zeta: float) -> float:
    """x_F by the energy of one cycle, 0 where damping alone takes more."""
    load = load_harmonics(mass, f_n, zeta)
    n = np.arange(x.size)
    speed = 1j * n * contact_harmonics(mass, x)
    angle = 2.0 * np.pi * np.arange(_PLACES) / _PLACES
    work = 0.5 * float(np.sum(load[1:] * np.conj(speed[1 : load.size])).real)
    lost = zeta * mass.frequency / f_n * float(np.sum(np.abs(speed) ** 2))
    return max(work - lost, 0.0) / float(np.mean(np.abs(harmonics_at(speed, angle))))
