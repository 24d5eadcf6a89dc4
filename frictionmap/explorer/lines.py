"""Boundaries of a view: their values over r, and how the page draws and explains them."""

import numpy as np

from ..theory.boundary_curves import find_curves
from .scene_parts import Line
from .views import View

_ONE_CONTACT = (
    Line(("beta_lim",), "lim", (), "below: continuous sliding is possible"),
    Line(("beta_stick",), "stick", (7, 4), "at or above: the contact can stay stuck"),
)


def lines_of(view: View) -> tuple[Line, ...]:
    """The boundaries that a view has."""
    if view.system.general is None:
        return _ONE_CONTACT
    from .general_lines import general_lines  # these modules are needed for few systems

    return general_lines(view)


def line_names(view: View) -> tuple[str, ...]:
    """Names of all curves of a view."""
    return tuple(name for line in lines_of(view) for name in line.names)


def line_values(view: View, r: np.ndarray) -> dict[str, np.ndarray]:
    """The curves of a view over r."""
    if view.system.general is None:
        curves = find_curves(view.system, r, np.array([view.mu]))
        return {"beta_lim": curves.beta_lim[0], "beta_stick": curves.beta_stick[0]}
    from .general_lines import general_line_values, limits_of

    return general_line_values(view, limits_of(view, r))
