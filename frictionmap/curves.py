"""Boundaries of the motion regimes over frequency, and the response functions they come from."""

from dataclasses import dataclass

import numpy as np
import xarray as xr

from . import checks
from ._kernels.curves import boundary, response_functions
from ._kernels.sums import many_mode_functions
from ._kernels.sweep import Frequencies
from .features import high_frequency_limits, peak_thresholds
from .labels import coordinate, label_variable, stamp
from .system import System


@dataclass(frozen=True)
class Curves:
    """What depends on r, and on (mu, r), only; arrays of shape (n_r,) and (n_mu, n_r).

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
    """Curves of one mass, and what its cells need of them: `lim` is beta_lim over the load amplitude."""

    curves: Curves
    frequencies: Frequencies
    lim: np.ndarray


def one_mass_curves(system: System, r: np.ndarray, mu: np.ndarray) -> OneMass:
    """All curves of a system of one mass; `r` and `mu` are checked axes.

    One mass has its own search of S, with intervals in closed form, and one equation for both contacts.
    """
    load = system.contact_load(r)
    v_abs, v_arg, u, g, h, s = np.empty((6, r.size))
    response_functions(r, system.zeta, u, g, v_abs, v_arg, h, s)
    amplitude = np.abs(load)
    frequencies = Frequencies(r, amplitude, np.angle(load), v_abs, v_arg, u, g)
    lim = np.empty((mu.size, r.size))
    for row, value in zip(lim, mu, strict=True):
        boundary(r, v_abs, u, h, s, value, row)
    stiffness = (1.0 - r) * (1.0 + r) + 2j * system.zeta * r
    resonance = stiffness == 0.0
    found = Curves(
        v=np.where(resonance, np.inf, load / np.where(resonance, 1.0, stiffness)),
        u=u,
        g=g,
        h=h,
        s=s,
        beta_lim=lim * amplitude,
        beta_lim_modal=lim * amplitude,  # of one mode the maximum of the sum is the sum of the maxima
        beta_stick=amplitude / mu[:, np.newaxis],
    )
    return OneMass(found, frequencies, lim)


def _lim(v: np.ndarray, u: np.ndarray, bracket: np.ndarray) -> np.ndarray:
    """|V|/sqrt(U^2 + bracket^2); 0 where U or S alone is infinite, or U has no limit (r = 0)."""
    size = np.hypot(np.where(np.isnan(u), np.inf, u), bracket)
    finite = np.isfinite(size)
    return np.where(finite, np.abs(v) / np.where(finite, size, 1.0), 0.0)


def many_mode_curves(system: System, r: np.ndarray, mu: np.ndarray) -> Curves:
    """All curves of a system of any number of masses; `r` and `mu` are checked axes."""
    modes = system.modes
    v = modes.response(r, modes.chi) - modes.base_motion
    u, g, h, s, by_modes = np.empty((5, r.size))
    many_mode_functions(r, modes.w, modes.zeta, modes.chi, modes.inverse_mass, u, g, h, s, by_modes)
    end = np.zeros(r.size)
    np.divide(modes.inverse_mass, r**2, out=end, where=r > 0.0)
    lim, lim_modal = np.empty((2, mu.size, r.size))
    resonance = np.isinf(v) & np.isinf(u)
    # there |V|/|U| -> (pi/4) |lambda_i/chi_i|, and both outgrow S
    seen = modes.w == r[:, np.newaxis]  # only where r is a natural frequency to the bit are they infinite
    ratio = np.abs(modes.participation) / np.where(modes.chi == 0.0, np.inf, np.abs(modes.chi))
    at_resonance = 0.25 * np.pi * (seen * ratio).sum(axis=1)
    for m, value in enumerate(mu):
        with np.errstate(invalid="ignore"):  # inf - inf at a resonance, replaced below
            static = h + value * end
            lim[m] = np.where(resonance, at_resonance, _lim(v, u, np.maximum(s, static)))
            lim_modal[m] = np.where(resonance, at_resonance, _lim(v, u, np.maximum(by_modes, static)))
    return Curves(
        v=v,
        u=u,
        g=g,
        h=h,
        s=s,
        beta_lim=lim,
        beta_lim_modal=lim_modal,
        beta_stick=np.abs(modes.held_load(r)) / mu[:, np.newaxis],
    )


def boundary_variables(found: Curves) -> dict[str, xr.Variable]:
    """beta_lim, beta_lim_modal and beta_stick, dims (mu, r)."""
    return {
        name: label_variable(name, ("mu", "r"), getattr(found, name))
        for name in ("beta_lim", "beta_lim_modal", "beta_stick")
    }


def boundaries(system: System, r: object, mu: object = 1.0) -> xr.Dataset:
    """Boundaries of the motion regimes over frequency.

    Parameters
    ----------
    system : System
    r : array_like, shape (n_r,)
        Frequency ratios omega/omega_1, omega_1 = sqrt(k_1/m_1) [-], >= 0, increasing.
    mu : array_like, shape (n_mu,)
        Static over kinetic friction [-], >= 1, increasing.

    Returns
    -------
    xarray.Dataset
        On (mu, r): `beta_lim` (continuous below it, theory.md 3), `beta_lim_modal` (T(5.65) with (5.55))
        and `beta_stick` (permanent sticking is possible from it on, theory.md 4).  On r: the response
        function of z, `V` (real part) and `V_imag`, and `U`, `G`, `H`, `S`.  Features (theory.md 7): by
        mode `natural_frequency` and `peak_threshold`; `held_frequency`; by mu the limits for r -> infinity,
        `beta_lim_high` and `beta_stick_high`.

    Raises
    ------
    InputError
        An axis is empty, not finite, not increasing or out of range.

    Examples
    --------
    >>> import frictionmap as fm
    >>> ds = fm.boundaries(fm.System(contact="joined-base-wall"), r=[0.5, 2.0])
    >>> ds.beta_stick.values
    array([[0.25, 4.  ]])
    """
    r = checks.axis(r, "r", least=0.0, most=checks.LARGEST_RATIO)
    mu = checks.axis(mu, "mu", least=1.0)
    many = system.n > 1
    found = many_mode_curves(system, r, mu) if many else one_mass_curves(system, r, mu).curves
    functions = {
        "V": found.v.real,
        "V_imag": np.where(np.isinf(found.v.real), 0.0, found.v.imag),
        "U": found.u,
        "G": found.g,
        "H": found.h,
        "S": found.s,
    }
    variables = boundary_variables(found)
    variables |= {name: label_variable(name, ("r",), v) for name, v in functions.items()}
    limits = [high_frequency_limits(system, value) for value in mu]
    features = {
        "natural_frequency": ("mode", system.modes.w),
        "peak_threshold": ("mode", peak_thresholds(system)),
        "beta_lim_high": ("mu", np.array([limit.beta_lim for limit in limits])),
        "beta_stick_high": ("mu", np.array([limit.beta_stick for limit in limits])),
    }
    if system.n > 1:  # one mass held does not vibrate, and NetCDF has no empty dimension
        features["held_frequency"] = ("held_mode", system.modes.held_frequencies())
    variables |= {name: label_variable(name, (dim,), v) for name, (dim, v) in features.items()}
    ds = xr.Dataset(variables, coords={"mu": coordinate("mu", mu), "r": coordinate("r", r)})
    return stamp(ds, "Boundaries of the motion regimes", system)
