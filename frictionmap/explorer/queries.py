"""Queries of the page, checked like a configuration: every key valid, given once and of the right type."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple, get_args
from urllib.parse import parse_qsl

from .. import checks
from ..errors import InputError
from ..model.settings import Start
from ..units.axes import KINDS, has_units, require
from ..units.quantities import quantity
from ..units.scales import Scales, Units, rounded, scales_of
from .contacts import shown_contact
from .quantities import CellQuantity, quantities_of
from .scene import Scene, checked_range
from .scene_parts import BELT_SPEED, FREQUENCY, Slider
from .views import MOST_PIXELS, Piece, View

#: Keys of a query: 64 contacts have some numbers each.
_MOST_KEYS = 500

#: Points of a cut.
_MOST_POINTS = 8192

_VIEW = ("beta", "mu", "start", "contact")


class Query(NamedTuple):
    """A checked query: the view, what else was given, and the units of the scene."""

    view: View
    given: Mapping[str, str]
    units: Units | None = None
    numbers: Mapping[str, float] = {}  # of the sliders

    def ratio(self, text: str, name: str, kind: str) -> float:
        """Convert a number of a query, which may have a unit of its kind: a ratio."""
        return _ratio(text, name, kind, lambda: scales_of(self.units, self.view.system))

    def ratios(self, parts: Sequence[str], name: str, kind: str) -> list[float]:
        """Convert several numbers of one kind, of which all have a unit or none: ratios."""
        return _ratios(parts, name, kind, lambda: scales_of(self.units, self.view.system))

    def cell(self, r: str, beta: str) -> tuple[float, float]:
        """Convert frequency and friction of a cell to ratios; one message names all that lack a reference."""
        across = self.view.across
        given = {across.key: (across.measure, r), "beta": (KINDS["beta"], beta)}
        if has_units([r, beta]):
            require(scales_of(self.units, self.view.system), **given)
        at_r, at_beta = (self.ratio(text, name, kind) for name, (kind, text) in given.items())
        return at_r, at_beta


def read_query(scene: Scene, text: str, further: Sequence[str] = ()) -> Query:
    """Return the requested view; missing keys have the values with which the page begins.

    Parameters
    ----------
    text : the query of an address, such as "r=0.5,1.5&mu=1.2&damping_ratios=0.01"
    further : valid keys other than those of a view

    Numbers may have units, such as "beta=0 N,50 N", where the scene has their reference values.

    Raises
    ------
    InputError
        A key is unknown or given twice, or a value is invalid.
    """
    numbers = {slider.key: slider for slider in scene.sliders if slider.key != "mu"}
    across = BELT_SPEED if scene.unloaded else FREQUENCY
    given = read_keys(text, (across.key, *_VIEW, *numbers, *further))
    start = given.get("start", scene.solver.start)
    checks.choice(start, "start", get_args(Start))
    contact = given.get("contact", "")

    def scales() -> Scales:
        return scales_of(scene.units, scene.changed(contact, ()))

    changes = tuple(
        (key, _slider_ratio(given[key], slider, scales)) for key, slider in numbers.items() if key in given
    )
    view = View(
        system=scene.changed(contact, changes),
        r=_range(given, across.key, scene.r, across.measure, scales),
        beta=_range(given, "beta", scene.beta, KINDS["beta"], scales),
        mu=checks.number(number(given["mu"], "mu"), "mu", least=1.0) if "mu" in given else scene.mu,
        solver=replace(scene.solver, start=start),  # type: ignore[arg-type]
        contact=shown_contact(contact),
        unloaded=scene.unloaded,
    )
    return Query(view, given, scene.units, dict(changes))


def read_keys(text: str, valid: Sequence[str]) -> dict[str, str]:
    """Keys and values of a query, as texts: every key valid and given once."""
    try:
        pairs = parse_qsl(text, keep_blank_values=True, strict_parsing=bool(text), max_num_fields=_MOST_KEYS,
                          errors="strict")  # fmt: skip
    except ValueError as error:
        raise InputError(f"the query must be KEY=VALUE&...; got {checks.one_line(text)} ({error})") from None
    given: dict[str, str] = {}
    for key, value in pairs:
        if key not in valid:
            hint = checks.nearest(key, valid)
            raise InputError(f"unknown key {key!r}{hint}; valid: {', '.join(valid)}")
        if key in given:
            raise InputError(f"{key} must be given once; got {given[key]!r} and {value!r}")
        given[key] = value
    return given


def number(text: str, name: str) -> float:
    """Convert a number of a query."""
    try:
        if "_" in text:
            raise ValueError
        value = float(text)
    except ValueError:
        raise InputError(f"{name} must be a number; got {checks.one_line(text)}") from None
    return checks.number(value, name)


def _ratio(text: str, name: str, kind: str, scales: Callable[[], Scales]) -> float:
    """Convert a number, which may have a unit of its kind: a ratio.

    scales : gives the reference values; it is asked only about a number with a unit
    """
    if not has_units(text):
        return number(text, name)
    value = quantity(text, name, kind).value / scales().needed(kind, name, text)
    return checks.number(rounded(value), name)


def _ratios(parts: Sequence[str], name: str, kind: str, scales: Callable[[], Scales]) -> list[float]:
    """Convert several numbers of one kind: all of them have a unit, or none."""
    if has_units(list(parts)):
        for part in parts:
            quantity(part, name, kind)
    return [_ratio(part, name, kind, scales) for part in parts]


def _slider_ratio(text: str, slider: Slider, scales: Callable[[], Scales]) -> float:
    """Convert the number of a slider, which may have a unit if it has a dimension."""
    if slider.measure or not has_units(text):
        return _ratio(text, slider.key, slider.measure, scales)
    relative = f", {slider.unit}" if slider.unit else ""
    speed = slider.key.endswith("wall_velocity")  # it grows with the frequency
    hint = "; for a speed that is the same at all frequencies set wall_speed in the configuration" * speed
    raise InputError(
        f"{slider.key} must be a number without a unit{relative}; got {checks.one_line(text)}{hint}"
    )


def whole(given: Mapping[str, str], name: str, default: int | None = None) -> int:
    """Return a whole number of a query."""
    if name not in given and default is not None:
        return default
    text = needed(given, name)
    value = number(text, name)
    if value != int(value):
        raise InputError(f"{name} must be a whole number; got {text}")
    return int(value)


def needed(given: Mapping[str, str], name: str) -> str:
    """Return the value of a required key."""
    if name not in given:
        raise InputError(f"{name} must be given; got nothing")
    return given[name]


def _range(
    given: Mapping[str, str], name: str, default: tuple[float, float], kind: str,
    scales: Callable[[], Scales],
) -> tuple[float, float]:  # fmt: skip
    if name not in given:
        return default
    parts = given[name].split(",")
    if len(parts) != 2:
        raise InputError(
            f"{name} must be two numbers separated by a comma; got {checks.one_line(given[name])}"
        )
    return checked_range(_ratios(parts, name, kind, scales), name)


#: Keys of a page, of boundaries, and of a piece of a map.
PAGE = ("page", "turn")
LINES = ("count", "known", *PAGE)
PIECE = ("columns", "rows", "first", "last", "lines", "quantity", *PAGE)


def piece_of(query: Query) -> tuple[CellQuantity, Piece]:
    """Requested piece of a map, and the quantity that colours it."""
    given = query.given
    columns, rows = whole(given, "columns"), whole(given, "rows")
    piece = Piece(columns, rows, whole(given, "first", 0), whole(given, "last", columns))
    piece.check()
    known = quantities_of(query.view)
    key = checks.choice(given.get("quantity", known[0].key), "quantity", tuple(one.key for one in known))
    return next(one for one in known if one.key == key), piece


def lines_of(query: Query) -> int:
    """Number of requested points of the boundaries; 0: none."""
    return checks.whole(whole(query.given, "lines", 0), "lines", least=0, most=MOST_PIXELS)


def points_of(query: Query) -> int:
    """Number of points of a cut or of boundaries."""
    return checks.whole(whole(query.given, "count"), "count", least=2, most=_MOST_POINTS)


def page_of(query: Query) -> tuple[str, int]:
    """Page that asks, and the number of its request; a later request cancels this one."""
    page = query.given.get("page", "")
    if len(page) > 64 or not page.isascii():
        raise InputError("page", f"must be at most 64 ASCII characters; got {checks.one_line(page)}")
    return page, checks.whole(whole(query.given, "turn", 0), "turn", least=0)
