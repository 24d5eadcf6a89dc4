"""Keys of the configuration of a rig, by the kind of data: meanings and valid values.

`Kind` has the keys of a kind of data; here are those of all kinds.
"""

from typing import Any

from ...files.json_schema import DIALECT, described, keyed_table
from ...files.key import Key, either, number, several, table, with_unit, word
from ...files.keys import KEYS
from ...units.table import COLUMN_NAMES, UNITS, units_of
from ..parameters import Parameter
from ..tables.columns import MISSING
from ..tables.text_files import DECIMALS
from .configuration import JOINT_NAME, KINDS
from .joint import DATA_KEYS, JOINED, JOINT
from .rig import WINDOW

#: Descriptions of the tables.
TABLES = {
    "data": "The measurement.",
    "system": "The structure, as in maps.",
    "known": "Known parameters, which are not fitted, and scales of the results, in Hz, mm, s, N/m.",
    "fit": "Options of the fit.",
}

_TITLE = KEYS[""][0]._replace(meaning="title of plots; default: name of the data file")

#: A column by name, with its unit and its calibration: scale * (number in the file) + offset, in the unit.
_COLUMN = table(
    {
        "name": {"type": "string", "minLength": 1},
        "unit": word(*COLUMN_NAMES.values()),
        "scale": number(),
        "offset": number(),
    }
)

_DATA = (
    Key("kind", "kind of measurement", word(*KINDS)),
    Key("file", "data file, relative to this file", {"type": "string", "minLength": 1}, example='"data.csv"'),
    Key(
        "columns",
        "names of columns; default: names like those in the example, which end in units",
        {"type": "object", "additionalProperties": either({"type": "string"}, _COLUMN)},
        example='{ time = "time_s", x = "x_mm" }',
        words='a table of column names, or of { name = "Weg", unit = "mm", scale = 4.0, offset = 2.5 }',
    ),
    Key("decimal", "decimal sign of a text file; default: as its numbers show it", word(*DECIMALS),
        example='","'),
    Key("missing", "rows without a number: refuse, or ignore up to 1 % of the rows", word(*MISSING),
        MISSING[0]),
)  # fmt: skip

#: Key of each of several measurements.
_LABEL = Key("label", "name in the results; default: its number", {"type": "string", "minLength": 1},
             example='"10 N"')  # fmt: skip

_FREE = Key(
    "free", "parameters to fit; must be all that are not in [known], which is the default; "
    "X0, t0, centre and offset of a decay need not be named; "
    "contact_stiffness, delay and gain may be named, or are fitted where one of them explains the data",
    several({"type": "string"}), example='["f_n", "zeta", "x_F", "X0", "t0", "centre"]',
    words="a list of parameters",
)  # fmt: skip


def _known(name: str, parameter: Parameter) -> Key:
    """A key of [known]: in its unit, or with any other of that kind as text."""
    meaning, example, unit, _ = parameter
    if not unit:
        return Key(name, meaning, number(), example=example)
    kind = UNITS[unit].measures
    words = f"a number, or text with a unit: {', '.join(units_of(kind))}"
    return Key(name, meaning, either(number(), with_unit(kind)), example=example, words=words)


def _with_example(key: Key, kind: str) -> Key:
    """A key with the example for a kind of data."""
    return key._replace(example=KINDS[kind].examples.get(key.name, key.example))


def rig_keys(kind: str) -> dict[str, tuple[Key, ...]]:
    """The keys of each table, for a kind of data."""
    of = KINDS[kind]
    fit = (*((_FREE,) if of.parameters else ()), *of.fit)
    tables = {
        "": (_TITLE,),
        "data": tuple(_with_example(key, kind) for key in (*_DATA, *of.data)),
        "system": of.system,
        "known": (*(_known(*item) for item in of.numbers.items()), *of.lists),
        "fit": tuple(_with_example(key, kind) for key in fit),
    }
    return {name: keys for name, keys in tables.items() if keys}


def rig_settings() -> list[str]:
    """The keys of all kinds, each with its table, as `--set` takes them."""
    found = {
        f"{section}.{key.name}": None
        for kind in KINDS
        for section, keys in rig_keys(kind).items()
        for key in keys
        if section
    }
    return list(found)


def rig_schema() -> dict[str, Any]:
    """The schema of what `identify` reads."""
    return {
        "$schema": DIALECT,
        "title": "Configuration of a rig, for frictionmap identify",
        "type": "object",
        "properties": {"data": either({"type": "object", "required": ["kind", "file"]}, {"type": "array"})},
        "required": ["data"],
        "oneOf": [*(_kind_schema(kind) for kind in KINDS), _several_measurements()],
    }


def _several_measurements() -> dict[str, Any]:
    """Several measurements, tables [[data]]."""
    named = {key.name: key for key in (*_DATA, WINDOW, _LABEL)}
    data = table(described(tuple(named[name] for name in DATA_KEYS)), ("kind", "file"))
    data["properties"]["kind"] = {"description": "what was measured", **word(*JOINED)}
    known = tuple(_known(*item) for item in JOINT.numbers.items())
    tables = {
        "data": {"description": "Measurements fitted together.", **several(data, least=2)},
        "system": keyed_table("system", JOINT.system, TABLES["system"]),
        "known": keyed_table("known", known, TABLES["known"]),
        "fit": keyed_table("fit", (_FREE, *JOINT.fit), TABLES["fit"]),
    }
    return {**table({**described(KEYS[""]), **tables}), "title": JOINT_NAME}


def _kind_schema(kind: str) -> dict[str, Any]:
    keys = rig_keys(kind)
    sections = {name: keyed_table(name, keys[name], TABLES[name]) for name in keys if name}
    sections["data"]["properties"]["kind"] = {"description": "what was measured", "const": kind}
    needed = ("system",) if KINDS[kind].needs_system else ()
    return {**table({**described(keys[""]), **sections}, needed), "title": kind}
