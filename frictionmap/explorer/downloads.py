"""Downloads: a view as a configuration, its map as NetCDF or CSV."""

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import cast

from ..datasets.labels import BOUNDARIES, MEASURE_OF
from ..datasets.provenance import configuration, to_toml
from ..errors import InputError
from ..files.config import config_of, parse, read_system
from ..files.export import write_export
from ..model.matrices import Matrices
from ..model.settings import Output, Solver
from ..no_load.sweep import belt_map
from ..steady.sweep import swept
from ..units.scales import scales_of
from .quantities import CellQuantity
from .scene import Scene
from .views import Follower, Piece, View

#: Largest number of degrees of freedom whose matrices are written to a configuration, not only their file.
_WRITTEN = 64

#: Outputs of every saved map.
_ALWAYS: tuple[Output, ...] = ("regime", "stops_per_cycle", "contact_amplitude")

#: Outputs that NetCDF packs into next to nothing.
_CODES = ("regime", "stops_per_cycle")

#: Bytes of a number of a table, of one of a cell in NetCDF, and of all else there; measured: a
#: number of a table has 10.6 to 13.6 bytes.
_PER_NUMBER, _PER_FLOAT, _PER_FILE = 12.0, 5.0, 60e3


#: Numbers of a cell without a load, about.
_OF_BELTS = 25


def _solver(view: View, quantity: CellQuantity) -> Solver:
    wanted = dict.fromkeys((*_ALWAYS, *filter(None, (quantity.output,))))
    return replace(view.solver, outputs=cast(tuple[Output, ...], tuple(wanted)))


def _described(scene: Scene, view: View, quantity: CellQuantity, piece: Piece) -> str:
    """Configuration of a view; matrices too large for text become a comment."""
    axes = view.axes(piece.columns, piece.rows)
    of_grid = {view.across.key: axes["r"], "beta": axes["beta"], "mu": axes["mu"]}
    if view.unloaded:
        return configuration(scene.title, view.system, of_grid, units=scene.units)
    return configuration(scene.title, view.system, of_grid, _solver(view, quantity), units=scene.units)


def configuration_text(scene: Scene, view: View, quantity: CellQuantity, piece: Piece) -> str:
    """A configuration whose map is that of the view, cell by cell to the bit.

    Raises
    ------
    InputError
        The system is larger than text should hold, and comes from no file, or from files that have changed.
    """
    text = _described(scene, view, quantity, piece)
    if _is_large(view):
        return _with_files(scene, view, text)
    loaded = config_of(text, {})
    across = loaded.r if loaded.wall_speed is None else loaded.wall_speed
    again = {view.across.key: across, "beta": loaded.beta, "mu": loaded.mu}
    solver = None if view.unloaded else loaded.solver
    found = configuration(scene.title, loaded.system, again, solver, units=loaded.units)
    if _uncommented(found) != _uncommented(text):
        raise InputError(
            "cannot save this view: no configuration reproduces it exactly; save its cells instead"
        )
    return text


def _uncommented(text: str) -> str:
    """Remove comments from a configuration, such as those on the reduction of a structure."""
    return "\n".join(line for line in text.splitlines() if not line.startswith("#"))


def _is_large(view: View) -> bool:
    return isinstance(view.system.matrices, Matrices) and view.system.n > _WRITTEN


def _with_files(scene: Scene, view: View, text: str) -> str:
    """Configuration of the view that `text` describes, with matrices by the names of their files."""
    if scene.config is None:
        raise InputError(
            f"cannot save this view: its matrices ({scene.system.n} degrees of freedom) are too large for "
            "a configuration; save its cells instead"
        )
    given = parse(scene.config.text)
    of_view = parse(_uncommented(text))
    of_files = {key: given["system"][key] for key in ("matrices", "reduce") if key in given["system"]}
    if view.system.load is not None:  # on all masses of the files, of which a reduced structure has fewer
        of_files["load"] = view.system.load
    tree = {**given, **of_view, "system": {**of_view["system"], **of_files}}
    tree.pop("axes", None)
    written = to_toml(tree)
    if read_system(parse(written)["system"], scene.config.files[0].parent) != view.system:
        raise InputError(
            "cannot save this view: the files of its matrices have changed; restart frictionmap explore"
        )
    return written


def sizes(scene: Scene, view: View, quantity: CellQuantity, piece: Piece) -> dict[str, float]:
    """Estimate the bytes of the files of `saved_map` by format; fewer where many cells stick."""
    scales = scales_of(scene.units, view.system)
    if view.unloaded:
        cells = piece.columns * piece.rows
        return {"csv": _PER_NUMBER * _OF_BELTS * cells, "nc": _PER_FILE + _PER_FLOAT * _OF_BELTS * cells}
    outputs = _solver(view, quantity).outputs
    masses = view.system.n if "amplitude" in outputs else 1
    contacts = view.system.contact_system.count

    def copies(name: str) -> int:
        """Number of variables: the ratio, and its value in SI units if known."""
        return 1 + (name in MEASURE_OF and scales.of(MEASURE_OF[name]) is not None)

    axes = sum(1 + (scales.of(measure) is not None) for measure in ("frequency", "force"))
    several = (contacts - 1) * len(outputs)
    # a table has a column for each mass, and no ratio where there is a value in SI units
    numbers = axes + len(("mu",)) + masses - 1 + several + len((*outputs, *BOUNDARIES))
    floats = sum(
        copies(name) * (masses if name == "amplitude" else contacts) for name in outputs if name not in _CODES
    )
    cells = piece.columns * piece.rows
    return {
        "csv": _PER_NUMBER * numbers * cells,
        "nc": _PER_FILE + _PER_FLOAT * floats * cells,
    }


def saved_map(
    scene: Scene, view: View, quantity: CellQuantity, piece: Piece, ending: str, follower: Follower
) -> bytes:
    """The map of a view as a file: `ending` is .nc or .csv."""
    axes = view.axes(piece.columns, piece.rows)
    given = axes["r"], axes["beta"], axes["mu"]
    if view.unloaded:
        mu, speed, beta = axes["mu"], axes["r"], axes["beta"]
        ds = belt_map(view.system, speed, beta, mu, scene.units, None, follower.progress)
    else:
        ds = swept(view.system, given, _solver(view, quantity), None, None, follower.progress, scene.units,
                   follower.watch)  # fmt: skip
    ds.attrs |= {"title": scene.title, "config": _described(scene, view, quantity, piece)}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"map{ending}"
        follower.watch()
        write_export(ds, path, "frictionmap explore")
        return path.read_bytes()
