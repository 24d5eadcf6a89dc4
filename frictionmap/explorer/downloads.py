"""A view as a configuration, and its map as NetCDF or CSV."""

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import cast

from ..datasets.provenance import configuration, to_toml
from ..errors import InputError
from ..files.config import config_of, parse
from ..files.export import write_export
from ..model.matrices import Matrices
from ..model.settings import Output, Solver
from ..steady.sweep import sweep
from .scene import Scene
from .views import Follower, Piece, Quantity, View

#: Matrices of so many degrees of freedom are put into a configuration; of larger ones only the file is named.
_WRITTEN = 64

#: What every map that is saved has.
_ALWAYS: tuple[Output, ...] = ("regime", "stops_per_cycle", "contact_amplitude")


def _solver(view: View, quantity: Quantity) -> Solver:
    wanted = dict.fromkeys((*_ALWAYS, *filter(None, (quantity.output,))))
    return replace(view.solver, outputs=cast(tuple[Output, ...], tuple(wanted)))


def configuration_text(scene: Scene, view: View, quantity: Quantity, piece: Piece) -> str:
    """A configuration whose map is that of the view, cell by cell to the bit.

    Raises
    ------
    InputError
        The system is larger than text should hold, and comes from no file.
    """
    axes = view.axes(piece.columns, piece.rows)
    of_grid = {name: axes[name] for name in ("r", "beta", "mu")}
    solver = _solver(view, quantity)
    if _is_large(view):
        return _with_files(
            scene, configuration(scene.title, scene.system, of_grid, solver, units=scene.units)
        )
    text = configuration(scene.title, view.system, of_grid, solver, units=scene.units)
    loaded = config_of(text, {})
    again = {"r": loaded.r, "beta": loaded.beta, "mu": loaded.mu}
    if configuration(scene.title, loaded.system, again, loaded.solver, units=loaded.units) != text:
        raise InputError("this view has no configuration that gives it again")
    return text


def _is_large(view: View) -> bool:
    return isinstance(view.system.matrices, Matrices) and view.system.n > _WRITTEN


def _with_files(scene: Scene, text: str) -> str:
    """The grid and the solver of `text`, with the system as its own configuration gives it."""
    if scene.config is None:
        raise InputError(f"a system of {scene.system.n} degrees of freedom is too large to be put into text")
    of_view = parse("\n".join(line for line in text.splitlines() if not line.startswith("#")))
    tree = {**parse(scene.config.text), "grid": of_view["grid"], "solver": of_view["solver"]}
    tree.pop("axes", None)
    return to_toml(tree)


def saved_map(
    scene: Scene, view: View, quantity: Quantity, piece: Piece, ending: str, follower: Follower
) -> bytes:
    """The map of a view as a file: `ending` is .nc or .csv."""
    axes = view.axes(piece.columns, piece.rows)
    ds = sweep(view.system, axes["r"], axes["beta"], axes["mu"], solver=_solver(view, quantity),
               units=scene.units, progress=follower.progress)  # fmt: skip
    ds.attrs["title"] = scene.title
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"map{ending}"
        write_export(ds, path, "frictionmap explore")
        return path.read_bytes()
