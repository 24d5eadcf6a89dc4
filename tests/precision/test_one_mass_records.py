"""Steady states of one mass under several harmonics: against one harmonic, and the equations integrated."""

import numpy as np
import pytest
from records import Truth, base_at, places, steady

import frictionmap as fm
from frictionmap.general import one_mass
from frictionmap.general.one_mass import steady_motion

#: The base of the tests: harmonics 0 to 5.
BASE = tuple(1.8 * c for c in (0.01, 0.7 + 0.7j, 0.05 - 0.02j, 0.02j, -0.01, 0.003))


def motion(r, zeta, friction, mu, load, phases, start=(0.0, 0.01), most=2000):
    """The steady state and its displacements at phases."""
    state = steady_motion(r, zeta, friction, mu, np.array(load, complex), start, phases, most)
    return state, state.places


@pytest.mark.parametrize("seed", range(16))
def test_one_harmonic_is_the_one_mass_of_maps(seed):
    rng = np.random.default_rng(seed)
    r, beta = 10.0 ** rng.uniform(-1.0, 0.5), rng.uniform(0.02, 0.9)
    mu, zeta = rng.choice([1.0, 1.3]), rng.choice([0.0, 0.01, 0.3, 1.0, 1.5])
    ds = fm.response(fm.System(contact="fixed-wall", damping_ratios=float(zeta)), r=r, beta=beta, mu=mu)
    phases = ds.tau.values[ds.tau.values < 2.0 * np.pi]
    state, found = motion(r, zeta, beta, mu, [0.0, 1.0], phases, start=(0.0, 0.0))
    assert state.repeats
    # the place of a mass that rests is known to the rounding error of the load, 1
    atol = max(1e-13 * np.abs(ds.z).max().item(), 1e-14)
    np.testing.assert_allclose(found, ds.z.values[: phases.size], atol=atol)
    assert state.stops == np.nan_to_num(ds.stops_per_cycle)  # of what is stuck there is no number


def test_motions_do_not_depend_on_those_found_before_in_the_same_memory():
    """Of four sizes of memory each is used by several motions, in two orders; all are the same to the bit."""
    rng = np.random.default_rng(7)
    phases = np.linspace(0.0, 6.0, 20)
    cells = []
    for k in range(48):
        load = [0.1, 1.0, 0.3j, *([0.2] if k % 2 else [])]
        mu, spring = (1.0, 3.0 * (k % 3)) if k % 3 else (1.0 + 0.2 * (k % 2), 0.0)
        cells.append((rng.uniform(0.3, 2.0), rng.uniform(0.0, 0.2), rng.uniform(0.0, 1.2), mu, load, spring))

    def found(cell):
        r, zeta, friction, mu, load, spring = cell
        state = steady_motion(r, zeta, friction, mu, np.array(load), (0.0, 0.01), phases, 500, spring)
        return repr(state._replace(places=state.places.tolist()))

    alone = []
    for cell in cells:
        one_mass._memories.cache_clear()
        alone.append(found(cell))
    assert [found(cell) for cell in cells] == alone
    assert [found(cell) for cell in cells[::-1]] == alone[::-1]
    assert one_mass._memories.cache_info().hits > 48


@pytest.mark.parametrize(
    ("r", "zeta", "x_F", "mu", "contact", "reference"),
    [
        (0.32, 0.0055, 0.84, 1.0, "fixed-wall", "base"),
        (0.274, 0.03, 0.5, 1.2, "fixed-wall", "ground"),
        (0.163, 0.01, 0.3, 1.0, "fixed-wall", "base"),
        (0.5, 0.0, 0.6, 1.0, "fixed-wall", "ground"),  # harmonic 2 resonates
        (0.25, 0.0, 0.4, 1.1, "fixed-wall", "base"),  # harmonic 4 resonates
        (0.231, 0.02, 0.06, 1.2, "joined-base-wall", "base"),
        (1.889, 0.04, 4.0, 1.2, "joined-base-wall", "ground"),
        (0.816, 1.3, 0.3, 1.0, "joined-base-wall", "base"),
    ],
)
def test_several_harmonics_against_the_equation_of_motion(r, zeta, x_F, mu, contact, reference):
    """The integration determines positions to its tolerance, some 1e-11 of the motion at every event."""
    truth = Truth(3.0, zeta, x_F, mu, -0.1, 3.0 * r, BASE, contact, reference)
    expected = steady(truth)
    assert expected.change < 1e-10
    n, Y = np.arange(len(BASE)), np.array(BASE)
    damper = 2j * zeta * n * r
    if contact == "fixed-wall":
        load = Y * (1.0 + (damper if reference == "base" else 0.0))
    else:
        load = Y * ((n * r) ** 2 - (damper if reference == "ground" else 0.0))
    phases = np.linspace(0.0, 2.0 * np.pi, 400, endpoint=False)
    state, found = motion(r, zeta, x_F, mu, load, phases)
    time = phases / (2.0 * np.pi * truth.f)
    x = found + truth.offset_x + (base_at(truth, time) if contact == "joined-base-wall" else 0.0)
    assert state.repeats
    np.testing.assert_allclose(x, places(truth, expected, time), atol=1e-9)
    assert state.stops == expected.stops > 0


def test_without_friction_it_is_the_harmonic_motion():
    r, zeta, load = 0.7, 0.02, np.array([0.3, 1.0 - 0.5j, 0.2j, 0.1])
    n = np.arange(load.size)
    phasors = load / (1.0 - (n * r) ** 2 + 2j * zeta * n * r)
    phases = np.linspace(0.0, 6.0, 50)
    state, found = motion(r, zeta, 0.0, 1.0, load, phases)
    exact = (np.exp(1j * np.multiply.outer(phases, n)) @ phasors).real
    np.testing.assert_allclose(found, exact, atol=1e-12)
    assert state.stops == 0


def test_held_permanently():
    state, found = motion(0.5, 0.0, 1.5, 1.0, [0.2, 1.0], np.linspace(0.0, 6.0, 9), start=(0.1, 0.0))
    assert (state.repeats, state.stops, state.stuck) == (True, 0, pytest.approx(1.0))
    np.testing.assert_allclose(found, 0.1, atol=1e-15)


def test_an_undamped_resonance_has_no_steady_state():
    state, found = motion(1.0, 0.0, 0.0, 1.0, [0.0, 1.0], np.linspace(0.0, 6.0, 9), most=100)
    assert not state.repeats
    assert np.abs(found).max() < 400.0  # it grows by pi a cycle


def test_cycles_allowed_are_kept():
    state, found = motion(0.95, 0.0, 0.7, 1.0, [0.0, 1.0], np.linspace(0.0, 6.0, 9), most=2)
    assert not state.repeats
    assert np.isfinite(found).all()
