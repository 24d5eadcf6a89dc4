"""Options of pictures: size, legend, caption, title, limits, choice of panels and lines, marks.

Every function that draws takes them as keyword arguments (`FigureOptions`).  They are checked once, by
`drawing.with_options`, and are valid while that function runs.
"""

import contextlib
import math
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any, TypedDict, TypeVar

from .. import checks
from ..errors import InputError

T = TypeVar("T")

#: Units of lengths on paper [inch], and valid widths and heights [inch].
_INCH = {"mm": 1.0 / 25.4, "cm": 1.0 / 2.54, "in": 1.0}
_SMALLEST, _LARGEST = 1.0, 80.0

_LENGTH = r"(\d+(?:\.\d+)?)\s*(mm|cm|in)"
_DPI = (20.0, 2400.0)

#: Width [inch] that a panel needs beside another one.
_PANEL = 2.8


#: Least width [inch] of a figure with a size that has a caption unless asked otherwise.
_CAPTIONED = 4.5


class FigureOptions(TypedDict, total=False):
    """Keyword arguments of all functions that draw."""

    size: str | tuple[float, float]
    dpi: float
    legend: bool
    caption: bool
    title: str
    xlim: tuple[float, float]
    ylim: tuple[float, float]
    panels: int | Sequence[int]
    mass: int | Sequence[int]
    beta: float | Sequence[float]
    point: tuple[float | str, float | str]
    box: tuple[float | str, float | str]


@dataclass(frozen=True)
class Options:
    """Checked options; None where an option is not given."""

    size: tuple[float, float | None] | None = None  # width and height [inch]
    dpi: float | None = None
    legend: bool = True
    caption: bool | None = None
    title: str | None = None
    xlim: tuple[float, float] | None = None
    ylim: tuple[float, float] | None = None
    panels: tuple[int, ...] = ()
    mass: tuple[int, ...] = ()
    beta: tuple[float, ...] = ()
    point: tuple[float | str, float | str] | None = None  # r and beta, or frequency and force with units
    box: tuple[float | str, float | str] | None = None

    @property
    def has_caption(self) -> bool:
        """Whether there is a caption: as asked for, else unless a narrow figure needs the room for data."""
        if self.caption is None:
            return self.size is None or self.size[0] >= _CAPTIONED
        return self.caption

    def columns(self, wanted: int) -> int:
        """Number of panels side by side: as many as wanted, or as the width has room for."""
        return wanted if self.size is None else max(1, min(wanted, int(self.size[0] / _PANEL)))

    def chosen(self, panels: Iterable[T]) -> list[T]:
        """The panels to draw, in the order asked for."""
        there = list(panels)
        for number in self.panels:
            if not 1 <= number <= len(there):
                raise InputError(f"panels must be 1 to {len(there)}; got {number}")
        return [there[number - 1] for number in self.panels] or there


_CURRENT: ContextVar[Options] = ContextVar("options of the picture", default=Options())  # noqa: B039


def current() -> Options:
    """Options of the picture that is being drawn."""
    return _CURRENT.get()


@contextlib.contextmanager
def used(options: Options) -> Iterator[None]:
    """Make options the `current` ones for a while."""
    token = _CURRENT.set(options)
    try:
        yield
    finally:
        _CURRENT.reset(token)


def checked_options(given: dict[str, Any]) -> Options:
    """Check keyword arguments of functions that draw.

    Raises
    ------
    InputError
        There is no such option, or its value is invalid.
    """
    found: dict[str, Any] = {}
    for name, value in given.items():
        if name not in _CHECKS:
            valid = ", ".join(_CHECKS)
            raise InputError(f"unknown option {name!r}{checks.nearest(name, _CHECKS)}; valid: {valid}")
        if value is not None:
            found[name] = _CHECKS[name](name, value)
    if "box" in found and "point" not in found:
        raise InputError("cannot use box without point: it is the uncertainty of a point; give point")
    return Options(**found)


def _size(name: str, value: object) -> tuple[float, float | None]:
    """Width, and height if given [inch]."""
    lengths: list[float] = []
    if isinstance(value, str):
        found = re.fullmatch(rf"{_LENGTH}(?:\s*x\s*{_LENGTH})?", value.strip())
        if found:
            parts = [found.group(1, 2), found.group(3, 4)][: 1 + bool(found[3])]
            lengths = [float(number) * _INCH[unit] for number, unit in parts]
    else:
        lengths = list(_two(name, value))
    if not lengths or not all(_SMALLEST <= length <= _LARGEST for length in lengths):
        raise InputError(
            "size must be a width such as 85mm or 3.3in, or a width and a height such as 85mm x 60mm, "
            f"from {_SMALLEST:g} to {_LARGEST:g} inches; got {checks.one_line(value)}"
        )
    return lengths[0], lengths[1] if len(lengths) > 1 else None


def _dpi(name: str, value: object) -> float:
    return checks.number(value, name, least=_DPI[0], most=_DPI[1])


def _bool(name: str, value: object) -> bool:
    if not isinstance(value, bool):
        raise InputError(f"{name} must be True or False; got {checks.one_line(value)}")
    return value


def _text(name: str, value: object) -> str:
    if not isinstance(value, str):
        raise InputError(f"{name} must be text; got {checks.one_line(value)}")
    return value


def _two(name: str, value: object) -> tuple[float, float]:
    """Two finite numbers."""
    try:
        first, second = (float(one) for one in value)  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        raise InputError(f"{name} must be two numbers; got {checks.one_line(value)}") from None
    if not math.isfinite(first) or not math.isfinite(second):
        raise InputError(f"{name} must be two finite numbers; got {first:g}, {second:g}")
    return first, second


def _limits(name: str, value: object) -> tuple[float, float]:
    low, high = _two(name, value)
    if low >= high:
        raise InputError(f"{name} must be increasing; got {low:g}, {high:g}")
    return low, high


def _with_units(name: str, value: object) -> tuple[float | str, float | str]:
    """Two finite numbers, or texts with units, which are converted where the dataset is known."""
    if isinstance(value, (list, tuple)) and len(value) == 2 and any(isinstance(one, str) for one in value):
        first, second = (one if isinstance(one, str) else checks.number(one, name) for one in value)
        return first, second
    return _two(name, value)


def _half_widths(name: str, value: object) -> tuple[float | str, float | str]:
    widths = _with_units(name, value)
    if any(not isinstance(one, str) and one < 0.0 for one in widths):
        raise InputError(f"{name} must be half-widths >= 0; got {widths[0]}, {widths[1]}")
    return widths


def _several(name: str, value: object) -> tuple[object, ...]:
    """The values of an option that takes one or several."""
    values = tuple(value) if isinstance(value, Iterable) and not isinstance(value, str) else (value,)
    if not values:
        raise InputError(f"{name} must have at least one value; got none")
    return values


def _numbers(name: str, value: object) -> tuple[float, ...]:
    return tuple(checks.number(one, name, least=0.0) for one in _several(name, value))


def _counted(name: str, value: object) -> tuple[int, ...]:
    return tuple(checks.whole(one, name, least=1) for one in _several(name, value))


_CHECKS: dict[str, Callable[[str, Any], Any]] = {
    "size": _size,
    "dpi": _dpi,
    "legend": _bool,
    "caption": _bool,
    "title": _text,
    "xlim": _limits,
    "ylim": _limits,
    "panels": _counted,
    "mass": _counted,
    "beta": _numbers,
    "point": _with_units,
    "box": _half_widths,
}
