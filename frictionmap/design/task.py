"""What every design question needs: the system, the band, the response, the range of friction."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from .. import checks
from ..datasets.amounts import Amounts, amounts_by
from ..errors import InputError
from ..features import peak_thresholds
from ..model.system import System
from ..solvers.choose import has_closed_forms
from ..units.axes import KINDS, ratios, require
from ..units.scales import Scales, Units, scales_of
from .band import Band, checked_band, peak_samples
from .limits import (
    Extreme,
    has_no_stop_limit,
    largest_stick,
    least_no_stop,
    starts_matter,
    stick_limit,
    unknown_stick,
)
from .performance import Performance
from .responses import Response, Responses, checked_response

#: Friction ratios of a search: their number, and the share of the highest one at which they begin.
SEARCHED, _LEAST_SHARE = 60, 1.0 / 500.0

#: The search ends at this multiple of the friction that holds over the whole band, so that its last friction
#: ratios do; without damping, where there may be none, at this multiple of the median over some frequencies.
_ABOVE_STUCK, _ABOVE_MEDIAN, _SOME = 1.25, 30.0, 200


@dataclass(frozen=True)
class Task:
    """A checked question about the largest response over a band."""

    system: System
    band: Band
    response: Response
    mu: float
    low: float  # range of the friction ratio
    high: float
    threads: int | None
    units: Units | None
    scales: Scales

    @cached_property
    def stuck(self) -> Extreme:
        """The friction ratio that holds over the whole band, whatever the start."""
        return largest_stick(self.system, self.band, None)

    @cached_property
    def amounts(self) -> Amounts:
        """Numbers of the question in words."""
        return amounts_by(self.scales, self.response_in_words, self.system.excitation == "base")

    @property
    def response_in_words(self) -> str:
        """The response, with the name of its mass or point."""
        return self.response.describe(self.system.dofs)

    def limits(self) -> dict[str, float]:
        """Values of an answer about the band: friction without stops, and friction that sticks.

        With mu > 1 the most friction without a stop whatever the start is a question of its own.
        """
        found = {"beta_stuck": self.stuck.beta, "beta_no_stop": float("nan")}
        no_stop = float("nan")
        if has_no_stop_limit(self.system):
            no_stop = least_no_stop(self.system, self.band, self.mu)[0].beta
        if not starts_matter(self.system, self.mu):
            return found | {"beta_no_stop": no_stop}
        found["beta_stuck_some_starts"] = largest_stick(self.system, self.band, self.mu).beta
        return found | ({} if np.isnan(no_stop) else {"beta_no_stop_some_starts": no_stop})

    def performance(self) -> Performance:
        """The performance curve."""
        responses = Responses(self.system, self.response, self.mu, self.threads)
        return Performance(responses, peak_samples(self.system, self.band), self.stuck)

    def searched(self) -> np.ndarray:
        """Friction ratios of the search, increasing."""
        least = max(self.low, self.high * _LEAST_SHARE)
        ladder = np.geomspace(least, self.high, SEARCHED)
        ladder[[0, -1]] = least, self.high
        begins = self.low == 0.0 and self.may_be_without_friction
        return np.concatenate(([0.0], ladder)) if begins else ladder

    @property
    def may_be_without_friction(self) -> bool:
        """Whether beta = 0 is a steady state of the engine: springs of contacts without friction are not."""
        return not self.system.contact_system.elastic.any()


def checked_task(
    system: Any, band: Any, response: tuple[Any, Any, Any], mu: Any, beta: Any, threads: int | None,
    units: Units | None, spread: float = 0.0,
) -> Task:  # fmt: skip
    """Check the arguments that questions share.

    response : quantity, mass, contact
    beta : two friction ratios, or None: see `range_of_friction`
    spread : relative spread of the friction
    """
    checks.instance(system, "system", System)
    _refuse_own_friction(system)
    scales = scales_of(units, system)
    require(scales, band=(KINDS["r"], band), beta=(KINDS["beta"], beta))
    found = checked_band(band, scales)
    mu = checks.number(mu, "mu", least=1.0)
    asked = checked_response(system, *response)
    low, high = range_of_friction(system, found, spread) if beta is None else _checked_range(beta, scales)
    return Task(system, found, asked, mu, low, high, threads, units, scales)


def _refuse_own_friction(system: System) -> None:
    """Refuse contacts whose friction all are fixed by a preload or a force: nothing is left to choose."""
    groups = system.contact_system.groups
    if any(one.friction(1.0, 1.0)[0] > one.friction(0.0, 1.0)[0] for one in groups):
        return
    k = next((k for k, one in enumerate(groups, 1) if one.first.has_preload), None)
    if k is not None:
        raise InputError(
            f"cannot choose friction with contacts[{k}].normal.preload: it fixes the friction at preload of "
            f"the contact, and no other has one that is searched; omit preload"
        )


def checked_number(given: Any, name: str, kind: str, scales: Scales, **ends: float) -> float:
    """Check one number, which may have a unit: a ratio."""
    found = ratios(given, name, kind, scales)
    return checks.number(
        found[0] if isinstance(found, list) and not isinstance(given, list) else found, name, **ends
    )


def checked_boundary(system: Any, band: Any, mu: Any, units: Units | None) -> tuple[Band, Scales]:
    """Check the arguments of questions about boundaries."""
    checks.instance(system, "system", System)
    scales = scales_of(units, system)
    checks.number(mu, "mu", least=1.0)
    return checked_band(band, scales), scales


def _checked_range(beta: Any, scales: Scales) -> tuple[float, float]:
    ends = checks.axis(ratios(beta, "beta", KINDS["beta"], scales), "beta", least=0.0)
    if ends.size != 2:
        raise InputError("beta", f"must be two friction ratios; got {ends.size}")
    return float(ends[0]), float(ends[1])


def range_of_friction(system: System, band: Band, spread: float = 0.0) -> tuple[float, float]:
    """Range of the friction ratio in which the response over a band changes.

    With a spread it is so wide that all of the spread around some friction ratio holds.

    Raises
    ------
    InputError
        The boundary to sticking is infinite or 0 over the whole band.
    """
    unknown = unknown_stick(system)
    if unknown:
        raise InputError(
            "beta",
            f"must be two friction ratios with {unknown}: the friction that holds has no closed form there; "
            f"got none",
        )
    stick = stick_limit(system, band.samples(_SOME, np.empty(0)), None)
    finite = stick[np.isfinite(stick) & (stick > 0.0)]
    if not finite.size:
        raise InputError("beta", "must be two friction ratios where beta_stick is infinite or 0; got none")
    high = _ABOVE_STUCK * largest_stick(system, band, None).beta
    if np.isinf(high) or not system.modes.damping.any():
        high = min(high, _ABOVE_MEDIAN * float(np.median(finite)))
    high *= (1.0 + spread) / (1.0 - spread)
    return _least_friction(system, band, high), float(high)


def _least_friction(system: System, band: Band, high: float) -> float:
    """Friction below which a response without damping is infinite at a resonance of the band, T(6.2)."""
    modes = system.modes
    if modes.damping.any() or not has_closed_forms(system):
        return 0.0
    inside = (modes.w >= band.low) & (modes.w <= band.high)
    thresholds = peak_thresholds(system)[inside]
    below = thresholds[np.isfinite(thresholds) & (thresholds < high)]
    return float(below.max(initial=0.0))
