"""JSON Schema of configurations, with which editors complete, explain and check them.

It refuses nothing that the program takes.  What needs arithmetic is left to the program: increasing values,
one number per mass, stop after start, files that are there; and JSON has no difference between 9 and 9.0.
"""

import re
from typing import Any

from ..model.variations import CONTACT_NUMBERS, LISTS, NUMBERS
from ..units.dimensions import RATIOS, axis_kind
from .key import Key, Schema, axis, describe_values, either, number, several, with_unit
from .keys import KEYS, TABLES

DIALECT = "https://json-schema.org/draft/2020-12/schema"

#: A structure that is no chain.
_GIVEN = {"anyOf": [{"required": [name]} for name in ("matrices", "modes", "beam", "plate")]}

#: One with a frequency scale: a ring of sectors is given by matrices, too, but its masses are counted.
_SCALED: Schema = {"anyOf": [*_GIVEN["anyOf"], {"required": ["sectors"]}]}

#: What keys of [system] say of each other, in the words of the errors of `System`.
_TOGETHER: list[Schema] = [
    {"dependentSchemas": {"matrices": {"properties": {"mass_ratios": False, "stiffness_ratios": False}}}},
    {"dependentSchemas": {"load": {"properties": {"load_mass": False, "excitation": {"const": "force"}}}}},
    {"dependentRequired": {name: ["matrices"] for name in ("reduce", "rayleigh", "decouple")}},
    {
        "dependentSchemas": {
            "masses": {"properties": {"mass_ratios": False, "matrices": False}},
            "dampers": {"properties": {"damping_ratios": False, "matrices": False}},
        }
    },
    {
        "if": {  # springs of a chain, not tables of springs
            "properties": {"springs": {"items": {"type": "string"}}},
            "required": ["springs"],
        },
        "then": {"properties": {"stiffness_ratios": False, "matrices": False}},
    },
    {"if": {"required": ["frequency_scale"]}, "then": _SCALED},
    {"dependentSchemas": {"rayleigh": {"properties": {"damping_ratios": False}}}},
    {
        "if": {"not": _GIVEN},  # a chain has no labels
        "then": {
            "properties": {"contact_masses": {"items": {"type": "integer"}}, "load_mass": {"type": "integer"}}
        },
    },
    {
        "if": {"properties": {"contact": {"const": "between-masses"}}, "required": ["contact"]},
        "then": {"properties": {"contact_masses": {"minItems": 2}}, "required": ["contact_masses"]},
        "else": {"properties": {"contact_masses": {"maxItems": 1}}},
    },
    {
        "if": {"properties": {"contact": {"const": "joined-base-wall"}}, "required": ["contact"]},
        "then": {"properties": {"excitation": {"const": "base"}, "load": False, "load_mass": {"const": 1}}},
        "else": {
            "if": {"not": {"properties": {"excitation": {"const": "base"}}, "required": ["excitation"]}},
            "then": {"properties": {"damping_reference": {"const": "ground"}}},
        },
    },
]


def map_schema() -> dict[str, Any]:
    """The schema of what `map`, `curves`, `boundaries` and `response` read."""
    sections = {name: keyed_table(name, keys) for name, keys in KEYS.items() if name}
    sections["system"]["allOf"] = _TOGETHER
    sections["grid"] |= {
        "allOf": [
            {"oneOf": [{"required": ["r"]}, {"required": ["wall_speed"]}]},
            {"oneOf": [{"required": ["beta"]}, {"required": ["friction_coefficient"]}]},
        ],
    }  # fmt: skip
    return {
        "$schema": DIALECT,
        "title": "Configuration of frictionmap",
        "type": "object",
        "properties": {**described(KEYS[""]), **sections, "axes": _further_axes()},
        "required": ["system", "grid"],
        "additionalProperties": False,
    }


def keyed_table(name: str, keys: tuple[Key, ...], what: str = "") -> dict[str, Any]:
    """A table with these keys and no other."""
    return {
        "description": what or TABLES[name], "type": "object", "properties": described(keys),
        "additionalProperties": False,
    }  # fmt: skip


def described(keys: tuple[Key, ...]) -> dict[str, Any]:
    """The schema of every key, with its meaning and default in words."""
    return {key.name: _described(key) for key in keys}


def _described(key: Key) -> dict[str, Any]:
    text = f"{key.meaning}; {describe_values(key)}"
    if key.default is None:
        return {"description": text, **key.valid}
    return {"description": text, "default": key.default, **key.valid}


def _pattern(name: str) -> str:
    """Pattern of the names of an axis, with any index."""
    return f"^{re.escape(name).replace('1', '[1-9][0-9]*')}$"


def _number(kind: str) -> Schema:
    return either(number(), with_unit(kind)) if kind else number()


def _further_axes() -> dict[str, Any]:
    """[axes]: numbers of the system by their names, and names of what changes together."""
    numbers, lists = "|".join(NUMBERS), "|".join(LISTS)
    names = (
        *NUMBERS,
        *(f"{name}[1]" for name in (*LISTS, *RATIOS)),
        *(f"contacts[1].{name}" for name in CONTACT_NUMBERS),
    )
    columns = {
        "type": "object", "minProperties": 1, "additionalProperties": False,
        "patternProperties": {_pattern(name): several(_number(axis_kind(name))) for name in names},
    }  # fmt: skip
    file = {
        "type": "object", "required": ["file"], "additionalProperties": False,
        "properties": {"file": {"type": "string", "minLength": 1}},
    }  # fmt: skip
    return {
        "description": TABLES["axes"],
        "type": "object",
        "minProperties": 1,
        "patternProperties": {
            **{_pattern(name): axis(axis_kind(name)) for name in names},
            f"^(?!({numbers}|{lists})$)[a-z][a-z0-9_]*$": {"anyOf": [file, columns]},
        },
        "additionalProperties": False,
    }
