"""Reference pages of the manual, generated from the program: commands, keys, variables of files, API."""

import re
import textwrap
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

import frictionmap as fm
from frictionmap import regimes
from frictionmap.command_line.arguments import Command, described
from frictionmap.datasets.design_labels import answer_labels
from frictionmap.datasets.labels import LABELS, Label
from frictionmap.datasets.provenance import value_text
from frictionmap.files.key import Key, describe_values
from frictionmap.files.keys import KEYS, TABLES
from frictionmap.identify.rigs.configuration import KINDS
from frictionmap.identify.rigs.keys import TABLES as RIG_TABLES
from frictionmap.identify.rigs.keys import rig_keys

HERE = Path(__file__).resolve().parent

#: The public names, grouped by purpose; a name in none of these groups is added to the last one.
_GROUPS: Mapping[str, tuple[str, ...]] = {
    "Systems and settings": (
        "System", "Contact", "FrictionLaw", "NormalForce", "Spring", "PeriodicLoad", "Modes", "Beam", "Plate",
        "Solver", "Units", "load_config",
    ),
    "Maps, curves, motions": (
        "sweep", "boundaries", "borders", "curves", "response", "continuous_motion", "shares",
        "history", "spectrum", "stationary",
    ),
    "Pictures": (
        "plot_regimes", "plot_quantity", "plot_boundaries", "plot_curves", "plot_response", "plot_orbit",
        "plot_history", "plot_energies", "plot_spectrum", "plot_incremental", "plot_fit", "plot_shares",
        "plot_forces", "plot_design", "plot_modes", "plot_structure", "animate", "explore",
    ),
    "Errors, and others": ("InputError", "NoSteadyState"),
}  # fmt: skip


def write(folder: Path) -> None:
    """Write the pages that have changed; unchanged files are not built again."""
    folder.mkdir(exist_ok=True)
    pages = {
        "commands.md": commands(),
        "configuration.md": configuration(),
        "variables.md": variables(),
        "api.rst": api(),
        "citation.bib": citation(),
    }
    for name, lines in pages.items():
        text = "\n".join(lines) + "\n"
        path = folder / name
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def _table(header: Iterable[str], rows: Iterable[Iterable[str]]) -> Iterator[str]:
    header = list(header)
    for cells in (header, ["---"] * len(header), *rows):
        yield f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"


# citation


def _cited(text: str, key: str) -> str:
    """First value of a key of CITATION.cff."""
    found = re.search(rf"^ *(?:- )?{key}: *\"?(.*?)\"?$", text, re.MULTILINE)
    assert found is not None, key
    return found[1]


def citation() -> Iterator[str]:
    """Entries for BibTeX of the last release and of the thesis, from CITATION.cff."""
    program, _, thesis = (HERE.parent / "CITATION.cff").read_text(encoding="utf-8").partition("references:")
    yield "@software{frictionmap,"
    yield f"  title   = {{{_cited(program, 'title')}}},"
    yield f"  author  = {{{{{_cited(program, 'name')}}}}},"
    yield f"  version = {{{_cited(program, 'version')}}},"
    yield f"  year    = {{{_cited(program, 'date-released')[:4]}}}"
    yield "}\n"
    family = _cited(thesis, "family-names")
    yield f"@phdthesis{{{family.lower()}{_cited(thesis, 'year')},"
    yield f"  title  = {{{_cited(thesis, 'title').replace('Coulomb', '{Coulomb}')}}},"
    yield f"  author = {{{family}, {_cited(thesis, 'given-names')}}},"
    yield f"  school = {{{_cited(thesis, 'name')}}},"
    yield f"  year   = {{{_cited(thesis, 'year')}}}"
    yield "}"


# commands


def commands() -> Iterator[str]:
    """Page of all commands with their arguments, as in `--help`."""
    yield "# Commands\n"
    yield "Exit status: 0 success; 1 internal error; 2 invalid input, with a message of one line;"
    yield "130 interrupted."
    for command in described():
        yield from _command(command)


def _command(command: Command) -> Iterator[str]:
    yield f"\n## frictionmap {command.name}\n\n{command.description}\n"
    usage = "\n".join(textwrap.wrap(command.usage, 84, subsequent_indent="    ", break_on_hyphens=False))
    yield f"```text\n{usage}\n```\n"
    rows = (
        (
            f"`{', '.join(argument.flags)} {argument.metavar}`".replace(" `", "`")
            if argument.flags
            else f"`{argument.metavar}`",
            argument.help,
        )
        for argument in command.arguments
        if "--help" not in argument.flags
    )
    yield from _table(("argument", "meaning"), rows)


# configurations


def configuration() -> Iterator[str]:
    """Page of all keys, from the table that the checks use."""
    yield "# Keys of a configuration\n"
    yield "`frictionmap init --full` writes a file with all keys, `frictionmap setup schema` a schema.\n"
    yield "## Maps, curves, boundaries, responses"
    for section, keys in KEYS.items():
        yield from _keys(section, keys, TABLES.get(section, ""))
    yield f"\n### [axes]\n\n{TABLES['axes']} See [large maps](../large-maps.md)."
    yield "\n## Measured data"
    for kind in KINDS:
        yield f'\n### kind = "{kind}"'
        for section, keys in rig_keys(kind).items():
            yield from _keys(section, keys, RIG_TABLES.get(section, ""), "####")


def _keys(section: str, keys: Iterable[Key], what: str, level: str = "###") -> Iterator[str]:
    yield f"\n{level} [{section}]\n\n{what}\n" if section else ""
    rows = (
        (
            f"`{key.name}`",
            key.meaning,
            describe_values(key),
            "" if key.default is None else f"`{value_text(key.default)}`",
        )
        for key in keys
    )
    yield from _table(("key", "meaning", "valid values", "default"), rows)


# files


def variables() -> Iterator[str]:
    """Page of all variables that a file can contain."""
    yield "# Variables of files\n"
    yield "Variables without a unit are dimensionless. `frictionmap info` lists those that a file contains.\n"
    yield from _labelled(LABELS)
    yield "\n## Answers to design questions\n"
    yield from _labelled(answer_labels())


def _labelled(labels: Mapping[str, Label]) -> Iterator[str]:
    rows = (
        (f"`{name}`", ", ".join(label.dims), label.dtype.__name__, _with_unit(label))
        for name, label in labels.items()
    )
    yield from _table(("variable", "dimensions", "type", "content"), rows)


def _with_unit(label: Label) -> str:
    """Meaning of a variable, with its unit if it has one."""
    return label.long_name if label.units == "1" else f"{label.long_name} [{label.units}]"


# API


def api() -> Iterator[str]:
    """Page of the public names with their docstrings."""
    yield "Python API\n==========\n\n``import frictionmap as fm``"
    named = [name for names in _GROUPS.values() for name in names]
    public = [
        name
        for name in fm.__all__
        if name not in ("__version__", "design", "features", "identify", "regimes")
    ]
    others = [name for name in public if name not in named]
    for title, names in _GROUPS.items():
        yield f"\n{title}\n{'-' * len(title)}\n"
        last = title == list(_GROUPS)[-1]
        for name in (*names, *(others if last else ())):
            if name in public:
                yield _documented("frictionmap", name)
    for module in ("design", "features", "identify"):
        yield f"\nfrictionmap.{module}\n{'-' * (12 + len(module))}\n"
        yield f".. automodule:: frictionmap.{module}\n   :no-members:\n" if module == "features" else ""
        for name in _public(module):
            yield _documented(f"frictionmap.{module}", name)
    title = "ds.frictionmap"
    yield f"\n{title}\n{'-' * len(title)}\n"
    yield ".. autoclass:: frictionmap.accessor.FrictionAccessor\n   :members:\n"
    yield from _codes()


def _codes() -> Iterator[str]:
    """Tables of the constants of `frictionmap.regimes`, one per coded variable."""
    title = "frictionmap.regimes"
    yield f"\n{title}\n{'-' * len(title)}\n"
    yield f".. automodule:: {title}\n   :no-members:\n"
    for variable, table in (
        ("regime", regimes.BELT_REGIMES), ("origin", regimes.ORIGINS), ("status", regimes.STATUSES),
        ("limit_kind", regimes.LIMIT_KINDS), ("regime", regimes.NO_LOAD_REGIMES),
        ("status", regimes.BELT_STATUSES), ("friction_lim_kind", regimes.SLIDING_LIMIT_KINDS),
    ):  # fmt: skip
        yield f".. list-table:: Codes of ``{variable}``\n   :header-rows: 1\n"
        yield "   * - constant\n     - value\n     - meaning"
        for code in table:
            yield f"   * - {code.name.upper()}\n     - {code.value}\n     - {code.meaning}"
        yield ""
    for name in ("regime_name", "status_meaning"):
        yield _documented(title, name)


def _public(module: str) -> list[str]:
    found = getattr(fm, module)
    if hasattr(found, "__all__"):
        return list(found.__all__)
    own = vars(found).items()
    return [
        name
        for name, value in own
        if callable(value) and not name.startswith("_") and getattr(value, "__module__", "") == found.__name__
    ]


def _documented(module: str, name: str) -> str:
    kind = "class" if name[0].isupper() else "function"
    if name in ("InputError", "NoSteadyState"):
        kind = "exception"
    members = "   :members:\n" if kind == "class" else ""
    return f".. auto{kind}:: {module}.{name}\n{members}"
