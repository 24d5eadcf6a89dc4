"""The picture of a beam or a plate with its points, contacts, loads and supports."""

import io
from importlib.util import find_spec

from ..model.system import System
from ..structures.modes import Modes


def has_picture(system: System) -> bool:
    """Whether the page shows a picture of a structure: of a beam or a plate, with matplotlib installed."""
    given = system.matrices
    is_drawn = isinstance(given, Modes) and given.geometry is not None
    return is_drawn and find_spec("matplotlib") is not None


def structure_svg(system: System) -> bytes:
    """The picture of `plot_structure` as SVG."""
    from ..plot import plot_structure  # matplotlib takes long to import

    figure = plot_structure(system)[0].figure
    file = io.BytesIO()
    figure.savefig(file, format="svg")
    return file.getvalue()
