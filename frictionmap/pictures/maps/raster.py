"""Cells to pixels: each pixel shows its most frequent class, and no thin feature is lost.

A pixel of a large map contains many cells, a cell of a small map many pixels.  Cells are collected in slots;
one slot is what one pixel shows.  A class that wins no slot nearby, such as a strip one cell wide, is
assigned the slot it lies in, the rarest class last.
"""

from typing import NamedTuple

import numpy as np

from ..classes import blocks


class Cover(NamedTuple):
    """Assignment of the cells of an axis to slots, and of slots to pixels."""

    slot: np.ndarray  # slot of each visible cell, consecutive from 0, increasing
    visible: slice  # cells that are at least partly in the picture
    pixel: np.ndarray  # the slot of each pixel; -1 outside the map
    slots: int


def cover(edges: np.ndarray, pixels: int) -> Cover:
    """Assign cells between `edges`, in pixels from the picture's start, increasing, to slots."""
    inside = np.clip(edges, 0.0, float(pixels))
    seen = np.flatnonzero(np.diff(inside) > 0.0)
    if not seen.size:
        return Cover(np.empty(0, dtype=np.intp), slice(0, 0), np.full(pixels, -1), 0)
    visible = slice(int(seen[0]), int(seen[-1]) + 1)
    middle = 0.5 * (inside[:-1] + inside[1:])[visible]
    home, slot = np.unique(np.minimum(middle.astype(np.intp), pixels - 1), return_inverse=True)
    # a pixel that contains no cell centre lies within a wide cell and shows that cell's slot
    centres = np.arange(pixels) + 0.5
    cell = np.searchsorted(edges, centres, side="right") - 1
    outside = (cell < visible.start) | (cell >= visible.stop)
    pixel = slot[np.clip(cell - visible.start, 0, slot.size - 1)]
    pixel[outside] = -1
    pixel[home] = np.arange(home.size)
    return Cover(slot, visible, pixel, home.size)


def _near(won: np.ndarray) -> np.ndarray:
    """Slots that are true, or adjacent to a true one."""
    wide = won.copy()
    wide[1:] |= won[:-1]
    wide[:-1] |= won[1:]
    tall = wide.copy()
    tall[:, 1:] |= wide[:, :-1]
    tall[:, :-1] |= wide[:, 1:]
    return tall


def _votes(found: np.ndarray, x: Cover, y: Cover, most: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (winner, present, totals): most frequent class of each slot, classes in it, cells over all
    slots.
    """
    winner = np.empty((x.slots, y.slots), dtype=np.uint8)
    present = np.zeros((most, x.slots, y.slots), dtype=bool)
    totals = np.zeros(most, dtype=np.int64)
    cells_of_slots = -(-found.shape[0] // x.slots) * found.shape[1]
    for rows in blocks((x.slots, max(cells_of_slots, most * y.slots))):
        first, last = np.searchsorted(x.slot, [rows.start, min(rows.stop, x.slots)])
        part = found[first:last]
        size = min(rows.stop, x.slots) - rows.start
        where = (x.slot[first:last, np.newaxis] - rows.start) * y.slots + y.slot
        counts = np.bincount((where * most + part).ravel(), minlength=size * y.slots * most)
        counts = counts.reshape(size, y.slots, most)
        winner[rows] = counts.argmax(axis=2)
        present[:, rows] = np.moveaxis(counts > 0, 2, 0)
        totals += counts.sum(axis=(0, 1))
    return winner, present, totals


def _gather(found: np.ndarray, x: Cover, y: Cover, most: int) -> np.ndarray:
    """Class that each slot shows."""
    winner, present, totals = _votes(found, x, y, most)
    shown = winner.copy()
    for index in np.argsort(-totals, kind="stable"):
        if totals[index]:
            lost = present[index] & ~_near(winner == index)
            shown[lost] = index
    return shown


def rasterise(
    found: np.ndarray, x_edges: np.ndarray, y_edges: np.ndarray, pixels: tuple[int, int], most: int
) -> np.ndarray:
    """Class that each pixel shows, shape (width, height); `most` where there is no cell.

    Parameters
    ----------
    found : array of uint8, shape (n_x, n_y)
        Classes of the cells, below `most`.
    x_edges, y_edges : array, shape (n_x + 1,), (n_y + 1,)
        Edges of the cells in pixels, increasing, 0 at the lower left corner of the picture.
    pixels : (width, height)
    """
    x, y = cover(x_edges, pixels[0]), cover(y_edges, pixels[1])
    if x.slots == 0 or y.slots == 0:
        return np.full(pixels, most, dtype=np.uint8)
    seen = found[x.visible, y.visible]
    shown = seen if seen.shape == (x.slots, y.slots) else _gather(seen, x, y, most)
    raster = shown[np.ix_(x.pixel, y.pixel)]
    raster[x.pixel < 0] = most
    raster[:, y.pixel < 0] = most
    return raster


def stripes(pixels: tuple[int, int], spacing: float, width: float) -> np.ndarray:
    """Darkness of each pixel under diagonal stripes, 0 to 1, shape (width, height); lengths in pixels."""
    across = (np.arange(pixels[1]) - np.arange(pixels[0])[:, np.newaxis]) / np.sqrt(2.0)
    off_line = np.abs(np.mod(across, spacing) - 0.5 * spacing)
    return np.clip(0.5 * width + 0.5 - off_line, 0.0, 1.0)


def level_stripes(pixels: tuple[int, int], spacing: float, width: float) -> np.ndarray:
    """Darkness of each pixel under level stripes, 0 to 1, shape (width, height); lengths in pixels."""
    off_line = np.abs(np.mod(np.arange(pixels[1]), spacing) - 0.5 * spacing)
    return np.broadcast_to(np.clip(0.5 * width + 0.5 - off_line, 0.0, 1.0), pixels)


def paint(raster: np.ndarray, table: np.ndarray) -> np.ndarray:
    """Convert a raster to an image of colours, first row at the bottom; `table` is `colour_table()`."""
    return np.ascontiguousarray(table[raster.T])


def shade(image: np.ndarray, darkness: np.ndarray, colour: tuple[int, int, int]) -> None:
    """Mix a colour into an image with the shares of `stripes`."""
    share = darkness.T[:, :, np.newaxis]
    image[..., :3] = np.rint((1.0 - share) * image[..., :3] + share * np.array(colour)).astype(np.uint8)
