"""Energies of one motion over time: stored, lost in the contacts, lost in the damping."""

import numpy as np

from .structure import Structure

#: Places of Gauss's rule of two points in an interval 0 to 1; both have the weight 1/2.
_GAUSS = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3.0)


def energies_over_time(
    structure: Structure, stored: np.ndarray, belt: np.ndarray, states: np.ndarray, slider: np.ndarray
) -> dict[str, np.ndarray]:
    """Energies at the states of a motion, which include both sides of all events.

    In between every contact slides in one sense, so that the loss of a constant friction force is exact.
    Of a force that varies it is by the trapezoidal rule, and of dampers by a cubic through both states.

    Parameters
    ----------
    stored : (times,) energy of masses and springs
    belt : (N,) velocities of the walls
    states : (1 + 2 m + N or more, times) time, q, q', friction forces of the contacts
    slider : (N, times) places of what slides: of the contact, or of the slider of one with a spring
    """
    m, contacts = structure.modal.squares.size, belt.size
    time, q, p = states[0], states[1 : 1 + m], states[1 + m : 1 + 2 * m]
    force = states[1 + 2 * m : 1 + 2 * m + contacts]
    slid = np.diff(slider, axis=1) - belt[:, np.newaxis] * np.diff(time)
    return {
        "stored_energy": stored,
        "lost_friction": _summed(0.5 * (force[:, 1:] + force[:, :-1]) * slid),
        "lost_damping": _summed(_damped(structure.modal.damping, time, q, p)),
    }


def _summed(steps: np.ndarray) -> np.ndarray:
    """Sums from the beginning, 0 there."""
    return np.concatenate((np.zeros((*steps.shape[:-1], 1)), np.cumsum(steps, axis=-1)), axis=-1)


def _damped(damping: np.ndarray, time: np.ndarray, q: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Loss q'.C q' dt between neighbouring states, of a cubic with their places and velocities."""
    h = np.diff(time)
    mean = np.divide(np.diff(q, axis=1), h, out=np.zeros((q.shape[0], h.size)), where=h > 0.0)
    begin, end, lost = p[:, :-1], p[:, 1:], np.zeros(h.size)
    for s in _GAUSS:
        rate = (1.0 - s) * (1.0 - 3.0 * s) * begin + s * (3.0 * s - 2.0) * end + 6.0 * s * (1.0 - s) * mean
        lost += 0.5 * h * np.einsum("it,ij,jt->t", rate, damping, rate)
    return lost
