"""The command line: parses arguments, calls the package, writes files."""

import contextlib
import functools
import math
import shlex
import sys
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError, NoSteadyState
from .arguments import (
    CONTACTS,
    FIGURE,
    QUANTITIES,
    STREAM,
    Options,
    build_parser,
    help_on,
    listed_commands,
    one_line,
    parse,
    unknown_command,
)
from .interrupts import before_exit

if TYPE_CHECKING:
    import xarray as xr

    from ..explorer.scene import Scene
    from ..explorer.stored import StoredPage
    from ..files.config import Config
    from ..files.places import Output
    from ..motions.configuration import Motions, Task
    from ..stores.contents import Contents
    from ..stores.run import Fill
    from ..stores.store import Store
    from .progress import Progress


#: Beginnings of --at that a shell completes: the further axes in most frequent use.
_FURTHER_AXES = ("damping_ratios=", "mass_ratios_2=", "stiffness_ratios_2=", "sample=")

#: Endings of NetCDF files; none is taken for one, too.
_NETCDF = (".nc", ".nc4", "")

#: Number of cells from which the expected cost of a map is printed.
_MANY = 3_000_000


def _finish(ds: "xr.Dataset", config: "Config", options: Options) -> Callable[[Path], None]:
    """Return a function that writes the dataset to a path."""
    from ..files.storage import write_netcdf

    ds.attrs["title"] = config.title
    ds.attrs["config"] = config.text
    return lambda scratch: write_netcdf(ds, scratch, options.command_line)


@contextlib.contextmanager
def _watched(options: Options, what: str, parts: str = "") -> Iterator["Progress"]:
    """Report the progress of work, and that kernels are being compiled; arguments as of `Progress`."""
    from .._kernels.compiler.notices import listening
    from .progress import Progress

    with Progress(what, options.quiet, parts) as progress, listening(progress.compiling):
        yield progress


def _report(options: Options, output: "Output", *summary: str) -> None:
    if not options.quiet:
        _print("\n  ".join((f"{summary[0]}; wrote {output.path}", *summary[1:])))


def _map(options: Options, config: "Config", output: "Output") -> None:
    from ..steady.sweep import sweep

    if config.wall_speed is not None:
        _belt_map(options, config, output)
        return
    points = 1 if config.variations is None else config.variations.count
    cells = points * config.mu.size * config.r.size * config.beta.size

    def run(progress: "Progress") -> "xr.Dataset":
        if cells >= _MANY and not options.quiet:
            progress.say(f"{cells:,} cells need about {_cost(options, config)}", always=True)
        ds = sweep(config.system, config.r, config.beta, config.mu, solver=config.solver,
                   axes=config.variations, threads=options.threads, progress=progress,
                   units=config.units)  # fmt: skip
        return _with_borders(ds, config) if config.borders else ds

    _fill_cells(options, config, output, f"map of {cells:,} cells", run)


def _belt_map(options: Options, config: "Config", output: "Output") -> None:
    """Compute a map over belt speeds without a load."""
    from ..files.belts import describe_belts
    from ..steady.sweep import sweep

    assert config.wall_speed is not None
    cells = config.mu.size * config.wall_speed.size * config.beta.size
    with _watched(options, f"map of {cells:,} cells") as progress:
        ds = sweep(config, threads=options.threads, progress=progress)
        output.fill(_finish(ds, config, options))
    first, *others = describe_belts(ds)
    _report(options, output, f"{first} in {progress.took}", *others)


def _with_borders(ds: "xr.Dataset", config: "Config") -> "xr.Dataset":
    """Add the borders between numbers of stops in the window of [grid]."""
    from ..stop_counts.dataset import with_borders

    return with_borders(ds, config.system, config.beta, config.units)


def _curves(options: Options, config: "Config", output: "Output") -> None:
    from ..steady.curves import curves

    asked = config.curves

    def run(progress: "Progress") -> "xr.Dataset":
        return curves(config.system, config.r, config.beta, config.mu, harmonics=asked.harmonics,
                      quantities=asked.quantities, solver=config.solver, threads=options.threads,
                      progress=progress, units=config.units)  # fmt: skip

    lines = config.mu.size * config.beta.size
    _fill_cells(options, config, output, f"{lines:,} response curves", run)


def _fill_cells(
    options: Options, config: "Config", output: "Output", what: str, run: Callable[["Progress"], "xr.Dataset"]
) -> None:
    """Compute a grid of cells with progress, write it, and print a summary."""
    from ..files.summary import describe_causes, describe_locking, describe_map, describe_reduction

    with _watched(options, what) as progress:
        ds = run(progress)
        output.fill(_finish(ds, config, options), lambda size: progress.writing(output.path, size))
    first = f"{describe_map(ds)} in {progress.took}"
    warned = [*describe_causes(ds), *describe_locking(ds), *describe_reduction(ds)]
    comment = [f"comment: {ds.attrs['comment']}"] if ds.attrs.get("comment") else []
    _report(options, output, first, *warned, *comment)


def _cost(options: Options, config: "Config") -> str:
    from ..steady.cost import in_bytes, in_time, memory_of_map, seconds_of_map

    axes = {"mu": config.mu, "r": config.r, "beta": config.beta}
    counts = {name: axis.size for name, axis in axes.items()}
    counts["points"] = 1 if config.variations is None else config.variations.count
    memory = memory_of_map(counts, config.system.n, tuple(config.solver.outputs), config.units)
    seconds = counts["points"] * seconds_of_map(
        config.system, **axes, solver=config.solver, threads=options.threads
    )
    return f"{in_bytes(memory)} of memory and {in_time(seconds)}"


def _boundaries(options: Options, config: "Config", output: "Output") -> None:
    from ..files.summary import describe_reduction
    from ..steady.boundaries import boundaries

    if config.wall_speed is not None:
        _belt_boundaries(options, config, output)
        return
    frequencies = f"{config.r.size:,} frequenc{'ies' if config.r.size != 1 else 'y'}"
    what = f"boundaries at {frequencies}, {config.mu.size} mu"
    with _watched(options, what) as progress:
        ds = boundaries(config.system, config.r, config.mu, units=config.units)
        if options.borders or config.borders:
            ds = _with_borders(ds, config)
        output.fill(_finish(ds, config, options))
    _report(options, output, f"{what} in {progress.took}", *describe_reduction(ds))


def _belt_boundaries(options: Options, config: "Config", output: "Output") -> None:
    """Find the limits of motions without a load."""
    from ..files.belts import describe_belts
    from ..steady.boundaries import boundaries

    if options.borders:
        config.refuse_belt("find borders between numbers of stops")
    with _watched(options, "limits of the belt"):
        ds = boundaries(config)
        output.fill(_finish(ds, config, options))
    _report(options, output, *describe_belts(ds))


def _response(options: Options, config: "Config", output: "Output") -> None:
    from ..files.summary import describe_locking, describe_response
    from ..steady.response import response

    if options.beta is None:
        raise InputError("--beta must be given, such as --beta 0.5; got nothing")
    mu = _one_mu(config) if options.mu is None else options.mu
    if config.wall_speed is not None or options.wall_speed is not None:
        _belt_response(options, config, output, mu)
        return
    if options.r is None:
        raise InputError("--r must be given, such as --r 0.5; got nothing")
    with _watched(options, "response"):
        ds = response(config.system, options.r, options.beta, mu, solver=config.solver, units=config.units)
        output.fill(_finish(ds, config, options))
    _report(options, output, describe_response(ds), *describe_locking(ds))


def _belt_response(options: Options, config: "Config", output: "Output", mu: float) -> None:
    """Compute a motion on a belt without a load in time."""
    from ..files.belts import describe_belts
    from ..steady.response import response

    if config.wall_speed is None:
        raise InputError("cannot use --wall-speed with grid.r: it is for [grid] wall_speed; give --r instead")
    if options.r is not None or options.wall_speed is None:
        raise InputError("--wall-speed must be given with [grid] wall_speed, in the place of --r; got --r")
    with _watched(options, "response"):
        ds = response(
            config.system, None, options.beta, mu, wall_speed=options.wall_speed, units=config.units
        )
        output.fill(_finish(ds, config, options))
    _report(options, output, *describe_belts(ds))


def _one_mu(config: "Config") -> float:
    """Return the mu of a configuration with a single value."""
    if config.mu.size > 1:
        values = ", ".join(f"{mu:g}" for mu in config.mu[:5])
        raise InputError(f"cannot choose mu: grid.mu has {config.mu.size} values, {values}; give --mu")
    return float(config.mu[0])


def _compute(options: Options) -> None:
    from ..files.config import load_config
    from ..files.places import claimed
    from ..steady.cost import refuse_curves_without_memory, refuse_map_without_memory

    rooms = {"map": refuse_map_without_memory, "curves": refuse_curves_without_memory}
    room = rooms.get(options.command)
    if options.command == "map" and _is_store(options):
        _store(options)
        return
    _refuse_ending(options)
    config = load_config(options.config, options.overrides, None if room and options.yes else room)
    ending = "" if options.command == "map" else f"-{options.command}"
    if config.variations is not None and options.command != "map":
        raise InputError(
            f"cannot run {options.command} with [axes]: [axes] is supported by `map` only; remove it"
        )
    if options.command in _UNDER_LOADS:
        config.refuse_belt(_UNDER_LOADS[options.command])
    path = options.output or Path(f"{config.name}{ending}.nc")
    commands = {"map": _map, "curves": _curves, "boundaries": _boundaries, "response": _response}
    command = commands[options.command]
    with claimed(path, options.overwrite, config.files) as output:
        command(options, config, output)


def _is_store(options: Options) -> bool:
    """Whether a map or spectra go into a store, block by block."""
    stored = options.output is not None and options.output.suffix == ".zarr"
    if not stored and (options.workers or options.scheduler):
        raise InputError("cannot use --workers or --scheduler: they compute stores only; give -o OUT.zarr")
    if options.threads and (options.workers or options.scheduler):
        raise InputError("cannot use --threads with workers: every worker has one thread; omit --threads")
    return stored


def _refuse_ending(options: Options) -> None:
    """Refuse an output that does not end as NetCDF, before any work."""
    path = options.output
    if path is None or path.suffix.lower() in _NETCDF or path == options.config:
        return
    if path.suffix == ".zarr":
        raise InputError(
            f"cannot write {path}: only `map` and `spectrum` can write a .zarr store; use another -o"
        )
    endings = ".nc or .zarr" if options.command in ("map", "spectrum") else ".nc"
    raise InputError(f"-o must end in {endings}; got {path}")


def _store(options: Options) -> None:
    """Compute a map into a store, or resume one."""
    from ..files.config import load_config
    from ..files.studies import describe_cells
    from ..stores.study import study_of

    config = load_config(options.config, options.overrides, lambda *_: None)  # a block is all that is held
    config.refuse_belt("write a store")
    axes = {"mu": config.mu, "r": config.r, "beta": config.beta}
    if config.borders:
        raise InputError(
            f"cannot write borders between numbers of stops into {options.output}: a store has cells only; "
            "use -o with a name that ends in .nc"
        )
    study = study_of(config.system, config.variations, axes, config.solver, config.units)
    store, took = _fill_store(options, study, config.title, f"map of {study.cells:,} cells")
    if not options.quiet:
        first, *others = describe_cells(store.path)
        _print("\n  ".join((f"{first} in {took}; wrote {options.output}", *others)))


def _fill_store(options: Options, contents: "Contents", title: str, what: str) -> tuple["Store", str]:
    """Compute contents into a store, or its missing blocks; return the store and the time in words."""
    from ..stores.cuts import cut_by_cost
    from ..stores.run import fill_store

    find_cut = functools.partial(cut_by_cost, workers=options.workers or 0, threads=options.threads)
    with _watched(options, what) as progress:
        fill = _fill(options, progress)
        store = fill_store(options.output, contents, title, fill, options.overwrite, progress, find_cut)
        return store, progress.took


def _fill(options: Options, progress: "Progress") -> "Fill":
    """Return the function that computes the blocks of a store."""
    from ..stores.run import in_this_process

    if not options.workers and not options.scheduler:
        return in_this_process(options.threads)
    from ..stores import workers

    if options.scheduler:
        return workers.running(options.scheduler, lambda text: progress.say(text, always=True))
    return workers.local(options.workers)


def _explore(options: Options) -> None:
    """Serve the page until interrupted, or save it as a file."""
    from ..explorer.presets import PRESETS, preset_scene

    if options.config is None:
        if options.overrides:
            raise InputError("cannot use --set without CONFIG.toml: it changes a configuration; give one")
        scene: Scene | Motions = preset_scene(next(iter(PRESETS)))
    else:
        scene = _subject(options)
    if options.output is not None:
        _export_page(options, scene)
        return
    for name in ("sliders", "size"):
        if getattr(options, name) is not None:
            raise InputError(f"cannot use --{name} without --export: it is of a saved page; add --export")
    from ..explorer.server import begin, open_server, show

    server = open_server(scene, options.port)
    begin(server.page)
    before_exit(lambda: "page closed")
    _print(f"{scene.title}: {server.url} (end with Ctrl-C)")
    if not options.no_browser:
        show(server.url)
    server.serve_forever()


def _subject(options: Options) -> "Scene | Motions":
    """What the page of a configuration shows: a map, or, with [record] and no [grid], motions in time."""
    from ..explorer.scene import scene_of
    from ..files.config import load_config, read_tree

    tree, _ = read_tree(options.config, options.overrides)
    if "record" not in tree or "grid" in tree:
        # the page has its own grid
        return scene_of(load_config(options.config, options.overrides, lambda *_: None))
    if "spectrum" in tree and "system" not in tree:
        raise InputError(
            "cannot open a page of spectra: it shows motions of one system; use "
            f"frictionmap spectrum {options.config}, or add a table [system]"
        )
    from ..explorer.in_time import check
    from ..motions.configuration import load_motions

    motions = load_motions(options.config, options.overrides)
    check(motions)
    return motions


def _put(content: bytes, path: Path) -> None:
    path.write_bytes(content)


def _export_page(options: Options, scene: "Scene | Motions") -> None:
    from ..explorer.scene import Scene
    from ..explorer.stored import StoredPage, check_page
    from ..files.places import claimed

    if not isinstance(scene, Scene):
        raise InputError(
            "cannot use --export with a configuration of motions in time: their page needs the program; use "
            f"frictionmap history {options.config}, and frictionmap plot"
        )
    if scene.unloaded:
        raise InputError(
            "cannot use --export over grid.wall_speed: saved pages are of maps under loads; use frictionmap "
            f"map {options.config}, and frictionmap plot"
        )
    check_page(options.output)
    page = StoredPage(scene, _keys_of(options.sliders))
    with claimed(options.output, options.overwrite, scene.files) as output:
        output.kept = lambda: _kept_page(output, page)
        with _watched(options, f"page of {scene.title}", "maps") as progress:
            page.compute(progress, only_first=True)
            _ask_for_sliders(options, page)
            page.compute(progress, 1e6 * (options.size or math.inf))
        content = page.page()
        output.kept = lambda: ""
        output.fill(lambda scratch: _put(content, scratch))
    if not options.quiet:
        fewer = f" with {page.done} of {page.count} maps" if page.done < page.count else ""
        _print(f"{progress.took}; wrote {options.output}{fewer} ({len(content) / 1e6:.2g} MB)")


def _keys_of(text: str | None) -> list[str] | None:
    """Keys of sliders that were given; None: all."""
    if text is None:
        return None
    return [] if text == "none" else [key.strip() for key in text.split(",") if key.strip()]


def _ask_for_sliders(options: Options, page: "StoredPage") -> None:
    """State the size that the page will have, and ask on a terminal which sliders it keeps."""
    if options.quiet or sys.stderr is None:
        return
    about = f"{page.count} maps, about {page.expected_size / 1e6:.2g} MB"
    asks = options.sliders is None and options.size is None and len(page.sliders) > 0
    if not (asks and sys.stdin is not None and sys.stdin.isatty() and sys.stderr.isatty()):
        print(f"frictionmap: {about}", file=sys.stderr, flush=True)
        return
    keys = ", ".join(slider.key for slider in page.sliders)
    print(f"frictionmap: {about} with the sliders {keys}", file=sys.stderr)
    question = "Sliders to keep, separated by commas (Enter: all; none: none): "
    print(question, end="", file=sys.stderr, flush=True)
    answer = sys.stdin.readline().strip()
    if answer:
        page.keep(_keys_of(answer))


def _kept_page(output: "Output", page: "StoredPage") -> str:
    """Write the maps so far when the run is interrupted."""
    if page.done == 0:
        return ""
    output.keep(page.page())
    return f"wrote {output.path} with {page.done} of {page.count} maps"


def _reduce(options: Options) -> None:
    """Reduce the matrices of a configuration and write them."""
    from ..files.config import load_config
    from ..files.places import claimed
    from ..steady.reduced import describe_reduced, refuse_unreduced, write_reduced

    path = options.output
    if path is not None and path.suffix.lower() != ".npz":
        raise InputError(f"-o must end in .npz; got {path}")
    config = load_config(options.config, options.overrides)
    config.refuse_belt("state what a reduction costs")
    refuse_unreduced(config.system)
    path = path or Path(f"{config.name}-reduced.npz")
    with claimed(path, options.overwrite, config.files) as output:
        words = describe_reduced(config.system, config.r, config.mu, path)
        output.fill(lambda scratch: write_reduced(config.system, scratch))
    _report(options, output, *words)


def _identify(options: Options) -> None:
    from ..files.estimates import describe_estimates
    from ..files.places import claimed
    from ..files.storage import write_netcdf
    from ..identify.rigs.configuration import identify, load_rig

    _refuse_ending(options)
    rig = load_rig(options.config, options.overrides)
    path = options.output or Path(f"{rig.name}-identify.nc")
    with claimed(path, options.overwrite, rig.files) as output:
        with _watched(options, f"fit of {rig.title}") as progress:
            ds = identify(rig)
        output.fill(lambda scratch: write_netcdf(ds, scratch, options.command_line))
    _report(options, output, f"{rig.title} in {progress.took}", *describe_estimates(ds, options.verbose))


def _design(options: Options) -> None:
    """Answer the question of a configuration; what is written reproduces the answer."""
    from ..design.configuration import load_design
    from ..files.designs import describe_design
    from ..files.places import claimed
    from ..files.storage import write_netcdf

    _refuse_ending(options)
    design = load_design(options.config, options.overrides, options.threads)
    path = options.output or Path(f"{design.name}-design.nc")
    with claimed(path, options.overwrite, design.files) as output:
        with _watched(options, f"design question {design.question}") as progress:
            ds = design.ask()
        ds.attrs |= {"title": design.title, "config": design.text}
        output.fill(lambda scratch: write_netcdf(ds, scratch, options.command_line))
    first = f"{design.title}: {design.question} in {progress.took}"
    _report(options, output, first, *describe_design(ds))


def _history(options: Options) -> None:
    """Follow the motions of a configuration under its records."""
    from ..motions.configuration import load_history

    task = load_history(options.config, options.overrides)
    _follow_records(options, task, f"{task.motions:,} motion{'s' * (task.motions != 1)} in time")


def _spectrum(options: Options) -> None:
    """Compute the friction response spectra of a configuration."""
    from ..files.motions import describe_motions
    from ..files.reading import read
    from ..motions.configuration import load_spectrum
    from ..stores.spectra import spectra_of

    in_store = _is_store(options)
    task, what = load_spectrum(options.config, options.overrides), "spectra of {:,} motions"
    if not in_store:
        _follow_records(options, task, what.format(task.motions))
    elif task.asked is None:
        raise InputError(
            f"cannot write spectra along [axes] into {options.output}: a store is of one damping ratio; use "
            "-o with a name that ends in .nc"
        )
    else:
        spectra = spectra_of(task.asked(), task.wanted, task.text)
        store, took = _fill_store(options, spectra, task.title, what.format(spectra.cells))
        if not options.quiet:
            lines = describe_motions(read(store.path))
            _print("\n  ".join((f"{task.title} in {took}; wrote {options.output}", *lines)))


def _follow_records(options: Options, task: "Task", what: str) -> None:
    from ..files.motions import describe_motions
    from ..files.places import claimed
    from ..files.storage import write_netcdf

    _refuse_ending(options)
    path = options.output or Path(f"{task.name}-{options.command}.nc")
    with claimed(path, options.overwrite, task.files) as output:
        with _watched(options, what) as progress:
            ds = task.ask(threads=options.threads, progress=progress)
        ds.attrs |= {"title": task.title, "config": task.text}
        output.fill(lambda scratch: write_netcdf(ds, scratch, options.command_line))
    _report(options, output, f"{task.title} in {progress.took}", *describe_motions(ds))


def _chosen(options: Options, only: Mapping[str, Collection[str]] | None = None) -> "xr.Dataset":
    """Read the point of a file, or its shares over an axis, selected by the arguments.

    only : the variables to read for a picture; by default all
    """
    from ..files.reading import read
    from ..files.slices import parse_choices
    from ..probabilities import read_shares

    choices = parse_choices(options.at)
    if options.over is None:
        return read(options.file, only, choices, contacts=True)
    return read_shares(options.file, options.over, choices)


def _maps_along(options: Options, names: Collection[str]) -> "xr.Dataset":
    """Read the maps of a file along one of its further axes, with the values that a picture needs."""
    from ..files.reading import opened
    from ..files.slices import choose, parse_choices

    for given, name in ((options.over, "--over"), (options.quantity, "--quantity"), (options.log, "--log")):
        if given:
            raise InputError(f"cannot use {name} with --against: it draws what two contacts do; omit {name}")
    with opened(options.file) as ds:
        part = choose(ds, parse_choices(options.at), options.against, contacts=True, option="--against")
        return part[[name for name in part.data_vars if name in names]].load()


def _plot_structure(options: Options) -> None:
    """Draw the structure of a configuration, or its modes."""
    from ..files.config import common_tables, read_tree
    from ..files.places import claimed
    from ..plot import FORMATS, save_structure

    what = options.quantity or "structure"
    for flag, wrong in (("--at", options.at), ("--against", options.against), ("--log", options.log)):
        if wrong:
            raise InputError(f"cannot use {flag} with a configuration: it is for results; omit it")
    path = options.output or Path(f"{options.file.stem}-{what}.png")
    if path.suffix.lower() not in FORMATS:
        raise InputError(f"-o must end in {', '.join(FORMATS)}; got {path}")
    tables = common_tables(read_tree(options.file)[0], options.file)
    given: Any = {name: getattr(options, name) for name in FIGURE if getattr(options, name) is not None}
    with claimed(path, options.overwrite, [options.file]) as output:
        output.fill(
            lambda scratch: save_structure(
                tables.system, scratch, what, style=options.style, units=tables.units, **given
            )
        )
    if not options.quiet:
        _print(f"wrote {path}")


def _plot(options: Options) -> None:
    if options.file.suffix == ".toml":
        _plot_structure(options)
        return
    from ..files.places import claimed
    from ..plot import check_picture, few_curves, kind, pictured, save_picture

    if options.output is not None:
        check_picture(options.output)
    path = options.output or Path(f"{options.file.stem}.png")
    names, along = pictured(options.quantity), options.against is not None
    ds = _maps_along(options, names["map"]) if along else _chosen(options, names)
    given: Any = {name: getattr(options, name) for name in FIGURE if getattr(options, name) is not None}
    note = ""
    if kind(ds) == "curves" and options.beta is None:
        ds, note = few_curves(ds)
    with claimed(path, options.overwrite, [options.file]) as output:
        output.fill(
            lambda scratch: save_picture(
                ds,
                scratch,
                options.quantity,
                log=options.log,
                against=options.against,
                style=options.style,
                **given,
            )
        )
    if not options.quiet:
        _print(f"wrote {path}{note}")


def _export(options: Options) -> None:
    from ..files.export import check_export, csv_of, in_rows, write_export
    from ..files.places import claimed

    if options.output == STREAM:
        _print(csv_of(_chosen(options), options.everything).rstrip("\n"))
        return
    if options.output is not None:
        check_export(options.output)
    path = options.output or Path(f"{options.file.stem}.csv")
    with claimed(path, options.overwrite, [options.file]) as output:
        ds = _chosen(options)
        output.fill(lambda scratch: write_export(ds, scratch, options.command_line, options.everything))
    if not options.quiet:
        _print(f"wrote {path}{in_rows(ds) if path.suffix.lower() != '.nc' else ''}")


def _info(options: Options) -> None:
    from ..files.in_json import record_json, summary_json
    from ..files.reading import opened, read
    from ..files.slices import choose, parse_choices
    from ..files.studies import describe_study, is_study
    from ..files.summary import describe_file
    from ..motions.formats.files import states_everything

    if options.file.is_file() and states_everything(options.file):
        from ..motions.record import Record

        if options.at:
            raise InputError("cannot use --at with a record: it has no axes; omit it")
        record = Record.read(options.file)
        _print(record_json(record) if options.json else record.summary())
    elif options.json:
        with opened(options.file) as ds:
            _print(summary_json(choose(ds, parse_choices(options.at)) if options.at else ds))
    elif not options.at and is_study(options.file):
        _print(describe_study(options.file, options.verbose))
    else:
        _print(describe_file(read(options.file, at=parse_choices(options.at)), options.verbose))


def _init(options: Options) -> None:
    """Write a starting configuration; for a rig also its synthetic data file."""
    from ..files.places import claimed

    path = options.config or Path("rig.toml" if options.rig else "map.toml")
    _check_template(options)
    if path.suffix != ".toml":
        raise InputError(f"NAME.toml must end in .toml; got {path}")
    if options.rig:
        from ..examples import short_rig, starting_rig

        text, data = (starting_rig if options.full else short_rig)(options.rig)
        texts = {path: text, path.parent / f"{options.rig}.csv": data}
        then = f"frictionmap identify {path}"
    else:
        from ..files.special import SPECIAL, special_configuration
        from ..files.template import short_configuration, short_motion, starting_configuration

        if options.full:
            text = starting_configuration(path.stem, options.contact or CONTACTS[0], options.units)
        else:
            kind = options.contact or options.template or CONTACTS[0]
            one = special_configuration if kind in SPECIAL else short_configuration
            write = short_motion if kind == "history" else functools.partial(one, kind=kind)
            text = write(path.stem, in_units=not options.ratios)
        texts = {path: text}
        then = f"frictionmap explore {path}, or frictionmap map {path} && frictionmap plot {path.stem}.nc"
        if options.template in SPECIAL:  # the page does not show all of them
            then = f"frictionmap map {path} && frictionmap plot {path.stem}.nc"
        if options.template == "history":
            then = f"frictionmap history {path} && frictionmap plot {path.stem}-history.nc"
    with contextlib.ExitStack() as places:
        outputs = [
            places.enter_context(claimed(place, options.overwrite, name="NAME.toml")) for place in texts
        ]
        for output, text in zip(outputs, texts.values(), strict=True):
            output.fill(functools.partial(_write, text=text))
    if not options.quiet:
        _print(f"wrote {', '.join(map(str, texts))}; next: {then}")


def _check_template(options: Options) -> None:
    """Refuse options of short configurations of maps with others."""
    given = [name for name in ("units", "ratios") if options.rig and getattr(options, name)]
    given += [options.template] if options.full and options.template else []
    if given:
        other = "rig" if options.rig else "full"
        raise InputError(
            f"cannot use --{given[0]} with --{other}: it is for a short configuration of a map; omit one"
        )


def _write(scratch: Path, text: str) -> None:
    scratch.write_text(text, encoding="utf-8", newline="\n")


def _schema(options: Options) -> None:
    import json

    if options.rig:
        from ..identify.rigs.keys import rig_schema as schema
    else:
        from ..files.json_schema import map_schema as schema
    _print(json.dumps(schema(), indent=2))


def _help(options: Options) -> None:
    text = help_on(options.verb)
    if text is None:
        raise InputError(unknown_command(options.verb, *listed_commands()))
    _print(text.rstrip("\n"))


def _completion(options: Options) -> None:
    from ..files.keys import KEYS
    from ..identify.rigs.keys import rig_settings
    from .completion import completion

    settings = [f"{section}.{key.name}=" for section, keys in KEYS.items() if section for key in keys]
    words: dict[str, dict[str, Sequence[str]]] = {
        "identify": {"--set": [f"{key}=" for key in rig_settings()]},
        "": {"--set": settings, "--at": _FURTHER_AXES, "--quantity": QUANTITIES},
    }
    _print(completion(build_parser(), options.shell, words))


def _setup(options: Options) -> None:
    """Print what an editor or a shell needs."""
    {"schema": _schema, "completion": _completion}[options.part](options)


def _print(text: str) -> None:
    """Print and flush."""
    try:
        print(text, flush=True)
    except BrokenPipeError:  # the reader has closed the pipe
        raise
    except OSError as error:
        raise OSError(f"cannot print: {error.strerror}; lost output: {text}") from error


def _complain(error: Exception) -> None:
    with contextlib.suppress(OSError):  # stderr is closed
        print(f"frictionmap: {one_line(error) or type(error).__name__}", file=sys.stderr)


def _check_text(arguments: Sequence[str]) -> None:
    """Refuse arguments that no file can record, before any work is done."""
    for argument in arguments:
        try:
            argument.encode()
        except UnicodeEncodeError:
            encoding = sys.getfilesystemencoding().upper()
            raise InputError(f"arguments must be text in {encoding}; got {argument!r}") from None


def _boundaries_alone(options: Options) -> None:
    """Turn `map --boundaries-only` into the command `boundaries`.

    Raises
    ------
    InputError
        Options of cells are given, or --borders without it.
    """
    if not options.boundaries_only:
        if options.borders:
            raise InputError(
                "cannot use --borders with the cells of a map: it is for boundaries alone; "
                "add --boundaries-only, or border_r and border_beta to solver.outputs"
            )
        return
    for name in ("threads", "workers", "scheduler", "yes"):
        if getattr(options, name):
            raise InputError(
                f"cannot use --{name} with --boundaries-only: no cell is computed; omit --{name}"
            )
    options.command = "boundaries"


#: Commands that need a load, and what they do.
_UNDER_LOADS = {"curves": "compute response curves"}

#: Functions of the commands; other commands compute a configuration.
_COMMANDS: dict[str, Callable[[Options], None]] = {
    "plot": _plot,
    "info": _info,
    "reduce": _reduce,
    "identify": _identify,
    "design": _design,
    "history": _history,
    "spectrum": _spectrum,
    "export": _export,
    "explore": _explore,
    "init": _init,
    "setup": _setup,
    "schema": _schema,
    "completion": _completion,
    "help": _help,
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program and return the exit status."""
    given = sys.argv[1:] if arguments is None else list(arguments)
    options = parse(given)
    from ..files.places import abandon

    options.command_line = f"frictionmap {shlex.join(given)}"
    before_exit(abandon)
    try:
        _check_text(given)
        if options.command == "map":
            _boundaries_alone(options)
        _COMMANDS.get(options.command, _compute)(options)
    except InputError as error:
        _complain(error)
        return 2
    except BrokenPipeError:  # the reader has closed the pipe
        return 0
    except (NoSteadyState, OSError, MemoryError) as error:
        _complain(error)
        return 1
    return 0
