"""Maps on a belt without a load: what their cells and lines show, over belt speed and friction."""

import time
from typing import Any

import numpy as np

from .. import regimes
from ..no_load.belts import belts_of, is_one_mass, is_phases
from ..no_load.limits import sliding_limits, slope_limits_of
from ..no_load.one_mass import cycle_speed_limits
from ..no_load.sweep import Given, checked, friction_of, law_of, values_of_cells
from .belt_classes import classes_of_cells
from .scene_parts import CellQuantity, Line
from .views import Follower, Piece, View, middles

#: Values of friction at which a belt speed is drawn: each one takes the time of some cells.
_SPEEDS = 80


def given_of(view: View, wall_speed: np.ndarray, beta: np.ndarray) -> Given:
    """The system of a view on belts with these axes."""
    return checked(view.system, wall_speed, beta, [view.mu], None)


def solve(view: View, piece: Piece, follower: Follower) -> dict[str, np.ndarray]:
    """The cells of a piece (columns, rows): `classes`, and the quantities.

    A quantity of cells in steady sliding is NaN, as nothing vibrates there; so is the growth of a small
    vibration where it decays.
    """
    piece.check()
    axes = view.axes(piece.columns, piece.rows)
    given = given_of(view, axes["r"][piece.first : piece.last], axes["beta"])
    values = values_of_cells(given, None, follower.progress, follower.watch)
    found = {name: one[0] for name, one in values.items()}  # of the only mu
    several = len(given.belts.groups) > 1
    if several and view.shown is not None:
        found |= {name: found[name][..., view.shown] for name in ("z_max", "z_min", "stuck_fraction")}
        found |= {name: found[name][..., view.shown] for name in ("open_fraction",) if name in found}
    moves = np.isin(found["regime"], (regimes.STICK_SLIP_CYCLE, regimes.CYCLE_WITHOUT_STOPS))
    if view.shown is not None:
        found["contact_peak_to_peak"] = np.where(moves, found["z_max"] - found["z_min"], np.nan)
        found["stuck_fraction"] = np.where(moves, found["stuck_fraction"], np.nan)
    whole = found["x_max"] - found["x_min"]
    found["peak_to_peak"] = np.where(moves[..., np.newaxis], whole, np.nan)
    found["growth"] = np.where(found["growth"] > 0.0, found["growth"], np.nan)
    found["classes"] = classes_of_cells(found["regime"], found["also_reachable"])
    return found


def piece_of_map(
    view: View, quantity: CellQuantity, piece: Piece, follower: Follower, lines: int = 0
) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """A piece of a picture for the page; see `pieces.piece_of_map`."""
    began = time.perf_counter()
    found = solve(view, piece, follower)
    seconds = time.perf_counter() - began
    arrays = {"classes": found["classes"]}
    if quantity.output:
        values = found[quantity.output]
        arrays["values"] = (values if quantity.row is None else values[..., quantity.row]).astype(np.float32)
    if lines:
        arrays |= packet_of_lines(view, lines)
    return {"first": piece.first, "last": piece.last, "seconds": seconds, "stops": {}}, arrays


def lines_of(view: View) -> tuple[Line, ...]:
    """The limits that a view has: of one contact with a constant normal force."""
    if view.system.contact_system.count > 1 or is_phases(view.system):
        return ()
    sliding = Line(("beta_sliding_lim",), "slide", (7, 4), "at or above: steady sliding is unstable")
    if not is_one_mass(view.system):
        return (sliding,)
    meaning = "at higher belt speeds: no stick-slip cycle"
    return (Line(("cycle_speed_lim",), "cycle", (), meaning, "v", upright=True), sliding)


def limits_of(view: View, speed: np.ndarray, beta: np.ndarray) -> dict[str, np.ndarray]:
    """The limits of a view by name: `beta_sliding_lim` over belt speed, `cycle_speed_lim` over beta."""
    names = {name for line in lines_of(view) for name in line.names}
    belts, found = belts_of(view.system), {}
    if "beta_sliding_lim" in names:
        slope, one_mass = slope_limits_of(view.system, belts), is_one_mass(view.system)
        found["beta_sliding_lim"] = sliding_limits(belts, slope.limit, speed, one_mass)
    if "cycle_speed_lim" in names:
        kinetic, ratio = friction_of(belts, beta, np.array([view.mu]))
        found["cycle_speed_lim"] = cycle_speed_limits(law_of(belts), view.system.zeta, ratio, kinetic)[0]
    return found


def packet_of_lines(view: View, count: int) -> dict[str, np.ndarray]:
    """The limits over the complete view: `line_sliding_lim`, `line_cycle_speed_lim`."""
    beta = middles(view.beta, min(count, _SPEEDS), "lines")
    found = limits_of(view, middles(view.r, count, "lines"), beta)
    return {f"line_{name.removeprefix('beta_')}": line for name, line in found.items()}


def one_cell(view: View, speed: float, beta: float) -> int:
    """The class of one cell."""
    values = values_of_cells(given_of(view, np.array([speed]), np.array([beta])), 1, None)
    return int(classes_of_cells(values["regime"], values["also_reachable"]).item())
