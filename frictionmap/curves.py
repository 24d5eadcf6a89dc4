"""Boundaries of the motion regimes over frequency, and the response functions they come from."""

from dataclasses import dataclass

import numpy as np
import xarray as xr

from . import checks
from ._kernels.curves import boundary, response_functions
from ._kernels.sweep import Frequencies
from .labels import coordinate, label_variable, stamp
from .system import System


@dataclass(frozen=True)
class Curves:
    """What depends on r, and on (mu, r), only; arrays of shape (n_r,) and (n_mu, n_r).

    U, G, H and S are those of theory.md 2 and 3; `lim` is beta_lim over the load amplitude.
    """

    frequencies: Frequencies
    h: np.ndarray
    s: np.ndarray
    lim: np.ndarray
    beta_lim: np.ndarray
    beta_stick: np.ndarray


def response_function(system: System, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """V of z, theory.md 2, real and imaginary part; at an undamped resonance infinite and 0."""
    stiffness = (1.0 - r) * (1.0 + r) + 2j * system.zeta * r
    resonance = stiffness == 0.0
    value = system.contact_load(r) / np.where(resonance, 1.0, stiffness)
    return np.where(resonance, np.inf, value.real), np.where(resonance, 0.0, value.imag)


def curves(system: System, r: np.ndarray, mu: np.ndarray) -> Curves:
    """All curves of a system; `r` and `mu` are checked axes."""
    load = system.contact_load(r)
    v_abs, v_arg, u, g, h, s = np.empty((6, r.size))
    response_functions(r, system.zeta, u, g, v_abs, v_arg, h, s)
    amplitude = np.abs(load)
    frequencies = Frequencies(r, amplitude, np.angle(load), v_abs, v_arg, u, g)
    lim = np.empty((mu.size, r.size))
    for row, value in zip(lim, mu, strict=True):
        boundary(r, v_abs, u, h, s, value, row)
    return Curves(
        frequencies=frequencies,
        h=h,
        s=s,
        lim=lim,
        beta_lim=lim * amplitude,
        beta_stick=amplitude / mu[:, np.newaxis],
    )


def boundary_variables(found: Curves) -> dict[str, xr.Variable]:
    """beta_lim, beta_lim_modal and beta_stick, dims (mu, r)."""
    return {
        # one mode: the maximum of the sum is the sum of the maxima
        name: label_variable(name, ("mu", "r"), values)
        for name, values in (
            ("beta_lim", found.beta_lim),
            ("beta_lim_modal", found.beta_lim),
            ("beta_stick", found.beta_stick),
        )
    }


def boundaries(system: System, r: object, mu: object = 1.0) -> xr.Dataset:
    """Boundaries of the motion regimes over frequency.

    Parameters
    ----------
    system : System
    r : array_like, shape (n_r,)
        Frequency ratios omega/omega_1 [-], >= 0, increasing.
    mu : array_like, shape (n_mu,)
        Static over kinetic friction [-], >= 1, increasing.

    Returns
    -------
    xarray.Dataset
        On (mu, r): `beta_lim` (continuous below it, theory.md 3), `beta_lim_modal` (T(5.65) with (5.55))
        and `beta_stick` (permanent sticking is possible from it on, theory.md 4).  On r: the response
        function of z, `V` (real part) and `V_imag`, and `U`, `G`, `H`, `S`.

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
    found = curves(system, r, mu)
    real, imaginary = response_function(system, r)
    functions = {
        "V": real,
        "V_imag": imaginary,
        "U": found.frequencies.u,
        "G": found.frequencies.g,
        "H": found.h,
        "S": found.s,
    }
    variables = boundary_variables(found)
    variables |= {name: label_variable(name, ("r",), v) for name, v in functions.items()}
    ds = xr.Dataset(variables, coords={"mu": coordinate("mu", mu), "r": coordinate("r", r)})
    return stamp(ds, "Boundaries of the motion regimes", system)
