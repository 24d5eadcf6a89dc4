"""Results of one group of cells: digits lost, wrong regimes and counts, exceptions."""

import math
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import xarray as xr

from frictionmap import regimes

from ...references.closed_forms import Number, mp

ALLOWED = 2.0  # digits beyond the condition number
SLOW = 10.0  # seconds for a cell
ROUNDING = 2.0**-53
#: Numbers below this are compared as zero: the least normal double and its rounding.
_NOTHING = 1e-290
STATUS_NAMES = {code.value: code.name for code in regimes.STATUSES}


@dataclass
class Group:
    """Results of one group of cells."""

    name: str
    answers: list[dict] = field(default_factory=list)  # numbers compared: what, k, lost, explained
    cells: int = 0
    statuses: Counter = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)  # regimes
    at_rounding: int = 0
    many_turns: int = 0  # without stops above beta_lim, by more than two turns a cycle
    miscounted: list[str] = field(default_factory=list)
    flagged_miscounts: int = 0  # wrong counts under a status that says so
    miscounts_at_rounding: int = 0  # right for a beta that differs by rounding
    counted: int = 0  # cells whose stops were counted in 40 digits
    inconsistent: list[str] = field(default_factory=list)
    trouble: list[str] = field(default_factory=list)  # exceptions, warnings, hangs
    slowest: float = 0.0
    seconds: float = 0.0

    def compare(
        self,
        what: str,
        k: int | None,
        value: float,
        exact: Number,
        explained: Callable[[], Iterable],
    ) -> None:
        """Digits lost by a number; `explained` gives the parts of its condition number, one by one.

        Only as many parts are requested as are needed to explain the digits lost.
        """
        lost = digits_lost(value, exact)
        known, total = 0.0, mp.mpf(0)
        for part in explained() if lost > ALLOWED else ():
            total += part
            known = float(min(mp.log10(max(total, 1)), 99))
            if lost - known <= ALLOWED:
                break
        self.answers.append({"what": what, "k": k, "lost": lost, "explained": known})

    @property
    def beyond(self) -> list[dict]:
        """Results that lost more digits than allowed."""
        return [row for row in self.answers if row["lost"] - row["explained"] > ALLOWED]


def digits_lost(value: float, exact: Number) -> float:
    """log10 of the relative error over the rounding error of a double, 0 to 16."""
    if mp.isinf(exact) or math.isinf(value):
        return 0.0 if mp.isinf(exact) and math.isinf(value) else 16.0
    if math.isnan(value):
        return 16.0
    error = abs(mp.mpf(value) - exact)
    if error == 0 or (abs(exact) < _NOTHING and abs(value) < _NOTHING):
        return 0.0
    if exact == 0:
        return 16.0
    return float(min(max(mp.log10(error / abs(exact) / ROUNDING), 0), 16))


def watched(group: Group, what: str, call: Callable[[], xr.Dataset], cells: int) -> xr.Dataset | None:
    """Call the package; exceptions, warnings and hangs are recorded."""
    began = time.perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            found = call()
        except Exception as problem:  # of any kind: that there is one is what is looked for
            group.trouble.append(f"{what}: {type(problem).__name__}: {problem}")
            return None
    taken = (time.perf_counter() - began) / cells
    group.slowest = max(group.slowest, taken)
    if taken > SLOW:
        group.trouble.append(f"{what}: {taken:.0f} s a cell")
    return found
