"""Tables of forced responses, checked: lags and amplitudes of masses over frequency, set by set."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ... import checks
from ...errors import InputError
from ...model.system import System
from .. import spring
from ..signals.samples import finite_numbers
from .model import Rows, Samples

#: Initial errors of the data, until the residuals give better ones: radian, and relative.
_PHASE, _AMPLITUDE = np.radians(1.0), 0.02

#: Tolerance of lags beyond their range, in their errors, and in degrees if these are unknown.
_ERRORS, _DEGREES = 5.0, 5.0

#: Values by mass, or those of the only mass.
Values = Sequence[float] | np.ndarray | Mapping[int, Sequence[float] | np.ndarray]


class ForcedTable(NamedTuple):
    """Rows and samples, what the sets are called, and what one load of each set is."""

    rows: Rows
    samples: Samples
    labels: tuple[str, ...]  # of the sets
    load: np.ndarray  # (sets,) mean base amplitude or force; 1 if none was given
    given: tuple[bool, bool]  # whether errors of lags, and of amplitudes, were given


def checked_table(
    system: System, frequency: object, values: tuple[Values | None, Values | None],
    errors: tuple[object, object], load: object, sets: Sequence[object] | None, elastic: bool = False,
) -> ForcedTable:  # fmt: skip
    """Rows and samples of lags [deg] and amplitude ratios, with their errors [deg] and relative ones.

    Raises
    ------
    InputError
        Numbers are not finite, of another length or out of range; it names the index.
    """
    f = finite_numbers(frequency, "frequency", above=0.0, style="g")
    member, labels = _members(sets, f.size)
    amplitudes = (
        np.ones(f.size) if load is None else finite_numbers(load, "load", f.size, above=0.0, style="g")
    )
    means = np.bincount(member, amplitudes) / np.bincount(member)
    rows = Rows(f, amplitudes / means[member], member)
    lags = _by_mass(values[0], "phase_lag", system)
    ratios = _by_mass(values[1], "amplitude_ratio", system)
    if not lags and not ratios:
        raise InputError("phase_lag or amplitude_ratio must be given; got neither")
    sigmas = [
        None if one is None else _errors(one, name, f.size)
        for one, name in zip(errors, ("sigma_phase", "sigma_amplitude"), strict=True)
    ]
    parts = [
        _phases(system, mass, given, name, sigmas[0], f.size, elastic) for mass, (given, name) in lags.items()
    ]
    parts += [_amplitudes(mass, given, name, sigmas[1], f.size) for mass, (given, name) in ratios.items()]
    samples = Samples(*(np.concatenate(part) for part in zip(*parts, strict=True)))
    return ForcedTable(rows, samples, labels, means, (sigmas[0] is not None, sigmas[1] is not None))


def _errors(values: object, name: str, size: int) -> np.ndarray:
    """Check errors > 0, one for all or one per frequency."""
    if np.ndim(checks.array(values, name)) == 0:
        return np.full(size, checks.number(values, name, above=0.0))
    return finite_numbers(values, name, size, above=0.0, style="g")


def _members(sets: Sequence[object] | None, size: int) -> tuple[np.ndarray, tuple[str, ...]]:
    """The set of every row, from 0, and the labels: numbers sorted, other words in order of appearance."""
    if sets is None:
        return np.zeros(size, dtype=int), ("1",)
    labels = [_label(one) for one in checks.array(sets, "sets").tolist()]
    if len(labels) != size:
        raise InputError(f"sets must be {size} labels, one per frequency; got {len(labels)}")
    known = list(dict.fromkeys(labels))
    if all(label.isdecimal() for label in known):
        known.sort(key=int)
    return np.array([known.index(label) for label in labels]), tuple(known)


def _label(value: object) -> str:
    """A set's name; whole numbers without a point."""
    if isinstance(value, float) and value.is_integer():
        return str(int(value))
    return str(value).strip()


def _by_mass(values: Values | None, name: str, system: System) -> dict[int, tuple[object, str]]:
    """Values and their names by mass, from 0."""
    if values is None:
        return {}
    if not isinstance(values, Mapping):
        if system.n > 1:
            raise InputError(
                f"{name} must be a mapping by mass, such as {{1: [...]}}, for {system.n} masses; "
                f"got {checks.one_line(values)}"
            )
        return {0: (values, name)}
    found: dict[int, tuple[object, str]] = {}
    for mass, given in values.items():
        number = checks.whole(mass, f"{name}: mass", least=1, most=system.n)
        found[number - 1] = (given, f"{name}_{number}" if system.n > 1 else name)
    return found


def check_lag(
    system: System, mass: int, lag: np.ndarray, sigma: np.ndarray | None, places: Sequence[str],
    elastic: bool = False,
) -> None:  # fmt: skip
    """Refuse lags [deg] that no errors bring into the range of the loaded mass; `mass` from 0.

    places : of the lags, in words
    elastic : whether the contact has a spring
    """
    if not _drives(system, mass):
        return
    slack = np.full(lag.size, _DEGREES) if sigma is None else _ERRORS * sigma
    slack = slack + spring.LEAD if elastic else slack
    wrong = np.flatnonzero((lag < -slack) | (lag > 180.0 + slack))
    if wrong.size:
        raise InputError(
            f"{places[wrong[0]]} must be 0 to 180 deg for the loaded mass; got {lag[wrong[0]]:g} "
            "(is it a lead, or another mass?)"
        )


def most_beyond(table: ForcedTable) -> np.ndarray:
    """Tolerance of lags beyond their range [rad], sample by sample."""
    given, sigma = table.given[0], table.samples.sigma
    return _ERRORS * sigma if given else np.full(sigma.size, np.radians(_DEGREES))


def _phases(
    system: System, mass: int, values: object, name: str, sigma: np.ndarray | None, size: int, elastic: bool
) -> Samples:
    lag = finite_numbers(values, name, size, style="g")
    check_lag(system, mass, lag, sigma, [f"{name} at index {index}" for index in range(size)], elastic)
    error = np.full(size, _PHASE) if sigma is None else np.radians(sigma)
    return Samples(np.arange(size), np.full(size, mass), np.ones(size, bool), np.radians(lag), error)


def _amplitudes(mass: int, values: object, name: str, sigma: np.ndarray | None, size: int) -> Samples:
    ratio = finite_numbers(values, name, size, above=0.0, style="g")
    error = np.full(size, _AMPLITUDE) if sigma is None else sigma
    return Samples(np.arange(size), np.full(size, mass), np.zeros(size, bool), np.log(ratio), error)


def _drives(system: System, mass: int) -> bool:
    """Whether the work of the load is that on this mass alone, so that its lag is in (0, 180) deg."""
    if system.n == 1:
        return True
    if system.base_motion or system.matrices is not None or system.damping_reference == "base":
        return False
    return isinstance(system.load_mass, int) and mass == system.dofs.row(system.load_mass)
