"""Solvers that the benchmarks compare with, on single cells: they agree to their own errors."""

import numpy as np
import pytest

from benchmarks.measures import continuation, laws
from benchmarks.measures.general.against import periods_needed
from benchmarks.measures.general.cost import stick_slip_range
from benchmarks.measures.general.kernels import map_row, single_cells
from benchmarks.measures.general.scenes import E1, ELASTIC, FIVE, SCENES, TWO
from benchmarks.peers import heyoka, solve_ivp
from benchmarks.peers.contacts import ContactBody, ContactCell, largest_difference
from benchmarks.peers.harmonic_balance import HarmonicBalance, amplitudes
from benchmarks.peers.moreau import ContactsMoreau
from benchmarks.peers.nlvib import NLvib
from benchmarks.peers.pyharm import PyHarm
from benchmarks.peers.siconos import Siconos
from benchmarks.peers.slider import SliderSolveIvp

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
        off.append(np.abs(amplitudes(balance.orders, balance.solve(0.7, beta)) / exact - 1.0).max())
    assert off[0] > off[1] > off[2]
    assert off[2] < 1e-3


@pytest.mark.parametrize("cells", [laws.opening_cells, laws.belt_cells])
def test_sliders_with_events(cells):
    """A contact that opens, and a cycle on a belt without a load."""
    for cell in cells(True):
        slider, period = cell.given
        found = SliderSolveIvp(slider, 1e-10).range(0.0, period, cell.periods)
        assert found == pytest.approx(cell.expected, rel=1e-8)


def test_siconos_converges_with_its_step():
    if why := Siconos.why_missing():
        pytest.skip(why)
    _, cell = laws.law_cells(None, True)
    body = ContactBody(((1,),), {1: 1.0}, zeta=laws.ZETA)
    found = [Siconos(body, steps).run(cell.given, cell.periods).ranges[0] for steps in (64, 512)]
    coarse, fine = (abs(one / cell.expected - 1.0) for one in found)
    assert fine < 0.25 * coarse
    assert fine < 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("kind", [PyHarm, NLvib])
@pytest.mark.parametrize("name", list(continuation.RIGS))
def test_programs_for_harmonic_balance(kind, name):
    """They converge to the steady states with the number of harmonics."""
    if why := kind.why_missing():
        pytest.skip(why)
    rig = continuation.RIGS[name]._replace(frequencies=(0.6, 0.9))
    one, more = (continuation.point(kind(rig), highest, 1) for highest in (1, 5))
    assert one["followed up to r"] >= 0.9
    assert more["median relative error of Z"] < 0.5 * one["median relative error of Z"] < 0.05
