"""Work per cycle, and force transmitted to the ground, from first harmonics; theory.md 9.

The load and a moving base are harmonic, so that only first harmonics do work with them; these relations hold
in every regime.
"""

import math

import numpy as np

from ..model.modes import ModalModel


def work_input(modes: ModalModel, r: float, first: np.ndarray, friction: complex) -> float:
    """Work of the load per cycle, over P^2/k1; for a moving base, of everything that moves base and wall.

    Parameters
    ----------
    r : frequency ratio
    first : (n,) complex, first harmonics X_k1 of the displacements
    friction : first harmonic F_1 of the friction force against z'
    """
    load = modes.load + 1j * r * modes.load_rate
    work = float(np.sum(load * np.conj(first)).imag)
    if modes.base_motion:
        work -= friction.imag  # the wall moves against the friction force
    dashpots = modes.load_rate.real  # dashpots that end at the base move with it there
    return math.pi * (work + r * float(np.sum(dashpots * (1.0 - 2.0 * first.real))))


def damping_participation(modes: ModalModel, r: float) -> np.ndarray:
    """Harmonic part of the modal coordinates relative to the other ends of their dashpots, complex (n,).

    These ends may move with the base.  0 for undamped modes, which have no dashpots.
    """
    at = np.array([r])
    damped = modes.zeta > 0.0
    parts = np.where(damped, modes.modal_responses(at, modes.participation(at))[0], 0.0)
    if modes.load_rate.any():
        parts -= np.where(damped, modes.phi.T @ modes.mass @ np.ones(damped.size), 0.0)
    return parts


def transmitted_first_harmonic(modes: ModalModel, r: float, first: np.ndarray) -> complex:
    """First harmonic of the force of springs, dashpots and wall on the ground: loads less inertia, over P.

    Forces of a moving base on the masses count as load, as in the equations of motion.
    """
    load = complex(np.sum(modes.load + 1j * r * modes.load_rate))
    return load + r * r * complex(np.sum(modes.mass @ first))
