"""Every cell of the valid range ends within the scan steps that docs/known-limits.md states."""

import time

import numpy as np
import pytest
from outputs import OF_ONE_CONTACT

import frictionmap as fm
from benchmarks.measures.own_entry import own_entry
from frictionmap import regimes
from frictionmap._kernels.compiler.packed import packed
from frictionmap._kernels.engine.march import steady_state
from frictionmap._kernels.engine.motion import at_frequency, contact_at, forget_neighbour, start
from frictionmap.single.cells import Cells, limits

LEAST = 1e-6

#: Scan steps of a motion at most, over `cycles` and `steps`.
FREE_PERIODS = 4000.0

#: Frequencies, none 1/(2n), and friction over r^2, where motion without damping takes very long to settle.
UNSETTLED = (1.1e-4, 1.1e-5)
FAINT = 1e-6

#: Against hangs, and compilation on a busy machine, only: a cell takes some hundredths of a second.
WALL = 1200.0


def fastest(zeta):
    """Bound on the rate of free motion of one mass, over its natural frequency."""
    return 2.0 * zeta if zeta > 1.0 else 1.0


def random_cell(rng, k):
    """A cell of the whole valid range; every third one near the boundaries, where motions are followed."""
    zeta = 0.0 if k % 4 == 0 else rng.uniform(0.0, 2.0)
    contact = ("fixed-wall", "joined-base-wall")[k % 2]
    r = 10.0 ** rng.uniform(np.log10(LEAST * fastest(zeta)), 6.0)
    beta = 10.0 ** rng.uniform(-20.0, 6.0)
    if k % 3 == 0:
        load = 1.0 if contact == "fixed-wall" else r * np.hypot(r, 2.0 * zeta)
        beta = load * 10.0 ** rng.uniform(-6.0, 0.0)
    mu = 1.0 if k % 5 == 0 else rng.uniform(1.0, 3.0)
    return fm.System(contact=contact, damping_ratios=zeta), r, beta, mu, zeta


@own_entry
def _with_motion(system, motion, beta, mu, limits, moving):
    """The same with the arrays of a motion, which the caller keeps.

    Arguments are packed as in maps: of other types, all kernels would be compiled once more.
    """
    system, motion = packed(system), packed(motion)
    forget_neighbour(motion)
    contact = contact_at(system, 0, 0, beta, mu)
    at = start(motion, system, 0, contact, moving)
    found = steady_state(motion, contact, at, moving, limits, np.zeros(1, dtype=np.uint8))
    return found.regime, limits.steps - motion.scratch.left[0]


@own_entry
def _followed(system, beta, mu, limits, moving):
    """(regime, scan steps taken) of the motion in an open cell at the only frequency."""
    return _with_motion(system, at_frequency(system, 0), beta, mu, limits, moving)


def steps_of(system, r, beta, mu, cycles, moving):
    """(scan steps that the motion in a cell takes, those that are stated)."""
    solver = fm.Solver(cycles=cycles)
    one = Cells(system, np.array([r]), np.array([beta]), np.array([mu]), solver).motion
    _, steps = _followed(one, beta, mu, limits(solver), moving)
    # beside the motion's own, bounds over one orbit, in one period's number of steps
    period = 2.0 * (solver.steps + 1) * max(1.0, fastest(system.zeta) / r)
    return steps, FREE_PERIODS * cycles * solver.steps + period


def test_random_cells_of_the_whole_range_take_no_more_steps_than_is_stated():
    rng = np.random.default_rng(21)
    for k in range(120):
        system, r, beta, mu, _ = random_cell(rng, k)
        steps, most = steps_of(system, r, beta, mu, 1 + 2 * (k % 2), k % 7 == 0)
        assert 0.0 <= steps <= most, (system, r, beta, mu)


@pytest.mark.parametrize("r", UNSETTLED)
def test_motions_that_do_not_settle_take_all_steps(r):
    """So there is a bound that ends them, and not some other that is less."""
    steps, most = steps_of(fm.System(), r, FAINT * r * r, 1.5, 1, False)
    assert FREE_PERIODS * 24 <= steps <= most


def test_structures_take_no_more_steps_than_is_stated():
    rng = np.random.default_rng(5)
    for k in range(12):
        r, beta = 10.0 ** rng.uniform(-5.5, 1.0), 10.0 ** rng.uniform(-8.0, -0.5)
        system = fm.System(mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0], damping_ratios=0.01 * (k % 2))
        solver = fm.Solver(cycles=2)
        one = Cells(system, np.array([r]), np.array([beta]), np.array([1.5]), solver).motion
        _, steps = _followed(one, beta, 1.5, limits(solver), False)
        most = FREE_PERIODS * 2 * solver.steps + 2.0 * (solver.steps + 1) * max(1.0, 2.0 / r)
        assert 0.0 <= steps <= most, (r, beta)


@pytest.mark.slow
def test_random_cells_of_the_whole_range_end_with_all_outputs():
    """Some excitation periods, and the default number of them."""
    rng = np.random.default_rng(22)
    for k in range(24):
        system, r, beta, mu, zeta = random_cell(rng, k)
        cycles, begin = (10, 2000)[k % 4 == 3], ("rest", "moving")[k % 2]
        began = time.perf_counter()
        fm.sweep(system, [r], [beta], mu, outputs=OF_ONE_CONTACT, cycles=cycles, start=begin)
        assert time.perf_counter() - began < WALL, (r, beta, mu, zeta)


def test_steps_do_not_grow_as_the_frequency_falls():
    """A motion that hardly ever stops: its periods of the load fall with r, as its scan steps are bounded."""
    followed = []
    for r in (1.1e-3, *UNSETTLED):
        beta = FAINT * r * r
        ds = fm.sweep(fm.System(), [r], [beta], 1.5, cycles=20, outputs=["regime", "cycles", "status"])
        assert ds.status.item() == regimes.NOT_REACHED
        followed.append(ds.cycles.item())
    assert followed[0] >= 20 > followed[1] > 3 * followed[2]


@pytest.mark.parametrize("r", [1e-7, 1e-300])
@pytest.mark.parametrize("zeta", [0.0, 0.02])
def test_frequencies_below_the_limit_are_refused(r, zeta):
    """One mass as structures: in maps, curves, responses, boundaries, by closed forms."""
    system = fm.System(damping_ratios=zeta)
    message = rf"r must be 0, or >= 1e-06 for this system: .*; got {r:g}"
    calls = (
        lambda: fm.sweep(system, [r], [0.2]),
        lambda: fm.boundaries(system, [r]),
        lambda: fm.curves(system, [r], [0.2]),
        lambda: fm.response(system, r, 0.2),
        lambda: fm.continuous_motion(system, r, 0.0),
    )
    for call in calls:
        with pytest.raises(fm.InputError, match=message):
            call()


def test_the_least_frequency_follows_the_fastest_rate():
    assert fm.boundaries(fm.System(), [0.0, 1e-6]).beta_lim.values[0, 1] > 0.0
    with pytest.raises(fm.InputError, match=r"r must be 0, or >= 0.0002 for this system"):
        fm.sweep(fm.System(damping_ratios=100.0), [1.9e-4], [0.2])
    assert fm.sweep(fm.System(damping_ratios=100.0), [2e-4], [0.2]).regime.item() == regimes.STICK_SLIP
    fast = fm.System(mass_ratios=[1.0, 1e-4], stiffness_ratios=[1.0, 1.0], contact_masses=[2])
    with pytest.raises(fm.InputError, match=r"r must be 0, or >= 0.0001 for this system"):
        fm.boundaries(fast, [5e-5])


def test_friction_below_the_rounding_of_the_load_counts_as_none():
    """mu > 1: the limit of small friction, on which friction has no more say; every regime that there is."""
    for system in (fm.System(), fm.System(damping_ratios=0.01), fm.System(contact="joined-base-wall")):
        r = np.array([1e-4, 0.3, 0.8, 2.7])
        load = fm.boundaries(system, r).beta_stick.values[0]
        for k, ratio in enumerate(r):
            ds = fm.sweep(
                system, [ratio], [1e-18 * load[k]], 1.5, outputs=[*OF_ONE_CONTACT[:8], "also_reachable"]
            )
            none = fm.sweep(system, [ratio], [0.0], 1.5)
            assert ds.regime.item() == regimes.CONTINUOUS
            assert ds.also_reachable.item() == 1 << regimes.CONTINUOUS
            np.testing.assert_allclose(ds.contact_amplitude, none.contact_amplitude, rtol=1e-12)
    # a little more is followed
    ds = fm.sweep(fm.System(damping_ratios=0.01), [0.3], [1e-15], 1.5, outputs=["regime", "origin"])
    assert ds.origin.item() == regimes.INTEGRATED
    assert ds.regime.item() == regimes.CONTINUOUS


def test_a_structure_that_does_not_settle_is_bounded_too():
    """Undamped, at low frequency, mu > 1: all starts and ladders of two masses."""
    system = fm.System(mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0])
    began = time.perf_counter()
    ds = fm.sweep(system, [1e-5], [1e-13], 1.5, cycles=3, outputs=["regime", "cycles", "also_reachable"])
    assert time.perf_counter() - began < WALL
    assert ds.cycles.item() <= 1
