"""The box law of many contacts, a = b - D f = 0, |f| <= beta, or f = beta sgn(a): against least squares."""

import numpy as np
import pytest
from general_systems import frame
from scipy.optimize import lsq_linear

from benchmarks.measures.own_entry import own_entry
from frictionmap._kernels.compiler.packed import packed
from frictionmap._kernels.general.keys import begin_key, find_key, make_keys, put_digit
from frictionmap._kernels.general.pattern import (
    BOX_ROWS,
    FORCE,
    FREE,
    KINETIC,
    MAY_SLIDE,
    PARTICIPATES,
    box_law,
)
from frictionmap._kernels.general.row import make_motion, make_row
from frictionmap.general.problem import problem_of

SIZES = (2, 5, 9, 16, 33, 64)


@own_entry
def solve(problem, row, motion, box):
    """Patterns that are tried from the one in `motion.sense`; the forces are in the box."""
    return box_law(packed(problem), packed(row), packed(motion), box, False)


@own_entry
def look_up(keys, bits, digits):
    """(place, whether it is new) of each row of digits."""
    found = np.zeros((digits.shape[0], 2), np.int64)
    for k in range(digits.shape[0]):
        begin_key(keys)
        for j in range(digits.shape[1]):
            put_digit(keys, bits, j, digits[k, j])
        place, new = find_key(keys, False)
        found[k, 0], found[k, 1] = place, 1 if new else 0
    return found


class Law:
    """Contacts with a given mobility."""

    def __init__(self, mobility):
        self.problem, _ = problem_of(frame(len(mobility)), np.array([1.0]))
        self.row, self.motion = make_row(self.problem), make_motion(self.problem)
        self.row.mobility[:] = mobility

    def solve(self, b, beta, begin, taking_part=True):
        """(forces, senses, patterns tried) from a pattern."""
        box = np.zeros((BOX_ROWS, b.size))
        box[FREE], box[KINETIC] = b, beta
        box[PARTICIPATES] = box[MAY_SLIDE] = taking_part
        self.motion.sense[:] = begin
        tried = solve(self.problem, self.row, self.motion, box)
        assert tried > 0
        return box[FORCE].copy(), self.motion.sense.copy(), tried


def mobility(n, rng, full):
    """Of a chain of random masses, or of contacts that all move each other."""
    if full:
        root = rng.normal(size=(n, n))
        return root @ root.T / n + 0.02 * np.eye(n)
    mass = 1.0 / rng.uniform(0.5, 2.0, n)
    own = mass + np.append(0.0, mass[:-1])
    return np.diag(own) - np.diag(mass[:-1], 1) - np.diag(mass[:-1], -1)


def by_least_index(d, b, beta):
    """Flip the first contact that is wrong, from all held; forces and patterns tried."""
    sense = np.zeros(b.size, int)
    for tried in range(1, 5000):
        held = sense == 0
        f = sense * beta
        f[held] = np.linalg.solve(d[np.ix_(held, held)], (b - d[:, ~held] @ f[~held])[held])
        a = b - d @ f
        wrong = np.flatnonzero(np.where(held, np.abs(f) > beta, sense * a < 0.0))
        if wrong.size == 0:
            return f, tried
        j = wrong[0]
        sense[j] = np.sign(f[j]) if held[j] else 0
    raise AssertionError


@pytest.mark.parametrize("full", [False, True])
@pytest.mark.parametrize("n", SIZES)
def test_four_methods_agree(n, full):
    """Blocks from all held and from a neighbour, one by one, and bounded least squares."""
    rng = np.random.default_rng(n)
    for case in range(4):
        d = mobility(n, rng, full)
        law, root = Law(d), np.linalg.cholesky(d)
        beta, b = rng.uniform(0.1, 1.0, n), rng.normal(size=n) * 10.0 ** rng.uniform(-0.5, 0.5)
        f, sense, tried = law.solve(b, beta, np.zeros(n, int))
        assert tried <= 16
        nearby = law.solve(b + 0.3 * rng.normal(size=n), beta, sense)[1]
        assert law.solve(b, beta, nearby)[0] == pytest.approx(f, abs=1e-11)
        if case == 0:
            assert by_least_index(d, b, beta)[0] == pytest.approx(f, abs=1e-11)
        least = lsq_linear(root.T, np.linalg.solve(root, b), (-beta, beta), method="bvls", tol=1e-15)
        assert least.x == pytest.approx(f, abs=1e-8)  # the square root of its tolerance
        held = sense == 0
        assert np.abs((b - d @ f)[held]).max(initial=0.0) < 1e-11


@pytest.mark.parametrize("full", [False, True])
def test_few_patterns_are_tried_after_an_event(full):
    """64 contacts, of which one arrives at velocity zero: those that slide go on, as in a motion."""
    rng, tries = np.random.default_rng(64 + full), []
    for _ in range(60):
        d = mobility(64, rng, full)
        law = Law(d)
        beta, b = rng.uniform(0.1, 1.0, 64), rng.normal(size=64)
        f, sense, _ = law.solve(b, beta, np.zeros(64, int))
        sliding = np.flatnonzero(sense)
        arrives = rng.choice(sliding)
        takes_part = sense == 0
        takes_part[arrives] = True
        b = b - 2.0 * (b - d @ f)[arrives] * np.eye(64)[arrives]  # its velocity falls
        others = np.where(takes_part, 0.0, f)
        tries.append(law.solve(b - d @ others, beta, np.where(takes_part, 0, sense), takes_part)[2])
    assert max(tries) <= 4  # the last of them is the answer: three were wrong
    assert np.mean(tries) < 2.5


@pytest.mark.parametrize("bits", [1, 16])
def test_places_of_patterns(bits):
    """Each pattern has one place for as long as it is among those looked for last."""
    rng = np.random.default_rng(bits)
    digits = rng.integers(0, 2 if bits == 1 else 25, (150, 64))
    keys = make_keys(64, bits, 256)
    first = look_up(keys, bits, digits)
    assert first[:, 1].all()
    assert np.unique(first[:, 0]).size > 100
    recent = digits[-60:]
    again = look_up(keys, bits, recent)
    kept = again[:, 1] == 0
    assert kept.sum() >= 55
    assert (again[kept, 0] == first[-60:][kept, 0]).all()
    other = recent.copy()
    other[:, 63] += 1  # differs in the last contact alone
    assert look_up(keys, bits, other)[:, 1].all()
