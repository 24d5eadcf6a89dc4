"""A structure as arrays for the kernels: modes, held oscillators, loads and initial states over r."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .._kernels.closed_form import damping_functions
from .._kernels.engine.extremes import OutputMatrices
from .._kernels.engine.many_masses import Starts
from .._kernels.engine.policies import MOVING_START, MOVING_START_CAP
from .._kernels.structure.sliding_orbit import Continuous
from .._kernels.structure.state import MODE_ROWS, STATIC_SHAPE, Loads, Model
from ..model.balance import dynamic_stiffness
from ..model.free_structure import FreeStructure
from ..model.held_structure import HeldStructure, held_structure
from ..model.modes import ModalModel, angles, modulus, times
from ..model.system import System
from ..theory.boundary_curves import Curves

#: A share of the load below this factor times n eps of its upper bound is rounding error, as in `modes`.
_ZERO_SHARE = 64.0

#: cos and sin parts.
Phase = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class StructureArrays:
    """A system at frequencies r, as arrays for its cells; values of the moving structure at r = 0 are
    placeholders.
    """

    participating: np.ndarray  # indices of the participating modes
    model: Model
    loads: Loads
    orbit: Continuous
    marginal: np.ndarray  # (n_r,) bool
    rest: Starts
    moving: Starts
    outputs: OutputMatrices
    uncoupled: np.ndarray  # (n_r, n_dof) phasor of what moves with the load alone; 0 where infinite
    resonant: np.ndarray  # (n_r, n_dof) bool, where that is infinite
    held: np.ndarray  # (n_r, n_dof) phasor of the displacements with the contact held


def _contact_rows(modes: ModalModel, which: np.ndarray, mass: float) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients of the participating modes and of their velocities in the load in the contact."""
    w, zeta, chi = modes.w[which], modes.zeta[which], modes.chi[which]
    load, load_rate = mass * chi * w**2, 2.0 * mass * chi * zeta * w
    coupling = modes.participating_coupling()
    return load, load_rate if coupling is None else load_rate + mass * (chi @ coupling)


def _model(modes: ModalModel, which: np.ndarray, held: HeldStructure) -> Model:
    """Build the numerical model of the system, independent of r."""
    free, w, chi = modes.free, modes.w[which], modes.chi[which]
    n = w.size
    mass = 1.0 / np.sum(chi**2)  # m_eff
    load, load_rate = _contact_rows(modes, which, mass)
    watch = np.concatenate((load, load_rate)) @ held.to_free
    # a force in the contact has no feedthrough: its static response involves coordinates only
    shape = (free.to_oscillators @ np.append(held.static_shape, np.zeros(n)))[:n]
    nothing = np.zeros(n)
    rows = np.array((np.append(load, load_rate), np.append(chi, nothing), np.append(nothing, chi)))
    table = np.zeros((MODE_ROWS, n))
    table[:4] = free.omega, free.zeta, free.push, shape
    table[4:10] = (rows @ free.to_modes).reshape(6, n)
    reach = math.sqrt(sum((a / b) * (a / b) + c * c for a, b, c in zip(load, w, load_rate, strict=True)))
    return Model(
        table, held.omega, held.zeta, watch,
        np.ascontiguousarray(free.to_oscillators @ held.to_free),
        np.ascontiguousarray(held.to_held @ free.to_modes), 1.0 / mass, held.stiffness, reach,
        abs(float(chi @ load_rate)) * math.sqrt(mass) / reach, free.norm(w),
    )  # fmt: skip


def _shares(parts: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Real parts (n_r, n) @ rows.T, (n_r, m), exactly zero where they are rounding error.

    A held oscillator without load must not be driven by 1e-17: undamped at its resonance it would grow.
    """
    shares = times(parts, rows.T).real
    most = np.sqrt(times(parts * parts, np.ones((parts.shape[1], 1))).real) * np.linalg.norm(rows, axis=1)
    return np.where(np.abs(shares) <= _ZERO_SHARE * rows.shape[1] * np.finfo(float).eps * most, 0.0, shares)


class _Driven(NamedTuple):
    """cos and sin of the load on oscillators, and of its feedthrough into their velocities."""

    cos: np.ndarray
    sin: np.ndarray
    feedthrough_cos: np.ndarray
    feedthrough_sin: np.ndarray


def _driven(rate: np.ndarray, r: np.ndarray, on_y: Phase, on_p: Phase) -> _Driven:
    """Convert loads (cos, sin) on y and on p to the load of y'' + rate y' + ... = load.

    y' = p + feedthrough, whose derivative adds to the load on y''.
    """
    turn = r[:, np.newaxis]
    cosine = on_p[0] + rate * on_y[0] + turn * on_y[1]
    return _Driven(cosine, on_p[1] + rate * on_y[1] - turn * on_y[0], *on_y)


def _on_held(held: HeldStructure, r: np.ndarray, participation: np.ndarray) -> _Driven:
    """Load on the held oscillators."""
    m, n = held.omega.size, held.static_shape.size
    cosine, sine = participation.real, -participation.imag
    on_y, on_p = held.to_held[:m, n:], held.to_held[m:, n:]
    return _driven(
        2.0 * held.zeta * held.omega, r, (_shares(cosine, on_y), _shares(sine, on_y)),
        (_shares(cosine, on_p), _shares(sine, on_p)),
    )  # fmt: skip


def _on_free(free: FreeStructure, r: np.ndarray, participation: np.ndarray) -> _Driven:
    """Load on the free oscillators."""
    n = free.omega.size
    loads = times(participation, free.to_oscillators[:, n:].T) if free.coupled else participation
    nothing = np.zeros_like(participation)
    on_y, on_p = (loads[:, :n], loads[:, n:]) if free.coupled else (nothing, loads)
    return _driven(2.0 * free.zeta * free.omega, r, (on_y.real, -on_y.imag), (on_p.real, -on_p.imag))


def _loads(model: Model, free: _Driven, held: _Driven, in_contact: np.ndarray) -> Loads:
    """Combine cos and sin of the load on free and held oscillators, and in the contact, phasor (n_r,)."""
    contact_cos, contact_sin = in_contact.real / model.inverse_mass, -in_contact.imag / model.inverse_mass
    return Loads(*(np.ascontiguousarray(a) for a in (*free, *held, contact_cos, contact_sin)))


def _orbit(free: FreeStructure, r: np.ndarray, driven: _Driven, curves: Curves) -> Continuous:
    """Response functions of the continuous orbit."""
    stiffness = dynamic_stiffness(free.omega, free.zeta, r).rows()
    resonant = stiffness == 0.0
    load = np.empty(stiffness.shape, dtype=complex)
    load.real, load.imag = driven.cos, -driven.sin
    response = np.where(resonant, np.inf, load / np.where(resonant, 1.0, stiffness))
    u, g = np.empty((2, r.size, free.omega.size))
    for k, mode in enumerate(zip(free.omega, free.zeta, strict=True)):
        for j, value in enumerate(r):
            u[j, k], g[j, k] = damping_functions(*mode, value)
    return Continuous(
        np.ascontiguousarray(response.real), np.ascontiguousarray(response.imag), u, g,
        modulus(curves.v), angles(curves.v), curves.u, curves.g,
    )  # fmt: skip


def _start(
    free: FreeStructure, place: np.ndarray, velocity: np.ndarray, phase: Phase, driven: _Driven
) -> Starts:
    """Convert modal coordinates and velocities (n_r, n) at the load phase (cos, sin) to the oscillators."""
    cosine, sine = phase
    if free.coupled:
        n = free.omega.size
        state = times(np.concatenate((place, velocity), axis=1), free.to_oscillators.T).real
        # contiguous, both: another memory layout would be another type to the kernels
        place, velocity = np.ascontiguousarray(state[:, :n]), np.ascontiguousarray(state[:, n:])
        velocity += (
            driven.feedthrough_cos * cosine[:, np.newaxis] + driven.feedthrough_sin * sine[:, np.newaxis]
        )
    return Starts(place, velocity, cosine, sine)


def _rest(modes: ModalModel, participating: np.ndarray, driven: _Driven) -> Starts:
    """Initial state with every mass at rest at 0, the mass at a joined base-wall at the base's displacement;
    tau = 0.
    """
    c = modes.contact
    x = modes.base_motion * (c / (c @ c) - 1.0)  # relative to the base
    n_r = len(driven.cos)
    place = (modes.phi[:, participating].T @ modes.mass @ x)[np.newaxis].repeat(n_r, axis=0)
    return _start(modes.free, place, np.zeros_like(place), (np.ones(n_r), np.zeros(n_r)), driven)


def _moving(
    modes: ModalModel, participating: np.ndarray, r: np.ndarray, participation: np.ndarray, force: np.ndarray,
    driven: _Driven,
) -> Starts:  # fmt: skip
    """Initial state with z = 0 and every mode at its largest speed, while the load in the held contact falls
    through 0.

    The amplitude of each mode is 1.5 times its response without friction, that response limited to 10 times
    the static one; `force` (n_r,) is the phasor of the load in the held contact.
    """
    w = modes.w[participating]
    stiffness = np.ascontiguousarray(modulus(modes.dynamic_stiffness(r)[:, participating]))
    with np.errstate(divide="ignore"):
        gain = np.minimum(1.0 / stiffness, MOVING_START_CAP / w**2)
    size = MOVING_START * modulus(participation) * gain * np.maximum(w, r[:, np.newaxis])
    lead = np.where(np.isfinite(force), angles(force), 0.0)
    sine, cosine = (np.array([function(angle) for angle in lead]) for function in (math.sin, math.cos))
    velocity = size * np.sign(modes.chi[participating])
    return _start(modes.free, np.zeros_like(size), velocity, (sine, cosine), driven)


def _uncoupled_response(modes: ModalModel, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Phasor (n_r, n_dof) of base motion and modes that do not participate, and where it is infinite."""
    idle = ~modes.participating
    parts = modes.modal_responses(r, np.where(idle, modes.relative_participation(r), 0.0))[:, idle]
    resonant = np.isinf(parts)
    uncoupled = modes.base_motion + times(np.where(resonant, 0.0, parts), modes.phi[:, idle].T)
    return uncoupled, (resonant.astype(float) @ np.abs(modes.phi[:, idle].T)) > 0.0


def _marginal(w: np.ndarray, zeta: np.ndarray, r: np.ndarray) -> np.ndarray:
    """Whether the continuous motions at r form a continuum (n_r,): a free vibration exists that leaves the
    turns unchanged.

    This holds for an undamped mode that turns n times in half a period of the load, r = w_k/(2 n), T(3.33).
    It holds for two modes together, whose velocities cancel in the contact, where the sum or the difference
    of their frequencies satisfies w_k -+ w_j = 2 n r, to the rounding of both.
    """
    free = w[zeta == 0.0]
    found = (free >= 2.0 * r[:, np.newaxis]) & (np.mod(0.5 * free / r[:, np.newaxis], 1.0) == 0.0)
    found = found.any(axis=1)
    for k in range(1, free.size):
        for both in (free[k] + free[:k], free[k] - free[:k]):
            turns = 0.5 * both / r[:, np.newaxis]
            off = np.abs(turns - np.round(turns)) * r[:, np.newaxis]
            found |= ((turns > 0.5) & (off <= 1e-15 * free[k])).any(axis=1)
    return found


def _displacement_outputs(model: Model, free: FreeStructure, phi: np.ndarray) -> OutputMatrices:
    """Output matrices of the displacements of the masses; `phi` (n_dof, n) of the participating modes."""
    n = phi.shape[1]
    # contiguous, all of them: another memory layout would be another type to the kernels, compiled anew
    nothing = np.zeros(phi.shape[0])
    if free.coupled:
        rows = phi @ free.to_modes[:n]
        return OutputMatrices(rows, rows @ model.to_free, rows[:, :n] @ model.modes[STATIC_SHAPE], nothing)
    return OutputMatrices(
        np.concatenate((phi, np.zeros_like(phi)), axis=1), np.ascontiguousarray(phi @ model.to_free[:n]),
        phi @ model.modes[STATIC_SHAPE], nothing,
    )  # fmt: skip


def structure_arrays(system: System, r: np.ndarray, curves: Curves) -> StructureArrays:
    """Build the arrays of a system for its cells at frequencies r, with the `curves` there."""
    modes, free = system.modes, system.modes.free
    which = np.flatnonzero(modes.participating)
    chi = modes.chi[which]
    fixed = held_structure(modes.w[which], modes.zeta[which], chi, modes.participating_coupling())
    model = _model(modes, which, fixed)
    uncoupled, resonant = _uncoupled_response(modes, r)
    held, force = modes.held(r)
    held = held + modes.base_motion
    r = np.where(r > 0.0, r, 1.0)  # placeholder: no cell at r = 0 is followed
    participation = np.ascontiguousarray(modes.relative_participation(r)[:, which])
    on_free, on_held = _on_free(free, r, participation), _on_held(fixed, r, participation)
    return StructureArrays(
        which, model, _loads(model, on_free, on_held, times(participation, chi[:, np.newaxis])[:, 0]),
        _orbit(free, r, on_free, curves), _marginal(free.omega, free.zeta, r),
        _rest(modes, which, on_free), _moving(modes, which, r, participation, force, on_free),
        _displacement_outputs(model, free, modes.phi[:, which]), np.ascontiguousarray(uncoupled), resonant,
        np.ascontiguousarray(held),
    )  # fmt: skip
