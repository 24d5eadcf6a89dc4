"""Configurations to begin with: short ones, and commented ones that have every key with its valid values."""

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


class _Short(NamedTuple):
    """A short configuration: lines of [system], in units and in ratios where they differ."""

    title: str
    system: tuple[str | tuple[str, str], ...]
    base: bool  # whether a moving base is the load, not a force
    friction: float  # the largest of the grid, over P

    def lines(self, in_units: bool) -> list[str]:
        """Lines of [system]."""
        return [line if isinstance(line, str) else line[0 if in_units else 1] for line in self.system]


_ONE_MASS = (
    ('masses = ["40 kg"]', "mass_ratios = [1.0]"),
    ('springs = ["500 N/mm"]', "stiffness_ratios = [1.0]"),
)
_TWO_MASSES = (
    ('masses = ["40 kg", "20 kg"]', "mass_ratios = [1.0, 0.5]"),
    ('springs = ["500 N/mm", "250 N/mm"]', "stiffness_ratios = [1.0, 0.5]"),
)
_ZETA = "damping_ratios = 0.02"

#: Short configurations by kind; r = 1 is 17.8 Hz and P 100 N in all of them.
SHORT = {
    "fixed-wall": _Short(
        "One mass against a fixed wall", (*_ONE_MASS, _ZETA, 'contact = "fixed-wall"'), False, 1.2
    ),
    "joined-base-wall": _Short(
        "One mass against a wall that moves with the shaken base",
        (*_ONE_MASS, _ZETA, 'contact = "joined-base-wall"'), True, 4.0,
    ),
    "between-masses": _Short(
        "Two masses that rub on each other",
        (*_TWO_MASSES, _ZETA, 'contact = "between-masses"', "contact_masses = [1, 2]"), False, 1.2,
    ),
    "contacts": _Short(
        "Two-storey frame with two brace dampers",
        (
            *_TWO_MASSES, _ZETA,
            'contacts = [{ kind = "joined-base-wall", masses = [1] },',
            '            { kind = "between-masses", masses = [1, 2], ratio = 0.5 }]',
        ), True, 4.0,
    ),
    "elastic": _Short(
        "One mass and a contact with a spring",
        (*_ONE_MASS, _ZETA, ('contact_stiffness = "500 N/mm"', "contact_stiffness = 1.0")), False, 1.2,
    ),
    "belt": _Short(
        "A mass on a belt", (*_ONE_MASS, _ZETA, ('wall_speed = "20 mm/s"', "wall_speed = 0.9")), False, 1.2
    ),
}  # fmt: skip

_SHORT_HEAD = """\
# frictionmap map {name}.toml && frictionmap plot {name}.nc; also explore, curves, boundaries, design
# frictionmap response {name}.toml --r {r} --beta {beta}
"""

_SHORT_GRIDS = {
    True: """\
[grid]                            # numbers without a unit are ratios: to the natural frequency, to the load
r = {{ start = "4 Hz", stop = "40 Hz", step = "0.4 Hz" }}
beta = {{ start = "0 N", stop = "{friction:g} N", num = 61 }}
mu = 1.0                          # static over kinetic friction
[design]
question = "least-peak"
band = ["6 Hz", "40 Hz"]
""",
    False: """\
[grid]
r = {{ start = 0.2, stop = 2.2, step = 0.02 }}      # excitation over natural frequency
beta = {{ start = 0.0, stop = {friction:g}, num = 61 }}      # friction force over load
mu = 1.0                                      # static over kinetic friction
[design]
question = "least-peak"
band = [0.3, 2.2]
""",
}

_MOTION_HEAD = """\
# frictionmap history {name}.toml && frictionmap plot {name}-history.nc
# frictionmap spectrum {name}.toml && frictionmap plot {name}-spectrum.nc
"""

#: A pulse, the motions under it, and its spectrum.
_MOTIONS = {
    True: """\
[record]
unit = "g"
pulse = { kind = "half-sine", amplitude = "0.4 g", duration = "0.05 s" }      # or file = "elcentro.at2"
[history]
friction = ["0.05 g", "0.1 g"]    # friction force over the mass
[spectrum]
period = { start = "0.02 s", stop = "0.2 s", num = 10 }
friction = ["0.05 g", "0.1 g"]
""",
    False: """\
[record]
pulse = { kind = "half-sine", amplitude = 1.0, duration = 6.0 }      # time in 1/omega_1
[history]
beta = [0.1, 0.2]
[spectrum]
period = { start = 2.0, stop = 12.0, num = 10 }
friction = [0.1, 0.2]
""",
}

#: What P is, by whether the base moves.
_LOADS = {
    True: 'base_amplitude = "0.2 mm"         # the base moves by 0.2 mm cos(omega t)',
    False: 'load = "100 N"                    # amplitude of the force on mass 1',
}

#: Other questions, for a configuration that is written for its design.
_QUESTIONS = """\
#question = "at-most"              # all friction with a response up to a limit
#limit = {limit}
#question = "no-stop"              # the most friction without a stop
#question = "stuck"                # the least friction that holds the contact
"""

_HEAD = """\
# Try it as it stands:
#
#     frictionmap explore {name}.toml
#     frictionmap map {name}.toml && frictionmap plot {name}.nc
#
# Above each key: its meaning and its valid values.  A line such as #cycles = 2000 shows the default or, if
# there is none, an example.  Editors complete and check this file with the output of
# `frictionmap setup schema`.
"""

_AXES = """\

# ---- [axes]: {what}
#[axes]
#damping_ratios = [0.0, 0.01, 0.05]
#"stiffness_ratios[2]" = {{ start = 0.5, stop = 2.0, num = 4 }}    # one entry of a list, counted from 1
#sample = {{ file = "variants.csv" }}    # columns named like the keys above
"""


def starting_configuration(name: str, contact: str = "fixed-wall", in_units: bool = False) -> str:
    """Return the text of a commented configuration of a map, which runs as it stands.

    name : file name without its suffix
    contact : one of `System`
    in_units : with a table [units] that has values
    """
    start = _STARTS[contact]
    said = {
        "": {"title": f'"{start.title}"'},
        "system": {"contact": f'"{contact}"', **start.system},
        "grid": {
            "r": "{ start = 0.02, stop = 2.5, step = 0.02 }",
            "beta": f"{{ start = 0.0, stop = {start.beta}, num = 121 }}",
            "mu": "[1.0]",
        },
        "design": {"question": '"least-peak"', "band": "[0.3, 2.2]"},
    }
    if in_units:
        said["units"] = {"natural_frequency": '"4.2 Hz"', "load": '"12.5 N"', "stiffness": '"3 N/mm"'}
    tables = [section_text(section, keys, said.get(section, {})) for section, keys in KEYS.items()]
    return "".join([_HEAD.format(name=name), *tables, _AXES.format(what=TABLES["axes"])])


def short_configuration(name: str, kind: str = "fixed-wall", in_units: bool = True) -> str:
    """Return the text of a short configuration that runs as it stands with every command.

    name : file name without its suffix
    kind : one of `SHORT`, or "design": the question of one mass with the others beside it
    in_units : numbers in kilograms, newtons and hertz, or ratios
    """
    short = SHORT["fixed-wall" if kind == "design" else kind]
    r, beta = ("'10 Hz'", "'30 N'") if in_units else ("0.6", "0.3")
    lines = [_SHORT_HEAD.format(name=name, r=r, beta=beta), f'title = "{short.title}"\n', "[system]\n"]
    lines += [f"{line}\n" for line in short.lines(in_units)]
    if short.base and 'contact = "joined-base-wall"' not in short.system:
        lines.append('excitation = "base"\n')
    if in_units:
        lines += ["[units]\n", f"{_LOADS[short.base]}\n"]
    friction = 100.0 * short.friction if in_units else short.friction
    lines.append(_SHORT_GRIDS[in_units].format(friction=friction))
    if kind == "belt":  # its contact never holds, which would end the search
        lines.append('beta = ["5 N", "120 N"]\n' if in_units else "beta = [0.05, 1.2]\n")
    if kind == "design":
        lines.append(_QUESTIONS.format(limit='"0.5 mm"' if in_units else "2.5"))
    return "".join(lines)


def short_motion(name: str, in_units: bool = True) -> str:
    """Return the text of a short configuration of motions in time and of a spectrum."""
    short = SHORT["joined-base-wall"]
    lines = [_MOTION_HEAD.format(name=name), 'title = "One mass under a pulse of its base"\n', "[system]\n"]
    lines += [f"{line}\n" for line in short.lines(in_units)]
    # a pulse of acceleration leaves the base moving: dashpots to the ground would go on dragging
    return "".join([*lines, 'damping_reference = "base"\n', _MOTIONS[in_units]])


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
