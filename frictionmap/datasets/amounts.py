"""Numbers of answers to design questions in words: rounded, in units where the reference values are known."""

import math
from collections.abc import Iterable, Mapping
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Decimal
from typing import TYPE_CHECKING

from ..units.scales import Scales
from ..units.table import UNITS, handy_unit
from .labels import SCALES

if TYPE_CHECKING:
    import xarray as xr

#: Directions of rounding: of a bound from below, of one from above.
DOWN, NEAREST, UP = ROUND_FLOOR, ROUND_HALF_EVEN, ROUND_CEILING

#: Significant digits of a sentence and of a row.
_DIGITS, DIGITS = 3, 5

#: Relative error that an answer may have: a bound that is rounded away from it keeps 100 as 100.
_ACCURACY = 1e-9

#: Numbers below this are written without an exponent.
_LARGE = 1e6

#: What a response of 0 is written in like: 0 mm.
_LIKE_ZERO = {"length": 1e-3}

#: The response that is a share, not a length or a force.
SHARE_LOST = "loss of normal force over the preload"


def rounded(value: float, towards: str = NEAREST, digits: int = _DIGITS) -> str:
    """Format a number with a few significant digits; a bound is rounded to the side on which it holds."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}"
    slack = {UP: -_ACCURACY, DOWN: _ACCURACY}.get(towards, 0.0)
    exact = Decimal(value + slack * abs(value))
    found = float(exact.quantize(Decimal(1).scaleb(exact.adjusted() + 1 - digits), rounding=towards))
    return f"{found:.0f}" if 10.0**digits <= abs(found) < _LARGE else f"{found:.{digits}g}"


def per_cycle(numbers: Iterable[float], what: str) -> str:
    """How many stops or slips there are per cycle, of every contact; `what`: their plural."""
    listed = ", ".join(f"{number:.4g}" for number in numbers)
    return f"{listed} {what.removesuffix('s') if listed == '1' else what} per cycle"


class Amounts:
    """Friction, frequencies and responses in words.

    Parameters
    ----------
    ones : SI values of a ratio of 1, as far as they are known, by their measures
    response : response of a question, in words
    of_base : whether displacements are over Y, the amplitude of the base
    """

    def __init__(self, ones: Mapping[str, float], response: str, of_base: bool = False) -> None:
        self._ones, self._response = ones, response
        measures = {"transmitted force": ("force", "P"), SHARE_LOST: ("", "")}
        self._measure, self._over = measures.get(response, ("length", "Y" if of_base else "P/k1"))

    @property
    def measure(self) -> str:
        """What the response measures: length or force; nothing if it is a share."""
        return self._measure

    def _with_unit(
        self, ratio: float, measure: str, towards: str, digits: int, like: float | None = None
    ) -> str:
        """A ratio in the unit that is handy for it, or for another one."""
        size, one = ratio * self._ones[measure], self._ones[measure]
        unit = handy_unit(abs(one * like if like else size or _LIKE_ZERO.get(measure, one)), measure)
        return f"{rounded(size / float(UNITS[unit].size), towards, digits)} {unit}"

    def friction(
        self, beta: float, towards: str = NEAREST, digits: int = _DIGITS, like: float | None = None
    ) -> str:
        """A friction force, or its ratio; `like`: another one whose unit is used."""
        if "force" in self._ones:
            return self._with_unit(beta, "force", towards, digits, like)
        return f"beta = {rounded(beta, towards, digits)}"

    def friction_range(self, begin: float, end: float) -> str:
        """A range of friction in one unit, each end rounded into it."""
        if "force" not in self._ones:
            return f"beta = {rounded(begin, UP)} to {rounded(end, DOWN)}"
        first = self._with_unit(begin, "force", UP, _DIGITS, like=end)
        return f"{first.partition(' ')[0]} to {self.friction(end, DOWN)}"

    def friction_and_ratio(self, beta: float) -> str:
        """A friction force with its ratio."""
        ratio = f"beta = {rounded(beta, digits=DIGITS)}"
        return f"{self.friction(beta, digits=DIGITS)} ({ratio})" if "force" in self._ones else ratio

    def frequency(self, r: float, towards: str = NEAREST, digits: int = _DIGITS) -> str:
        """A frequency, or its ratio."""
        if "frequency" in self._ones:
            return self._with_unit(r, "frequency", towards, digits)
        return f"r = {rounded(r, towards, digits)}"

    def frequency_and_ratio(self, r: float) -> str:
        """A frequency with its ratio."""
        ratio = f"r = {rounded(r, digits=DIGITS)}"
        return f"{self.frequency(r, digits=DIGITS)} ({ratio})" if "frequency" in self._ones else ratio

    def speed(self, v: float, towards: str = NEAREST, digits: int = _DIGITS) -> str:
        """A belt speed, or its ratio."""
        if "velocity" in self._ones:
            return self._with_unit(v, "velocity", towards, digits)
        return f"v = {rounded(v, towards, digits)}"

    def response(self, size: float, towards: str = NEAREST, digits: int = _DIGITS) -> str:
        """A response; a bound from above is rounded up."""
        if not math.isfinite(size):
            return "infinite" if math.isinf(size) else "not known"
        if self._measure in self._ones:
            return self._with_unit(size, self._measure, towards, digits)
        return f"{rounded(size, towards, digits)} {self._over}".rstrip()

    def band(self, low: float, high: float) -> str:
        """A band by its ends, after a sentence."""
        if "frequency" not in self._ones:
            return f" for r between {rounded(low, digits=6)} and {rounded(high, digits=6)}"
        unit = handy_unit(high * self._ones["frequency"], "frequency")
        one = self._ones["frequency"] / float(UNITS[unit].size)
        return f" between {rounded(low * one, digits=6)} and {rounded(high * one, digits=6)} {unit}"

    def stays(self, size: str) -> str:
        """The response is at most a size."""
        if self._response.startswith("amplitude of "):
            return f"{self._response.removeprefix('amplitude of ')} moves at most {size}"
        return f"the {self._response} is at most {size}"

    def rests(self) -> str:
        """The response is 0."""
        if self._response.startswith("amplitude of "):
            return f"{self._response.removeprefix('amplitude of ')} does not move"
        return f"the {self._response} is 0"


def amounts_of(ds: "xr.Dataset") -> Amounts:
    """The words of an answer."""
    from .physical import ones_of

    of_base = ds.attrs.get("excitation") == "base"
    return Amounts(ones_of(ds), str(ds.attrs.get("response", "response")), of_base)


def amounts_by(scales: Scales, response: str, of_base: bool) -> Amounts:
    """The words of a question that is not answered yet."""
    ones = {measure: scales.of(measure) for measure in SCALES}
    return Amounts({name: one for name, one in ones.items() if one is not None}, response, of_base)


def band_of(ds: "xr.Dataset") -> str:
    """The band of an answer, after a sentence; empty where the answer does not have it."""
    if "r_search" not in ds.coords or not ds.sizes["r_search"]:
        return ""
    return amounts_of(ds).band(float(ds["r_search"][0]), float(ds["r_search"][-1]))
