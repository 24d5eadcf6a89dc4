"""Commented configurations: every key with its meaning, valid values and default."""

import textwrap
from collections.abc import Mapping
from typing import NamedTuple

from ..datasets.provenance import value_text
from .key import Key, describe_values
from .keys import KEYS, TABLES

_WIDTH = 100


class _Start(NamedTuple):
    """The entries of a commented configuration that depend on the kind of contact."""

    title: str
    system: Mapping[str, str]  # TOML, by keys
    beta: str


_DAMPED = {"damping_ratios": "0.01"}
_CHAIN = {"mass_ratios": "[1.0, 0.5]", "stiffness_ratios": "[1.0, 0.5]"}

_STARTS = {
    "fixed-wall": _Start("One mass against a fixed wall", _DAMPED, "1.2"),
    "joined-base-wall": _Start(
        "One mass against a wall that moves with the shaken base",
        {**_DAMPED, "excitation": '"base"'},
        "4.0",
    ),
    "between-masses": _Start(
        "Two masses that rub on each other", {"contact_masses": "[1, 2]", **_CHAIN, **_DAMPED}, "1.2"
    ),
}

_HEAD = """\
# Try it as it stands:
#
#     frictionmap explore {name}.toml
#     frictionmap map {name}.toml && frictionmap plot {name}.nc
#
# Above each key: its meaning and its valid values.  A line such as #cycles = 2000 shows the default or, if
# there is none, an example.  Editors complete and check this file with the output of `frictionmap schema`.
"""

_AXES = """\

# ---- [axes]: {what}
#[axes]
#damping_ratios = [0.0, 0.01, 0.05]
#"stiffness_ratios[2]" = {{ start = 0.5, stop = 2.0, num = 4 }}    # one entry of a list, counted from 1
#sample = {{ file = "variants.csv" }}    # columns named like the keys above
"""


def starting_configuration(name: str, contact: str = "fixed-wall") -> str:
    """Return the text of a commented configuration of a map, which runs as it stands.

    name : file name without its suffix
    contact : one of `System`
    """
    start = _STARTS[contact]
    said = {
        "": {"title": f'"{start.title}"'},
        "system": {"contact": f'"{contact}"', **start.system},
        "grid": {
            "r": "{ start = 0.02, stop = 2.5, step = 0.02 }",
            "beta": f"{{ start = 0.0, stop = {start.beta}, num = 121 }}",
            "mu": "[1.0, 1.5]",
        },
    }
    tables = [section_text(section, keys, said.get(section, {})) for section, keys in KEYS.items()]
    return "".join([_HEAD.format(name=name), *tables, _AXES.format(what=TABLES["axes"])])


def section_text(section: str, keys: tuple[Key, ...], said: Mapping[str, str], what: str = "") -> str:
    """Write a table with all its keys; keys without a given value are commented out."""
    lines = ["", f"# ---- [{section}]: {what or TABLES[section]}", f"[{section}]"] if section else []
    for key in keys:
        lines += ["", *_explained(key), _line(key, said)]
    return "\n".join(lines) + "\n"


def _explained(key: Key) -> list[str]:
    return [*_comment(key.meaning, "# "), *_comment(describe_values(key), "#   ")]


def _comment(text: str, indent: str) -> list[str]:
    return textwrap.wrap(
        text, _WIDTH, initial_indent=indent, subsequent_indent="#   ", break_on_hyphens=False
    )


def _line(key: Key, said: Mapping[str, str]) -> str:
    if key.name in said:
        return f"{key.name} = {said[key.name]}"
    return f"#{key.name} = {key.example or value_text(key.default)}"
