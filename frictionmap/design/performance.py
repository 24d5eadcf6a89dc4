"""The performance curve M(beta): the largest response over a band of frequencies, with its peaks.

Every peak is a maximum in r of exact cells (`extremes`).  A table keeps what has been computed: between two
of its friction ratios peaks are sought around those of its neighbours only.
"""

import math
from bisect import bisect
from typing import NamedTuple, Protocol

import numpy as np

from .extremes import Brackets, brackets_of, joined, refine_maxima
from .limits import Extreme
from .responses import Responses, Values, unresolved

#: Peaks below this share of the largest one are not followed.
_FOLLOWED = 0.5

#: Samples that differ by less than this share of the largest one are equal: a plateau has one peak.
_ROUNDING = 1e-12

#: Responses below this share of the largest one are rounding error of contacts that stick.
_ZERO = 1e-13

#: An irregular motion does not decide if the largest response seen of it, in more than 300 periods, is below
#: this share of the largest peak: in 20 times as many periods it was up to 1.31 times as large, in 62 cells
#: of one to three masses with mu from 1.3 to 2 and zeta from 0.003 to 0.02.
_HARMLESS = 0.75

#: Samples of a window around a peak at least; its least half width, and that around a peak that a neighbour
#: does not have, in steps of the samples of the band.
_IN_WINDOW, _LEAST_WINDOW, _FAR = 9, 0.25, 8.0


class Peaks(NamedTuple):
    """Peaks over the band at one beta, from the highest down."""

    beta: float
    r: np.ndarray
    size: np.ndarray
    owner: np.ndarray | None = None  # of several structures the one of each peak

    @property
    def largest(self) -> float:
        """M(beta)."""
        return float(self.size[0])

    def above(self, least: float) -> "Peaks":
        """The peaks of at least this size."""
        return self._chosen(np.flatnonzero(self.size >= least))

    def by_frequency(self, tolerance: float) -> "Peaks":
        """Order the peaks by size, and those that agree to a relative tolerance by frequency.

        Which of two equal peaks is larger depends on rounding.
        """
        smaller = self.size[1:] < self.size[:-1] * (1.0 - tolerance)
        return self._chosen(np.lexsort((self.r, np.append(0, np.cumsum(smaller)))))

    def _chosen(self, which: np.ndarray) -> "Peaks":
        """Some of the peaks, in this order."""
        owner = None if self.owner is None else self.owner[which]
        return Peaks(self.beta, self.r[which], self.size[which], owner)


class Unclear(NamedTuple):
    """Cells at one beta without a periodic steady state: how many, and the one that matters most."""

    number: int
    r: float
    seen: float  # the largest response seen of an irregular motion; NaN where none is known
    peak: float  # the largest known response of the other cells


class PerformanceCurve(Protocol):
    """M(beta) of one structure, or of several."""

    @property
    def table(self) -> list[Peaks]:
        """All peaks that were computed, by increasing beta."""

    @property
    def unknown(self) -> dict[float, Unclear]:
        """Cells that may be above all known responses, by beta: M is infinite there."""

    @property
    def harmless(self) -> dict[float, Unclear]:
        """Cells with irregular motions far below the largest peak, by beta."""

    @property
    def stuck(self) -> Extreme:
        """Friction ratio from which all contacts hold over the band, and the frequency that decides."""

    def whole(self, beta: np.ndarray, all_peaks: bool = False) -> list[Peaks]:
        """Peaks at increasing beta (n_beta,), from samples over the whole band.

        The largest one of each beta is exact, or all are; others are at least samples of the band.
        """

    def at(self, beta: np.ndarray) -> list[Peaks]:
        """Peaks at increasing beta (n_beta,), near those of the neighbours in the table.

        The largest one of each beta is exact.
        """

    def forget(self, low: float, high: float) -> None:
        """Drop the entries of the table between two friction ratios, because a peak was missed there."""

    def look_at(self, beta: float, r: np.ndarray, peak: float) -> None:
        """Note cells at frequencies (k,) that are unknown or harmless beside a peak."""

    def states(self, peaks: Peaks) -> Values:
        """The responses at peaks."""


def _note(
    table: dict[float, Unclear], beta: np.ndarray, r: np.ndarray, seen: np.ndarray, peak: np.ndarray,
    *, count: bool,
) -> None:  # fmt: skip
    """Put cells (k,) into a table by their beta; of a beta that it has, if they are more.

    count : whether to count them; those of a refinement are close to one another and count as one
    """
    for level in np.unique(beta).tolist():
        own = np.flatnonzero(beta == level)
        worst = own[np.argmax(np.where(np.isnan(seen[own]), np.inf, seen[own]))]
        number = own.size if count else 1
        if level not in table or number > table[level].number:
            table[level] = Unclear(number, float(r[worst]), float(seen[worst]), float(peak[worst]))


class Performance:
    """M(beta) of a response over a band sampled at frequencies r (n_r,)."""

    def __init__(self, responses: Responses, r: np.ndarray, stuck: Extreme) -> None:
        self.stuck = stuck
        self.unknown: dict[float, Unclear] = {}
        self.harmless: dict[float, Unclear] = {}
        self._responses, self._r = responses, r
        self._table: list[Peaks] = []
        self._scale = 0.0

    @property
    def table(self) -> list[Peaks]:
        """All peaks that were computed, by increasing beta."""
        return self._table

    def states(self, peaks: Peaks) -> Values:
        """The responses at peaks."""
        return self._responses.at(peaks.r, np.full(peaks.r.size, peaks.beta))

    def look_at(self, beta: float, r: np.ndarray, peak: float) -> None:
        """Note cells at frequencies (k,) that are unknown or harmless beside a peak."""
        if r.size:
            ones = np.ones(r.size)
            self._unclear(self._responses.at(r, beta * ones), r, beta * ones, peak * ones)

    def whole(self, beta: np.ndarray, all_peaks: bool = False) -> list[Peaks]:
        """Peaks at increasing beta (n_beta,), from samples over the whole band."""
        values = self._on_grid(self._r, beta)
        return self._keep([self._brackets(self._r, column) for column in values.T], beta, all_peaks)

    def at(self, beta: np.ndarray) -> list[Peaks]:
        """Peaks at increasing beta (n_beta,), near those of the neighbours in the table."""
        windows = self._windows(beta)
        r = np.unique(np.concatenate(windows))
        if r.size > self._r.size:  # they cover most of the band
            return self.whole(beta)
        values = self._on_grid(r, beta)
        parts = []
        for column in values.T:
            inside = [np.searchsorted(r, window) for window in windows]
            parts.append(joined([self._brackets(r[which], column[which]) for which in inside]))
        return self._keep(parts, beta, all_peaks=False)

    def _on_grid(self, r: np.ndarray, beta: np.ndarray) -> np.ndarray:
        """Responses on a grid; at beta where one that may be the largest is not known, all are infinite."""
        values = self._responses.on_grid(r, beta)
        size = values.size[np.isfinite(values.size)]
        self._scale = max(self._scale, size.max(initial=0.0))
        size = self._rounded(values.size)
        steady = ~unresolved(values) & (values.irregular == 0.0)
        peak = np.where(steady, size, 0.0).max(axis=0)
        unknown = self._unclear(values, *np.broadcast_arrays(r[:, np.newaxis], beta, peak))
        return np.where(unknown.any(axis=0), np.inf, size)

    def _rounded(self, size: np.ndarray) -> np.ndarray:
        """Responses without those that are rounding error."""
        return np.where(size < _ZERO * self._scale, 0.0, size)

    def _unclear(self, values: Values, r: np.ndarray, beta: np.ndarray, peak: np.ndarray) -> np.ndarray:
        """Where a response that may be above a known peak is not known; cells that are irregular are noted.

        r, beta, peak : of the shape of the values
        """
        moves = values.irregular != 0.0
        with np.errstate(invalid="ignore"):  # NaN: nothing was seen
            low = values.irregular <= _HARMLESS * peak
        unknown = unresolved(values) | (moves & ~low)
        seen = np.where(moves, values.irregular, np.nan)
        for table, which in ((self.unknown, unknown), (self.harmless, moves & ~unknown)):
            _note(table, *(array[which] for array in (beta, r, seen, peak)), count=which.ndim == 2)
        return unknown

    def _brackets(self, r: np.ndarray, size: np.ndarray) -> Brackets:
        """Brackets of the peaks of one column that may be the largest."""
        found = brackets_of(r, size, _ROUNDING * size.max())
        high = found.at_m >= _FOLLOWED * size.max()
        return Brackets(*(array[high] for array in found))

    def _keep(self, parts: list[Brackets], beta: np.ndarray, all_peaks: bool) -> list[Peaks]:
        """Refine the peaks at every beta, or the largest only, and put them into the table."""
        owner = np.repeat(np.arange(beta.size), [part.m.size for part in parts])
        peak = np.array([part.at_m.max() for part in parts])

        def size(which: np.ndarray, r: np.ndarray) -> np.ndarray:
            own = owner[which]
            values = self._responses.at(r, beta[own])
            unknown = self._unclear(values, r, beta[own], peak[own])
            return np.where(unknown, np.inf, self._rounded(values.size))

        places, sizes = refine_maxima(size, joined(parts), None if all_peaks else owner)
        found = []
        for j, value in enumerate(beta.tolist()):
            own = np.flatnonzero(owner == j)
            order = own[np.argsort(-sizes[own], kind="stable")]
            found.append(Peaks(value, places[order], sizes[order]))
        for one in found:
            self._insert(one)
        return found

    def _insert(self, peaks: Peaks) -> None:
        place = bisect(self._table, peaks.beta, key=lambda one: one.beta)
        if place and self._table[place - 1].beta == peaks.beta:
            self._table[place - 1] = peaks
        else:
            self._table.insert(place, peaks)

    def _neighbours(self, beta: float) -> list[Peaks]:
        """The two entries of the table on either side of beta, or the one at its end."""
        place = bisect(self._table, beta, key=lambda one: one.beta)
        return self._table[max(0, place - 1) : place + 1]

    def _windows(self, beta: np.ndarray) -> list[np.ndarray]:
        """Samples around the peaks of the neighbours of each beta; overlapping windows are one."""
        found: list[tuple[float, float, float]] = []
        for value in beta.tolist():
            found += self._spans(self._neighbours(value))
        spans: list[list[float]] = []
        for low, high, step in sorted(set(found)):
            if spans and low <= spans[-1][1]:
                spans[-1][1] = max(spans[-1][1], high)
                spans[-1][2] = min(spans[-1][2], step)
            else:
                spans.append([low, high, step])
        return [
            np.linspace(low, high, max(_IN_WINDOW, 2 * math.ceil((high - low) / step) + 1))
            for low, high, step in spans
        ]

    def _spans(self, neighbours: list[Peaks]) -> list[tuple[float, float, float]]:
        """Ranges around the peaks of neighbours, with the step of the samples there.

        A peak that both have moves from one to the other; one that only one of them has may move further.
        """
        found = []
        for one in neighbours:
            others = np.concatenate([other.r for other in neighbours if other is not one] or [np.empty(0)])
            for r in one.r.tolist():
                step = self._step(r)
                nearest = others[np.argmin(np.abs(others - r))] if others.size else math.inf
                moved = abs(nearest - r)
                half = max(_LEAST_WINDOW * step, moved) if moved <= _FAR * step else _FAR * step
                found.append((max(self._r[0], r - half), min(self._r[-1], r + half), step))
        return found

    def _step(self, r: float) -> float:
        """Largest distance of the samples of the band next to r."""
        k = int(np.clip(np.searchsorted(self._r, r), 2, self._r.size - 2))
        return float(np.diff(self._r[k - 2 : k + 2]).max())

    def forget(self, low: float, high: float) -> None:
        """Drop the entries of the table between two friction ratios, because a peak was missed there."""
        self._table = [one for one in self._table if not low < one.beta < high]
