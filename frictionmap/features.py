"""Features of the regimes and of the continuous response that need no map: limits, peaks, invariant points.

Equation numbers are those of theory.md 7 and of the thesis (T).
"""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from . import checks
from ._kernels.boundary.damping import first_damping_functions
from .errors import InputError
from .model.modes import ModalModel
from .model.system import System

#: Invariant points crowd towards r = 0, where hardly any motion is continuous: no more than so many are
#: looked for, from the highest down.
MOST_POINTS = 1000

#: Between two poles a change of sign is looked for at these shares of the way: ever closer to the poles,
#: where a mode of little weight bends the sum only at its own.
_NEAR = 0.25 ** np.arange(1.0, 16.0)
_SHARES = np.unique(np.concatenate((_NEAR, 1.0 - _NEAR, np.arange(1.0, 16.0) / 16.0)))

#: Phases of a load that differ by less than this are one: a few units of rounding of an exponential.
_ONE_PHASE = 1e-14

_EPS = float(np.finfo(float).eps)

#: Steps to a root at most: every third is a halving, and no interval is halved more often than a double's
#: bits allow.
_STEPS = 200


class HighFrequency(NamedTuple):
    """Boundaries in the limit r -> infinity; infinite where they grow without bound."""

    beta_lim: float
    beta_stick: float


def peak_thresholds(system: System) -> np.ndarray:
    """Least beta for which the i-th resonant peak is finite, T(6.2), (6.26), (7.62); shape (n,).

    (pi/4)|lambda_i/chi_i| without damping; with it T(7.62), which is approximate.  Infinite for a mode that
    the contact does not see.
    """
    modes = system.modes
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.abs(np.diagonal(modes.participation(modes.w))) / np.abs(modes.chi)  # each at its own w
    x = math.pi * modes.zeta
    # (cosh x - 1)/(2 zeta sinh x) = tanh(x/2)/(2 zeta), which is pi/4 at zeta = 0
    factor = np.full(x.size, 0.25 * math.pi)
    np.divide(np.tanh(0.5 * x), 2.0 * modes.zeta, out=factor, where=modes.zeta > 0.0)
    return np.where(modes.chi == 0.0, np.inf, ratio * factor)


def peak_amplitudes(system: System, beta: float) -> np.ndarray:
    """Amplitude of every mass at every resonance, T(7.60), approximate; shape (n, n): mass, mode.

    It falls with beta on a straight line, to 0 at the mode's `peak_thresholds`; from there on NaN, as the
    motion is not continuous.  Infinite without damping.
    """
    beta = checks.number(beta, "beta", least=0.0)
    modes = system.modes
    part = np.abs(modes.phi * np.diagonal(modes.participation(modes.w))) / modes.w**2
    with np.errstate(divide="ignore", invalid="ignore"):
        # |phi chi|/w^2 sinh/(cosh - 1) is the frictionless peak over the threshold
        left = 1.0 - beta / peak_thresholds(system) if beta > 0.0 else np.ones(modes.w.size)
        peaks = np.where(part > 0.0, part / (2.0 * modes.zeta) * left, 0.0)
    return np.where(left > 0.0, peaks, np.nan)


def high_frequency_limits(system: System, mu: float = 1.0) -> HighFrequency:
    """beta_lim and beta_stick for r -> infinity, T(2.31), (6.8), (6.28), (6.29), with mu squared.

    Zero if the load acts elsewhere than on a mass in contact; a joined base-wall's grow with r^2, those of
    dashpots to the base with r.
    """
    mu = checks.number(mu, "mu", least=1.0)
    modes = system.modes
    if system.base_motion or modes.contact_acceleration(modes.load_rate) != 0.0:
        return HighFrequency(math.inf, math.inf)
    # where the parts that grow leave each other, what C makes of them in the next power of r is left:
    # c^T M^-1 (load - C M^-1 load_rate)
    left = modes.load - modes.damping @ np.linalg.solve(modes.mass, modes.load_rate)
    share = abs(modes.contact_acceleration(left)) / modes.inverse_mass
    return HighFrequency(float(share) * 2.0 / math.hypot(2.0 * mu, math.pi), float(share) / mu)


def quasi_static_displacement(system: System, beta: float) -> np.ndarray:
    """Displacements for r -> 0 while the contact slides: K x0 = p - beta c, T(6.5); shape (n,).

    They are those at tau = 0, where the load is the real part of its phasor, with the contact sliding
    towards larger z; the contact sticks instead if beta is not below beta_stick at r = 0.
    """
    beta = checks.number(beta, "beta", least=0.0)
    modes = system.modes
    return np.linalg.solve(modes.stiffness, modes.load.real - beta * modes.contact)


class _Range(NamedTuple):
    """A stretch of frequencies, and where in it the sums over modes turn sharply."""

    low: float
    high: float
    edges: np.ndarray  # increasing, strictly inside
    poles: np.ndarray  # of the edges, those where a sum may be infinite


def _range(modes: ModalModel, low: object, high: object, most: object) -> _Range:
    """The checked range, cut at its lower end so that it has at most about `most` edges.

    Edges are the natural frequencies and, of every seen mode that vibrates, the damped frequency over
    1, 3, 5...: there u of T(7.11) has its poles, or without them changes its sign.
    """
    low = checks.number(low, "low", above=0.0)
    high = checks.number(high, "high", above=low, most=checks.LARGEST_RATIO)
    most = checks.whole(most, "most", least=1)
    seen = (modes.chi != 0.0) & (modes.zeta < 1.0)
    edges, poles = [modes.w], [modes.w[modes.zeta == 0.0]]
    for w, zeta in zip(modes.w[seen], modes.zeta[seen], strict=True):
        top = w * math.sqrt((1.0 - zeta) * (1.0 + zeta))
        first = 2.0 * math.floor(0.5 * top / high) + 1.0
        last = min(top / low, first + 2.0 * most)
        found = top / np.arange(first, last + 1.0, 2.0)
        edges.append(found)
        if zeta == 0.0:
            poles.append(found)
    inside = [np.unique(np.concatenate(part)) for part in (edges, poles)]
    inside = [part[(part > low) & (part < high)] for part in inside]
    if inside[0].size > most:
        low = float(inside[0][-most - 1])
        inside = [part[part > low] for part in inside]
    return _Range(low, high, *inside)


def _polish(
    f: Callable[[np.ndarray, np.ndarray], np.ndarray],
    which: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    at_low: np.ndarray,
    at_high: np.ndarray,
) -> np.ndarray:
    """Roots of the functions `which` between low and high, all (n_roots,), to two units of rounding.

    The Illinois method: false position, where the value at an end that stays twice is halved; every third
    step is a bisection, which bounds their number.
    """
    root = high.copy()
    left = np.arange(low.size)
    stayed = np.zeros(low.size)  # which end did: -1 low, 1 high
    for step in range(_STEPS):
        least = 2.0 * _EPS * high
        open_ = (high - low > 2.0 * least) & (at_high != 0.0)
        root[left] = np.where(open_, root[left], high)
        left, which, low, high, at_low, at_high, least, stayed = (
            part[open_] for part in (left, which, low, high, at_low, at_high, least, stayed)
        )
        if left.size == 0:
            break
        if step % 3 == 2:
            new = 0.5 * (low + high)
        else:
            new = np.clip(low + (high - low) * (at_low / (at_low - at_high)), low + least, high - least)
        value = f(new, which)
        moves_low = value * np.sign(at_low) > 0.0
        low, high = np.where(moves_low, new, low), np.where(moves_low, high, new)
        at_high = np.where(moves_low, np.where(stayed > 0.0, 0.5 * at_high, at_high), value)
        at_low = np.where(moves_low, value, np.where(stayed < 0.0, 0.5 * at_low, at_low))
        stayed = np.where(moves_low, 1.0, -1.0)
    return root


def _roots(f: Callable[..., np.ndarray], where: _Range) -> list[np.ndarray]:
    """Roots with a change of sign of several functions.

    f(r) returns the values of all functions, (n_r, n_functions); f(r, which) those of one a frequency,
    (n_r,).  A pair of roots between two samples is missed.
    """
    edges = np.concatenate(([where.low], where.edges, [where.high]))
    r = np.unique(edges[:-1, np.newaxis] + np.diff(edges)[:, np.newaxis] * _SHARES)
    r = r[~np.isin(r, where.poles)]  # a narrow stretch has samples that round to its ends
    values = f(r)
    sign = np.sign(values)
    same_side = np.searchsorted(where.poles, r[1:]) == np.searchsorted(where.poles, r[:-1])
    k, which = np.nonzero((sign[1:] * sign[:-1] < 0.0) & same_side[:, np.newaxis])
    found = _polish(f, which, r[k], r[k + 1], values[k, which], values[k + 1, which])
    exact = (sign == 0.0) & (values != 0.0).any(axis=0)  # not of a function that is zero everywhere
    return [np.unique(np.concatenate((found[which == j], r[exact[:, j]]))) for j in range(values.shape[1])]


def _first_damping(modes: ModalModel, r: np.ndarray) -> np.ndarray:
    """u_i/w_i^2 chi_i, and 0 of modes that the contact does not see, whose u may be infinite; (n_r, n)."""
    seen = modes.chi != 0.0
    u = np.empty((r.size, int(seen.sum())))
    first_damping_functions(r, modes.w[seen], modes.zeta[seen], u)
    terms = np.zeros((r.size, seen.size))
    terms[:, seen] = u * (modes.chi / modes.w**2)[seen]
    return terms


def _sums(terms: np.ndarray, rows: np.ndarray, which: np.ndarray | None) -> np.ndarray:
    """Sums over modes, terms (n_r, n), with weights (n_rows, n): (n_r, n_rows), or (n_r,) of one a term."""
    return terms @ rows.T if which is None else np.einsum("ij,ij->i", terms, rows[which])


def invariant_points(system: System, low: float, high: float, most: int = MOST_POINTS) -> np.ndarray:
    """Frequency ratios in (low, high) where friction leaves z as it is: U = 0, T(6.9), increasing.

    Without damping amplitude and phase of z are there what they are without friction, and these are all
    such points: between two of its poles U falls from +inf to -inf, once.  With damping it is the phase.
    Of more than about `most` points the highest are returned.
    """
    modes = system.modes
    where = _range(modes, low, high, most)
    row = modes.chi[np.newaxis]
    return _roots(lambda r, which=None: _sums(_first_damping(modes, r), row, which), where)[0]


def _turned_load(modes: ModalModel) -> np.ndarray:
    """The load with its largest entry made real and positive, which turns the whole motion with it."""
    return modes.load * np.exp(-1j * np.angle(modes.load[np.argmax(np.abs(modes.load))]))


def one_phase(system: System) -> bool:
    """Whether all masses are loaded in phase, or in opposition: with two phases no amplitude is invariant."""
    turned = _turned_load(system.modes)
    return bool(np.all(np.abs(turned.imag) <= _ONE_PHASE * np.abs(turned)))


def _undamped(system: System) -> ModalModel:
    """The structure without its damping and with a real load."""
    if not one_phase(system):
        raise InputError(
            f"load must have one phase for invariant points of a mass; got {system.modes.load.tolist()}"
        )
    modes = system.modes
    turned = _turned_load(modes)
    none = np.zeros(modes.w.size)
    return replace(
        modes,
        zeta=none,
        damping=np.zeros_like(modes.damping),
        load=turned.real.astype(complex),
        load_rate=none.astype(complex),
    )


def _responses(modes: ModalModel, r: np.ndarray) -> np.ndarray:
    """lambda_i/(w_i^2 - r^2) without damping and with a real load, at no resonance; (n_r, n)."""
    return modes.participation(r).real / modes.dynamic_stiffness(r).real


def _displacement_rows(modes: ModalModel, masses: np.ndarray) -> np.ndarray:
    """phi_k of the masses (counted from 1), (n_masses, n), with exact zeros at nodes of a mode."""
    rows = modes.phi[masses - 1]
    return np.where(np.abs(rows) <= 1e-13 * np.abs(modes.phi).max(axis=0), 0.0, rows)


def _follows_contact(modes: ModalModel, rows: np.ndarray) -> np.ndarray:
    """Whether a mass is the contact itself, one against a fixed wall; bool (n_masses,)."""
    return (not modes.base_motion) & np.isclose(np.abs(rows), np.abs(modes.chi), 1e-12, 1e-13).all(axis=1)


def all_mass_invariant_points(
    system: System, low: float, high: float, most: int = MOST_POINTS
) -> list[np.ndarray]:
    """`mass_invariant_points` of every mass, at about the cost of one."""
    modes = _undamped(system)
    where = _range(modes, low, high, most)
    rows = _displacement_rows(modes, np.arange(1, system.n + 1))
    own = _follows_contact(modes, rows)

    def functions(r: np.ndarray, which: np.ndarray | None = None) -> np.ndarray:
        row = None if which is None else which % system.n
        u, v = _first_damping(modes, r), _responses(modes, r)
        u_k, v_k = _sums(u, rows, row), _sums(v, rows, row)
        u_z, v_z = u @ modes.chi, modes.contact_response(r).real
        if which is None:
            u_z, v_z = u_z[:, np.newaxis], v_z[:, np.newaxis]
        # of the contact itself T(6.10) is never zero, but what it is multiplied with here is
        free = ~own if row is None else ~own[row]
        other = np.where(free & (u_k != 0.0), v_z * u_k - 2.0 * v_k * u_z, 0.0)
        return np.hstack((u_k, other)) if which is None else np.where(which < system.n, u_k, other)

    roots = _roots(functions, where)
    return [np.union1d(roots[k], roots[k + system.n]) for k in range(system.n)]


def mass_invariant_points(
    system: System, mass: int, low: float, high: float, most: int = MOST_POINTS
) -> np.ndarray:
    """The same for the displacement of one mass: U_k = 0, and 1 - 2 V_k U/(V U_k) = 0, T(6.10).

    There friction turns from lowering the monoharmonic amplitude T(5.50) to raising it, or back; of the
    exact amplitude these are the limits of `inversion_points` for beta -> 0.  Of a mass in contact with a
    fixed wall they are those of `invariant_points`.  Damping is left out: with it they are approximate,
    T 7.4.3.  The load must have one phase.
    """
    mass = checks.whole(mass, "mass", least=1, most=system.n)
    return all_mass_invariant_points(system, low, high, most)[mass - 1]


def first_harmonic_invariant_points(
    system: System, mass: int, low: float, high: float, most: int = MOST_POINTS
) -> np.ndarray:
    """Frequency ratios in (low, high) where no friction changes the first harmonic's amplitude of a mass.

    With the compliance H_k = sum phi_ki chi_i/(w_i^2 - r^2), which the first harmonic of the friction force
    acts through, abs(X)^2 = V_k^2 + (8 beta^2/pi) H_k (V_k U/V + 2 H_k/pi): its zeros, for all beta alike.
    In T 4.4 the inversion of frequency-based curves.  Damping is left out; the load must have one phase.
    """
    mass = checks.whole(mass, "mass", least=1, most=system.n)
    modes = _undamped(system)
    where = _range(modes, low, high, most)
    rows = _displacement_rows(modes, np.array([mass]))
    own = _follows_contact(modes, rows)
    pushed = replace(modes, load=modes.contact.astype(complex))  # H_k is V_k of a load c

    def functions(r: np.ndarray, which: np.ndarray | None = None) -> np.ndarray:
        h_k, v_k = _responses(pushed, r) @ rows[0], _responses(modes, r) @ rows[0]
        v = modes.contact_response(r).real
        if own[0]:  # V_k = V
            v_k, v = np.ones(r.size), np.ones(r.size)
        other = v_k * (_first_damping(modes, r) @ modes.chi) + 2.0 / math.pi * v * h_k
        return np.column_stack((h_k, other)) if which is None else np.where(which == 0, h_k, other)

    return np.unique(np.concatenate(_roots(functions, where)))
