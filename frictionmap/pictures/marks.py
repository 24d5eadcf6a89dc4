"""Positions of names, rings and labels, such that they do not overlap and cover nothing.

Positions are shares of an axis: 0 at its start, 1 at its end.
"""

import numpy as np

#: Pixels per axis of the raster on which names of regions are placed.
COARSE = 120

#: Width of a letter and height of a line of text [inch].
_LETTER, _LINE = 0.075, 0.18

#: Number of rings that would fill a panel in each direction.  A group of rare cells that needs more than
#: `_FEW` rings is visible without them.
RINGS = (44, 32)
_FEW = 8

#: A class is rare if it has fewer than this share of the cells.
_RARE = 1e-3


def trace(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Raster pixels that a curve passes through, shape (COARSE, COARSE); `x`, `y` are shares."""
    passed = np.zeros((COARSE, COARSE), dtype=bool)
    places = np.linspace(0.0, 1.0, 8 * COARSE + 1)
    curve = COARSE * np.interp(places, x, np.clip(np.nan_to_num(y, nan=2.0), -1.0, 2.0))
    for column in range(COARSE):
        part = curve[8 * column : 8 * column + 9]
        low, high = np.clip([np.floor(part.min()), np.floor(part.max()) + 1], 0, COARSE).astype(int)
        passed[column, low:high] = True
    return passed


def room_for(free: np.ndarray, text: str, size: tuple[float, float]) -> tuple[float, float] | None:
    """Centre of the widest free place for a text, as shares of the axes; None if there is none.

    Parameters
    ----------
    free : array of bool, shape (COARSE, COARSE)
        Where the text may be placed.
    size : (width, height) of the axes [inch]
    """
    from scipy.ndimage import binary_erosion, distance_transform_edt

    wide = int(np.ceil(COARSE * (len(text) + 1.0) * _LETTER / size[0]))
    tall = int(np.ceil(COARSE * 1.4 * _LINE / size[1]))
    if max(wide, tall) >= COARSE:
        return None
    fits = binary_erosion(free, np.ones((wide, tall)))
    if not fits.any():
        return None
    room = distance_transform_edt(np.pad(fits, 1))[1:-1, 1:-1]
    best = np.argwhere(room > room.max() - 1.0)
    i, j = best[np.argmin(np.square(best - best.mean(axis=0)).sum(axis=1))]  # in the middle of a strip
    return (i + 0.5) / COARSE, (j + 0.5) / COARSE


def rare_classes(counts: np.ndarray) -> np.ndarray:
    """Classes that have cells, but too few to be noticed."""
    return np.flatnonzero((counts > 0) & (counts < _RARE * counts.sum()))


def rings(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Centres of rings around small groups of cells at `x`, `y` (shares); shape (n, 2)."""
    from scipy.ndimage import label

    inside = (x >= 0.0) & (x <= 1.0) & (y >= 0.0) & (y <= 1.0)
    places = np.column_stack((x[inside], y[inside]))
    bins = np.minimum((places * RINGS).astype(int), np.array(RINGS) - 1)
    filled = np.zeros(RINGS, dtype=bool)
    filled[tuple(bins.T)] = True
    patches, _ = label(filled, np.ones((3, 3)))
    ringed = (np.bincount(patches.ravel()) <= _FEW)[patches[tuple(bins.T)]]
    homes, member = np.unique(bins[ringed], axis=0, return_inverse=True)
    sums = np.zeros((len(homes), 2))
    np.add.at(sums, member.ravel(), places[ringed])
    return sums / np.maximum(np.bincount(member.ravel(), minlength=len(homes)), 1)[:, np.newaxis]


def spread(places: np.ndarray, gap: float) -> np.ndarray:
    """Positions of labels next to `places`, in the same order: at least `gap` apart, within 0 to 1 if they
    fit.

    Labels that are too close are moved as a group to the nearest possible positions.
    """
    order = np.argsort(places, kind="stable")
    groups: list[tuple[float, int]] = []  # centre and number of labels of each
    for place in np.asarray(places, dtype=float)[order]:
        centre, size = float(place), 1
        while groups and centre - groups[-1][0] < 0.5 * gap * (size + groups[-1][1]):
            before, many = groups.pop()
            centre, size = (before * many + centre * size) / (many + size), many + size
        groups.append((centre, size))
    moved = np.concatenate([c + gap * (np.arange(n) - 0.5 * (n - 1)) for c, n in groups] or [np.empty(0)])
    moved = np.maximum.accumulate(np.maximum(moved, gap * np.arange(moved.size)))
    moved = np.minimum(moved[::-1], 1.0 - gap * np.arange(moved.size))[::-1]
    result = np.empty_like(moved)
    result[order] = moved
    return result
