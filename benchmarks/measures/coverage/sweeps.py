"""Sweeps with known true values: chains with base excitation from M, K and C, identified by `sweep`."""

from collections.abc import Sequence
from functools import partial

import numpy as np

import frictionmap as fm

from ...references.chains import chain
from .case import Case, Made, cramer_rao, robust
from .disturbances import outliers

#: Relative error of amplitudes; that of lags is as large in radian.
NOISE = 0.02

#: Frequencies over that of mass 1 on its spring.
RATIOS = {
    2: np.concatenate((np.linspace(0.2, 0.56, 6), np.linspace(0.68, 1.58, 14), np.linspace(1.75, 2.6, 6))),
    3: np.linspace(0.12, 2.6, 44),
}


def _names(n: int, damped: bool) -> list[str]:
    """Parameters of a chain in the order f_k1m1, masses, springs, damping ratios."""
    others = range(2, n + 1)
    ratios = ["gamma", "kappa"] if n == 2 else [f"mass_ratio_{k}" for k in others]
    ratios += [f"stiffness_ratio_{k}" for k in others] if n > 2 else []
    return ["f_k1m1", *ratios, *([f"zeta_{k}" for k in range(1, n + 1)] if damped else [])]


def _responses(values: np.ndarray, n: int, frequency: np.ndarray) -> np.ndarray:
    """X/Y, shape (frequencies, n), from the parameters in the order of `_names`."""
    masses, springs = (np.concatenate(([1.0], part)) for part in np.split(values[1 : 2 * n - 1], 2))
    zeta = values[2 * n - 1 :] if values.size > 2 * n - 1 else np.zeros(n)
    structure = chain(masses, springs, zeta, False)
    return np.array([structure.response(r) for r in frequency / values[0]])


def _quantities(phasors: np.ndarray, lags: bool) -> np.ndarray:
    """Logarithms of amplitudes, and phase lags [rad]."""
    phasors = phasors.ravel()
    return np.concatenate((np.log(np.abs(phasors)), -np.angle(phasors))) if lags else np.log(np.abs(phasors))


def _made(
    rng: np.random.Generator,
    n: int,
    zeta: tuple[float, float] | None = None,
    measured: Sequence[int] = (1,),
    far: bool = False,
    **arguments: object,
) -> Made:
    """Amplitudes of some masses; for a damped chain (range `zeta`) also phase lags; `far`: also outliers."""
    damped = zeta is not None
    values = np.concatenate((
        [rng.uniform(2.0, 5.0)], rng.uniform(0.7, 1.4, 2 * (n - 1)), rng.uniform(*zeta, n) if damped else [],
    ))  # fmt: skip
    frequency = values[0] * RATIOS[n]
    columns = np.array(measured) - 1

    def model(at: np.ndarray) -> np.ndarray:
        return _quantities(_responses(at, n, frequency)[:, columns], damped)

    exact = model(values)
    noise = rng.normal(0.0, NOISE, exact.size) + (outliers(rng, exact.size, NOISE) if far else 0.0)
    data = (exact + noise).reshape(-1, frequency.size, len(measured))
    amplitudes = dict(zip(measured, np.exp(data[0]).T, strict=True))
    lags = dict(zip(measured, np.degrees(data[1]).T, strict=True)) if damped else None
    truth = dict(zip(_names(n, damped), values.tolist(), strict=True))
    return Made(
        truth | (_frequencies(values) if n == 2 else {}),
        lambda: fm.identify.sweep(frequency, amplitudes, lags, masses=n, **arguments),
        cramer_rao(model, truth, NOISE),
    )


def _frequencies(values: np.ndarray) -> dict[str, float]:
    """f1, f2 and f0 of two masses."""
    f_k1m1, gamma, kappa = values[:3]
    total = 1.0 + kappa + kappa / gamma
    squares = 0.5 * (total + np.array([-1.0, 1.0]) * np.sqrt(total**2 - 4.0 * kappa / gamma))
    f1, f2 = f_k1m1 * np.sqrt(squares)
    return {"f1": f1, "f2": f2, "f0": f_k1m1 * np.sqrt(kappa / gamma)}


CASES = (
    Case("two masses, noise only", partial(_made, n=2)),
    Case("two masses, outliers", partial(_made, n=2, far=True, **robust(fm.identify.sweep))),
    Case("two masses, zeta 0.08 to 0.12", partial(_made, n=2, zeta=(0.08, 0.12))),
    Case("three masses, first one measured", partial(_made, n=3), 100),
    Case("three masses, all measured", partial(_made, n=3, zeta=(0.01, 0.04), measured=(1, 2, 3)), 100),
)
