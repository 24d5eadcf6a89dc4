"""Initial states: at rest, or in a large sliding motion, as in the engine of one rigid contact.

The moving start has z = 0 and every mode at 1.5 times its largest speed without friction, in the direction
that slides the contact upwards, while the load in the held contact falls through 0.  Under several harmonics
the speeds of a mode add up, and the load is that of the lowest order.  Of several contacts it is the one with
the largest load, of equal ones the first.
"""

import numpy as np

from .._kernels.engine.policies import MOVING_START, MOVING_START_CAP
from .._kernels.general.problem import Problem
from ..model.settings import Start
from ..model.system import System
from .boundaries import load_velocities, moving_alone, rest_states
from .held import possible_forces
from .problem import ModalSystem, general_of

#: Loads that differ by this share are equal: far above the rounding error of a solution of a few equations.
_EQUAL = 1e-9


def initial_states(system: System, problem: Problem, modal: ModalSystem, start: Start) -> np.ndarray:
    """Modes, their velocities q', and the phase at which they are so, (n_r, 3, m); see `from_rest`."""
    r = np.where(problem.r > 0.0, problem.r, 1.0)  # placeholder: no cell at r = 0 is followed
    return states_at(system, modal, r, start)


def states_at(system: System, modal: ModalSystem, r: np.ndarray, start: Start) -> np.ndarray:
    """The states of `initial_states` at r > 0."""
    if start == "moving":
        return _moving_states(system, modal, r)
    rest = rest_states(system, modal, r)
    return np.concatenate((rest, np.zeros_like(rest[:, :1])), axis=1)


def _moving_states(system: System, modal: ModalSystem, r: np.ndarray) -> np.ndarray:
    """States of the moving start; masses move with a base to which a wall is joined."""
    general = general_of(system)
    direction, phase = _loaded_contact(system, modal, r)
    speeds = _largest_speeds(system, modal, r) * direction
    alone = moving_alone(system, modal)
    speeds[:, alone] = load_velocities(system, modal, r, phase)[:, alone]
    state = np.stack((np.zeros_like(speeds), speeds, np.repeat(phase[:, np.newaxis], speeds.shape[1], 1)), 1)
    joined, of_points = any(group.base for group in general.groups), general.shaken_points is not None
    if joined != of_points:  # the start is relative to the base and the coordinates are not, or the reverse
        ones = modal.phi.T @ general.moved(modal.mass)
        for order, u in general.base.items():
            wave = (-u if of_points else u) * np.exp(1j * order * phase)[:, np.newaxis]
            state[:, 0] += wave.real * ones
            state[:, 1] += (1j * order * wave).real * ones
    return state


def _loaded_contact(system: System, modal: ModalSystem, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Signs of the modes (n_r, m) in the contact with the largest load, and phases (n_r,), at which it falls
    through 0.

    At a resonance of the held structure the load has no phase; it counts as one in phase with cos(tau).
    """
    forces, _ = possible_forces(system, r)
    loads = np.stack(list(forces.values()), axis=-1)  # (n_r, N, H)
    rows = np.arange(r.size)
    sizes = np.abs(loads).max(axis=-1)
    contact = np.argmax(sizes >= (1.0 - _EQUAL) * sizes.max(axis=1, keepdims=True), axis=1)
    load = loads[rows, contact]
    lowest = np.argmax(load != 0.0, axis=1)
    found = load[rows, lowest]
    lead = np.angle(np.where(np.isfinite(found), found, 1.0))
    order = np.array(list(forces))[lowest]
    return np.sign(modal.chi[contact]), np.mod((0.5 * np.pi - lead) / order, 2.0 * np.pi)


def _largest_speeds(system: System, modal: ModalSystem, r: np.ndarray) -> np.ndarray:
    """1.5 times the largest speeds q' of the modes without friction, each response limited to
    `MOVING_START_CAP` times the static one, (n_r, m).
    """
    general = general_of(system)
    w, damping = np.sqrt(modal.squares), np.diag(modal.damping)
    found = np.zeros((r.size, w.size))
    for order in {*general.forces, *general.base}:
        turn = order * r[:, np.newaxis]
        with np.errstate(divide="ignore"):
            gain = np.minimum(
                1.0 / np.abs(modal.squares - turn**2 + 1j * damping * turn), MOVING_START_CAP / modal.squares
            )
        found += np.abs(_participation(system, modal, order, turn)) * gain * np.maximum(w, turn)
    return MOVING_START * found / r[:, np.newaxis]


def _participation(system: System, modal: ModalSystem, order: int, turn: np.ndarray) -> np.ndarray:
    """Modal loads of a harmonic, (n_r, m) for `turn` (n_r, 1) = n r: on displacements relative to the base
    where a wall is joined to it.
    """
    general = general_of(system)
    u, by_damping = general.base.get(order, 0.0), general.moved(modal.viscous)
    load = general.forces.get(order, np.zeros(len(modal.mass))) + 0j * turn
    if any(group.base for group in general.groups):
        load = load + u * turn**2 * general.moved(modal.mass)
        by_damping = -by_damping * (system.damping_reference != "base")
    else:
        load = load + u * general.moved(modal.stiffness)
        by_damping = by_damping * (system.damping_reference == "base")
    return (load + 1j * turn * u * by_damping) @ modal.phi
