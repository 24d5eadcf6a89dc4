"""One key of a configuration: its meaning, default and valid values, as JSON Schema."""

import math
import re
from collections.abc import Mapping
from typing import Any, NamedTuple

from .. import checks
from ..units.quantities import NUMBER
from ..units.table import spellings

Schema = Mapping[str, Any]


class Key(NamedTuple):
    """One key of a table."""

    name: str
    meaning: str
    valid: Schema  # JSON Schema
    default: Any = None  # None: no default that a file could state
    example: str = ""  # TOML, where there is no default
    words: str = ""  # the valid values in words, where the schema alone is hard to read


def number(
    *,
    least: float | None = None,
    most: float | None = None,
    above: float | None = None,
    below: float | None = None,
) -> Schema:
    """Schema of a number in a range."""
    ends = {"minimum": least, "maximum": most, "exclusiveMinimum": above, "exclusiveMaximum": below}
    return {"type": "number", **{name: end for name, end in ends.items() if end is not None}}


def whole(**ends: float) -> Schema:
    """Schema of an integer in a range."""
    return {**number(**ends), "type": "integer"}


def word(*valid: str) -> Schema:
    """Schema of one of several words."""
    return {"enum": list(valid)}


def several(item: Schema, least: int = 1, **more: Any) -> Schema:
    """Schema of a list."""
    return {"type": "array", "items": item, "minItems": least, **more}


def either(*kinds: Schema) -> Schema:
    """Schema of a value that matches any of several schemas."""
    return {"anyOf": list(kinds)}


def table(keys: Mapping[str, Schema], required: tuple[str, ...] = ()) -> Schema:
    """Schema of a table without further keys."""
    return {
        "type": "object", "properties": dict(keys), "required": list(required),
        "additionalProperties": False,
    }  # fmt: skip


def with_unit(kind: str) -> Schema:
    """Schema of a number with a unit of the given kind."""
    units = "|".join(re.escape(unit) for unit in spellings(kind))
    return {"type": "string", "pattern": rf"^{NUMBER} ?({units})$"}


def axis(kind: str, **ends: float) -> Schema:
    """Schema of an axis: values or a range; `kind` is the kind of unit that values may have, or ""."""
    value, step = number(**ends), number(above=0.0)
    if kind:
        value, step = either(value, with_unit(kind)), either(step, with_unit(kind))
    edges = {"start": value, "stop": value}
    return either(
        value,
        several(value),
        table({"values": several(value)}, ("values",)),
        table({**edges, "step": step}, ("start", "stop", "step")),
        table({**edges, "num": whole(least=1, most=checks.MOST_CELLS)}, ("start", "stop", "num")),
    )


#: Number, label or name of a mass or point.
DOF = either(whole(least=1), {"type": "string", "minLength": 1})


def describe_values(key: Key) -> str:
    """Describe the valid values of a key in a few words."""
    return key.words or _describe_schema(key.valid)


def _describe_schema(valid: Schema) -> str:
    if "enum" in valid:
        *others, last = (f'"{one}"' for one in valid["enum"])
        return f"{', '.join(others)} or {last}" if others else last
    if "anyOf" in valid:
        return " or ".join(_describe_schema(one) for one in valid["anyOf"])
    if valid["type"] == "array":
        some = "one or more of " if "enum" in valid["items"] else ""
        return f"a list of {some}{_describe_schema(valid['items'])}"
    words = {"integer": "a whole number", "number": "a number", "string": "text"}[valid["type"]]
    ends = [
        f"{sign} {valid[name]:g}"
        for name, sign in (
            ("exclusiveMinimum", ">"),
            ("minimum", ">="),
            ("maximum", "<="),
            ("exclusiveMaximum", "<"),
        )
        if name in valid
    ]
    return " ".join((words, " and ".join(ends))).strip()


def fits(value: object, valid: Schema) -> bool:
    """Whether a value is valid by itself: what JSON Schema says of the schemas of this module."""
    if "anyOf" in valid:
        return any(fits(value, one) for one in valid["anyOf"])
    if "enum" in valid:
        return value in valid["enum"]
    if valid["type"] in ("number", "integer"):
        return _is_in_range(value, valid)
    if valid["type"] == "string":
        return isinstance(value, str) and bool(re.search(valid.get("pattern", ""), value))
    if valid["type"] == "array":
        least, most = valid["minItems"], valid.get("maxItems", math.inf)
        return (
            isinstance(value, list)
            and least <= len(value) <= most
            and all(fits(one, valid["items"]) for one in value)
        )
    keys = valid["properties"]
    return (
        isinstance(value, Mapping)
        and set(valid["required"]) <= set(value)
        and all(name in keys and fits(one, keys[name]) for name, one in value.items())
    )


def _is_in_range(value: object, valid: Schema) -> bool:
    """Whether a value is a finite number, or an integer, in the range of a schema."""
    kinds = int if valid["type"] == "integer" else (int, float)
    if isinstance(value, bool) or not isinstance(value, kinds) or not math.isfinite(value):
        return False
    return valid.get("minimum", -math.inf) <= value <= valid.get("maximum", math.inf) and valid.get(
        "exclusiveMinimum", -math.inf
    ) < value < valid.get("exclusiveMaximum", math.inf)
