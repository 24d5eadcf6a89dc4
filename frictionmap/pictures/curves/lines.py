"""Lines of response curves: pieces by regime, phases without jumps, bands for maxima held during a stop."""

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ... import regimes
from ..grids import HIGH
from ..palette import REGIME_LINES
from ..panels import Handle

_BAND = 0.3  # opacity


def regime_runs(regime: np.ndarray) -> Iterator[tuple[int, slice]]:
    """Runs of neighbouring points with their regime; a line between two regimes has the style of the lower
    one.

    A continuous line thus connects continuous motions only.
    """
    between = np.minimum(regime[1:], regime[:-1])
    first = np.flatnonzero(np.diff(between, prepend=between[0] - 1))
    last = np.append(first[1:], between.size)
    for a, b in zip(first, last, strict=True):
        yield int(between[a]), slice(int(a), int(b) + 1)


def _jumps(degrees: np.ndarray) -> np.ndarray:
    """Indices of values that differ by more than half a turn from the previous one."""
    return np.flatnonzero(np.abs(np.diff(degrees)) > 180.0) + 1


def without_jumps(x: np.ndarray, degrees: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Interrupt a phase over x where it wraps around."""
    at = _jumps(degrees)
    return np.insert(x, at, np.nan), np.insert(degrees, at, np.nan)


def by_regime(x: np.ndarray, y: np.ndarray, regime: np.ndarray) -> dict[int, tuple[np.ndarray, np.ndarray]]:
    """Divide a curve by regime, each part with gaps where the others are."""
    parts: dict[int, list[np.ndarray]] = {}
    for code, where in regime_runs(regime):
        parts.setdefault(code, []).append(np.array([[*x[where], np.nan], [*y[where], np.nan]]))
    found = {code: np.concatenate(pieces, axis=1) for code, pieces in parts.items()}
    return {code: (both[0], both[1]) for code, both in found.items()}


def draw_curve(
    ax: Axes, x: np.ndarray, y: np.ndarray, regime: np.ndarray, colour: str, top: float | None
) -> None:
    """Draw one curve in the styles of its regimes: an amplitude up to about `top`, or a phase [degrees]."""
    for code, (part_x, part_y) in by_regime(x, y, regime).items():
        if code == regimes.UNRESOLVED:
            continue
        line = without_jumps(part_x, part_y) if top is None else (part_x, np.minimum(part_y, HIGH * top))
        ax.plot(*line, color=colour, linewidth=1.3, linestyle=REGIME_LINES[code])


def draw_band(ax: Axes, x: np.ndarray, begin: np.ndarray, end: np.ndarray, colour: str) -> None:
    """Draw the range of phases [degrees] between start and end of a stop; it may exceed 180 degrees."""
    at = _jumps(begin)
    x, low, high = (
        np.insert(values, at, np.nan) for values in (x, begin, begin + np.mod(end - begin, 360.0))
    )
    for turn in (0.0, -360.0):
        ax.fill_between(x, low + turn, high + turn, color=colour, alpha=_BAND, linewidth=0.0)


def regime_handles(regime: np.ndarray, elastic: bool = False) -> list[Handle]:
    """Legend entries of the regimes that occur; `elastic`: of contacts with a spring."""
    words = {
        regimes.CONTINUOUS: "continuous",
        regimes.STICK_SLIP: "slips" if elastic else "stick-slip",
        regimes.PERMANENT_STICKING: "no slip" if elastic else "permanent sticking",
        regimes.ONE_WAY_SLIDING: "one-way sliding",
    }
    return [
        Line2D([], [], color="#606060", linewidth=1.3, linestyle=REGIME_LINES[code], label=word)
        for code, word in words.items()
        if (regime == code).any()
    ]


def band_handle() -> Handle:
    """Legend entry of a stop during which a displacement is largest."""
    return Patch(color="#606060", alpha=_BAND, linewidth=0.0, label="largest throughout a stop")
