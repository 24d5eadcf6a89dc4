"""What all functions that draw have in common: their options, checked, described and applied."""

import functools
import inspect
from collections.abc import Callable
from typing import ParamSpec, TypeVar

from ..errors import InputError
from .options import checked_options, used
from .sizes import finish, sizes

P = ParamSpec("P")
R = TypeVar("R")

_DESCRIPTION = """
Other Parameters
----------------
size : str, or (width, height) in inches
    Size on paper: a width such as "85mm" or "3.3in", or "85mm x 60mm".  Text has at least 7 pt.
dpi : number
    Pixels per inch, 20 to 2400.
legend, caption : bool
    Whether there is a legend, and a caption above it; figures narrower than 4.5 inches have a caption only if
    asked for.
title : str
    Title in place of the one in the dataset; "" for none.
xlim, ylim : (low, high)
    Limits of the axes of the first panel, and of panels with the same axis, in the numbers on the axis.
panels : int, or sequence of int
    Panels to draw, counted from 1 in reading order.
mass : int, or sequence of int
    Masses to draw, for curves, motions, and quantities of masses.
beta : float, or sequence of float
    Friction ratios whose response curves are drawn, by value; the nearest ones of the dataset.
point, box : (r, beta), (dr, dbeta)
    Working point on a map or on boundaries, and the half-widths of its uncertainty, >= 0.
"""


def with_options(draw: Callable[P, R]) -> Callable[P, R]:
    """Make a function that draws take the options: checked, described in its docstring, and `current`."""
    own = [
        name for name, one in inspect.signature(draw).parameters.items() if one.kind is not one.VAR_KEYWORD
    ]

    @functools.wraps(draw)
    def drawn(*args: P.args, **kwargs: P.kwargs) -> R:
        options = checked_options({name: value for name, value in kwargs.items() if name not in own})
        if options.size is not None and kwargs.get("ax") is not None:
            raise InputError("cannot use size with ax: the axes have a figure already; set its size")
        with used(options), sizes(options):
            axes = draw(*args, **{name: kwargs[name] for name in own if name in kwargs})  # type: ignore[arg-type]
            finish(axes, options)
        return axes

    drawn.__doc__ = _with_description(str(draw.__doc__))
    return drawn


def _with_description(docstring: str) -> str:
    """Insert the description of the options before the results."""
    before, results, after = docstring.partition("    Returns\n")
    described = "".join(f"    {line}\n" if line else "\n" for line in _DESCRIPTION.strip().splitlines())
    return f"{before}{described}\n{results}{after}"
