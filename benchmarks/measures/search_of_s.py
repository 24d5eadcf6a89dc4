"""The search of S, the maximum that beta_lim needs: sampling on a grid, as public codes do, and the kernel.

    S = max over 0 < tau < pi of  sum_i c_i [u_i cos(tau) + h_i'(tau)]/sin(tau),     c_i = chi_i^2/w_i^2

The grid has its points inside (0, pi), all evaluated at once by numpy; the limit at tau -> 0 counts too,
which public codes leave out (errors without it are given as well).  Modes, u, g and the limit are given to
the sampler and not timed; the kernel computes them itself, and V.  Reference:
`references.closed_forms`, modes included.
"""

from typing import NamedTuple

import numpy as np

import frictionmap as fm
from frictionmap._kernels.boundary.functions import response_functions
from frictionmap._kernels.boundary.structure import many_mode_functions
from frictionmap._kernels.closed_form import damping_functions
from frictionmap.theory.boundary_curves import find_curves

from ..references import closed_forms
from ..report.record import spread, timed
from .structures import equal_chain

GRIDS = (16, 64, 256, 1024, 4096, 16_384, 100_000)

#: Frequencies kept are those at which S lies inside the interval: elsewhere there is nothing to search.
FREQUENCIES = {"one mass": (0.04, 0.45), "five masses": (0.15, 0.8)}
ZETA = 0.01


class Modes(NamedTuple):
    """Terms of the bracket at one frequency; arrays over modes."""

    c: np.ndarray
    a: np.ndarray  # w/r
    zeta: np.ndarray
    u: np.ndarray
    g: np.ndarray


def modes_at(system: fm.System, r: float) -> Modes:
    """Participating modes."""
    modes = system.modes
    u, g = np.array([damping_functions(w, zeta, r) for w, zeta in zip(modes.w, modes.zeta, strict=True)]).T
    return Modes((modes.chi / modes.w) ** 2, modes.w / r, modes.zeta, u, g)


def bracket(m: Modes, tau: np.ndarray) -> np.ndarray:
    """Sum over modes at times tau in (0, pi), by numpy."""
    a, zeta, u, g = (column[:, np.newaxis] for column in m[1:])
    s = np.sqrt(1.0 - zeta**2)
    swing = np.exp(-zeta * a * tau)
    q = swing * np.sin(s * a * tau) / s
    e = swing * np.cos(s * a * tau) - zeta * q
    return m.c @ (u * np.cos(tau) + (1.0 + g) * a * q - u * e) / np.sin(tau)


def grid(points: int) -> np.ndarray:
    """Equally spaced points inside (0, pi)."""
    return np.pi * np.arange(1, points + 1) / (points + 1)


def references(body: closed_forms.Structure, r: float) -> tuple[float, float, float, bool]:
    """S, beta_lim and beta_lim_modal (mu = 1) to double precision; whether S is inside (0, pi)."""
    found = closed_forms.functions(body, r)
    by_modes = found._replace(s=closed_forms.sum_of_maxima(body, r))
    lims = [closed_forms.beta_lim(body, r, 1.0, one) for one in (found, by_modes)]
    return float(found.s), float(lims[0]), float(lims[1]), bool(found.tau > 0)


def _systems() -> dict[str, tuple[fm.System, closed_forms.Structure]]:
    """The structures for the package, and in 40 digits."""
    ones = [1.0] * 5
    five = closed_forms.structure(
        *closed_forms.chain_matrices(ones, ones), [0, 0, 1, 0, 0], [1, 0, 0, 0, 0], 0, [ZETA] * 5
    )
    return {
        "one mass": (fm.System(damping_ratios=ZETA), closed_forms.one_mass(ZETA)),
        "five masses": (equal_chain(5, 3, 1, ZETA), five),
    }


def _worst(found: np.ndarray, exact: np.ndarray) -> dict:
    """Largest relative errors over the frequencies."""
    errors = np.abs(found - exact) / np.abs(exact)
    return {"median": float(np.median(errors)), "largest": float(errors.max())}


def _by_kernel(system: fm.System, r: np.ndarray) -> np.ndarray:
    """S at frequencies r, computed together with V, U, G and H (five masses: U, G, H and the modal bound)."""
    if system.n == 1:
        out = np.empty((6, r.size))
        response_functions(r, system.zeta, *out)
        return out[5]
    modes, free = system.modes, system.modes.free
    weights = free.weights(modes.chi[modes.participating])
    out = np.empty((5, r.size))
    many_mode_functions(r, free.omega, free.zeta, *weights, modes.inverse_mass, *out)
    return out[3]


def _draw(
    body: closed_forms.Structure, count: int, limits: tuple[float, float], rng: np.random.Generator
) -> tuple:
    """Random frequencies with S inside the interval, and the exact S, beta_lim, beta_lim_modal there."""
    chosen: list[float] = []
    exact = []
    while len(chosen) < count:
        r = float(rng.uniform(*limits))
        *values, inside = references(body, r)
        if inside:
            chosen.append(r)
            exact.append(values)
    return np.array(chosen), np.array(exact).T


def _one_system(
    system: fm.System, body: closed_forms.Structure, limits: tuple[float, float], quick: bool,
    rng: np.random.Generator,
) -> dict:  # fmt: skip
    count = 2 if quick else 25
    repeats = 3 if quick else 9
    r, exact = _draw(body, count, limits, rng)
    order = np.argsort(r)
    r, exact = r[order], exact[:, order]
    curves = find_curves(system, r, np.ones(1))
    modes = [modes_at(system, x) for x in r]
    ends = curves.h + system.modes.inverse_mass / r**2
    many = np.repeat(r, 40)
    _by_kernel(system, many)  # compiles
    times: dict[int, list[float]] = {points: [] for points in GRIDS}
    ours = []
    values = {}
    kernel = np.empty(0)
    for _ in range(repeats):  # alternating: all see the same machine
        taken, kernel = timed(lambda: _by_kernel(system, many))
        ours.append(taken / many.size)
        for points in GRIDS:
            taken, values[points] = timed(lambda n=points: [bracket(m, grid(n)).max() for m in modes])
            times[points].append(taken / r.size)
    rows = {
        str(points): {
            "seconds": spread(times[points]),
            "relative error of S": _worst(np.maximum(values[points], ends), exact[0]),
            "relative error of S without the limit at tau = 0": _worst(np.array(values[points]), exact[0]),
        }
        for points in GRIDS
    }
    return {
        "frequencies": r.tolist(),
        "grid": rows,
        "kernel": {
            "seconds": spread(ours),
            "relative error of S": _worst(kernel[::40], exact[0]),
            "relative error of beta_lim": _worst(curves.beta_lim[0], exact[1]),
            "relative error of beta_lim_modal": _worst(curves.beta_lim_modal[0], exact[2]),
        },
    }


def measure(quick: bool) -> dict:
    """Error of S and seconds per frequency, by system."""
    rng = np.random.default_rng(227)
    return {
        name: _one_system(system, body, FREQUENCIES[name], quick, rng)
        for name, (system, body) in _systems().items()
    }
