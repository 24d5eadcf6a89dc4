"""Uncertain friction and uncertain structures."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from .. import checks
from ..errors import InputError
from ..model.system import System
from ..model.variations import Variations, checked_variations


def checked_spread(spread: Any) -> float:
    """Check a relative spread of the friction, 0 to below 1."""
    value = checks.number(spread, "spread", least=0.0)
    if value >= 1.0:
        raise InputError("spread", f"must be < 1; got {value:g}")
    return value


@dataclass(frozen=True)
class Samples:
    """An uncertain structure: samples of its parameters, and which share of them an answer is for.

    Parameters
    ----------
    axes : mapping
        As in `sweep`: values of parameters, such as {"sample": {"mass_ratios[2]": [...], "damping_ratios":
        [...]}} for parameters that vary together.  Every point is a sample.
    quantile : float
        Share of the samples whose response is at most the answer's, above 0, up to 1.

    Raises
    ------
    InputError
        The quantile is out of range.

    Examples
    --------
    The structure with the least damping decides:

    >>> import frictionmap as fm
    >>> samples = fm.design.Samples({"damping_ratios": [0.01, 0.02, 0.03]}, quantile=1.0)
    >>> pair = fm.System(contact_masses=[2], mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.02)
    >>> ds = fm.design.least_peak(pair, band=[0.3, 2.2], spread=samples)
    >>> int(ds.peak_of_sample.argmax("sample").squeeze())
    0
    """

    axes: Mapping[str, Any] | Variations
    quantile: float = 0.95

    def __post_init__(self) -> None:
        value = checks.number(self.quantile, "quantile", above=0.0)
        if value > 1.0:
            raise InputError("quantile", f"must be <= 1; got {value:g}")

    def of(self, system: System) -> Variations:
        """The variations of a system."""
        return checked_variations(system, self.axes)
