"""A structure in the numbers that the kernels take: modes, held oscillators, loads and starts over r."""

import math
from dataclasses import dataclass

import numpy as np

from .._kernels.closed_form import damping_functions
from .._kernels.engine.extremes import Shapes
from .._kernels.engine.many_masses import Starts
from .._kernels.engine.policies import MOVING, MOVING_CAP
from .._kernels.structure.sliding_orbit import Continuous
from .._kernels.structure.state import CHI, MODE_ROWS, STATIC_SHAPE, Loads, Model
from ..model.held_structure import held_structure
from ..model.modes import ModalModel, angles, modulus, times
from ..model.system import System
from ..theory.boundaries import Curves

#: A share of the load smaller than this times n eps of the most that it could be is rounding; as in `modes`.
_ZERO_SHARE = 64.0


@dataclass(frozen=True)
class Structures:
    """A system at frequencies r: everything that its cells need; nothing of what moves is meant at r = 0."""

    participating: np.ndarray  # the modes that move the contact, chi != 0
    model: Model
    loads: Loads
    orbit: Continuous
    marginal: np.ndarray  # (n_r,) bool
    rest: Starts
    moving: Starts
    shapes: Shapes
    alone: np.ndarray  # (n_r, n_dof) phasor of what moves with the load alone; 0 where infinite
    resonant: np.ndarray  # (n_r, n_dof) bool, where that is infinite
    held: np.ndarray  # (n_r, n_dof) phasor of the displacements with the contact held


def _model(modes: ModalModel, participating: np.ndarray) -> Model:
    w, zeta, chi = modes.w[participating], modes.zeta[participating], modes.chi[participating]
    held = held_structure(w, zeta, chi)
    table = np.empty((MODE_ROWS, w.size))
    mass = 1.0 / np.sum(chi**2)  # m_eff
    load, load_rate = mass * chi * w**2, 2.0 * mass * chi * zeta * w
    table[:] = w, zeta, chi, held.static_shape, load, load_rate
    watch = np.concatenate((load, load_rate)) @ held.to_free
    return Model(
        table, held.omega, held.zeta, watch, np.ascontiguousarray(held.to_free),
        np.ascontiguousarray(held.to_held), 1.0 / mass, held.stiffness,
    )  # fmt: skip


def _shares(parts: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Real parts (n_r, n) @ rows.T, (n_r, m), exactly zero where it is zero but for rounding.

    A held oscillator that the load does not drive must not be driven by 1e-17: undamped at its resonance that
    would grow.
    """
    shares = times(parts, rows.T).real
    most = np.sqrt(times(parts * parts, np.ones((parts.shape[1], 1))).real) * np.linalg.norm(rows, axis=1)
    return np.where(np.abs(shares) <= _ZERO_SHARE * rows.shape[1] * np.finfo(float).eps * most, 0.0, shares)


def _loads(model: Model, r: np.ndarray, participation: np.ndarray) -> Loads:
    """cos and sin parts of Re(lambda e^{i tau}) on free modes, held oscillators and in the contact."""
    n = model.modes.shape[1]
    m = model.omega.size
    chi = model.modes[CHI]
    cosine, sine = participation.real, -participation.imag
    on_y, on_p = model.to_held[:m, n:], model.to_held[m:, n:]
    direct_cos, direct_sin = _shares(cosine, on_y), _shares(sine, on_y)
    # y' = p + direct: its derivative joins the load on y''
    rate = 2.0 * model.ratio * model.omega
    turn = r[:, np.newaxis]
    held_cos = _shares(cosine, on_p) + rate * direct_cos + turn * direct_sin
    held_sin = _shares(sine, on_p) + rate * direct_sin - turn * direct_cos
    in_contact = times(participation, chi[:, np.newaxis])[:, 0]
    contact_cos, contact_sin = in_contact.real / model.inverse_mass, -in_contact.imag / model.inverse_mass
    arrays = (
        cosine, sine, held_cos, held_sin, direct_cos, direct_sin, contact_cos, contact_sin,
    )  # fmt: skip
    return Loads(*(np.ascontiguousarray(a) for a in arrays))


def _orbit(
    modes: ModalModel, participating: np.ndarray, r: np.ndarray, participation: np.ndarray, curves: Curves
) -> Continuous:
    stiffness = modes.dynamic_stiffness(r)[:, participating]
    resonant = stiffness == 0.0
    response = np.where(resonant, np.inf, participation / np.where(resonant, 1.0, stiffness))
    u, g = np.empty((2, r.size, participating.size))
    for k, i in enumerate(participating):
        for j, value in enumerate(r):
            u[j, k], g[j, k] = damping_functions(modes.w[i], modes.zeta[i], value)
    return Continuous(
        np.ascontiguousarray(response.real), np.ascontiguousarray(response.imag), u, g,
        modulus(curves.v), angles(curves.v), curves.u, curves.g,
    )  # fmt: skip


def _rest(modes: ModalModel, participating: np.ndarray, n_r: int) -> Starts:
    """Every mass at rest at 0, one on a joined base-wall at the base's displacement; tau = 0."""
    c = modes.contact
    x = modes.base_motion * (c / (c @ c) - 1.0)  # relative to the base
    place = (modes.phi[:, participating].T @ modes.mass @ x)[np.newaxis].repeat(n_r, axis=0)
    return Starts(place, np.zeros_like(place), np.ones(n_r), np.zeros(n_r))


def _moving(
    modes: ModalModel, participating: np.ndarray, r: np.ndarray, participation: np.ndarray, force: np.ndarray
) -> Starts:
    """The contact at z = 0, every mode at its largest speed; the load in the held contact falls through 0.

    Its amplitude is 1.5 times what the load alone sustains of it, that taken as 10 times its static answer at
    most; `force` (n_r,) is the phasor of the held load.
    """
    w = modes.w[participating]
    stiffness = np.ascontiguousarray(modulus(modes.dynamic_stiffness(r)[:, participating]))
    with np.errstate(divide="ignore"):
        gain = np.minimum(1.0 / stiffness, MOVING_CAP / w**2)
    size = MOVING * modulus(participation) * gain * np.maximum(w, r[:, np.newaxis])
    lead = np.where(np.isfinite(force), angles(force), 0.0)
    sine, cosine = (np.array([function(angle) for angle in lead]) for function in (math.sin, math.cos))
    return Starts(np.zeros_like(size), size * np.sign(modes.chi[participating]), sine, cosine)


def _alone(modes: ModalModel, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Phasor (n_r, n_dof) of the base's motion and of the modes that do not participate; where infinite."""
    idle = np.flatnonzero(modes.chi == 0.0)
    stiffness = modes.dynamic_stiffness(r)[:, idle]
    loads = modes.relative_participation(r)[:, idle]
    resonant = (stiffness == 0.0) & (loads != 0.0)
    parts = np.where(stiffness == 0.0, 0.0, loads / np.where(stiffness == 0.0, 1.0, stiffness))
    alone = modes.base_motion + times(parts, modes.phi[:, idle].T)
    return alone, (resonant.astype(float) @ np.abs(modes.phi[:, idle].T)) > 0.0


def _marginal(w: np.ndarray, zeta: np.ndarray, r: np.ndarray) -> np.ndarray:
    """Whether continuous motions at r form a continuum (n_r,): some free vibration leaves the turns alone.

    An undamped mode that turns n times in half a period of the load does, r = w_k/(2 n), T(3.33).  Two do
    together, their velocities cancelling in the contact, where that is so of the sum or the difference of
    their frequencies: w_k -+ w_j = 2 n r, to the rounding of the two.
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


def _shapes(model: Model, phi: np.ndarray) -> Shapes:
    """Displacements of the masses; `phi` (n_dof, n) of the participating modes."""
    n = phi.shape[1]
    # contiguous, all of them: another memory layout would be another type to the kernels, compiled anew
    return Shapes(
        np.concatenate((phi, np.zeros_like(phi)), axis=1), np.ascontiguousarray(phi @ model.to_free[:n]),
        phi @ model.modes[STATIC_SHAPE], np.zeros(phi.shape[0]),
    )  # fmt: skip


def structures(system: System, r: np.ndarray, curves: Curves) -> Structures:
    """Everything that the cells of a system need at frequencies r, for which `curves` are."""
    modes = system.modes
    participating = np.flatnonzero(modes.chi)
    model = _model(modes, participating)
    alone, resonant = _alone(modes, r)
    held, force = modes.held(r)
    held = held + modes.base_motion
    r = np.where(r > 0.0, r, 1.0)  # no cell at r = 0 is followed: any other number does
    participation = np.ascontiguousarray(modes.relative_participation(r)[:, participating])
    return Structures(
        participating, model, _loads(model, r, participation),
        _orbit(modes, participating, r, participation, curves),
        _marginal(modes.w[participating], modes.zeta[participating], r), _rest(modes, participating, r.size),
        _moving(modes, participating, r, participation, force), _shapes(model, modes.phi[:, participating]),
        np.ascontiguousarray(alone), resonant,
        np.ascontiguousarray(held),
    )  # fmt: skip
