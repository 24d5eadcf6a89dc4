"""Frequencies at which boundaries are sampled: as close together as the resonances near by are sharp.

A boundary is the largest, or the root of sums of squares, of functions that are analytic in r but at poles:
the complex frequencies w (sqrt(1 - zeta^2) + i zeta) over the order n of a harmonic.  A function below M
within the distance d of a place has a second derivative below 2 M/d^2 there (Cauchy).  So it rises above, or
falls below, a straight line between two samples h < d apart by M (h/d)^2/4 at most.  Samples that are a small
share of d apart therefore show every feature, however narrow; what is between them is found by refining each
local extremum of the samples.
"""

import numpy as np

from ..general.held import orders_of
from ..general.normal_resting import pressed_stiffness
from ..general.problem import springs
from ..model.held_structure import complex_frequencies
from ..model.system import System
from ..solvers.choose import engine_of
from .band import Band

#: Distance of samples over that from the nearest pole, of closed forms.
FINE = 1.0 / 16.0

#: The same where each sample is found by following motions, which costs a thousand times as much.
FOLLOWED = 1.0 / 4.0

#: Distance of samples, relative to the frequency, that is not divided further at a pole without damping: a
#: feature at a pole is found between the pole, which is a sample, and the next one.
_CLOSEST = 1e-9

#: Orders n of harmonics of the friction force whose dips of beta_lim at w/n are resolved; where motions are
#: followed they are fewer.
MOST_ORDERS, _FOLLOWED_ORDERS = 1000, 60

#: With n above this over zeta, neighbouring dips are wider than their distance, w/n^2, and no longer dips.
_MERGED = 2.0


def graded(band: Band, poles: np.ndarray, share: float) -> np.ndarray:
    """Increasing frequencies from end to end of a band, `share` of the distance to the nearest pole apart.

    Poles with their real part in the band are samples.  The origin counts as one, so that distances grow no
    faster than r.
    """
    inside = poles.real[(poles.real > band.low) & (poles.real < band.high)]
    known = [np.unique(np.concatenate(([band.low, band.high], inside)))]
    low, high = known[0][:-1], known[0][1:]
    while low.size:
        middle, width = 0.5 * (low + high), high - low
        wide = (width > share * _distance(middle, poles)) & (width > _CLOSEST * middle)
        low, middle, high = low[wide], middle[wide], high[wide]
        known.append(middle)
        low, high = np.concatenate((low, middle)), np.concatenate((middle, high))
    return np.sort(np.concatenate(known))


def _distance(r: np.ndarray, poles: np.ndarray) -> np.ndarray:
    """Distance of frequencies from the nearest pole, or from the origin."""
    nearest = np.abs(r[:, np.newaxis] - poles).min(axis=1, initial=np.inf)
    return np.minimum(nearest, r)


def stick_poles(system: System) -> np.ndarray:
    """Poles of the forces in contacts that are held: of the held structure, over the orders of the load."""
    modes, contacts = system.modes, system.contact_system
    held = contacts.vectors[~contacts.elastic]
    closed = pressed_stiffness(system) if contacts.has_phases else modes.stiffness
    stiffness = closed + (contacts.vectors.T * springs(contacts)) @ contacts.vectors
    p = complex_frequencies(modes.mass, modes.damping, stiffness, held)
    return (p / np.array(orders_of(contacts))[:, np.newaxis]).ravel()


def no_stop_poles(system: System, low: float) -> np.ndarray:
    """Poles of motions without stops down to a frequency: of the free structure, over orders of friction.

    Friction of one contact under one harmonic load is antiperiodic, with odd orders only.
    """
    modes = system.modes
    p = complex_frequencies(modes.mass, modes.damping, modes.stiffness, np.empty((0, system.n)))
    engine = engine_of(system)
    most = MOST_ORDERS if engine.has_closed_limits else _FOLLOWED_ORDERS
    found = []
    for one in p:
        merged = _MERGED * abs(one) / abs(one.imag) if one.imag else np.inf
        last = max(1.0, min(one.real / low + 1.0, merged, most))
        found.append(one / np.arange(1.0, last + 1.0, engine.order_step))
    return np.concatenate(found)
