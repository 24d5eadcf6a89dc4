"""Command-line arguments: every command with its options and help texts."""

import argparse
import sys
from argparse import Action, ArgumentParser
from argparse import Namespace as Options
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

from ..errors import nearest
from ..version import __version__

__all__ = [
    "CONTACTS",
    "FIGURE",
    "QUANTITIES",
    "RIGS",
    "SHELLS",
    "STREAM",
    "Action",
    "Argument",
    "ArgumentParser",
    "Command",
    "Options",
    "build_parser",
    "described",
    "help_on",
    "listed_commands",
    "one_line",
    "parse",
    "subcommands",
    "unknown_command",
]

#: Valid contacts of `System` and kinds of data of `identify`.  They are repeated here because importing them
#: would take longer than all of `--help`; a test compares them.
CONTACTS = ("fixed-wall", "joined-base-wall", "between-masses")
RIGS = ("free-decay", "forced", "record", "sweep", "loop")

#: Short configurations besides those of a single contact; a test compares them with those that there are.
_TEMPLATES = {
    "contacts": "several contacts: a frame with two brace dampers",
    "elastic": "a contact with a spring",
    "belt": "a mass on a belt",
    "design": "one mass, with design questions",
    "history": "motions in time under a pulse, and its spectrum",
    "law": "friction over speed",
    "squeal": "a mass on a belt without a load",
    "normal": "a contact whose normal force moves, and that opens",
    "backlash": "a spring with backlash",
    "modes": "a structure given by its modes",
    "beam": "a beam with a contact",
    "ring": "a bladed disk: a ring of sectors",
}

#: Shells that shtab knows; repeated here as the above, and compared by the same test.
SHELLS = ("bash", "zsh", "tcsh", "fish", "powershell")

#: Quantities of response curves, of responses and of maps that `plot` draws, compared by the same test.
QUANTITIES = (
    "amplitude",
    "first_harmonic",
    "contact",
    "harmonics",
    "energy",
    "transmitted_force",
    "history",
    "orbit",
    "regimes",
    *("contact_amplitude", "stuck_fraction", "period", "cycles", "multiplier", "asymmetry", "amplitude"),
    *("sliding_distance", "work_friction", "work_input", "work_damping", "equivalent_damping"),
)

#: Options of pictures, compared by the same test.
FIGURE = (
    *("size", "dpi", "legend", "caption", "title", "xlim", "ylim", "panels", "mass", "beta", "point", "box"),
)

#: Least similarity of a word that is suggested: commands and options are short, and often alike.
_SIMILAR = 0.7

#: Output "-": standard output.
STREAM = Path("-")

_DESCRIPTION = """\
Exact regime maps of a vibrating structure with dry-friction contacts: does a contact slide
continuously, stick and slip, or stay stuck, for each frequency ratio r, friction ratio beta and
static-to-kinetic ratio mu?"""

_EPILOG = """\
getting started:
  frictionmap init                                           write a configuration, map.toml
  frictionmap explore map.toml                               show its map in the browser
  frictionmap map map.toml && frictionmap plot map.nc        write the map and its picture to files

exit status: 0 success, 2 invalid input, 130 interrupted, 1 any other error"""


_SHORT_HELP = """\
usage: frictionmap COMMAND ...

  frictionmap init                                           write a configuration, map.toml
  frictionmap explore map.toml                               show its map in the browser
  frictionmap map map.toml && frictionmap plot map.nc        write the map and its picture to files
  frictionmap design map.toml                                which friction to choose
  frictionmap identify rig.toml                              friction from measured data

frictionmap --help lists all commands, frictionmap help COMMAND explains one."""


def one_line(message: object) -> str:
    """Join a message into one line: names and keys in it may contain line breaks."""
    return " ".join(str(message).split())


def unknown_command(word: str, known: Iterable[str], listed: Iterable[str]) -> str:
    """Return the message for a command that does not exist.

    known : all names, of which the nearest one is suggested
    listed : the names that help lists
    """
    valid = list(listed) or list(known)
    return f"unknown command {word!r}{nearest(word, known, _SIMILAR)}; valid: {', '.join(valid)}"


def _listed(commands: argparse._SubParsersAction) -> list[str]:
    """Names of the commands that help lists."""
    return [listed.dest for listed in commands._choices_actions]


class _Parser(argparse.ArgumentParser):
    """Parser with one-line errors that accepts no abbreviated options: --over is not --overwrite."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(allow_abbrev=False, **settings)

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {one_line(message)} (see {self.prog} --help)\n")

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Refuse an unknown command, naming the nearest one."""
        if isinstance(action, argparse._SubParsersAction) and value not in action.choices:
            self.exit(2, f"{self.prog}: {unknown_command(value, action.choices, _listed(action))}\n")
        super()._check_value(action, value)

    def parse_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse; refuse unknown options, naming the nearest one of the command."""
        self._refuse_before_command(args)
        found, unknown = self.parse_known_args(args, namespace)
        if unknown:
            sub = subcommands(self).choices[found.command]
            valid = [flag for action in sub._actions for flag in action.option_strings if flag[:2] == "--"]
            hints = [nearest(word.partition("=")[0], valid, _SIMILAR) for word in unknown if word[:2] == "--"]
            self.error(f"unrecognized arguments: {' '.join(unknown)}{next(filter(None, hints), '')}")
        return found

    def _refuse_before_command(self, args: Any) -> None:
        """Refuse an unknown option before the command; argparse would say that a command is missing."""
        first = next(iter(sys.argv[1:] if args is None else args), "")
        valid = self._option_string_actions
        if first.startswith("-") and first not in valid:
            self.error(
                f"unknown option {first!r}{nearest(first, valid, _SIMILAR)}; valid: {', '.join(valid)}"
            )


class _Once(argparse.Action):
    """Option that may be given once; argparse would silently drop the first of two values."""

    def __call__(
        self, parser: argparse.ArgumentParser, namespace: Options, values: object, option: str | None = None
    ) -> None:
        if getattr(namespace, self.dest, None) is not None:
            raise argparse.ArgumentError(self, "must be given once")
        setattr(namespace, self.dest, values)


def _file(text: str) -> Path:
    """Check the name of an output: a file, or a store, which is a folder."""
    if text in ("", "-") or (text.endswith(("/", "\\")) and not text.rstrip("/\\").endswith(".zarr")):
        raise argparse.ArgumentTypeError(f"must be the name of a file; got {text!r}")
    return Path(text)


def _file_or_stream(text: str) -> Path:
    """Check the name of an output that may also be "-", standard output."""
    return STREAM if text == "-" else _file(text)


def _threads(text: str) -> int:
    if (number := int(text)) < 1:
        raise argparse.ArgumentTypeError(f"must be >= 1; got {text}")
    return number


def _port(text: str) -> int:
    if not 0 <= (number := int(text)) <= 65535:
        raise argparse.ArgumentTypeError(f"must be 0 to 65535; got {text}")
    return number


_threads.__name__ = _port.__name__ = "whole number"  # its name in argparse's errors


def _ratio(text: str) -> float | str:
    """Convert a ratio; leave a number with a unit as text, to be checked where the units are known."""
    try:
        return float(text)
    except ValueError:
        if text[:1].isalpha() or not text:
            raise
        return text


_ratio.__name__ = "float"  # its name in argparse's errors


def _address(text: str) -> str:
    if not text:
        raise argparse.ArgumentTypeError("must be an address such as tcp://10.0.0.1:8786; got ''")
    return text


def _takes_output(
    sub: argparse.ArgumentParser, metavar: str, text: str, convert: Callable[[str], Path] = _file
) -> None:
    sub.add_argument("-o", dest="output", metavar=metavar, type=convert, action=_Once, help=text)
    _takes_replacement(sub)


def _takes_replacement(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("--overwrite", action="store_true", help="replace an existing output")
    sub.add_argument("--quiet", action="store_true", help="print errors only")


def _takes_config(
    sub: argparse.ArgumentParser,
    name: str = "CONFIG",
    what: str = "configuration of the computation",
    key: str = "grid.r.step=0.01",
    out: str = "OUT.nc",
) -> None:
    sub.add_argument("config", metavar=f"{name}.toml", type=Path, help=what)
    _takes_output(sub, out, f"output file (default: named after {name}, in the current folder)")
    _takes_overrides(sub, name, key)


def _takes_overrides(
    sub: argparse.ArgumentParser, name: str = "CONFIG", key: str = "grid.r.step=0.01"
) -> None:
    text = f"override a key of {name}, e.g. --set {key}; repeatable, once per key"
    sub.add_argument("--set", dest="overrides", metavar="KEY=VALUE", action="append", default=[], help=text)


def _takes_yes(sub: argparse.ArgumentParser) -> None:
    text = "run even if the estimated memory exceeds what is available"
    sub.add_argument("--yes", action="store_true", help=text)


def _takes_threads(sub: argparse.ArgumentParser) -> None:
    text = "number of threads (default: all processors); results do not depend on it"
    sub.add_argument("--threads", metavar="N", type=_threads, action=_Once, help=text)


def _takes_cell(sub: argparse.ArgumentParser) -> None:
    with_unit = "; with [units] in CONFIG also '"
    sub.add_argument("--r", type=_ratio, action=_Once, help=f"frequency ratio, > 0{with_unit}4.2 Hz'")
    text = f"in the place of --r, without a load: speed of the belt, > 0{with_unit}20 mm/s'"
    sub.add_argument("--wall-speed", metavar="V", dest="wall_speed", type=_ratio, action=_Once, help=text)
    sub.add_argument("--beta", type=_ratio, action=_Once, help=f"friction ratio, >= 0{with_unit}2 N'")
    text = "static over kinetic friction, >= 1 (default: grid.mu of CONFIG if it is a single value)"
    sub.add_argument("--mu", type=float, action=_Once, help=text)


def _takes_choices(sub: argparse.ArgumentParser) -> None:
    text = (
        "select a value on one of the further axes of a map, e.g. --at damping_ratios=0.01, or one of "
        "several motions in time, e.g. --at record=2; repeatable"
    )
    sub.add_argument("--at", metavar="NAME=VALUE", action="append", default=[], help=text)


def _takes_over(sub: argparse.ArgumentParser, what: str) -> None:
    text = (
        f"{what} the share of each regime over a further axis, e.g. sample, with quantiles of the boundaries"
    )
    sub.add_argument("--over", metavar="NAME", action=_Once, help=text)


def _takes_against(sub: argparse.ArgumentParser) -> None:
    text = "draw two contacts at one frequency over beta and this further axis, e.g. contacts_2_force"
    sub.add_argument("--against", metavar="NAME", action=_Once, help=text)


def _takes_picture(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("file", metavar="FILE", type=Path, help="file to draw: FILE.nc, or a store FILE.zarr")
    text = (
        ".png, .pdf or .svg; .gif or .mp4: a response or a motion, moving (default: FILE.png in the current "
        "folder)"
    )
    _takes_output(sub, "PICTURE", text)
    text = (
        "quantity to draw; response curves: amplitude (with the phase), first_harmonic, contact, harmonics, "
        "energy or transmitted_force (default: the first available); a response: history (default) or orbit; "
        "a map: regimes (default), or an output with a number in every cell, e.g. contact_amplitude"
    )
    sub.add_argument("--quantity", metavar="NAME", action=_Once, help=text)
    _takes_choices(sub)
    _takes_over(sub, "draw")
    _takes_against(sub)
    text = "logarithmic axis of amplitudes of response curves; logarithmic colours of a quantity of a map"
    sub.add_argument("--log", action="store_true", help=text)
    _takes_figure(sub)


def _takes_figure(sub: argparse.ArgumentParser) -> None:
    """Add the options of pictures for a publication; they are those of the functions that draw."""
    group = sub.add_argument_group("figure")
    text = "width, or width and height, on paper: 85mm, 3.3in, '85mm x 60mm'; text has at least 7 pt"
    group.add_argument("--size", metavar="SIZE", action=_Once, help=text)
    text = "pixels per inch (default: 160); in PDF and SVG only maps of over 10,000 cells consist of pixels"
    group.add_argument("--dpi", metavar="N", type=float, action=_Once, help=text)
    switch = argparse.BooleanOptionalAction
    group.add_argument("--legend", action=switch, help="draw the legend, or leave it out (default: draw)")
    text = (
        "draw the caption above the legend, or leave it out (default: draw, unless the width is below 4.5 in)"
    )
    group.add_argument("--caption", action=switch, help=text)
    text = "title in place of the one in the file; '' for none"
    group.add_argument("--title", metavar="TEXT", action=_Once, help=text)
    for axis in ("x", "y"):
        text = f"limits of the {axis} axis of the first panel and of panels with the same axis"
        group.add_argument(f"--{axis}lim", metavar=("A", "B"), nargs=2, type=float, action=_Once, help=text)
    text = "panels to draw, counted from 1 in reading order, e.g. 1,3"
    group.add_argument("--panels", metavar="LIST", type=_list_of(int), action=_Once, help=text)
    text = "masses to draw, e.g. 1,5 (curves, responses, quantities of masses)"
    group.add_argument("--mass", metavar="LIST", type=_list_of(int), action=_Once, help=text)
    text = "friction ratios whose response curves are drawn, e.g. 0.2,0.5 (the nearest ones in the file)"
    group.add_argument("--beta", metavar="LIST", type=_list_of(float), action=_Once, help=text)
    text = "mark a working point on a map or on boundaries: ratios, or '4.2 Hz' '2 N' for a file with units"
    group.add_argument("--point", metavar=("R", "BETA"), nargs=2, type=_ratio, action=_Once, help=text)
    text = "half-widths of the uncertainty of --point, drawn as a box"
    group.add_argument("--box", metavar=("DR", "DBETA"), nargs=2, type=_ratio, action=_Once, help=text)
    text = "settings of matplotlib for this picture: fonts, lines, colours of quantities"
    group.add_argument("--style", metavar="FILE.mplstyle", type=Path, action=_Once, help=text)


def _list_of(number: Callable[[str], float]) -> Callable[[str], list[float]]:
    """Convert numbers separated by commas."""

    def convert(text: str) -> list[float]:
        return [number(part) for part in text.split(",")]

    convert.__name__ = "list of numbers separated by commas"  # its name in argparse's errors
    return convert


def _megabytes(text: str) -> float:
    size = float(text)
    if not 0.0 < size < float("inf"):
        raise ValueError
    return size


_megabytes.__name__ = "number of MB > 0"  # its name in argparse's errors


def _takes_page(sub: argparse.ArgumentParser) -> None:
    text = "configuration of the map to explore (default: one mass against a fixed wall)"
    sub.add_argument("config", metavar="CONFIG.toml", type=Path, nargs="?", help=text)
    _takes_overrides(sub)
    text = "local port of the page (default: 8712, or any free port)"
    sub.add_argument("--port", metavar="N", type=_port, action=_Once, help=text)
    text = "print the address without opening a browser"
    sub.add_argument("--no-browser", action="store_true", help=text)
    text = "save the page as a single file, with precomputed maps for its sliders, instead of serving it"
    sub.add_argument("--export", dest="output", metavar="PAGE.html", type=_file, action=_Once, help=text)
    text = "with --export: sliders that the file keeps, such as mu,damping_ratios, or none (default: all)"
    sub.add_argument("--sliders", metavar="KEY,KEY", action=_Once, help=text)
    text = "with --export: largest size of the file in MB; sliders have fewer places if it would be larger"
    sub.add_argument("--size", metavar="MB", type=_megabytes, action=_Once, help=text)
    _takes_replacement(sub)


def _takes_workers(sub: argparse.ArgumentParser) -> None:
    where = sub.add_mutually_exclusive_group()
    text = "compute OUT.zarr with N local worker processes (needs dask)"
    where.add_argument("--workers", metavar="N", type=_threads, action=_Once, help=text)
    text = "compute OUT.zarr on the workers of a running dask scheduler"
    where.add_argument("--scheduler", metavar="ADDRESS", type=_address, action=_Once, help=text)


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of the whole command line."""
    parser = _Parser(
        prog="frictionmap",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("-V", "--version", action="version", version=f"frictionmap {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    def command(name: str, text: str, description: str) -> argparse.ArgumentParser:
        return commands.add_parser(name, help=text, description=description)

    _takes_grids(command)
    text = "Compute the time history of one steady state; write NetCDF."
    sub = command("response", "time history of one steady state", text)
    _takes_config(sub)
    _takes_cell(sub)
    text = "Open an interactive map in the browser; it runs locally and sends nothing over the network."
    _takes_page(command("explore", "interactive map in the browser", text))
    text = (
        "Fit friction, damping and natural frequency to measured data; print the friction with its 95 % "
        "interval, the conclusion, warnings and a table of all estimates; write NetCDF."
    )
    sub = command("identify", "friction, damping and natural frequency from measured data", text)
    _takes_config(sub, "RIG", "configuration of the measured data and the fit", "data.window=[0.5,4]")
    _takes_verbose(sub, "also print all further results of the fit")
    text = (
        "Answer a design question: which friction gives the least peak, keeps a limit, avoids stops or holds "
        "the contact, or the margins of a working point; print it in sentences and a table; write NetCDF."
    )
    sub = command("design", "which friction to choose: least peak, within a limit, no stops, stuck", text)
    _takes_config(sub, "CONFIG", "configuration with a table [design]", "design.band=[0.5,2]")
    _takes_threads(sub)
    text = (
        "Reduce the matrices of a configuration with the key reduce to its contacts, loads, kept degrees of "
        "freedom and modes; print what this costs in the range of r; write M, K, C and the names of rows."
    )
    sub = command("reduce", "small matrices of a structure with many degrees of freedom", text)
    _takes_config(sub, out="SMALL.npz")
    text = (
        "Follow motions in time under records: earthquakes, pulses, measured loads; print peaks, stops and "
        "the place of rest; write NetCDF."
    )
    sub = command("history", "motions in time under records", text)
    _takes_config(sub, "CONFIG", "configuration with a table [record]", "history.beta=[0.1,0.2]")
    _takes_threads(sub)
    text = (
        "Compute friction response spectra: peaks and residual displacements of one mass under records, over "
        "its natural period and friction; write NetCDF."
    )
    sub = command("spectrum", "friction response spectra under records", text)
    what = "configuration with tables [record] and [spectrum]"
    _takes_config(sub, "CONFIG", what, "spectrum.damping=0.05", out="OUT.nc|OUT.zarr")
    _takes_threads(sub)
    _takes_workers(sub)
    _takes_files(command)
    _takes_beginnings(command)
    _takes_setup(commands)
    return parser


def _takes_grids(command: Callable[[str, str, str], argparse.ArgumentParser]) -> None:
    """Add the commands that compute a grid."""
    text = "Determine the regime and the stops per cycle of every cell of a grid; write NetCDF."
    sub = command("map", "regime of every cell of a grid, or the boundaries alone", text)
    _takes_config(sub, out="OUT.nc|OUT.zarr")
    text = "compute the regime boundaries only; no cell is classified"
    sub.add_argument("--boundaries-only", action="store_true", dest="boundaries_only", help=text)
    _takes_borders(sub, "with --boundaries-only, ")
    _takes_threads(sub)
    _takes_yes(sub)
    _takes_workers(sub)
    text = "Compute amplitude, phase, harmonics and energy over frequency; write NetCDF."
    sub = command("curves", "response curves: amplitude, phase, harmonics, energy", text)
    _takes_config(sub)
    _takes_threads(sub)
    _takes_yes(sub)


def _takes_borders(sub: argparse.ArgumentParser, when: str = "") -> None:
    text = f"{when}also find the borders between numbers of stops within the ranges of [grid]"
    sub.add_argument("--borders", action="store_true", help=text)


def _takes_files(command: Callable[[str, str, str], argparse.ArgumentParser]) -> None:
    """Add the commands that read files of other commands."""
    sub = command(
        "plot",
        "picture of any output file",
        "Draw any file written by the other commands, or the structure of a configuration CONFIG.toml.",
    )
    _takes_picture(sub)
    text = (
        "Write a result, or a slice of one, as NetCDF or as a table (CSV): a row per cell of a map, per "
        "frequency of response curves, per instant of a motion, per motion of several ones; masses and "
        "contacts are columns, with the unit in the header."
    )
    sub = command("export", "any output file, or a slice, as a table (CSV) or NetCDF", text)
    sub.add_argument("file", metavar="FILE", type=Path, help="file to read: FILE.nc, or a store FILE.zarr")
    text = "OUT.nc or OUT.csv, or - for CSV on standard output (default: FILE.csv in the current folder)"
    _takes_output(sub, "OUT", text, _file_or_stream)
    _takes_choices(sub)
    _takes_over(sub, "write")
    text = (
        "CSV with all variables, also ratios where there are values in SI units (default: of motions time, "
        "displacements and friction forces; of curves regime, stops, amplitudes and phases; of several "
        "motions peaks, stops and places of rest)"
    )
    sub.add_argument("--all", action="store_true", dest="everything", help=text)
    _takes_info(command("info", "summary of a file", "Summarise the contents of a file on one screen."))


def _takes_verbose(sub: argparse.ArgumentParser, text: str) -> None:
    sub.add_argument("--verbose", action="store_true", help=text)


def _takes_info(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("file", metavar="FILE", type=Path, help="file to read: FILE.nc, or a store FILE.zarr")
    _takes_choices(sub)
    _takes_verbose(sub, "also list the meanings of all variables, the history and further results")
    text = "print the summary as JSON, for scripts: dimensions, ranges of axes, variables, numbers of cells"
    sub.add_argument("--json", action="store_true", help=text)


def _takes_beginnings(command: Callable[[str, str, str], argparse.ArgumentParser]) -> None:
    """Add the commands that help to write configurations and command lines."""
    text = "Write a short configuration that runs as it stands with every command, in units."
    sub = command("init", "write a configuration to begin with", text)
    text = "output file (default: map.toml, or rig.toml with --rig, in the current folder)"
    sub.add_argument("config", metavar="NAME.toml", type=_file, nargs="?", help=text)
    which = sub.add_mutually_exclusive_group()
    text = f"kind of contact: {', '.join(CONTACTS)} (default: {CONTACTS[0]})"
    which.add_argument("--contact", choices=CONTACTS, metavar="CONTACT", action=_Once, help=text)
    for name, words in _TEMPLATES.items():
        which.add_argument(f"--{name}", dest="template", action="store_const", const=name, help=words)
    text = (
        f"configuration for measured data, with a synthetic data file KIND.csv beside it: {', '.join(RIGS)}"
    )
    which.add_argument("--rig", choices=RIGS, metavar="KIND", action=_Once, help=text)
    numbers = sub.add_mutually_exclusive_group()
    text = "numbers in kilograms, newtons and hertz (default, but with --full)"
    numbers.add_argument("--units", action="store_true", help=text)
    numbers.add_argument("--ratios", action="store_true", help="dimensionless numbers")
    sub.add_argument("--full", action="store_true", help="every key, with its meaning and its valid values")
    _takes_replacement(sub)
    sub = command("help", "help on a command", "Show the help of a command, or of the program.")
    text = "command to explain (default: all commands in short)"
    sub.add_argument("verb", metavar="COMMAND", nargs="?", help=text)


def _takes_setup(commands: argparse._SubParsersAction) -> None:
    """Add `setup` with what editors and shells need, and older commands, which help does not list.

    Each part of `setup` is a command of its own as well, and `boundaries` is `map --boundaries-only`.
    """
    text = "Set up an editor or a shell: the JSON Schema of configurations, or a completion script."
    sub = commands.add_parser(
        "setup", help="for editors and shells: JSON Schema, completion", description=text
    )
    parts = sub.add_subparsers(dest="part", required=True, metavar="schema|completion")
    for add in (
        lambda name, words, about: parts.add_parser(name, help=words, description=about),
        lambda name, _, about: commands.add_parser(name, description=about),
    ):
        _takes_parts(add)
    text = "Compute the regime boundaries over frequency, as map --boundaries-only does; write NetCDF."
    older: argparse.ArgumentParser = commands.add_parser("boundaries", description=text)
    _takes_config(older)
    _takes_borders(older)


def _takes_parts(command: Callable[[str, str, str], argparse.ArgumentParser]) -> None:
    """Add the parts of `setup`."""
    text = "Print the JSON Schema of configurations, which editors use to complete and check them."
    sub = command("schema", "JSON Schema of configurations, for editors", text)
    sub.add_argument("--rig", action="store_true", help="schema of configurations for identify")
    text = "Print the completion script of a shell, to be loaded when the shell starts."
    sub = command("completion", "completion for bash, zsh, tcsh, fish or PowerShell", text)
    sub.add_argument("shell", choices=SHELLS, metavar="SHELL", help=f"one of {', '.join(SHELLS)}")


class Argument(NamedTuple):
    """An argument of a command as shown in its help."""

    flags: tuple[str, ...]  # empty for a positional argument
    metavar: str  # empty if it takes no value
    choices: tuple[str, ...]
    help: str


class Command(NamedTuple):
    """A command as shown in its help."""

    name: str
    help: str
    description: str
    usage: str
    arguments: tuple[Argument, ...]


def subcommands(parser: ArgumentParser) -> argparse._SubParsersAction:
    """Return the action of a parser that holds the parsers of its commands, by name, as `choices`."""
    (commands,) = (action for action in parser._actions if isinstance(action, argparse._SubParsersAction))
    return commands


def described() -> Iterator[Command]:
    """List every command with its arguments, for completion and for the manual."""
    commands = subcommands(build_parser())
    for listed in commands._choices_actions:
        sub = commands.choices[listed.dest]
        usage = " ".join(sub.format_usage().removeprefix("usage: ").split())
        arguments = tuple(_described(action) for action in sub._actions)
        yield Command(listed.dest, str(listed.help), str(sub.description), usage, arguments)


def _described(action: argparse.Action) -> Argument:
    takes_value = action.nargs != 0
    metavar = " ".join(action.metavar) if isinstance(action.metavar, tuple) else action.metavar
    metavar = str(metavar or action.dest.upper()) if takes_value else ""
    choices = tuple(str(choice) for choice in action.choices or ())
    return Argument(tuple(action.option_strings), metavar, choices, str(action.help))


def listed_commands() -> tuple[list[str], list[str]]:
    """Return the names of all commands, and of those that help lists."""
    commands = subcommands(build_parser())
    return list(commands.choices), _listed(commands)


def help_on(verb: str | None) -> str | None:
    """Return the help of a command, or of the program; None if there is no such command."""
    parser = build_parser()
    if verb is None:
        return parser.format_help()
    sub = subcommands(parser).choices.get(verb)
    return sub.format_help() if sub else None


def parse(arguments: Sequence[str]) -> Options:
    """Parse and check the arguments; help, version and errors end the program.

    Without arguments the short help is printed.
    """
    if not arguments:
        print(_SHORT_HELP)
        raise SystemExit(0)
    return build_parser().parse_args(arguments)
