"""The arguments of the command line."""

import argparse
from argparse import Namespace as Options
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

from .version import __version__

__all__ = ["CONTACTS", "RIGS", "SHELLS", "Argument", "Command", "Options", "described", "one_line", "parse"]

#: Contacts of `System` and kinds of data of `identify`, held to them by a test:
#: importing them would take longer than all of `--help`.
CONTACTS = ("fixed-wall", "joined-base-wall", "between-masses")
RIGS = ("free-decay", "forced", "record", "sweep")

SHELLS = ("bash", "zsh", "fish")

_DESCRIPTION = """\
Exact regime maps of a vibrating structure with one dry-friction contact: does it slide without stopping,
stick and slip, or stick for good, over frequency ratio r, friction ratio beta and static/kinetic ratio mu?"""

_EPILOG = """\
to begin with:
  frictionmap init                                           a configuration, map.toml
  frictionmap explore map.toml                               its map in a browser
  frictionmap map map.toml && frictionmap plot map.nc        the same as files

exit status: 0 done, 2 the input is at fault, 130 interrupted (also by termination), 1 anything else"""


def one_line(message: object) -> str:
    """A message without the line breaks that a name or a key put into it."""
    return " ".join(str(message).split())


class _Parser(argparse.ArgumentParser):
    """argparse, with errors on one line and no options cut short: --over is not --overwrite."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(allow_abbrev=False, **settings)

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {one_line(message)} (see {self.prog} --help)\n")


class _Once(argparse.Action):
    """An option with one value, which a second one would drop in silence."""

    def __call__(
        self, parser: argparse.ArgumentParser, namespace: Options, values: object, option: str | None = None
    ) -> None:
        if getattr(namespace, self.dest, None) is not None:
            raise argparse.ArgumentError(self, "must be given once")
        setattr(namespace, self.dest, values)


def _file(text: str) -> Path:
    """The name of a file to write, or of a store, which is a folder."""
    if text in ("", "-") or (text.endswith(("/", "\\")) and not text.rstrip("/\\").endswith(".zarr")):
        raise argparse.ArgumentTypeError(f"must be the name of a file; got {text!r}")
    return Path(text)


def _threads(text: str) -> int:
    if (number := int(text)) < 1:
        raise argparse.ArgumentTypeError(f"must be >= 1; got {text}")
    return number


def _port(text: str) -> int:
    if not 0 <= (number := int(text)) <= 65535:
        raise argparse.ArgumentTypeError(f"must be 0 to 65535; got {text}")
    return number


_threads.__name__ = _port.__name__ = "whole number"  # what argparse calls it


def _ratio(text: str) -> float | str:
    """A ratio, or a number with its unit, which is checked where the units are known."""
    try:
        return float(text)
    except ValueError:
        if text[:1].isalpha() or not text:
            raise
        return text


_ratio.__name__ = "float"  # what argparse calls it


def _address(text: str) -> str:
    if not text:
        raise argparse.ArgumentTypeError("must be an address such as tcp://10.0.0.1:8786; got ''")
    return text


def _takes_output(sub: argparse.ArgumentParser, metavar: str, text: str) -> None:
    sub.add_argument("-o", dest="output", metavar=metavar, type=_file, action=_Once, help=text)
    _takes_replacement(sub)


def _takes_replacement(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("--overwrite", action="store_true", help="replace an existing output")
    sub.add_argument("--quiet", action="store_true", help="print nothing but errors")


def _takes_config(
    sub: argparse.ArgumentParser,
    name: str = "CONFIG",
    what: str = "what to compute",
    key: str = "grid.r.step=0.01",
    out: str = "OUT.nc",
) -> None:
    sub.add_argument("config", metavar=f"{name}.toml", type=Path, help=what)
    _takes_output(sub, out, f"file to write; default: named after {name}, in the current folder")
    _takes_overrides(sub, name, key)


def _takes_overrides(
    sub: argparse.ArgumentParser, name: str = "CONFIG", key: str = "grid.r.step=0.01"
) -> None:
    text = f"override a key of {name}, e.g. --set {key}; repeatable, each key once"
    sub.add_argument("--set", dest="overrides", metavar="KEY=VALUE", action="append", default=[], help=text)


def _takes_yes(sub: argparse.ArgumentParser) -> None:
    text = "compute what this machine seems to have too little memory for"
    sub.add_argument("--yes", action="store_true", help=text)


def _takes_threads(sub: argparse.ArgumentParser) -> None:
    text = "threads to use (default: all processors); the result is the same to the bit"
    sub.add_argument("--threads", metavar="N", type=_threads, action=_Once, help=text)


def _takes_cell(sub: argparse.ArgumentParser) -> None:
    with_unit = "; with [units] in CONFIG also '"
    sub.add_argument(
        "--r", type=_ratio, required=True, action=_Once, help=f"frequency ratio, > 0{with_unit}4.2 Hz'"
    )
    sub.add_argument(
        "--beta", type=_ratio, required=True, action=_Once, help=f"friction ratio, >= 0{with_unit}2 N'"
    )
    text = "static over kinetic friction, >= 1 (default: grid.mu of CONFIG if that is one value, else needed)"
    sub.add_argument("--mu", type=float, action=_Once, help=text)


def _takes_choices(sub: argparse.ArgumentParser) -> None:
    text = "the point of a further axis, e.g. --at damping_ratios=0.01; repeatable"
    sub.add_argument("--at", metavar="NAME=VALUE", action="append", default=[], help=text)


def _takes_over(sub: argparse.ArgumentParser, what: str) -> None:
    text = (
        f"{what} the shares of regimes over a further axis, such as sample, and quantiles of the boundaries"
    )
    sub.add_argument("--over", metavar="NAME", action=_Once, help=text)


def _takes_page(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("config", metavar="CONFIG.toml", type=Path, help="what to explore, and where to begin")
    _takes_overrides(sub)
    text = "port of this machine to serve the page at (default: 8712, or any that is free)"
    sub.add_argument("--port", metavar="N", type=_port, action=_Once, help=text)
    text = "print the address and open no browser"
    sub.add_argument("--no-browser", action="store_true", help=text)
    text = "write the page as one file, with maps computed for its sliders, and serve nothing"
    sub.add_argument("--export", dest="output", metavar="PAGE.html", type=_file, action=_Once, help=text)
    _takes_replacement(sub)


def _takes_workers(sub: argparse.ArgumentParser) -> None:
    where = sub.add_mutually_exclusive_group()
    text = "compute OUT.zarr on N processes of this machine (needs dask)"
    where.add_argument("--workers", metavar="N", type=_threads, action=_Once, help=text)
    text = "compute OUT.zarr on the workers of a dask scheduler that is running"
    where.add_argument("--scheduler", metavar="ADDRESS", type=_address, action=_Once, help=text)


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="frictionmap",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"frictionmap {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    def command(name: str, text: str, description: str) -> argparse.ArgumentParser:
        return commands.add_parser(name, help=text, description=description)

    text = "Classify every cell of a grid and count its stops per cycle; write NetCDF."
    sub = command("map", "classify every cell of a grid", text)
    _takes_config(sub, out="OUT.nc|OUT.zarr")
    _takes_threads(sub)
    _takes_yes(sub)
    _takes_workers(sub)
    text = "Compute response curves over frequency: amplitude, phase, harmonics, energy; write NetCDF."
    sub = command("curves", "amplitude, phase, harmonics and energy over frequency", text)
    _takes_config(sub)
    _takes_threads(sub)
    _takes_yes(sub)
    text = "Compute the boundaries of the regimes over frequency (no cell is classified); write NetCDF."
    _takes_config(command("boundaries", "curves only", text))
    sub = command("response", "one steady state in time", "Compute one steady state in time; write NetCDF.")
    _takes_config(sub)
    _takes_cell(sub)
    text = "Show the map in a browser, to move about in; on this machine only."
    _takes_page(command("explore", "the map in a browser", text))
    text = "Fit friction, damping and frequency to measured data; print estimates with errors, write NetCDF."
    sub = command("identify", "friction, damping and frequency from measured data", text)
    _takes_config(sub, "RIG", "which data, and what is known", "data.window=[0.5,4]")
    sub = command("plot", "a picture of any file", "Draw any file that the other commands wrote.")
    sub.add_argument("file", metavar="FILE", type=Path, help="what to draw: FILE.nc, or a store FILE.zarr")
    _takes_output(sub, "PICTURE", ".png, .pdf or .svg; default: FILE.png in the current folder")
    text = (
        "what to draw of response curves: amplitude (with the phase), first_harmonic, contact, harmonics, "
        "energy or transmitted_force (default: the first there is); of a response: history (default) or orbit"
    )
    sub.add_argument("--quantity", metavar="NAME", action=_Once, help=text)
    _takes_choices(sub)
    _takes_over(sub, "draw")
    sub.add_argument("--log", action="store_true", help="amplitudes of curves on a logarithmic axis")
    text = "Write a map, or a slice of one, as NetCDF or as a table (CSV)."
    sub = command("export", "a slice of a file or a store as NetCDF or CSV", text)
    sub.add_argument("file", metavar="FILE", type=Path, help="what to read: FILE.nc, or a store FILE.zarr")
    _takes_output(sub, "OUT", "OUT.nc or OUT.csv; default: FILE.csv in the current folder")
    _takes_choices(sub)
    _takes_over(sub, "write")
    sub = command("info", "what is in a file", "Print what is in a file, in one screen.")
    sub.add_argument("file", metavar="FILE", type=Path, help="what to read: FILE.nc, or a store FILE.zarr")
    _takes_choices(sub)
    _takes_beginnings(command)
    return parser


def _takes_beginnings(command: Callable[[str, str, str], argparse.ArgumentParser]) -> None:
    """What helps to write configurations and command lines."""
    text = "Write a configuration to begin with, every key explained; it runs as it stands."
    sub = command("init", "a commented configuration to begin with", text)
    text = "file to write; default: map.toml, or rig.toml with --rig, in the current folder"
    sub.add_argument("config", metavar="NAME.toml", type=_file, nargs="?", help=text)
    which = sub.add_mutually_exclusive_group()
    text = f"where the friction acts: {', '.join(CONTACTS)} (default: {CONTACTS[0]})"
    which.add_argument("--contact", choices=CONTACTS, metavar="CONTACT", action=_Once, help=text)
    text = f"of measured data instead, with synthetic data beside it: {', '.join(RIGS)}"
    which.add_argument("--rig", choices=RIGS, metavar="KIND", action=_Once, help=text)
    _takes_replacement(sub)
    text = "Print what a configuration may hold as JSON Schema, by which editors complete and check it."
    sub = command("schema", "a JSON schema of configurations, for editors", text)
    sub.add_argument("--rig", action="store_true", help="of configurations for identify")
    text = "Print what lets a shell complete the command line, for it to read when it starts."
    sub = command("completion", "completion for bash, zsh or fish", text)
    sub.add_argument("shell", choices=SHELLS, metavar="SHELL", help=f"one of {', '.join(SHELLS)}")


class Argument(NamedTuple):
    """An argument of a command, as its help tells it."""

    flags: tuple[str, ...]  # none: by its place
    metavar: str  # empty: takes no value
    choices: tuple[str, ...]
    help: str


class Command(NamedTuple):
    """A command, as its help tells it."""

    name: str
    help: str
    description: str
    usage: str
    arguments: tuple[Argument, ...]


def described() -> Iterator[Command]:
    """Every command with its arguments: for completion and for the manual."""
    parser = _parser()
    (commands,) = (action for action in parser._actions if isinstance(action, argparse._SubParsersAction))
    for listed in commands._choices_actions:
        sub = commands.choices[listed.dest]
        usage = " ".join(sub.format_usage().removeprefix("usage: ").split())
        arguments = tuple(_described(action) for action in sub._actions)
        yield Command(listed.dest, str(listed.help), str(sub.description), usage, arguments)


def _described(action: argparse.Action) -> Argument:
    takes_value = action.nargs != 0
    metavar = str(action.metavar or action.dest.upper()) if takes_value else ""
    choices = tuple(str(choice) for choice in action.choices or ())
    return Argument(tuple(action.option_strings), metavar, choices, str(action.help))


def parse(arguments: Sequence[str]) -> Options:
    """The arguments, checked; help, version and errors end the program."""
    return _parser().parse_args(arguments)
