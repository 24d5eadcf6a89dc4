"""The performance curve M(beta): the largest response over a band of frequencies, with its peaks.

Every peak is a maximum in r of exact cells (`extremes`).  A table keeps what has been computed: between two
of its friction ratios peaks are sought around those of its neighbours only.
"""

import math
from bisect import bisect
from typing import NamedTuple, Protocol

import numpy as np

from .extremes import Brackets, brackets_of, joined, sharpened
from .responses import Responses, Values, unresolved

#: Peaks below this share of the largest one are not followed.
_FOLLOWED = 0.5

#: Samples that differ by less than this share of the largest one are equal: a plateau has one peak.
_ROUNDING = 1e-12

#: Responses below this share of the largest one are rounding error of contacts that stick.
_ZERO = 1e-13

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


class PerformanceCurve(Protocol):
    """M(beta) of one structure, or of several."""

    @property
    def table(self) -> list[Peaks]:
        """All peaks that were computed, by increasing beta."""

    @property
    def unknown(self) -> dict[float, int]:
        """Number of cells without a known response, at the beta where there are any: M is infinite there."""

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

    def states(self, peaks: Peaks) -> Values:
        """The responses at peaks."""


class Performance:
    """M(beta) of a response over a band sampled at frequencies r (n_r,)."""

    def __init__(self, responses: Responses, r: np.ndarray) -> None:
        self._responses, self._r = responses, r
        self._table: list[Peaks] = []
        self._scale = 0.0
        self._unknown: dict[float, int] = {}

    @property
    def table(self) -> list[Peaks]:
        """All peaks that were computed, by increasing beta."""
        return self._table

    @property
    def unknown(self) -> dict[float, int]:
        """Number of cells without a known response, by beta."""
        return self._unknown

    def states(self, peaks: Peaks) -> Values:
        """The responses at peaks."""
        return self._responses.at(peaks.r, np.full(peaks.r.size, peaks.beta))

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
        """Responses on a grid; at beta where one of them is not known, all are infinite."""
        values = self._responses.on_grid(r, beta)
        size = values.size[np.isfinite(values.size)]
        self._scale = max(self._scale, size.max(initial=0.0))
        return self._known(self._rounded(values.size), unresolved(values), beta)

    def _rounded(self, size: np.ndarray) -> np.ndarray:
        """Responses without those that are rounding error."""
        return np.where(size < _ZERO * self._scale, 0.0, size)

    def _known(self, size: np.ndarray, wrong: np.ndarray, beta: np.ndarray) -> np.ndarray:
        columns = wrong.any(axis=0)
        for level, count in zip(beta[columns].tolist(), wrong.sum(axis=0)[columns].tolist(), strict=True):
            self._unknown[level] = max(count, self._unknown.get(level, 0))
        return np.where(columns, np.inf, size)

    def _brackets(self, r: np.ndarray, size: np.ndarray) -> Brackets:
        """Brackets of the peaks of one column that may be the largest."""
        found = brackets_of(r, size, _ROUNDING * size.max())
        high = found.at_m >= _FOLLOWED * size.max()
        return Brackets(*(array[high] for array in found))

    def _keep(self, parts: list[Brackets], beta: np.ndarray, all_peaks: bool) -> list[Peaks]:
        """Refine the peaks at every beta, or the largest only, and put them into the table."""
        owner = np.repeat(np.arange(beta.size), [part.m.size for part in parts])

        def size(which: np.ndarray, r: np.ndarray) -> np.ndarray:
            values = self._responses.at(r, beta[owner[which]])
            return np.where(unresolved(values), np.inf, self._rounded(values.size))

        places, sizes = sharpened(size, joined(parts), None if all_peaks else owner)
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
