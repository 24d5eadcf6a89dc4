"""Random systems with friction over speed, no proof of a single steady state: every cell ends."""

import numpy as np
import pytest

import frictionmap as fm
from benchmarks.measures.laws import CYCLES, random_cell, random_system

#: Of 10,000 seeds those whose motion creeps, and neither returns nor rests within 20,000 periods.
CREEPING = (4264, 4802, 8329)

#: Periods of a cell at most, with those of Newton's method: 2,467 in 10,000 cells.
MOST = 1.25 * CYCLES


@pytest.mark.slow
def test_random_cells_end_with_a_regime():
    found = [random_cell(seed) for seed in range(1000, 1300)]
    ends = {fm.regimes.RESOLVED, fm.regimes.IRREGULAR}
    assert {one["status"] for one in found} <= ends
    assert all(one["regime"] >= 0 and one["cycles"] <= MOST for one in found)
    assert sum(one["status"] == fm.regimes.RESOLVED for one in found) >= 290


@pytest.mark.slow
@pytest.mark.parametrize("seed", CREEPING)
def test_creeping_cells_end_with_a_status_within_the_bound(seed):
    found = random_cell(seed)
    assert found["cycles"] <= MOST
    assert (found["status"] == fm.regimes.RESOLVED) == (found["regime"] >= 0)


def test_random_systems_have_laws_and_are_those_of_their_seeds():
    one, same = (random_system(np.random.default_rng(7)) for _ in range(2))
    assert one.contacts == same.contacts
    np.testing.assert_array_equal(one.modes.damping, same.modes.damping)
    assert one.contacts[0].law is not None
