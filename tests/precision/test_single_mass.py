"""Maps of one mass with one rigid contact at mu = 1, whose cells are solved by tables of their frequency,
against independent values and against the general solver, which responses use.
"""

import cmath
import math

import numpy as np
import pytest

import frictionmap as fm
from benchmarks.measures.own_entry import own_entry
from frictionmap._kernels.compiler.packed import packed
from frictionmap._kernels.general.problem import H
from frictionmap._kernels.general.record import make_record
from frictionmap._kernels.general.return_map import make_return
from frictionmap._kernels.general.row import make_row, set_row
from frictionmap._kernels.general.single_mass import solve_single
from frictionmap._kernels.general.single_tables import fits_row, make_single
from frictionmap.general.problem import problem_of

OUTPUTS = [
    "regime", "stops_per_cycle", "turns_per_cycle", "stuck_fraction", "midpoint", "peak_to_peak",
    "sliding_distance", "status",
]  # fmt: skip


def one_mass(load, zeta, kind="fixed-wall"):
    further = {"load_harmonics": {n: [value] for n, value in load.items()}} if kind == "fixed-wall" else {}
    return fm.System(contacts=[fm.Contact(kind, 1)], damping_ratios=zeta, **further)


def extremes(cell):
    half = 0.5 * float(cell.peak_to_peak.item())
    return float(cell.midpoint.item()) - half, float(cell.midpoint.item()) + half


def test_printed_steady_state():
    load = {1: 1.0, 2: cmath.rect(0.6, math.radians(-70.0))}
    cell = fm.sweep(one_mass(load, 0.05), [1.191], [1.00442], outputs=OUTPUTS)
    assert cell.stops_per_cycle.item() == 2
    assert cell.stuck_fraction.item() == pytest.approx(0.45154034026, abs=1e-7)  # stored as float32
    assert extremes(cell) == pytest.approx((-0.03732371066, 0.17594857068), abs=2e-11)


def test_rows_of_independent_programs(reference_table):
    content = reference_table("loads.json")
    tried = 0
    for row in content["rows"]:
        if row["system"] != "sdof" or row["mu"] != 1.0 or row["wall_velocity"] or row["permanently_stuck"]:
            continue
        load = {int(n): complex(*value[0]) for n, value in row["harmonics"].items()}
        cell = fm.sweep(one_mass(load, row["zeta"]), [row["r"]], [row["beta"]], outputs=OUTPUTS)
        assert cell.stops_per_cycle.item() == row["stops_per_cycle"]
        low, high = extremes(cell)
        size = max(abs(row["x_max"][0]), abs(row["x_min"][0]))
        offset = row["offset"][0]
        assert abs(high + offset - row["x_max"][0]) <= 1e-10 * size
        assert abs(low + offset - row["x_min"][0]) <= 1e-10 * size
        tried += 1
    assert tried > 10


def test_maps_equal_the_general_solver():
    rng = np.random.default_rng(24)
    compared = 0
    for _ in range(20):
        orders = rng.choice(np.arange(1, 8), rng.integers(1, 5), replace=False)
        load = {int(n): complex(*rng.normal(size=2)) / n for n in orders}
        system = one_mass(load, float(rng.choice([0.0, 0.003, 0.03, 0.3, 1.0, 1.4])))
        r = float(rng.uniform(0.2, 2.5))
        row = fm.sweep(system, [r], np.sort(rng.uniform(0.02, 1.5, 12)), outputs=OUTPUTS)
        for k in range(row.beta.size):
            cell = row.isel(beta=k)
            if cell.regime != 1 or cell.status != 0:
                continue
            motion = fm.response(system, r, float(cell.beta))
            assert cell.stops_per_cycle.item() == motion.stops_per_cycle.item()
            z = motion.z.values
            low, high = extremes(cell)
            assert (z.max() - high, z.min() - low) == pytest.approx((0.0, 0.0), abs=1e-3)  # samples
            assert cell.sliding_distance.item() == pytest.approx(float(motion.sliding_distance), rel=1e-10)
            assert cell.stuck_fraction.item() == pytest.approx(float(motion.stuck_fraction), abs=1e-6)
            compared += 1
    assert compared > 60


def test_a_wall_that_moves_with_the_base():
    """A joined base-wall: the tables contain the acceleration of the wall."""
    general = one_mass({}, 0.03, "joined-base-wall")
    plain = fm.System("joined-base-wall", (1,), damping_ratios=0.03)
    r, beta = np.linspace(0.3, 2.2, 5), np.linspace(0.05, 0.9, 12)
    names = ["regime", "stops_per_cycle", "contact_amplitude"]
    found, wanted = (fm.sweep(system, r, beta, outputs=names) for system in (general, plain))
    assert np.array_equal(found.stops_per_cycle, wanted.stops_per_cycle, equal_nan=True)
    assert np.abs(found.contact_amplitude - wanted.contact_amplitude).max() < 1e-11


# Arguments are packed as in maps: of other types, the kernels would be compiled once more.


@own_entry
def fill_tables(problem, row, single):
    """Fill the row of the only frequency, and its tables for two half periods; whether they fit."""
    problem, row, single = packed(problem), packed(row), packed(single)
    set_row(problem, 0, row)
    return fits_row(problem, row, single, 2)


@own_entry
def solve_by_tables(problem, row, single, beta, memory, record):
    """What `solve_single` returns."""
    problem, row, single = packed(problem), packed(row), packed(single)
    return solve_single(problem, row, single, beta, packed(memory), packed(record), 0)


@pytest.mark.plain
def test_the_tables_solve_a_cell():
    """From a state that is 1e-4 off, without the general solver."""
    system = one_mass({1: 1.0, 2: 0.35j}, 0.05)
    beta, r = 0.5, 0.8
    problem, _ = problem_of(system, np.array([r]))
    masses = np.empty((0, 1))
    row, memory, record = make_row(problem), make_return(problem), make_record(problem, masses, 0)
    single = make_single(problem, 0)
    assert fill_tables(problem, row, single)
    motion = fm.response(system, r, beta)
    tau = motion.tau.values
    section = 0.37
    h = row.numbers[H]
    memory.start[0, 0] = np.interp(section, tau, motion.z.values) + 1e-4
    memory.start[1, 0] = h * np.interp(section, tau, motion.v.values[0])
    memory.senses[0] = int(np.sign(memory.start[1, 0]))
    found, cycles, multiplier = solve_by_tables(problem, row, single, beta, memory, record)
    assert found
    assert cycles <= 6.0
    assert 0.0 <= multiplier < 1.0
    assert record.distance[0] == pytest.approx(float(motion.sliding_distance), rel=1e-10)


@pytest.mark.parametrize(("load", "r"), [({1: 1.0, 3: 0.2}, 1.0), ({1: 0.3, 2: 1.0}, 0.5)])
def test_an_undamped_resonance_has_no_steady_state_of_any_size(load, r):
    """Below beta = pi/4 of the resonant harmonic every motion grows; above it the contact stops."""
    found = fm.sweep(one_mass(load, 0.0), [r], np.linspace(0.05, 1.0, 20), outputs=OUTPUTS).squeeze()
    solved = found.status.values == 0
    limit = np.pi / 4.0 * max(abs(value) for n, value in load.items() if n * r == 1.0)
    assert not solved[found.beta.values < limit].any()
    assert solved[found.beta.values > 1.05 * limit].all()
    assert (found.stops_per_cycle.values[solved] >= 1.0).all()
    assert found.peak_to_peak.values[solved].max() < 20.0


def test_the_boundary_to_sticking_ends_no_interval_without_stops():
    load = {1: 1.0, 5: 0.25j}
    limits = fm.boundaries(one_mass(load, 0.3), [1.5075187969924813])
    begins = limits.no_stop_begin.values.ravel()
    assert begins[0] == 0.0
    assert np.isnan(begins[1:]).all()
    assert np.isfinite(limits.no_stop_end.values.ravel()[0])


def test_a_cell_does_not_depend_on_the_cells_before_it():
    system = one_mass({1: 1.0, 2: 0.3}, 0.0)
    few = fm.sweep(system, [1.000001], [0.5, 0.7, 0.9], outputs=OUTPUTS)
    many = fm.sweep(system, [1.000001], np.linspace(0.6, 0.9, 31), outputs=OUTPUTS)
    last = [ds.isel(beta=-1).squeeze() for ds in (few, many)]
    assert [ds.status.item() for ds in last] == [0, 0]
    assert last[0].peak_to_peak.item() == pytest.approx(last[1].peak_to_peak.item(), rel=1e-9)
