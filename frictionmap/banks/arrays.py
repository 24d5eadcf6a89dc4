"""A system as arrays for the kernels."""

import numpy as np

from .._kernels.banks.fill import Grid
from .._kernels.banks.problem import Problem, Row
from .._kernels.phases.fill import Cells
from .._kernels.phases.problem import COUNT_ROWS
from ..phases.arrays import Modal
from .system import BankSystem, Start


def problem_of(system: BankSystem, modes: Modal, observed: np.ndarray) -> Problem:
    """The arrays of a system; `observed` (R, n) are further displacements whose extremes are wanted."""
    contacts = system.contacts
    first = np.concatenate(([0], np.cumsum([one.stiffness.size for one in contacts]))).astype(np.int64)
    spring = np.concatenate([one.stiffness for one in contacts])
    # summed from the last element on, so that the last level has exactly 0
    left = [np.concatenate((np.cumsum(one.stiffness[::-1])[::-1], [0.0])) for one in contacts]
    coupled = bool((modes.damping != np.diag(np.diag(modes.damping))).any())
    return Problem(
        modes.squares, np.ascontiguousarray(modes.damping), coupled,
        np.ascontiguousarray(np.array([one.direction for one in contacts]) @ modes.phi),
        np.array([one.moved for one in contacts], dtype=float), first, spring, np.concatenate(left),
        np.ascontiguousarray(observed @ modes.phi),
    )  # fmt: skip


def fastest(problem: Problem) -> float:
    """Bound on the rate of the fastest part of the motion at any level, in t = tau/r.

    The roots of l^2 + c l + k have moduli of (c + sqrt(c^2 + 4 k))/2 at most.
    """
    whole = problem.left[problem.first[:-1] + np.arange(problem.moved.size)]
    stiffness = np.diag(problem.squares) + problem.chi.T @ (whole[:, np.newaxis] * problem.chi)
    k, c = float(np.linalg.eigvalsh(stiffness)[-1]), float(np.linalg.norm(problem.damping, 2))
    return 0.5 * (c + np.sqrt(c * c + 4.0 * k))


def row_of(system: BankSystem, problem: Problem, modes: Modal, r: float) -> Row:
    """The constants of one frequency ratio."""
    orders = sorted({*system.loads, *system.base})
    phasors = np.zeros((len(orders), system.n + 1), dtype=complex)
    for n, load in system.loads.items():
        phasors[orders.index(n), :-1] = modes.phi.T @ load
    for n, place in system.base.items():
        phasors[orders.index(n), -1] = place
    parts = np.stack((phasors.real, -phasors.imag))
    load = np.abs(parts[:, :, :-1]).sum(axis=(0, 1))
    size = float((load / (modes.squares + r * r)).max())
    chi = problem.chi**2
    with np.errstate(divide="ignore", invalid="ignore"):  # nothing restores a rigid-body mode
        softness = (chi / modes.squares).sum(axis=1)
    damping = np.linalg.norm(problem.damping, 2) if problem.coupled else np.diag(problem.damping).max()
    return Row(
        r, float(max(orders, default=0)), float(damping), float(modes.squares.max()),
        size if size > 0.0 else 1.0, all(n % 2 == 1 for n in orders), np.array(orders, dtype=float),
        np.ascontiguousarray(parts), softness, chi.sum(axis=1),
    )  # fmt: skip


def modal_offset(system: BankSystem, modes: Modal) -> np.ndarray | None:
    """Displacements of the modes under the constant loads; None without any."""
    return None if system.offset is None else np.linalg.solve(modes.phi, system.offset)


def grid_of(
    system: BankSystem, modes: Modal, beta: np.ndarray, start: Start, cycles: int, places: bool = True
) -> Grid:
    """The cells of one frequency ratio; arguments as of `solve.sweep_banks`."""
    limits = [one.limits(beta) for one in system.contacts]
    state = np.stack([np.linalg.solve(modes.phi, one) for one in (start.x, start.v)])
    return Grid(
        np.asarray(beta, dtype=float), np.ascontiguousarray(np.concatenate(limits, axis=1)), state, start.tau,
        cycles, places,
    )  # fmt: skip


def allocate(problem: Problem, many: int) -> Cells:
    """Allocate cells."""
    contacts = problem.moved.size

    def empty(*shape: int) -> np.ndarray:
        return np.full((many, *shape), np.nan)

    width = problem.observed.shape[0] + 2 * contacts
    return Cells(
        empty(5), empty(COUNT_ROWS, contacts), empty(width), empty(width), empty(contacts), empty(contacts),
        empty(contacts), empty(0), empty(0), empty(0),
    )  # fmt: skip
