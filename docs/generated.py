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

#: Public names by what readers do; a name with a dot at its end is all of a module.
_GROUPS: Mapping[str, tuple[str, ...]] = {
    "Structures, contacts and loads": (
        "System", "Contact", "FrictionLaw", "NormalForce", "Spring", "PeriodicLoad", "Modes", "Beam", "Plate",
        "ring", "Units", "system_in_units",
    ),
    "Maps": ("sweep", "boundaries", "borders", "shares", "Solver"),
    "Responses": ("response", "curves", "continuous_motion"),
    "Features that need no map": ("features.",),
    "Records and motions in time": ("Record", "history", "spectrum", "stationary", "ring_down"),
    "Design": ("design.",),
    "Identification from measured data": ("identify.",),
    "Pictures": (
        "plot_regimes", "plot_quantity", "plot_boundaries", "plot_curves", "plot_response", "plot_orbit",
        "plot_history", "plot_energies", "plot_spectrum", "plot_incremental", "plot_fit", "plot_shares",
        "plot_forces", "plot_design", "plot_modes", "plot_structure", "plot_belt", "plot_belt_motion",
        "animate", "explore",
    ),
    "Files, codes and errors": ("load_config", "open", "regimes.", "InputError", "NoSteadyState"),
}  # fmt: skip


def write(folder: Path) -> None:
    """Write the pages that have changed; unchanged files are not built again."""
    pages = {
        "commands.md": commands(),
        "configuration.md": configuration(),
        "variables.md": variables(),
        "api.rst": api(),
        "codes.rst": codes(),
        "citation.bib": citation(),
        "paper.md": paper(),
        **{f"api/frictionmap.{name}.rst": api_page(name) for name in public_names()},
    }
    for name, lines in pages.items():
        text = "\n".join(lines) + "\n"
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
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


# paper


def paper() -> Iterator[str]:
    """The paper of the folder paper, in the form of the manual: its citations lead to the bibliography."""
    folder = HERE.parent / "paper"
    _, head, text = (folder / "paper.md").read_text(encoding="utf-8").split("---\n", 2)
    names = dict(_short_citations((folder / "paper.bib").read_text(encoding="utf-8")))
    (title,) = re.findall(r"^title: '(.*)'$", head, re.MULTILINE)

    def cited(found: re.Match[str]) -> str:
        keys = [key.strip().removeprefix("@") for key in found[1].split(";")]
        return f"([{'; '.join(names[key] for key in keys)}](../bibliography.md))"

    text = re.sub(r"\[(@[^\]]+)\]", cited, text.replace("](map.png)", "](../../paper/map.png)"))
    text = text.replace("](../benchmarks/", "](../../benchmarks/")
    labels = re.findall(r"\\label\{(.*?)\}", text)
    text = re.sub(r"\\label\{.*?\}", "", text)
    for number, label in enumerate(labels, start=1):
        text = text.replace(rf"\autoref{{{label}}}", f"figure {number}")
    yield f"# {title}\n"
    yield re.sub(r"^# ", "## ", text.partition("# References")[0].strip(), flags=re.MULTILINE)


def _short_citations(entries: str) -> Iterator[tuple[str, str]]:
    """Keys of BibTeX entries, and their first author with the year."""
    for entry in entries.split("\n@"):
        key, authors, year = (
            re.findall(pattern, entry)[0]
            for pattern in (r"\{(.+?),", r"author = \{(.+?)\},", r"year = \{(\d+)\}")
        )
        families = [name.partition(",")[0].replace("\\'a", "á") for name in authors.split(" and ")]
        named = " and ".join(families) if len(families) < 3 else f"{families[0]} and others"
        yield key, f"{named} {year}"


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


def _in_group(names: Iterable[str]) -> Iterator[str]:
    """Names of a group, those of a module in place of its name with a dot."""
    for name in names:
        if not name.endswith("."):
            yield name
            continue
        found = getattr(fm, name.removesuffix("."))
        yield from (f"{name}{one}" for one in found.__all__ if callable(getattr(found, one)))


def public_names() -> list[str]:
    """Public functions and classes, such as "sweep" and "design.stuck", in the order of the groups."""
    return [name for names in _GROUPS.values() for name in _in_group(names)]


def api() -> Iterator[str]:
    """Page with a table of the public names for each group; every name has a page of its own."""
    yield "Python API\n==========\n\n``import frictionmap as fm``"
    for title, names in _GROUPS.items():
        yield from _heading(title)
        yield ".. autosummary::\n   :toctree: api\n   :nosignatures:\n"
        yield from (f"   ~frictionmap.{name}" for name in _in_group(names))
    yield ""
    yield "Codes of regimes and causes, with their constants: :doc:`codes`."
    yield from _heading("ds.frictionmap")
    yield ".. autoclass:: frictionmap.accessor.FrictionAccessor\n   :members:"


def _heading(title: str, line: str = "-") -> Iterator[str]:
    yield f"\n{title}\n{line * len(title)}\n"


def api_page(name: str) -> Iterator[str]:
    """Page of one public function or class."""
    value: object = fm
    for part in name.split("."):
        value = getattr(value, part)
    kind = "function"
    if isinstance(value, type):
        kind = "exception" if issubclass(value, Exception) else "class"
    yield from _heading(f"fm.{name}", "=")
    yield f".. auto{kind}:: frictionmap.{name}"
    yield "   :members:" if kind == "class" else ""


def codes() -> Iterator[str]:
    """Tables of the constants of `frictionmap.regimes`, one per coded variable."""
    title = "frictionmap.regimes"
    yield from _heading(title, "=")
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
