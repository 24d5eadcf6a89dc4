"""Starting values for a record: natural frequency, damping and mu from lists, friction from the energy.

Over a cycle the base's work is that of damping and friction, whatever the natural frequency does:

    <g q'> = 2 zeta r <q'^2> + x_F <|q'|>

A spring in the contact stores what the slider does not move: of one harmonic of amplitude a, compliance c,
friction takes 1 - x_F c/a of that.
"""

from collections.abc import Mapping
from itertools import product

import numpy as np

from ..parameters import ALIKE, CONTACT_STIFFNESS
from ..signals.phasors import Phasors, harmonics_at
from .motion import LAW, OFFSET, Shaken, contact_harmonics, corrected, load_harmonics, motion, shaken

#: Frequency ratios, damping ratios and mu that are tried.
_RATIOS = np.geomspace(0.1, 4.0, 37)
_DAMPINGS = (0.0, 0.003, 0.01, 0.03, 0.1, 0.3)
_STATIC = (1.0, 1.1, 1.3, 1.7)

#: Compliances of springs that are tried.
_COMPLIANCES = (2.0, 1.0, 0.5, 0.25, 0.12, 0.06, 0.03, 0.01)

#: Compliances beside a solution: with stiff springs the sum has many least values, as near to each other as
#: this factor.
_BESIDE = np.geomspace(0.003, 1.0, 40)

#: Places in a cycle at which motions are compared.
_PLACES = 128


def starts(
    contact: str, damping_reference: str, phasors: Phasors, known: Mapping[str, float], elastic: bool = False
) -> list[np.ndarray]:
    """Parameters near the record, the best first, each with another natural frequency or another spring."""
    angle = 2.0 * np.pi * np.arange(_PLACES) / _PLACES
    time = phasors.middle + angle / (2.0 * np.pi * phasors.frequency)
    delay, gain = (known.get(name, alike) for name, alike in ALIKE.items())
    mass = corrected(shaken(contact, damping_reference, phasors, time, elastic), delay, gain)
    measured = harmonics_at(phasors.values[1], angle)
    best: dict[tuple[float, float], tuple[float, np.ndarray]] = {}
    frequencies = [known["f_n"]] if "f_n" in known else list(phasors.frequency / _RATIOS)
    dampings = [known["zeta"]] if "zeta" in known else _DAMPINGS
    name, tried = (CONTACT_STIFFNESS, _COMPLIANCES) if elastic else ("mu", _STATIC)
    laws = [known[name]] if name in known else tried
    for f_n, zeta, law in product(frequencies, dampings, laws):
        for friction in _frictions(mass, phasors.values[1], known, (f_n, zeta, law)):
            places = motion(mass, np.array([f_n, zeta, friction, law, *ALIKE.values(), 0.0])).places
            offset = known.get("offset_x", float(np.mean(measured - places)))
            square = float(np.sum((measured - places - offset) ** 2))
            key = f_n, law if elastic else 0.0
            if key not in best or square < best[key][0]:
                best[key] = square, np.array([f_n, zeta, friction, law, delay, gain, offset])
    return [values for _, values in sorted(best.values(), key=lambda found: found[0])]


def other_springs(mass: Shaken, x: np.ndarray, values: np.ndarray) -> list[np.ndarray]:
    """Parameters with other compliances, the best first.

    x : shape (samples,), the mass as it was measured
    """
    found = []
    for compliance in _BESIDE:
        one = values.copy()
        one[LAW] = compliance
        off = x - motion(mass, one).places
        one[OFFSET] += float(np.mean(off))
        found.append((float(np.var(off)), one))
    return [one for _, one in sorted(found, key=lambda pair: pair[0])]


def _frictions(
    mass: Shaken, x: np.ndarray, known: Mapping[str, float], values: tuple[float, float, float]
) -> list[float]:
    """x_F, if it is known, or by the energy: with a spring the two solutions of x_F (1 - x_F c/a) = balance.

    values : f_n, zeta, and mu or the compliance
    """
    f_n, zeta, law = values
    if "x_F" in known:
        return [known["x_F"]]
    rigid = balance(mass, x, f_n, zeta)
    if not mass.elastic or law == 0.0:
        return [rigid]
    most = 0.5 * float(np.abs(contact_harmonics(mass, x)[1])) / law
    root = most * np.sqrt(max(1.0 - 2.0 * rigid / most, 0.0)) if most > 0.0 else 0.0
    return [most - root, most + root]


def balance(mass: Shaken, x: np.ndarray, f_n: float, zeta: float) -> float:
    """x_F by the energy of one cycle, 0 where damping alone takes more."""
    load = load_harmonics(mass, f_n, zeta)
    n = np.arange(x.size)
    speed = 1j * n * contact_harmonics(mass, x)
    angle = 2.0 * np.pi * np.arange(_PLACES) / _PLACES
    work = 0.5 * float(np.sum(load[1:] * np.conj(speed[1 : load.size])).real)
    lost = zeta * mass.frequency / f_n * float(np.sum(np.abs(speed) ** 2))
    return max(work - lost, 0.0) / float(np.mean(np.abs(harmonics_at(speed, angle))))
