"""Amplitudes and lags over frequency as they were measured, checked value by value."""

from collections.abc import Mapping, Sequence

import numpy as np

from ... import checks
from ...errors import InputError
from ..signals.samples import finite_numbers
from .fit import Measured, peaks

#: Values of the only mass measured, or by mass, counted from 1.
Values = Sequence[float] | np.ndarray | Mapping[int, Sequence[float] | np.ndarray]

#: Chains with more masses have more unknowns than sweeps usually determine.
MOST_MASSES = 5

WORDS = ("one", "two", "three", "four", "five")


def checked_sweep(
    frequency: object,
    quantities: tuple[Values, Values | None],
    sigmas: tuple[float | None, float | None],
    n: int,
) -> Measured:
    """Amplitudes and lags [deg] of the masses measured, with their errors, relative and [deg].

    Without errors amplitudes and lags count alike, 1 rad as a relative error of 1.
    """
    f = finite_numbers(frequency, "frequency", above=0.0)
    parts = []
    for is_phase, (values, sigma) in enumerate(zip(quantities, _errors(quantities, sigmas), strict=True)):
        for mass, given in _by_mass(values, ("amplitude_ratio", "phase_lag")[is_phase], n).items():
            ones = np.ones(f.size)
            checked = _numbers(given, f.size, mass, bool(is_phase))
            parts.append((f, (mass - 1) * ones, is_phase * ones, checked, sigma * ones))
    columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
    order = np.lexsort((columns[0], columns[1], columns[2]))  # lags after amplitudes, mass by mass
    at, of, phase, value, error = (column[order] for column in columns)
    return Measured(at, of.astype(int), phase == 1.0, value, error, n)


def check_enough(data: Measured, known: np.ndarray) -> None:
    """Refuse fewer data than unknowns, and fewer peaks than frequencies that are wanted."""
    unknowns = int(np.isnan(known).sum())
    if data.value.size <= unknowns:
        raise InputError(f"frequency must have more values than unknowns, {unknowns}; got {data.value.size}")
    wanted = min(data.n, int(np.isnan(known[: 2 * data.n - 1]).sum()))
    found = peaks(data)
    undamped = bool((known[2 * data.n - 1 :] == 0.0).all())
    if undamped and found < wanted:  # damping hides peaks
        number = WORDS[wanted - 1]
        some = f"{WORDS[found - 1]} peak{'s' * (found > 1)}" if found else "no peak"
        raise InputError(
            f"amplitude_ratio must have {number} peak{'s' * (wanted > 1)} for {number} "
            f"frequenc{'ies' if wanted > 1 else 'y'}; got {some}"
        )


def _errors(
    quantities: tuple[Values, Values | None], sigmas: tuple[float | None, float | None]
) -> tuple[float, float]:
    """Errors of logarithms and of lags [rad]."""
    amplitude, phase = sigmas
    if quantities[1] is None and phase is not None:
        raise InputError("cannot use sigma_phase without phase_lag: there are no lags; omit it")
    if quantities[1] is not None and (amplitude is None) != (phase is None):
        raise InputError(
            "sigma_amplitude and sigma_phase must both be given or both omitted; got one of them"
        )
    return (
        1.0 if amplitude is None else checks.number(amplitude, "sigma_amplitude", above=0.0),
        1.0 if phase is None else float(np.radians(checks.number(phase, "sigma_phase", above=0.0))),
    )


def _by_mass(values: Values | None, name: str, masses: int) -> Mapping[int, object]:
    if values is None:
        return {}
    if not isinstance(values, Mapping):
        return {1: values}
    for mass in values:
        checks.whole(mass, f"a mass in {name}", least=1, most=masses)
    if not values:
        raise InputError(f"{name} must have at least one mass; got none")
    return values


def _numbers(values: object, size: int, mass: int, is_phase: bool) -> np.ndarray:
    """Logarithms of amplitudes, or lags in radian."""
    if is_phase:
        return np.radians(finite_numbers(values, f"phase_lag of mass {mass}", size))
    return np.log(finite_numbers(values, f"amplitude_ratio of mass {mass}", size, above=0.0))
