"""A system under channels as arrays for the kernels, and the quantities that are watched of it."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from .._kernels.general.problem import Problem
from ..errors import InputError
from ..general.problem import (
    ModalSystem,
    coupling_of,
    fastest,
    law_of,
    modal_system,
    refuse_loop,
    spring_matrix,
    springs,
    ties,
)
from ..model.general import ContactSystem, in_general_form, refuse_banks, refuse_phases
from ..model.points import Points
from ..model.system import System
from .channels import Drive


class Structure(NamedTuple):
    """A system in modal coordinates."""

    system: System
    modal: ModalSystem
    spring: np.ndarray  # (N,)
    rate: float  # bound on the rate of free motion

    @property
    def points(self) -> Points | None:
        """The points of a structure given by modes."""
        return self.system.contact_system.points

    @property
    def softer(self) -> bool:
        """Whether modes that are left out add a residual flexibility."""
        return self.points is not None and self.points.residual is not None

    @property
    def shapes(self) -> np.ndarray:
        """Displacements of the masses, or points, by the modes, (n, m) or (p, m)."""
        return self.modal.phi if self.modal.points is None else self.modal.points.shapes

    @property
    def own_springs(self) -> np.ndarray:
        """Stiffness of the springs in the contacts alone, 0 where one is rigid, (N,)."""
        return np.array([group.stiffness or 0.0 for group in self.system.contact_system.groups])

    @property
    def given_modes(self) -> np.ndarray:
        """Displacements of the modes that a structure is given by, x = Phi q over P/k_1, by these, (m, m)."""
        return self.modal.phi * (np.sqrt(self.system.stiffness_scale) / self.system.omega_1)

    def beside_modes(self, forces: np.ndarray) -> np.ndarray:
        """What forces in the contacts (N, ...) displace beside the modes: the points, (p, ...)."""
        assert self.modal.points is not None
        return np.asarray(self.modal.points.forces @ forces)


class Watched(NamedTuple):
    """Where quantities stand in the table of weights."""

    weights: np.ndarray  # (Q, 2 m + N + D), or with further forces before the channels
    places: dict[str, slice]


def structure_of(system: System, opens: bool = False) -> Structure:
    """Modes of a system; opens: contacts that open and piecewise linear springs may be there."""
    if not opens:
        refuse_phases(
            system, "bound motions under records",
            "motions of contacts that open and of piecewise linear springs may move apart, so that no bound "
            "holds at all times; follow both motions by history and compare them",
        )  # fmt: skip
    system = in_general_form(system)
    general = system.contact_system
    if general.points is not None:
        refuse_banks(system, "compute motions under records of a structure given by modes")
    refuse_loop(general)
    if general.flexibility.size and any(group.first.normal_record is not None for group in general.groups):
        raise InputError(
            "cannot use",
            "normal_record",
            "with a residual flexibility that couples contacts: a slider that slips at once under less "
            "normal load would move the others; use with_residual = false of a beam or plate, or omit "
            "residual",
        )
    if any(group.first.nu for group in general.groups):
        raise InputError(
            "cannot use",
            "normal_load",
            "in a motion in time: its load has no period; give the contact a normal_record",
        )
    modal = modal_system(system)
    return Structure(system, modal, springs(general), fastest(modal, spring_matrix(general)))


def _belts(general: ContactSystem) -> np.ndarray:
    """Velocities of the walls; at r = 1 both are over omega_1 P/k_1."""
    return np.array([group.first.wall_velocity + group.first.wall_speed for group in general.groups])


def varying(drive: Drive) -> np.ndarray:
    """Whether the normal load of each contact varies, (N,) bool."""
    return np.abs(drive.normal).max(axis=1, initial=0.0) > 0.0


def ties_of(structure: Structure) -> np.ndarray:
    """The rigid contacts that keep both ends of springs at rest, see `general.problem.ties`."""
    general = structure.system.contact_system
    moved = general.joined
    return ties(general.vectors, moved, _belts(general), structure.spring)


def problem_of(structure: Structure, drive: Drive) -> Problem:
    """The arrays of a system under the channels of a record."""
    modal, general = structure.modal, structure.system.contact_system
    push = np.ascontiguousarray(modal.phi.T @ drive.push)
    largest = np.abs(drive.terms).sum(axis=2).max(axis=0)
    belt = _belts(general)
    # a slider under a varying normal load slips between ends at rest, too: it is watched there
    tied = ties_of(structure)
    tied[varying(drive)] = False
    size = float((np.abs(push) @ largest / (modal.squares + 1.0)).max())
    return Problem(
        modal.squares, modal.damping, bool((modal.damping != np.diag(np.diag(modal.damping))).any()),
        np.ascontiguousarray(modal.chi), push, np.ascontiguousarray(drive.base),
        np.ascontiguousarray(drive.normal), structure.spring, belt,
        tied, np.empty(0), np.ones(1),
        np.empty((1, 2, drive.push.shape[1], 0)), np.array([structure.rate]),
        np.array([size if size > 0.0 else 1.0]), False, law_of(structure.system, modal),
        coupling=coupling_of(general),
    )  # fmt: skip


def watched_of(
    structure: Structure, problem: Problem, drive: Drive, further: Mapping[str, np.ndarray] | None = None
) -> Watched:
    """The quantities whose peaks are kept, as sums of q, q', f, further forces and L.

    further : vectors (..., m) of further forces by name, which are watched
    """
    modal, others = structure.modal, further or {}
    m = modal.squares.size
    contacts, channels = structure.spring.size, drive.push.shape[1]
    vectors = np.concatenate([modal.chi, *others.values()])
    size = 2 * m + len(vectors) + channels
    q, p = np.eye(m, size), np.eye(m, size, m)
    forces = np.eye(len(vectors), size, 2 * m)
    f, load = forces[:contacts], np.eye(channels, size, size - channels)
    inertia = (
        -problem.squares[:, np.newaxis] * q - problem.damping @ p + problem.push @ load - vectors.T @ forces
    )
    rows = {
        "x": structure.shapes @ q,
        "z": problem.chi @ q - problem.base @ load,
        "acceleration": structure.shapes @ inertia + _carried(structure, drive.acceleration @ load),
        "friction": f,
        "base_force": _base_force(structure, q, p),
        "spring_force": _spring_forces(structure) @ q,
    }
    if structure.points is not None and structure.softer:
        beside = drive.place @ load + structure.beside_modes(f)
        rows["x"] = rows["x"] + beside
        rows["z"] = rows["z"] + structure.points.vectors @ structure.beside_modes(f)
        rows["acceleration"] = np.empty((0, size))  # there velocities jump
    begin = contacts
    for name, one in others.items():
        rows[name] = forces[begin : begin + len(one)]
        begin += len(one)
    places, begin = {}, 0
    for name, row in rows.items():
        places[name] = slice(begin, begin + len(row))
        begin += len(row)
    return Watched(np.ascontiguousarray(np.vstack(list(rows.values()))), places)


def _carried(structure: Structure, acceleration: np.ndarray) -> np.ndarray:
    """Accelerations of the masses, or points, with the base, as sums of the units (U,): (n, U)."""
    carried = np.ones(structure.system.n) if structure.points is None else structure.points.carried
    return np.outer(carried, acceleration)


def _base_force(structure: Structure, q: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Force of the base on springs and dampers, as sums of the units, (1, U); (0, U) of points: not known."""
    modal = structure.modal
    if structure.points is not None:
        return np.empty((0, q.shape[1]))
    restoring = modal.stiffness @ modal.phi @ q + modal.viscous @ modal.phi @ p
    return np.asarray(-restoring.sum(axis=0, keepdims=True))


def _spring_forces(structure: Structure) -> np.ndarray:
    """Forces in the springs of a chain by the modes, (n, m); none of matrices."""
    system, phi = structure.system, structure.shapes
    if system.stiffness_ratios is None:
        return np.empty((0, phi.shape[1]))
    stretch = np.diff(phi, axis=0, prepend=0.0)
    return np.array(system.stiffness_ratios)[:, np.newaxis] * stretch
