"""What a picture of a fit consists of."""

from typing import NamedTuple

from .curve_axes import Panel


class FitPicture(NamedTuple):
    """Panels over one axis, from top to bottom, and one beside them."""

    panels: list[tuple[float, Panel]]  # with their heights [inch]
    beside: Panel | None
    remarks: list[str]
