"""The driver: answers do not depend on how the work is cut, nor on what else is asked for."""

import itertools
import math

import numpy as np
import pytest

import frictionmap as fm
from frictionmap._kernels.engine import segment_table
from frictionmap._kernels.engine.fill import RESTART, one_cell
from frictionmap.datasets.labels import CELL_VARIABLES
from frictionmap.model.settings import OUTPUTS, Solver
from frictionmap.single.cells import Cells, limits
from frictionmap.single.maps import TILE, plan

ONE = fm.System("joined-base-wall", damping_ratios=0.001)
FIVE = fm.System(contact_masses=[2], mass_ratios=[1.0] * 5, stiffness_ratios=[1.0] * 5, damping_ratios=0.02)

#: Asked for without details this cell was answered with a period of 4, that of the moving start.
DRIFTING = (0.3538952175712172, 0.019093464571616342, 2.50808283808355)

BASIC = OUTPUTS[: OUTPUTS.index("multiplier")]


def same_bits(one, other):
    for name in one.data_vars:
        assert one[name].values.tobytes() == other[name].values.tobytes(), name


# How the work is cut


@pytest.mark.parametrize("system", [ONE, FIVE], ids=["one mass", "five masses"])
def test_blocks_of_rows_are_the_same_part_of_the_whole(system):
    """To the bit, how it was found included, in rows of many open cells and of few."""
    r = np.array([0.11, 0.35, 0.9, 1.3, 1.9] if system is ONE else [0.4, 0.7])
    beta = np.linspace(0.0, 4.0, 1201) if system is ONE else np.linspace(0.02, 0.5, 13)
    mu = np.array([1.0, 1.5])
    whole = fm.sweep(system, r, beta, mu, outputs=BASIC)
    for first, last in itertools.combinations(range(r.size + 1), 2):
        same_bits(fm.sweep(system, r[first:last], beta, mu, outputs=BASIC), whole.isel(r=slice(first, last)))
    for m in range(mu.size):
        same_bits(fm.sweep(system, r, beta, mu[m], outputs=BASIC), whole.isel(mu=slice(m, m + 1)))


def test_work_is_cut_only_where_the_search_from_neighbours_starts_anew():
    r, mu, beta = np.linspace(0.1, 2.5, 30), np.array([1.0, 1.5]), np.linspace(0.0, 5.0, 2000)
    solver = Solver()
    work = plan(Cells(ONE, r, beta, mu, solver), r, mu, beta, solver)
    tiles = list(work.tiles())
    assert [0, *(last for _, last in tiles)] == [*(first for first, _ in tiles), work.cells]
    assert all(last - first < TILE + RESTART for first, last in tiles)
    ends = set(work.ends.tolist())
    for first, _ in tiles[1:]:
        row = int(np.searchsorted(work.ends, first, side="right"))
        begin = work.ends[row - 1] if row else 0
        assert first in ends or (first - begin) % RESTART == 0
    assert any(first not in ends for first, _ in tiles[1:])  # rows of more open cells than a tile


# What is asked for


def test_outputs_are_described_once():
    """The names that settings allow are those of the rows that say what each is, and one boundary."""
    assert (*CELL_VARIABLES, "beta_lim_modal") == OUTPUTS


def test_an_answer_does_not_depend_on_what_else_is_asked_for():
    """The steady state of `DRIFTING` has period 8: marching 20,000 periods says so too."""
    r, beta, mu = DRIFTING
    alone = fm.sweep(ONE, [r], [beta], mu, outputs=BASIC)
    assert alone.period.item() == 8
    marched = fm.sweep(ONE, [r], [beta], mu, outputs=BASIC, steady="marched", cycles=20000)
    assert marched.period.item() == 8
    assert alone.contact_amplitude.item() == pytest.approx(marched.contact_amplitude.item(), rel=1e-9)
    for name in OUTPUTS:
        asked = fm.sweep(ONE, [r], [beta], mu, outputs=[*BASIC, name])
        same_bits(asked[list(BASIC)], alone)


@pytest.mark.parametrize("start", ["rest", "moving"])
def test_a_map_does_not_depend_on_what_else_is_asked_for(start):
    r, beta, mu = [0.3, 0.52, 1.0, 1.4], np.linspace(0.0, 1.1, 23), [1.0, 1.5]
    alone = fm.sweep(ONE, r, beta, mu, outputs=BASIC, start=start)
    detailed = fm.sweep(
        ONE, r, beta, mu, outputs=[*BASIC, "multiplier", "asymmetry", "amplitude"], start=start
    )
    same_bits(detailed[list(BASIC)], alone)


# The table of phases


@pytest.mark.parametrize("contact", ["fixed-wall", "joined-base-wall"])
@pytest.mark.parametrize(("r", "beta"), [(0.3, 0.05), (0.2, 0.02), (1.4, 1.2), (0.05, 0.001)])
def test_one_mass_and_its_structure_have_one_table_of_phases(contact, r, beta):
    """Of one steady state, whichever kind of motion it was followed as."""
    system = fm.System(contact, damping_ratios=0.05)
    axes = np.array([r]), np.array([beta]), np.array([1.0])
    solver = Solver(skip="none")
    one = Cells(system, *axes, solver)
    many = Cells(system, *axes, solver)
    many._one = None
    _, table = one_cell(one.motion, beta, 1.0, limits(solver), False)
    _, other = one_cell(many.motion, beta, 1.0, limits(solver), False)
    if table.shape[0] == 0:
        assert other.shape[0] == 0
        return
    assert table.shape == other.shape
    begins = np.concatenate(([0.0], np.cumsum(table[:, segment_table.LENGTH])))
    np.testing.assert_allclose(table[:, segment_table.BEGIN], begins[:-1], atol=1e-12)
    halves = begins[-1] / math.pi
    assert halves == pytest.approx(round(halves), abs=1e-9)
    # the anchors of the two may differ: one is a rotation of the other
    stops = table[:, segment_table.SENSE] == 0.0
    same = other[:, segment_table.SENSE] == 0.0
    for column in (segment_table.LENGTH, segment_table.Z_END):
        mine = np.sort(np.abs(table[stops, column]))
        np.testing.assert_allclose(mine, np.sort(np.abs(other[same, column])), rtol=1e-8)
