"""Every cell of the valid range ends within the scan steps that docs/known-limits.md states."""

import time

import numpy as np
import pytest

import frictionmap as fm
from frictionmap import regimes
from frictionmap.model.settings import OUTPUTS

LEAST = 1e-6

#: Scan steps of a motion at most, over `cycles` and `steps`; one more period of the fastest motion may begin.
FREE_PERIODS = 4000.0

#: Against hangs only: a cell takes some hundredths of a second.
WALL = 300.0


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


def check(cells, cycles):
    """Cells end, and none is followed for longer than its scan steps reach, whatever is asked for."""
    short = 0
    for k, (system, r, beta, mu, zeta) in enumerate(cells):
        start = ("rest", "moving")[k % 2]
        began = time.perf_counter()
        ds = fm.sweep(system, [r], [beta], mu, outputs=OUTPUTS, cycles=cycles, start=start)
        assert time.perf_counter() - began < WALL, (r, beta, mu, zeta)
        periods = FREE_PERIODS * cycles * r  # of the load at rate 1, which the fastest motion may double
        assert ds.cycles.item() <= min(cycles, np.ceil(periods) + 1.0) + 1.0, (r, beta, mu, zeta)
        short += periods < cycles and ds.status.item() == regimes.NOT_REACHED
    return short


@pytest.fixture(scope="module", autouse=True)
def _compiled():
    """Kernels are compiled before time is taken."""
    for system in (fm.System(), fm.System(mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0])):
        fm.sweep(system, [0.7], [0.2], 1.2, cycles=2, outputs=OUTPUTS)


def test_random_cells_of_the_whole_range_end():
    rng = np.random.default_rng(21)
    assert check((random_cell(rng, k) for k in range(60)), cycles=3) > 0


@pytest.mark.slow
def test_random_cells_of_the_whole_range_end_with_default_settings():
    rng = np.random.default_rng(22)
    check((random_cell(rng, k) for k in range(8)), cycles=2000)


def test_steps_do_not_grow_as_the_frequency_falls():
    """A motion that does not settle: its periods of the load fall with r, as its scan steps are bounded."""
    followed = []
    for r in (1.1e-3, 1.1e-4, 1.1e-5, 2.1e-6):  # none is 1/(2n)
        beta = 1e-6 * r * r
        ds = fm.sweep(fm.System(), [r], [beta], 1.5, cycles=20, outputs=["regime", "cycles", "status"])
        assert ds.status.item() == regimes.NOT_REACHED
        assert ds.cycles.item() <= min(20, np.ceil(FREE_PERIODS * 20 * r) + 1.0)
        followed.append(ds.cycles.item())
    assert followed[0] == 20 > followed[1] > 3.0 * followed[2]


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
            ds = fm.sweep(system, [ratio], [1e-18 * load[k]], 1.5, outputs=[*OUTPUTS[:8], "also_reachable"])
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
