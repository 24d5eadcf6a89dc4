"""Performance of uncertain structures: the quantile over samples of the largest response over a band."""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from ..model.variations import Variations
from .limits import Extreme
from .optimum import TWO_PEAKS, largest
from .performance import Peaks, Unclear
from .responses import Values, joined_values
from .task import Task, range_of_friction


class SampledPerformance:
    """The quantile over samples of M(beta), with the peaks of the sample that is there.

    It answers as `Performance` does.  The quantile is the value of one sample: the least that at least the
    share `quantile` of the samples do not exceed.  It has a kink where it passes to another sample.
    """

    def __init__(self, tasks: list[Task], quantile: float) -> None:
        self._curves = [task.performance() for task in tasks]
        self._rank = max(0, math.ceil(quantile * len(tasks)) - 1)
        self._table: dict[float, Peaks] = {}

    @property
    def unknown(self) -> dict[float, Unclear]:
        """Cells of all samples that may be above all known responses, by beta."""
        return _merge_unclear([curve.unknown for curve in self._curves])

    @property
    def harmless(self) -> dict[float, Unclear]:
        """Cells of all samples with irregular motions far below the largest peak, by beta."""
        return _merge_unclear([curve.harmless for curve in self._curves])

    @property
    def stuck(self) -> Extreme:
        """The friction ratio from which the quantile of the samples is held."""
        return sorted(curve.stuck for curve in self._curves)[self._rank]

    @property
    def table(self) -> list[Peaks]:
        """All peaks that were computed, by increasing beta."""
        return [self._table[beta] for beta in sorted(self._table)]

    def whole(self, beta: np.ndarray, all_peaks: bool = False) -> list[Peaks]:
        """Peaks at increasing beta (n_beta,), from samples over the whole band."""
        return self._chosen([curve.whole(beta, all_peaks) for curve in self._curves])

    def at(self, beta: np.ndarray) -> list[Peaks]:
        """Peaks at increasing beta (n_beta,), near those of the neighbours in the tables."""
        return self._chosen([curve.at(beta) for curve in self._curves])

    def forget(self, low: float, high: float) -> None:
        """Drop the entries of the tables between two friction ratios."""
        for curve in self._curves:
            curve.forget(low, high)
        self._table = {beta: one for beta, one in self._table.items() if not low < beta < high}

    def look_at(self, beta: float, r: np.ndarray, peak: float) -> None:
        """Note cells at frequencies (k,) that are unknown or harmless beside a peak."""
        for curve in self._curves:
            curve.look_at(beta, r, peak)

    def states(self, peaks: Peaks) -> Values:
        """The responses at peaks, each of its sample."""
        assert peaks.owner is not None
        return joined_values(
            [
                self._curves[owner].states(Peaks(peaks.beta, peaks.r[k : k + 1], peaks.size[k : k + 1]))
                for k, owner in enumerate(peaks.owner.tolist())
            ]
        )

    def of_samples(self, beta: float) -> np.ndarray:
        """M of every sample at a friction ratio, (samples,)."""
        return np.array([largest(curve.whole(np.array([beta])))[0] for curve in self._curves])

    def _chosen(self, found: list[list[Peaks]]) -> list[Peaks]:
        """The peaks at the quantile, of those of every sample at each beta."""
        chosen = []
        for at_beta in zip(*found, strict=True):
            sizes = np.array([peaks.largest for peaks in at_beta])
            place = np.argsort(sizes, kind="stable")[self._rank]
            level = sizes[place]  # samples with the same response make two equal peaks
            with np.errstate(invalid="ignore"):  # infinite less infinite: that sample alone
                near = np.abs(sizes - level) <= TWO_PEAKS * level
            owners = np.union1d(np.flatnonzero(near), place)
            peaks = _merge_peaks([at_beta[owner] for owner in owners], owners)
            self._table[peaks.beta] = peaks
            chosen.append(peaks)
        return chosen


def _merge_unclear(tables: list[dict[float, Unclear]]) -> dict[float, Unclear]:
    """Cells of several tables together: their number, and those that matter most."""
    found: dict[float, Unclear] = {}
    for beta in {beta for table in tables for beta in table}:
        own = [table[beta] for table in tables if beta in table]
        worst = max(own, key=lambda one: np.inf if np.isnan(one.seen) else one.seen)
        found[beta] = worst._replace(number=sum(one.number for one in own))
    return found


def _merge_peaks(parts: list[Peaks], owners: np.ndarray) -> Peaks:
    """Peaks of several samples, from the highest down."""
    r, size = np.concatenate([one.r for one in parts]), np.concatenate([one.size for one in parts])
    owner = np.repeat(owners, [one.r.size for one in parts])
    order = np.argsort(-size, kind="stable")
    return Peaks(parts[0].beta, r[order], size[order], owner[order])


def sampled(task: Task, variations: Variations, *, widen: bool) -> tuple[Task, list[Task]]:
    """The question of a nominal structure for its samples, and that of each sample.

    variations : the samples, see `Samples.of`
    widen : whether the range of friction is to be wide enough for all samples
    """
    systems = [variations.at(point) for point in variations.points()]
    low, high = task.low, task.high
    if widen:
        ranges = [range_of_friction(system, task.band) for system in systems]
        low, high = (max(ends) for ends in zip(*ranges, strict=True))
    return replace(task, low=low, high=high), [
        replace(task, system=system, low=low, high=high) for system in systems
    ]


def sample_values(tasks: list[Task], curve: SampledPerformance, beta: float) -> dict[str, Any]:
    """Variables of an answer about its samples."""
    limits = [task.limits() for task in tasks]
    ends = {name: max if name.startswith("beta_stuck") else min for name in limits[0]}
    return {
        "sample": np.arange(1, len(tasks) + 1),
        "peak_of_sample": curve.of_samples(beta),
        **{name: of(one[name] for one in limits) for name, of in ends.items()},
    }
