"""The command line: parses, calls, writes; no logic of its own."""

import argparse
import os
import shlex
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from .errors import InputError, NoSteadyState
from .version import __version__

if TYPE_CHECKING:
    import xarray as xr

    from .config import Config

_DESCRIPTION = """\
Exact regime maps of a vibrating structure with one dry-friction contact: does it slide without stopping,
stick and slip, or stick for good, over frequency ratio r, friction ratio beta and static/kinetic ratio mu?"""

_EPILOG = """\
example:
  frictionmap map configs/fig-3-12.toml && frictionmap plot fig-3-12.nc

exit status: 0 done, 2 the input is at fault, 130 interrupted, 1 anything else"""


def _one_line(message: object) -> str:
    """A message without the line breaks that a name or a key put into it."""
    return " ".join(str(message).split())


class _Parser(argparse.ArgumentParser):
    """argparse, with errors on one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {_one_line(message)} (see {self.prog} --help)\n")


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

    def takes_config(sub: argparse.ArgumentParser) -> None:
        sub.add_argument("config", metavar="CONFIG.toml", type=Path, help="what to compute")
        text = "file to write; default: named after CONFIG, in the current folder"
        sub.add_argument("-o", dest="output", metavar="OUT.nc", type=Path, help=text)
        text = "override a key of CONFIG, e.g. --set grid.r.step=0.01; repeatable"
        sub.add_argument(
            "--set", dest="overrides", metavar="KEY=VALUE", action="append", default=[], help=text
        )
        sub.add_argument("--overwrite", action="store_true", help="replace an existing output")
        sub.add_argument("--quiet", action="store_true", help="print nothing but errors")

    text = "Classify every cell of a grid and count its stops per cycle; write NetCDF."
    sub = command("map", "classify every cell of a grid", text)
    takes_config(sub)
    text = "threads to use (default: all processors); the result is the same to the bit"
    sub.add_argument("--threads", metavar="N", type=int, help=text)
    text = "Compute the boundaries of the regimes over frequency (no cell is classified); write NetCDF."
    sub = command("boundaries", "curves only", text)
    takes_config(sub)
    sub = command("response", "one steady state in time", "Compute one steady state in time; write NetCDF.")
    takes_config(sub)
    sub.add_argument("--r", type=float, required=True, help="frequency ratio, > 0")
    sub.add_argument("--beta", type=float, required=True, help="friction ratio, >= 0")
    text = "static over kinetic friction, >= 1 (default: 1)"
    sub.add_argument("--mu", type=float, default=1.0, help=text)
    sub = command("plot", "a picture of any file", "Draw any file that the other commands wrote.")
    sub.add_argument("file", metavar="FILE.nc", type=Path)
    text = ".png, .pdf or .svg; default: FILE.png in the current folder"
    sub.add_argument("-o", dest="output", metavar="PICTURE", type=Path, help=text)
    sub.add_argument("--overwrite", action="store_true", help="replace an existing picture")
    sub.add_argument("--quiet", action="store_true", help="print nothing but errors")
    sub = command("info", "what is in a file", "Print what is in a file, in one screen.")
    sub.add_argument("file", metavar="FILE.nc", type=Path)
    return parser


class _Progress:
    """A line on standard error, if that is a terminal and the work takes long."""

    def __init__(self, quiet: bool) -> None:
        self.shown = False
        self.active = sys.stderr.isatty() and not quiet
        self.next = time.monotonic() + 0.5

    def __call__(self, done: int, total: int) -> None:
        if self.active and time.monotonic() >= self.next:
            self.shown = True
            self.next = time.monotonic() + 0.1
            share = 100.0 * done / max(total, 1)
            print(f"\r{share:5.1f} %  {done:,} of {total:,} cells", end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        if self.shown:
            print("\r" + " " * 60 + "\r", end="", file=sys.stderr, flush=True)


def _save(
    ds: "xr.Dataset", config: "Config", options: argparse.Namespace, output: Path, *summary: str
) -> None:
    from .storage import write

    ds.attrs["title"] = config.title
    ds.attrs["config"] = config.text
    write(ds, output, options.command_line)
    if not options.quiet:
        print("\n  ".join((f"{summary[0]}; wrote {output}", *summary[1:])))


def _map(options: argparse.Namespace, config: "Config", output: Path) -> None:
    from .maps import sweep
    from .summary import describe_causes, describe_map

    progress = _Progress(options.quiet)
    began = time.perf_counter()
    try:
        ds = sweep(config.system, config.r, config.beta, config.mu, solver=config.solver,
                   threads=options.threads, progress=progress)  # fmt: skip
    finally:
        progress.end()
    took = time.perf_counter() - began
    _save(ds, config, options, output, f"{describe_map(ds)} in {took:.2g} s", *describe_causes(ds))


def _boundaries(options: argparse.Namespace, config: "Config", output: Path) -> None:
    from .curves import boundaries

    ds = boundaries(config.system, config.r, config.mu)
    _save(ds, config, options, output, f"{ds.sizes['r']:,} frequencies, {ds.sizes['mu']} mu")


def _response(options: argparse.Namespace, config: "Config", output: Path) -> None:
    from .steady import response
    from .summary import describe_response

    ds = response(config.system, options.r, options.beta, options.mu, solver=config.solver)
    _save(ds, config, options, output, describe_response(ds))


def _compute(options: argparse.Namespace) -> None:
    from .config import load_config
    from .storage import check_output

    config = load_config(options.config, options.overrides)
    ending = "" if options.command == "map" else f"-{options.command}"
    output = options.output or Path(f"{config.name}{ending}.nc")
    check_output(output, options.overwrite)
    command = {"map": _map, "boundaries": _boundaries, "response": _response}[options.command]
    command(options, config, output)


def _plot(options: argparse.Namespace) -> None:
    from .reading import read
    from .storage import check_output

    ds = read(options.file)
    output = options.output or Path(f"{options.file.stem}.png")
    check_output(output, options.overwrite)
    from .plot import save_picture

    save_picture(ds, output)
    if not options.quiet:
        print(f"wrote {output}")


def _info(options: argparse.Namespace) -> None:
    from .reading import read
    from .summary import describe_file

    print(describe_file(read(options.file)))


def _complain(error: Exception) -> None:
    print(f"frictionmap: {_one_line(error) or type(error).__name__}", file=sys.stderr)


def _check_text(arguments: Sequence[str]) -> None:
    """Refuse what no file could record, before any work is done."""
    for argument in arguments:
        try:
            argument.encode()
        except UnicodeEncodeError:
            raise InputError(f"arguments must be text in UTF-8; got {argument!r}") from None


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program; the exit status."""
    given = sys.argv[1:] if arguments is None else list(arguments)
    options = _parser().parse_args(given)
    options.command_line = f"frictionmap {shlex.join(given)}"
    run = {"plot": _plot, "info": _info}.get(options.command, _compute)
    try:
        _check_text(given)
        run(options)
    except InputError as error:
        _complain(error)
        return 2
    except (NoSteadyState, OSError, MemoryError) as error:
        _complain(error)
        return 1
    except KeyboardInterrupt:
        print("frictionmap: interrupted; nothing was written", file=sys.stderr, flush=True)
        os._exit(130)  # without waiting for what the threads are in the middle of
    return 0
