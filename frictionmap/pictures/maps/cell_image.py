"""Images of cells: in pixels for the resolution of each drawing, or as rectangles in vector files."""

from collections.abc import Iterator

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backend_bases import GraphicsContextBase, RendererBase
from matplotlib.backends.backend_mixed import MixedModeRenderer
from matplotlib.path import Path
from matplotlib.transforms import IdentityTransform

from ..grids import Grid

#: Largest number of cells that vector files contain as rectangles; more are pixels.
MOST_RECTANGLES = 10_000

#: Width of the rim of rectangles, which closes the gaps that viewers draw between them [points].
_RIM = 0.3


class CellImage(Artist):
    """Cells of a map, drawn again for the pixels of each drawing so that no feature is lost at any size.

    Classes derived from it define the colours.
    """

    def __init__(self, r: Grid, beta: Grid) -> None:
        super().__init__()
        self.r, self.beta = r, beta
        self.set_zorder(0.5)

    def image(self, edges: tuple[np.ndarray, np.ndarray], size: tuple[int, int], inch: float) -> np.ndarray:
        """Return the pixels, red, green, blue and opacity, shape (height, width, 4), first row at the bottom.

        edges : edges of the cells in r and in beta [pixel]
        size : width and height [pixel]
        inch : pixels per inch
        """
        raise NotImplementedError

    def colours(self) -> np.ndarray | None:
        """Return the colour of every cell, uint8, shape (r, beta, 4); None if it needs pixels."""
        raise NotImplementedError

    def draw(self, renderer: RendererBase) -> None:
        """Draw the cells in view."""
        assert self.axes is not None
        gc = renderer.new_gc()
        gc.set_clip_rectangle(self.axes.bbox)
        cells = self.r.values.size * self.beta.values.size
        vector = isinstance(renderer, MixedModeRenderer) and cells <= MOST_RECTANGLES
        colours = self.colours() if vector else None
        if colours is None:
            self._draw_pixels(renderer, gc)
        else:
            self._draw_rectangles(renderer, gc, colours)
        gc.restore()

    def _draw_pixels(self, renderer: RendererBase, gc: GraphicsContextBase) -> None:
        assert self.axes is not None
        scale = renderer.get_image_magnification()
        left, bottom, right, top = self.axes.bbox.extents
        left, bottom = round(left * scale) / scale, round(bottom * scale) / scale
        size = max(1, round((right - left) * scale)), max(1, round((top - bottom) * scale))
        x, y = self._edges()
        edges = (x - left) * scale, (y - bottom) * scale
        renderer.draw_image(gc, left, bottom, self.image(edges, size, scale * self.axes.figure.dpi))

    def _edges(self) -> tuple[np.ndarray, np.ndarray]:
        """Edges of the cells on the canvas."""
        assert self.axes is not None
        x, y = self.r.edges, self.beta.edges
        inside = self.axes.viewLim.x0, self.axes.viewLim.y0
        transform = self.axes.transData.transform
        across = transform(np.column_stack((x, np.full(x.size, inside[1]))))[:, 0]
        up = transform(np.column_stack((np.full(y.size, inside[0]), y)))[:, 1]
        return across, up

    def _draw_rectangles(self, renderer: RendererBase, gc: GraphicsContextBase, colours: np.ndarray) -> None:
        assert self.axes is not None
        box = self.axes.bbox
        x, y = self._edges()
        x, y = np.clip(x, box.x0 - 1.0, box.x1 + 1.0), np.clip(y, box.y0 - 1.0, box.y1 + 1.0)
        codes = np.ascontiguousarray(colours).view(np.uint32)[..., 0]
        gc.set_linewidth(_RIM)
        for code in np.unique(codes):
            *colour, opacity = np.array([code], dtype=np.uint32).view(np.uint8) / 255.0
            boxes = list(_columns(codes == code, x, y))
            if opacity and boxes:
                gc.set_foreground(tuple(colour))
                path = Path.make_compound_path(*boxes)
                renderer.draw_path(gc, path, IdentityTransform(), tuple(colour))


def _columns(where: np.ndarray, x: np.ndarray, y: np.ndarray) -> Iterator[Path]:
    """Rectangles around runs of cells along the second axis."""
    padded = np.pad(where.astype(np.int8), ((0, 0), (1, 1)))
    steps = np.diff(padded, axis=1)
    rows, begin = np.nonzero(steps == 1)
    _, end = np.nonzero(steps == -1)
    for i, low, high in zip(rows, begin, end, strict=True):
        corners = [(x[i], y[low]), (x[i + 1], y[low]), (x[i + 1], y[high]), (x[i], y[high]), (x[i], y[low])]
        yield Path(corners, closed=True)
