"""The search of S, the maximum that beta_lim needs: sampling on a grid, as public codes do, and the kernel.

    S = max over 0 < tau < pi of  sum_i c_i [u_i cos(tau) + h_i'(tau)]/sin(tau),     c_i = chi_i^2/w_i^2

The grid has its points inside (0, pi), all evaluated at once by numpy; the limit at tau -> 0 counts too,
which public codes leave out (errors without it are given as well).  Modes, u, g and the limit are given to
the sampler and not timed; the kernel computes them itself, and V.  Reference: every local maximum of a dense
sampling that comes near the best is polished in 40-digit arithmetic, from the same doubles for w, zeta, chi.
"""

from typing import NamedTuple

import mpmath as mp
import numpy as np

import frictionmap as fm
from frictionmap._kernels.closed_form import damping_functions
from frictionmap._kernels.curves import response_functions
from frictionmap._kernels.sums import many_mode_functions
from frictionmap.curves import find_curves

from ..report.record import spread, timed
from .structures import equal_chain

DIGITS = 40
GRIDS = (16, 64, 256, 1024, 4096, 16_384, 100_000)
DENSE = 200_001

#: Local maxima of the dense sampling within this share of the best are polished.
NEAR = 0.01

#: Frequencies kept are those at which S lies inside the interval: elsewhere there is nothing to search.
FREQUENCIES = {"one mass": (0.04, 0.45), "five masses": (0.15, 0.8)}
ZETA = 0.01


class Modes(NamedTuple):
    """What the bracket is made of at one frequency; arrays over modes."""

    c: np.ndarray
    a: np.ndarray  # w/r
    zeta: np.ndarray
    u: np.ndarray
    g: np.ndarray


def modes_at(system: fm.System, r: float) -> Modes:
    """The modes that the contact sees."""
    modes = system.modes
    u, g = np.array([damping_functions(w, zeta, r) for w, zeta in zip(modes.w, modes.zeta, strict=True)]).T
    return Modes((modes.chi / modes.w) ** 2, modes.w / r, modes.zeta, u, g)


def bracket(m: Modes, tau: np.ndarray) -> np.ndarray:
    """The sum over modes at times tau in (0, pi), by numpy."""
    a, zeta, u, g = (column[:, np.newaxis] for column in m[1:])
    s = np.sqrt(1.0 - zeta**2)
    swing = np.exp(-zeta * a * tau)
    q = swing * np.sin(s * a * tau) / s
    e = swing * np.cos(s * a * tau) - zeta * q
    return m.c @ (u * np.cos(tau) + (1.0 + g) * a * q - u * e) / np.sin(tau)


def grid(points: int) -> np.ndarray:
    """So many times inside (0, pi), equally spaced."""
    return np.pi * np.arange(1, points + 1) / (points + 1)


def _exact_modes(system: fm.System, r: float) -> list[tuple]:
    """(c, a, zeta, u, g) of every mode in high precision, from doubles w, zeta, chi, r; T(7.11), (7.12)."""
    found = []
    for w, zeta, chi in zip(system.modes.w, system.modes.zeta, system.modes.chi, strict=True):
        w, zeta, chi = (mp.mpf(float(value)) for value in (w, zeta, chi))
        a = w / mp.mpf(r)
        s = mp.sqrt(1 - zeta**2)
        below = mp.cosh(mp.pi * zeta * a) + mp.cos(mp.pi * s * a)
        u = a * mp.sin(mp.pi * s * a) / (s * below)
        g = (mp.sinh(mp.pi * zeta * a) - zeta / s * mp.sin(mp.pi * s * a)) / below
        found.append(((chi / w) ** 2, a, zeta, u, g))
    return found


def _exact_bracket(modes: list[tuple], tau: mp.mpf) -> mp.mpf:
    total = mp.mpf(0)
    for c, a, zeta, u, g in modes:
        s = mp.sqrt(1 - zeta**2)
        swing = mp.exp(-zeta * a * tau)
        q = swing * mp.sin(s * a * tau) / s
        e = swing * mp.cos(s * a * tau) - zeta * q
        total += c * (u * mp.cos(tau) + (1 + g) * a * q - u * e)
    return total / mp.sin(tau)


def _polished(modes: list[tuple], low: float, high: float) -> mp.mpf:
    """The largest value between two times that enclose one maximum, by golden sections."""
    ratio = (mp.sqrt(5) - 1) / 2
    low, high = mp.mpf(low), mp.mpf(high)
    left, right = high - ratio * (high - low), low + ratio * (high - low)
    f_left, f_right = _exact_bracket(modes, left), _exact_bracket(modes, right)
    while high - low > mp.mpf(10) ** -11:  # flat there: the value is good to 22 digits
        if f_left > f_right:
            high, right, f_right = right, left, f_left
            left = high - ratio * (high - low)
            f_left = _exact_bracket(modes, left)
        else:
            low, left, f_left = left, right, f_right
            right = low + ratio * (high - low)
            f_right = _exact_bracket(modes, right)
    return max(f_left, f_right)


def _largest(modes: list[tuple], dense: Modes, end: mp.mpf) -> mp.mpf:
    """S of some modes, `end` its limit at tau -> 0."""
    tau = grid(DENSE)
    values = bracket(dense, tau)
    top = max(values.max(), float(end))
    inside = values[1:-1]
    tops = np.flatnonzero((inside >= values[:-2]) & (inside >= values[2:]) & (inside >= (1.0 - NEAR) * top))
    return max([end, *(_polished(modes, float(tau[k]), float(tau[k + 2])) for k in tops)])


def _response(system: fm.System, r: float) -> mp.mpc:
    """V of a contact with a fixed wall."""
    m, r_exact = system.modes, mp.mpf(r)
    shares = m.participation(np.array([r]))[0]
    total = mp.mpc(0)
    for w, zeta, chi, share in zip(m.w, m.zeta, m.chi, shares, strict=True):
        w, zeta, chi = (mp.mpf(float(value)) for value in (w, zeta, chi))
        total += chi * mp.mpmathify(complex(share)) / mp.mpc(w**2 - r_exact**2, 2 * zeta * w * r_exact)
    return total


def references(system: fm.System, r: float, mu: float) -> tuple[float, float, float, bool]:
    """S, beta_lim and beta_lim_modal to double precision; whether S is inside (0, pi)."""
    with mp.workdps(DIGITS):
        modes = _exact_modes(system, r)
        dense = modes_at(system, r)
        slopes = [c * (g * a * a + 2 * zeta * a * u) for c, a, zeta, u, g in modes]
        ends = [c * a * a for c, a, _, _, _ in modes]
        h, inertia = mp.fsum(slopes), mp.fsum(ends)
        largest = _largest(modes, dense, h + inertia)
        by_modes = largest if len(modes) == 1 else mp.fsum(
            _largest([modes[k]], Modes(*(column[k : k + 1] for column in dense)), slopes[k] + ends[k])
            for k in range(len(modes))
        )  # fmt: skip
        u = mp.fsum(c * u for c, _, _, u, _ in modes)
        v = _response(system, r)
        lims = [abs(v) / mp.hypot(u, max(s, h + mu * inertia)) for s in (largest, by_modes)]
        return float(largest), float(lims[0]), float(lims[1]), bool(largest > h + inertia)


def _systems() -> dict[str, fm.System]:
    return {"one mass": fm.System(damping_ratios=ZETA), "five masses": equal_chain(5, 3, 1, ZETA)}


def _worst(found: np.ndarray, exact: np.ndarray) -> dict:
    """Relative errors over the frequencies."""
    errors = np.abs(found - exact) / np.abs(exact)
    return {"median": float(np.median(errors)), "largest": float(errors.max())}


def _by_kernel(system: fm.System, r: np.ndarray) -> np.ndarray:
    """S at frequencies r, with V, U, G and H (five masses: U, G, H and the bound by modes) on the way."""
    if system.n == 1:
        out = np.empty((6, r.size))
        response_functions(r, system.zeta, *out)
        return out[5]
    m = system.modes
    out = np.empty((5, r.size))
    many_mode_functions(r, m.w, m.zeta, m.chi, m.inverse_mass, *out)
    return out[3]


def _draw(system: fm.System, count: int, limits: tuple[float, float], rng: np.random.Generator) -> tuple:
    """Random frequencies with S inside the interval, and what is exact there: S, beta_lim, beta_lim_modal."""
    chosen: list[float] = []
    exact = []
    while len(chosen) < count:
        r = float(rng.uniform(*limits))
        *values, inside = references(system, r, 1.0)
        if inside:
            chosen.append(r)
            exact.append(values)
    return np.array(chosen), np.array(exact).T


def _one_system(
    system: fm.System, limits: tuple[float, float], quick: bool, rng: np.random.Generator
) -> dict:
    count = 2 if quick else 25
    repeats = 3 if quick else 9
    r, exact = _draw(system, count, limits, rng)
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
    """Error of S and seconds a frequency, by system."""
    rng = np.random.default_rng(227)
    return {name: _one_system(system, FREQUENCIES[name], quick, rng) for name, system in _systems().items()}
