"""Boundaries of the regimes over frequency, and the response functions they depend on, as arrays."""

from dataclasses import dataclass

import numpy as np

from .._kernels.boundary.functions import response_functions
from .._kernels.boundary.structure import many_mode_functions
from .._kernels.engine.one_mass import Frequencies
from ..errors import InputError
from ..model.modes import angles, modulus
from ..model.system import System

#: Least r over the fastest rate of free motion; there the search for S takes about 10^6 intervals, and a
#: period of the load about 10^7 scan steps.
_LEAST_RATIO = 1e-6


@dataclass(frozen=True)
class Curves:
    """Functions of r, and of (mu, r); arrays of shape (n_r,) and (n_mu, n_r).

    V, U, G, H and S are those of theory.md 2 and 3.
    """

    v: np.ndarray  # complex; infinite at an undamped resonance
    u: np.ndarray
    g: np.ndarray
    h: np.ndarray
    s: np.ndarray
    beta_lim: np.ndarray
    beta_lim_modal: np.ndarray
    beta_stick: np.ndarray


@dataclass(frozen=True)
class OneMass:
    """Curves of one mass, and the data of its cells; `lim` is beta_lim over the load amplitude."""

    curves: Curves
    frequencies: Frequencies
    lim: np.ndarray


def over_square(number: float, r: np.ndarray) -> np.ndarray:
    """Compute number/r^2; 0 at r = 0, where S is infinite."""
    return np.divide(number, r * r, out=np.zeros_like(r), where=r > 0.0)


def sliding_bracket(h: np.ndarray, s: np.ndarray, inertia: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """Compute max(S, H + mu/(m_eff r^2)), (n_mu, n_r), theory.md 3, the least (Z + beta G)/beta of continuous
    motion.
    """
    with np.errstate(invalid="ignore"):  # an infinite S or H may be stored as NaN; beta_lim is then 0
        return np.maximum(s, h + mu[:, np.newaxis] * inertia)


def find_beta_lim(
    v_abs: np.ndarray, u: np.ndarray, h: np.ndarray, s: np.ndarray, inertia: np.ndarray, mu: np.ndarray,
    at_resonance: np.ndarray,
) -> np.ndarray:  # fmt: skip
    """Boundary of continuous motion, |V|/sqrt(U^2 + max(S, H + mu/(m_eff r^2))^2), theory.md 3.

    T(2.26), (3.21), (5.65) and (7.46) are special cases.  0 where U or S alone is infinite, or U has no limit
    (r = 0).

    Parameters
    ----------
    v_abs, u, h, s : (n_r,) |V|, U, H, S; V and U are infinite at an undamped resonance
    inertia : (n_r,) 1/(m_eff r^2), 0 at r = 0
    mu : (n_mu,)
    at_resonance : (n_r,) or (), the limit at an undamped resonance, where |V|/|U| is finite and both exceed S

    Returns
    -------
    beta_lim : (n_mu, n_r)
    """
    resonance = np.isinf(v_abs) & np.isinf(u)
    bracket = sliding_bracket(h, s, inertia, mu)
    size = np.hypot(np.where(np.isnan(u), np.inf, u), bracket)
    finite = np.isfinite(size)
    found = np.where(finite, v_abs / np.where(finite, size, 1.0), 0.0)
    return np.where(resonance, at_resonance, found)


def find_beta_stick(force: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """Boundary to permanent sticking, |F|/mu, (n_mu, n_r), theory.md 4; F (n_r,), complex, is the force that
    holds z.

    T(2.29), (3.24), (6.11), (6.27) and (6.33) are special cases.
    """
    return modulus(force) / mu[:, np.newaxis]


def _least(omega: np.ndarray, zeta: np.ndarray) -> float:
    """Least r > 0 beside the rates of free motion of oscillators."""
    return _LEAST_RATIO * float((omega * np.where(zeta > 1.0, 2.0 * zeta, 1.0)).max())


def least_ratio(system: System) -> float:
    """Least r > 0 at which a system has curves."""
    modes = system.modes
    return _least(modes.w, modes.zeta) if system.normalised else _least(modes.free.omega, modes.free.zeta)


def _refuse_low(r: np.ndarray, omega: np.ndarray, zeta: np.ndarray) -> None:
    """Refuse 0 < r far below the rates of free motion of oscillators."""
    least = _least(omega, zeta)
    small = r[r < least]
    if small.any():  # any but 0
        raise InputError(
            "r",
            f"must be 0, or >= {least:.3g} for this system: below, a period of the load has more than 10^6 "
            f"periods of the fastest free motion; got {small[small > 0.0][0]:g}",
        )


def one_mass_curves(system: System, r: np.ndarray, mu: np.ndarray) -> OneMass:
    """All curves of a normalised system, whose one mode has w = 1; `r` and `mu` are checked axes.

    One mass has its own search for S, with intervals in closed form, and one equation for both contacts.

    Raises
    ------
    InputError
        0 < r is too low, see `find_curves`.
    """
    _refuse_low(r, system.modes.w, system.modes.zeta)
    load = system.contact_load(r)
    v_abs, v_arg, u, g, h, s = np.empty((6, r.size))
    response_functions(r, system.zeta, u, g, v_abs, v_arg, h, s)
    amplitude = modulus(load)
    half = np.divide(0.5, r, out=np.zeros_like(r), where=r > 0.0)
    even = (half >= 1.0) & (half == np.floor(half))
    marginal = even & (system.zeta == 0.0)
    frequencies = Frequencies(r, amplitude, angles(load), v_abs, v_arg, u, g, marginal)
    lim = find_beta_lim(v_abs, u, h, s, over_square(1.0, r), mu, np.array(0.25 * np.pi))
    stiffness = system.modes.dynamic_stiffness(r)[:, 0]
    resonance = stiffness == 0.0
    found = Curves(
        v=np.where(resonance, np.inf, load / np.where(resonance, 1.0, stiffness)),
        u=u,
        g=g,
        h=h,
        s=s,
        beta_lim=lim * amplitude,
        beta_lim_modal=lim * amplitude,  # for one mode the maximum of the sum is the sum of the maxima
        beta_stick=find_beta_stick(load, mu),
    )
    return OneMass(found, frequencies, lim)


def many_mode_curves(system: System, r: np.ndarray, mu: np.ndarray) -> Curves:
    """All curves of a system with any number of masses; `r` and `mu` are checked axes."""
    modes, free = system.modes, system.modes.free
    _refuse_low(r, free.omega, free.zeta)
    v = modes.contact_response(r)
    u, g, h, s, by_modes = np.empty((5, r.size))
    weights = free.weights(modes.chi[modes.participating])
    many_mode_functions(r, free.omega, free.zeta, *weights, modes.inverse_mass, u, g, h, s, by_modes)
    v_abs = modulus(v)
    inertia = over_square(modes.inverse_mass, r)
    # at a resonance |V|/|U| -> (pi/4) |lambda_i/chi_i|, T(6.2), (6.26)
    resonant = modes.dynamic_stiffness(r) == 0.0  # r is an undamped frequency to the bit
    ratio = modulus(modes.participation(r)) / np.where(modes.chi == 0.0, np.inf, np.abs(modes.chi))
    at_resonance = 0.25 * np.pi * (resonant * ratio).sum(axis=1)
    return Curves(
        v=v,
        u=u,
        g=g,
        h=h,
        s=s,
        beta_lim=find_beta_lim(v_abs, u, h, s, inertia, mu, at_resonance),
        beta_lim_modal=np.where(
            np.isnan(by_modes), np.nan, find_beta_lim(v_abs, u, h, by_modes, inertia, mu, at_resonance)
        ),
        beta_stick=find_beta_stick(modes.held_load(r), mu),
    )


def find_curves(system: System, r: np.ndarray, mu: np.ndarray) -> Curves:
    """All curves of any system; `r` and `mu` are checked axes.

    Raises
    ------
    InputError
        0 < r < 1e-6 times the fastest rate of free motion.
    """
    if system.normalised:
        return one_mass_curves(system, r, mu).curves
    return many_mode_curves(system, r, mu)
