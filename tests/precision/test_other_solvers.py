"""Solvers that the benchmarks compare with, on single cells: they agree to their own errors."""

import numpy as np
import pytest

from benchmarks.measures.general.against import periods_needed
from benchmarks.measures.general.cost import stick_slip_range
from benchmarks.measures.general.kernels import map_row, single_cells
from benchmarks.measures.general.scenes import E1, ELASTIC, FIVE, SCENES, TWO
from benchmarks.peers import heyoka, solve_ivp
from benchmarks.peers.contacts import ContactCell, largest_difference
from benchmarks.peers.harmonic_balance import HarmonicBalance
from benchmarks.peers.moreau import ContactsMoreau

#: Scene, r, share of the range of stick-slip.
CELLS = [(TWO, 0.7, 0.5), (FIVE, 1.1, 0.6), (E1, 0.9, 0.6)]


def found(name, r, share):
    """The cell, its stops and ranges by the package, and periods until other motions reach it."""
    scene = SCENES[name]
    system = scene.system()
    low, high = stick_slip_range(system, r)
    cell = ContactCell(r, scene.forces(low + share * (high - low)))
    solve, answer = single_cells(system, np.array([r]), np.array([cell.beta]))
    solve()
    return cell, answer.stops[0].tolist(), answer.ranges[0], periods_needed(float(answer.multiplier[0]))


#: General-purpose solvers, and how they are made for a body.
SOLVERS = [
    (solve_ivp.ContactsSolveIvp, lambda body: solve_ivp.contact_peer(body, rtol=1e-10, atol=1e-13)),
    (heyoka.ContactsHeyoka, heyoka.contact_peer),
]


@pytest.mark.parametrize(("kind", "make"), SOLVERS)
@pytest.mark.parametrize(("name", "r", "share"), CELLS)
def test_general_purpose_solvers(name, r, share, kind, make):
    if why := kind.why_missing():
        pytest.skip(why)
    cell, stops, ranges, cycles = found(name, r, share)
    outcome = make(SCENES[name].body).run(cell, cycles)
    assert list(outcome.stops) == stops
    assert largest_difference(outcome.ranges, ranges) < 1e-8


@pytest.mark.parametrize(("name", "r", "share"), CELLS)
def test_time_stepping(name, r, share):
    cell, _, ranges, cycles = found(name, r, share)
    off = [
        largest_difference(ContactsMoreau(SCENES[name].body, steps).run(cell, cycles).ranges, ranges)
        for steps in (512, 8192)
    ]
    assert off[1] < 0.1 * off[0]
    assert off[1] < 1e-4


@pytest.mark.slow
def test_harmonic_balance():
    scene = SCENES[ELASTIC]
    low, high = stick_slip_range(scene.system(), 0.7)
    beta = np.linspace(low, high, 10)
    solve, cells = map_row(scene.system(), 0.7, beta)
    solve()
    exact = np.maximum(cells.highest, -cells.lowest)[0, 0, :, 0]
    off = []
    for highest in (1, 5, 31):
        balance = HarmonicBalance(scene.body, scene.stiffness, highest)
        off.append(np.abs(balance.amplitudes(balance.solve(0.7, beta)) / exact - 1.0).max())
    assert off[0] > off[1] > off[2]
    assert off[2] < 1e-3
