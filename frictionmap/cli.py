"""The command line: parses, calls, writes; no logic of its own."""

import contextlib
import shlex
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from .arguments import Options, one_line, parse
from .errors import InputError, NoSteadyState

if TYPE_CHECKING:
    import xarray as xr

    from .config import Config
    from .outputs import Output


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


def _save(ds: "xr.Dataset", config: "Config", options: Options, output: "Output", *summary: str) -> None:
    from .storage import write_netcdf

    ds.attrs["title"] = config.title
    ds.attrs["config"] = config.text
    output.fill(lambda scratch: write_netcdf(ds, scratch, options.command_line))
    if not options.quiet:
        print("\n  ".join((f"{summary[0]}; wrote {output.path}", *summary[1:])))


def _map(options: Options, config: "Config", output: "Output") -> None:
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


def _boundaries(options: Options, config: "Config", output: "Output") -> None:
    from .curves import boundaries

    ds = boundaries(config.system, config.r, config.mu)
    _save(ds, config, options, output, f"{ds.sizes['r']:,} frequencies, {ds.sizes['mu']} mu")


def _response(options: Options, config: "Config", output: "Output") -> None:
    from .steady import response
    from .summary import describe_response

    mu = _one_mu(config) if options.mu is None else options.mu
    ds = response(config.system, options.r, options.beta, mu, solver=config.solver)
    _save(ds, config, options, output, describe_response(ds))


def _one_mu(config: "Config") -> float:
    """The mu of a configuration that has one."""
    if config.mu.size > 1:
        values = ", ".join(f"{mu:g}" for mu in config.mu[:5])
        raise InputError(f"--mu must be given where grid.mu has {config.mu.size} values; they are {values}")
    return float(config.mu[0])


def _compute(options: Options) -> None:
    from .config import load_config
    from .outputs import claimed

    config = load_config(options.config, options.overrides)
    ending = "" if options.command == "map" else f"-{options.command}"
    path = options.output or Path(f"{config.name}{ending}.nc")
    command = {"map": _map, "boundaries": _boundaries, "response": _response}[options.command]
    with claimed(path, options.overwrite, config.files) as output:
        command(options, config, output)


def _plot(options: Options) -> None:
    from .outputs import claimed
    from .plot import PICTURED, check_picture, save_picture
    from .reading import read

    ds = read(options.file, only=PICTURED)
    path = options.output or Path(f"{options.file.stem}.png")
    check_picture(path)
    with claimed(path, options.overwrite, [options.file]) as output:
        output.fill(lambda scratch: save_picture(ds, scratch))
    if not options.quiet:
        print(f"wrote {path}")


def _info(options: Options) -> None:
    from .reading import read
    from .summary import describe_file

    print(describe_file(read(options.file)))


def _complain(error: Exception) -> None:
    with contextlib.suppress(OSError):  # nobody to hear it
        print(f"frictionmap: {one_line(error) or type(error).__name__}", file=sys.stderr)


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
    options = parse(given)
    options.command_line = f"frictionmap {shlex.join(given)}"
    run = {"plot": _plot, "info": _info}.get(options.command, _compute)
    try:
        _check_text(given)
        run(options)
    except InputError as error:
        _complain(error)
        return 2
    except BrokenPipeError:  # whoever reads what we print has had enough
        return 0
    except (NoSteadyState, OSError, MemoryError) as error:
        _complain(error)
        return 1
    return 0
