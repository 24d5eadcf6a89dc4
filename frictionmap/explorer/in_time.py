"""Motions in time under records: what their page offers and asks for."""

import contextlib
import re
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import xarray as xr

from .. import checks
from ..datasets.motion_labels import CELL, si_name, stuck_times
from ..errors import InputError
from ..files.motions import rows_of_motion
from ..motions.channels import drive_of
from ..motions.configuration import Motions
from ..motions.formulas import PULSES
from ..motions.record import Record
from ..motions.scaling import friction_ratio, friction_ratios, motion_scales, scale_of
from ..units.axes import has_units
from ..units.table import UNITS, handy_unit
from ..version import __version__
from .queries import needed, number, read_keys, whole
from .scene_parts import Slider

if TYPE_CHECKING:
    from .jobs import Job

#: Keys of a query.
KEYS = ("record", "beta", "mu", "scale")

#: Keys of a pulse.
PULSE_KEYS = ("kind", "amplitude", "duration")

#: Parts of the time of a motion of which the extremes are drawn: about as many as pixels of a wide chart.
_PARTS = 700

#: Samples of a loop: every one is drawn, because a loop of extremes alone would have other corners.
_LOOP = 20_000

#: Masses, and contacts, that are drawn; more would cover each other.
_DRAWN = 6

#: Where sliders end at least: friction over the largest of the configuration, mu as on the page of maps.
_MOST_BETA, _MOST_MU = 2.0, 3.0


#: Records that a page keeps at most, and characters of the name of a file.
_MOST_RECORDS, _LONGEST_NAME = 200, 80


class Asked(NamedTuple):
    """A motion: the number of its record, counted from 1, friction, and the factor of the record."""

    record: int
    beta: float
    mu: float
    scale: float


def check(motions: Motions) -> None:
    """Refuse, before the page opens, what no motion could be computed of.

    Raises
    ------
    InputError
        A reference value of the units is missing, or friction is none.
    """
    if "axes" in motions.arguments:
        raise InputError("cannot open a page of motions with [axes]: it shows one system; remove [axes]")
    scales = motion_scales(motions.units, motions.system)
    for record in motions.records:
        scale_of(record, scales)
    first(motions)


def _values(motions: Motions, name: str) -> np.ndarray:
    """Values of an argument of the configuration: of friction as ratios."""
    given = motions.arguments.get(name, 1.0)
    if name == "beta":
        name = f"history.{motions.friction}" if motions.text else motions.friction
        return friction_ratios(given, name, motion_scales(motions.units, motions.system))
    least = 1.0 if name == "mu" else -np.inf
    found = checks.axis(given, name, least=least)
    return np.atleast_1d(found)


def first(motions: Motions) -> Asked:
    """The motion that the page opens with."""
    return Asked(1, *(float(_values(motions, name)[0]) for name in ("beta", "mu", "scale")))


def sliders(motions: Motions) -> tuple[Slider, ...]:
    """Numbers that can be changed; mu is of no use to springs alone, which would jump at break-away."""
    begin = first(motions)
    most = _MOST_BETA * float(_values(motions, "beta").max()) or _MOST_BETA
    found = [Slider("beta", "friction β", 0.0, most, begin.beta, "even", "", "force")]
    if not motions.system.contact_system.elastic.all():
        ends = 1.0, max(_MOST_MU, 2.0 * begin.mu)
        found.append(Slider("mu", "μ", *ends, begin.mu, "linear", "times the kinetic friction"))
    ends = min(0.0, 2.0 * begin.scale), max(2.0, 2.0 * begin.scale)
    found.append(Slider("scale", "factor of the record", *ends, begin.scale, "linear"))
    return tuple(found)


def _physical(motions: Motions) -> dict[str, dict[str, Any]]:
    """Unit and factor of friction: of a force, or of an acceleration over m_1 where no force is known."""
    scales = motion_scales(motions.units, motions.system)
    largest = float(_values(motions, "beta").max()) or 1.0
    if scales.force is not None:
        unit = handy_unit(scales.force * largest, "force")
        return {"force": {"unit": unit, "factor": float(scales.force) / float(UNITS[unit].size)}}
    if motions.units is None:
        return {}
    with contextlib.suppress(InputError):  # units that do not state P/m_1
        return {"force": {"unit": "m/s²", "factor": 1.0 / friction_ratio("1 m/s^2", "beta", scales)}}
    return {}


def describe(motions: Motions) -> dict[str, Any]:
    """Describe what the page offers."""
    begin = first(motions)
    names = [f"{k}: {one.name or one.quantity}" for k, one in enumerate(motions.records, 1)]
    return {
        "title": motions.title,
        "version": __version__,
        "system": motions.system.describe(),
        "records": [{"key": str(k), "label": name} for k, name in enumerate(names, 1)],
        "pulses": PULSES,
        "sliders": [slider._asdict() for slider in sliders(motions)],
        "physical": _physical(motions),
        "view": begin._asdict(),
    }


def read(motions: Motions, text: str) -> Asked:
    """The motion that a query asks for; missing keys have the values with which the page begins.

    Raises
    ------
    InputError
        A key is unknown or given twice, or a value is invalid.
    """
    given = read_keys(text, KEYS)
    begin = first(motions)
    record = checks.whole(whole(given, "record", begin.record), "record", least=1, most=len(motions.records))
    return Asked(
        record,
        _friction(motions, given["beta"]) if "beta" in given else begin.beta,
        checks.number(number(given["mu"], "mu"), "mu", least=1.0) if "mu" in given else begin.mu,
        number(given["scale"], "scale") if "scale" in given else begin.scale,
    )


def _friction(motions: Motions, text: str) -> float:
    """beta of a number, or of a force, or of an acceleration of friction over m_1."""
    if not has_units(text):
        return checks.number(number(text, "beta"), "beta", least=0.0)
    return friction_ratio(text, "beta", motion_scales(motions.units, motions.system))


def named_file(query: str) -> str:
    """Name of a file in a query, without what leads out of a folder.

    Raises
    ------
    InputError
        There is none.
    """
    name = re.sub(r"[^\w. -]", "_", needed(read_keys(query, ("name",)), "name"))[-_LONGEST_NAME:].strip(". ")
    if not name:
        raise InputError("name must be that of a file; got none")
    return name


def with_file(motions: Motions, name: str, body: bytes) -> Motions:
    """Add the record in a file, which is read from a temporary folder.

    Raises
    ------
    InputError
        It is no record, or does not go with the system; or there are too many.
    """
    with tempfile.TemporaryDirectory(prefix="frictionmap-") as folder:
        path = Path(folder) / name
        path.write_bytes(body)
        try:
            record = Record.read(path)
        except InputError as error:
            raise InputError(str(error).replace(str(path), name)) from None
    return _with_record(motions, record)


def with_pulse(motions: Motions, query: str) -> Motions:
    """Add a pulse of the quantity of the first record, by the keys of a query.

    Raises
    ------
    InputError
        A key is unknown or missing, or a value invalid; or there are too many records.
    """
    given = read_keys(query, PULSE_KEYS)
    kind, amplitude, duration = (needed(given, key).strip() for key in PULSE_KEYS)
    quantity = motions.records[0].quantity
    if quantity == "displacement":
        quantity = "acceleration"  # a pulse of displacement would jump
    _, _, unit = amplitude.partition(" ")
    if not unit and isinstance(_typed(amplitude), str):
        raise InputError("amplitude", f"must be a number, or one with its unit, as 0.4 g; got {amplitude!r}")
    record = Record.pulse(
        kind, _typed(amplitude), _typed(duration), quantity=quantity, unit=unit or None,
        name=f"{kind} {amplitude}, {duration}",
    )  # fmt: skip
    return _with_record(motions, record)


def _typed(text: str) -> float | str:
    """A number that was typed, as text if it has a unit."""
    try:
        return float(text)
    except ValueError:
        return text


def _with_record(motions: Motions, record: Record) -> Motions:
    """Add a record that goes with the system."""
    if len(motions.records) >= _MOST_RECORDS:
        raise InputError(f"cannot add a record: the page has {_MOST_RECORDS} already; start it again")
    drive_of(motions.system, record, scale_of(record, motion_scales(motions.units, motions.system)))
    return replace(motions, records=(*motions.records, record))


def _followed(motions: Motions, asked: Asked, **options: Any) -> xr.Dataset:
    record: Record = motions.records[asked.record - 1]
    changed: dict[str, Any] = {"beta": [asked.beta], "mu": [asked.mu], "scale": [asked.scale]}
    options |= {"samples": "all", "beta_hold": False, "statistics": None, **changed}
    return motions.follow([record], **options).squeeze(list(CELL))


def motion(motions: Motions, asked: Asked, job: "Job") -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """One motion for the page: its numbers in words; time, record, masses, contacts; stuck times."""
    ds = _followed(motions, asked, watch=job.watch)
    shown = {"x": ("displacement", "length", "m"), "z": ("slip", "length", "m"),
             "friction": ("contact force", "force", "N")}  # fmt: skip
    names, rows = {}, {"drive": ds["drive"].values[np.newaxis]}
    for name, (words, measure, unit) in shown.items():
        beside = si_name(name, measure)
        names[name] = f"{words} [{unit}]" if beside in ds else words
        values = ds[beside if beside in ds else name].values
        rows[name] = values.reshape(-1, values.shape[-1])
    masses, contacts = (spread(len(rows[name]), _DRAWN) for name in ("x", "z"))
    rows |= {"x": rows["x"][masses], "z": rows["z"][contacts], "friction": rows["friction"][contacts]}
    time = ds["time"].values
    over_time = [values for name, values in rows.items() if name != "z"]
    kept = extremes(np.concatenate(over_time), _PARTS)
    in_seconds = ds["time"].attrs.get("units") == "s"
    header = {
        **asked._asdict(),
        "rows": [*_friction_words(motions, asked.beta), *(list(row) for row in _numbers(ds))],
        "names": {**names, "time": "time [s]" if in_seconds else "time [1/ω₁]", "drive": "record"},
        "masses": [motions.system.dofs.name(int(ds["dof"].values[k])) for k in masses],
        "contacts": [f"contact {k + 1}" for k in contacts],
    }
    directions = ds["direction"].values.reshape(-1, time.size)
    arrays = {"time": time[kept], "stuck": stuck_times(time, directions)}
    loop = around_largest(rows["z"], _LOOP)
    header["names"]["slip"] = names["z"] + (", around the largest" if loop != slice(0, time.size) else "")
    arrays |= {"loop_z": rows.pop("z")[:, loop], "loop_force": rows["friction"][:, loop]}
    return header, arrays | {name: values[:, kept] for name, values in rows.items()}


def _friction_words(motions: Motions, beta: float) -> list[list[str]]:
    """The friction in its unit, if it has one."""
    one = _physical(motions).get("force")
    return [["friction", f"{beta * one['factor']:.4g} {one['unit']}"]] if one else []


def _numbers(ds: xr.Dataset) -> Iterator[tuple[str, str]]:
    """What is listed of a motion, and when the first contact slides, at the beginning or later."""
    yield from rows_of_motion(ds)
    time = ds["time"].values
    slides = ds["direction"].values.reshape(-1, time.size) != 0
    if "open" in ds:  # in an open contact nothing slides
        slides &= ds["open"].values.reshape(-1, time.size) == 0
    slides = time[slides.any(axis=0)]
    unit = " s" if ds["time"].attrs.get("units") == "s" else ""
    yield "slides first at", f"{slides[0]:.4g}{unit}" if slides.size else "never"


def spread(count: int, most: int) -> np.ndarray:
    """Some of several, at even steps, with the first and the last."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int))


def around_largest(rows: np.ndarray, most: int) -> slice:
    """At most `most` successive samples of rows (row, time), with the largest of all in their middle."""
    size = rows.shape[1]
    at = int(np.abs(rows).max(axis=0).argmax())
    begin = min(max(0, at - most // 2), max(0, size - most))
    return slice(begin, min(size, begin + most))


def extremes(rows: np.ndarray, parts: int) -> np.ndarray:
    """Places of the least and the largest value of every row (row, time) in every part, and of the ends."""
    size = rows.shape[1]
    step = -(-size // parts)
    if step < 3:  # no part has more than the two that are kept
        return np.arange(size)
    padded = np.pad(rows, ((0, 0), (0, -size % step)), mode="edge").reshape(len(rows), -1, step)
    begin = step * np.arange(padded.shape[1])
    places = [pick(padded, axis=2) + begin for pick in (np.argmin, np.argmax)]
    return np.unique(np.minimum(np.concatenate([*map(np.ravel, places), [0, size - 1]]), size - 1))
