"""What a picture shows, and whether its parts lie where they can be read."""

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg


def drawn(figure):
    """The figure, laid out; a warning of the layout is an error."""
    figure.draw_without_rendering()
    return figure


def legends(figure):
    return figure.legends + [ax.get_legend() for ax in figure.axes if ax.get_legend()]


def rendered(axes):
    """The picture, drawn; a warning is an error."""
    canvas = FigureCanvasAgg(axes[0].figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())


def words_of(axes):
    """The words of the legend."""
    return [text.get_text() for text in axes[0].figure.legends[0].get_texts()]


def assert_inside_and_apart(figure):
    """Legend and titles lie within the picture and off the axes."""
    renderer = FigureCanvasAgg(figure).get_renderer()
    drawn(figure)
    texts = [figure._suptitle, *legends(figure)]
    boxes = [item.get_window_extent(renderer) for item in texts]
    for box in boxes:
        assert box.x0 >= 0
        assert box.y0 >= 0
        assert box.x1 <= figure.bbox.x1
        assert box.y1 <= figure.bbox.y1
        for ax in figure.axes:
            assert not box.overlaps(ax.get_window_extent(renderer))
    tight = [ax.get_tightbbox(renderer) for ax in figure.axes]
    assert not any(a.overlaps(b) for i, a in enumerate(tight) for b in tight[:i])
