"""Rings under travelling loads: the sectors that differ say it all, against the whole structure."""

import numpy as np
import pytest

import frictionmap as fm
from frictionmap.general import maps
from frictionmap.general.cyclic import find_ring, keep_sectors
from frictionmap.general.problem import problem_of

_BETWEEN = {"kind": "between-masses", "masses": [1, "next.1"]}
_GROUND = {"kind": "fixed-wall", "masses": 2, "ratio": 0.4}
_NAMES = ["regime", "contact_regime", "contact_peak_to_peak", "contact_midpoint", "sliding_distance"]
_NAMES += ["work_friction", "amplitude", "midpoint", "acceleration_amplitude", "base_force"]


def _ring(count, order, contacts, **changed):
    sector = {
        "count": count, "mass": [[1.0, 0.0], [0.0, 2.0]], "stiffness": [[1.0, -1.0], [-1.0, 1.5]],
        "coupling": [{"masses": [2, 2], "stiffness": 0.8}], "engine_order": order,
    }  # fmt: skip
    keys = {"load_mass": 1, "damping_ratios": 0.03} | changed
    return fm.ring(sectors=sector | keys.pop("sectors", {}), contacts=contacts, **keys)


def _both(system, monkeypatch, **axes):
    """A map by the sectors that differ, and one by all of them."""
    found = fm.sweep(system, mu=[1.0], outputs=_NAMES, threads=1, **axes)
    with monkeypatch.context() as patched:
        patched.setattr(maps, "keep_sectors", lambda *_: None)
        whole = fm.sweep(system, mu=[1.0], outputs=_NAMES, threads=1, **axes)
    return found, whole


@pytest.mark.parametrize(
    ("count", "order", "kept", "sign"),
    [
        (5, 2, 5, 1.0),
        (5, 0, 1, 1.0),
        (6, 1, 3, -1.0),
        (6, 2, 3, 1.0),
        (6, 3, 1, -1.0),
        (8, 2, 2, -1.0),
        (9, 3, 3, 1.0),
    ],
)
def test_sectors_that_differ(count, order, kept, sign):
    """They are those until the load is the same or, as half periods mirror each other, the opposite one."""
    ring = find_ring(_ring(count, order, [_BETWEEN]))
    assert (ring.sectors, ring.order, ring.kept, ring.sign) == (count, order, kept, sign)
    assert len(np.unique(ring.contacts)) == kept


def test_an_even_harmonic_does_not_mirror():
    harmonics = [{"n": 1, "mass": 1, "amplitude": 1.0}, {"n": 2, "mass": 1, "amplitude": 0.3}]
    system = _ring(6, 2, [_BETWEEN], load_mass=None, load_harmonics=harmonics)
    assert find_ring(system)[2:4] == (3, 1.0)
    assert find_ring(_ring(6, 1, [_BETWEEN], load_mass=None, load_harmonics=harmonics))[2:4] == (6, 1.0)


@pytest.mark.parametrize(
    "sectors", [{"spread": {"standard_deviation": 0.01}}, {"mass_factors": [1.0] * 5 + [1.001]}]
)
def test_rings_whose_sectors_are_not_equal_are_solved_whole(sectors):
    assert find_ring(_ring(6, 2, [_BETWEEN], sectors=sectors)) is None


@pytest.mark.parametrize(
    ("count", "order", "contacts", "r"),
    [
        (6, 1, [_BETWEEN], 1.3),
        (5, 2, [_BETWEEN, _GROUND], 1.3),
        (5, 1, [{**_BETWEEN, "stiffness": 2.0}, _GROUND], 0.9),
        (6, 2, [_BETWEEN], 1.2),
        (4, 2, [_BETWEEN], 1.4),
        (6, 3, [{**_BETWEEN, "stiffness": 2.0}], 1.1),
        (8, 2, [{**_BETWEEN, "stiffness": 2.0}, _GROUND], 0.9),
        (4, 1, [_BETWEEN, _GROUND], 1.5),
        (4, 0, [{**_BETWEEN, "stiffness": 2.0}, _GROUND], 1.5),
    ],
)
def test_they_give_the_motion_of_the_whole_structure(count, order, contacts, r, monkeypatch):
    """Ranges, places after the start from rest, works, forces: of all contacts and masses."""
    found, whole = _both(_ring(count, order, contacts), monkeypatch, r=[r], beta=[0.05, 0.2, 0.35])
    assert (found.status.values == 0).all()
    known = whole.status.values == 0
    assert known.sum() >= 2
    assert (found.contact_peak_to_peak.values > 0.1).any()
    for name in _NAMES:
        one, other = found[name].values[known], whole[name].values[known]
        assert (np.isnan(one) == np.isnan(other)).all(), name
        # a state is exact to 1e-12 over its distance from a multiplier of 1
        size = np.nanmax(np.abs(other), initial=1.0)
        assert np.nanmax(np.abs(one - other), initial=0.0) <= 1e-10 * size, name


@pytest.mark.parametrize(("count", "order"), [(6, 1), (6, 2), (5, 2), (9, 3), (8, 3), (7, 3)])
def test_a_part_of_half_a_period_later_each_sector_is_where_another_was(count, order):
    """Checked on the harmonic motion without friction: q = T q(pi/parts), in the contacts too."""
    system, r = _ring(count, order, [{**_BETWEEN, "stiffness": 2.0}]), 1.1
    problem, modal = problem_of(system, np.array([r]))
    kept, _ = keep_sectors(system, problem, np.zeros((1, 3, modal.squares.size)))
    own = kept.problem
    load = own.push[:, 0] - 1j * own.push[:, 1]  # of cos(tau) and sin(tau)
    q = load / (own.squares - r * r + 1j * r * np.diag(own.damping))
    later = np.exp(1j * np.pi / own.parts)
    assert own.parts == kept.ring.kept > 1
    assert np.abs(own.turn.modes @ q * later - q).max() < 1e-12 * np.abs(q).max()
    z = own.chi @ q
    assert np.abs(own.turn.signs * z[own.turn.contacts] * later - z).max() < 1e-12 * np.abs(z).max()
    intervals = np.ceil(np.pi * own.rates / 2.1)
    assert (intervals % own.parts == 0.0).all()


def test_contacts_of_a_loop_come_to_rest_together(monkeypatch):
    """The disks rest, too: all that is left of the blades' velocities is rounding error.  One contact went on
    to slide with it, and was at rest for a fourth less of the time.
    """
    sectors = {
        "stiffness": [[1.0, -1.0], [-1.0, 1.643406486307998]],
        "coupling": [{"masses": [2, 2], "stiffness": 0.9939836985627005}],
    }
    system = _ring(3, 1, [_BETWEEN, {**_GROUND, "ratio": 0.44821744559719046}], sectors=sectors)
    monkeypatch.setattr(maps, "keep_sectors", lambda *_: None)
    found = fm.sweep(
        system,
        r=[1.5928375210008117],
        beta=[0.49735228],
        mu=[1.0],
        outputs=["stuck_fraction", "stops_per_cycle"],
    )
    assert np.ptp(found.stuck_fraction.values[0, 0, 0, :3]) < 1e-9
    assert found.stops_per_cycle.values[0, 0, 0, :3].tolist() == [4.0, 4.0, 4.0]


@pytest.mark.parametrize("count", [4, 6])
def test_contacts_that_never_move_rest(count, monkeypatch):
    """All sectors move alike under order 0: rounding errors of the contacts between them are no motion."""
    monkeypatch.setattr(maps, "keep_sectors", lambda *_: None)
    system = _ring(count, 0, [_BETWEEN, _GROUND])
    found = fm.sweep(system, r=[0.9], beta=[0.1, 0.3], mu=[1.0], outputs=["contact_peak_to_peak"])
    assert (found.status.values == 0).all()
    ranges = found.contact_peak_to_peak.values
    assert (ranges[..., :count] == 0.0).all()
    assert (ranges[..., count:] > 0.0).any()
    assert np.ptp(ranges[..., count:], axis=-1).max() < 1e-11


def test_two_harmonics_that_travel(monkeypatch):
    harmonics = [{"n": 1, "mass": 1, "amplitude": 1.0}, {"n": 2, "mass": 2, "amplitude": 0.4}]
    system = _ring(6, 2, [_BETWEEN, _GROUND], load_mass=None, load_harmonics=harmonics)
    found, whole = _both(system, monkeypatch, r=[0.8], beta=[0.1, 0.3])
    for name in ("contact_peak_to_peak", "midpoint", "base_force"):
        assert np.nanmax(np.abs(found[name].values - whole[name].values)) <= 1e-10


def test_multipliers_are_those_of_all_deviations(monkeypatch):
    """Also of those in which the sectors do not move alike."""
    system = _ring(4, 1, [_BETWEEN])
    found = fm.sweep(system, r=[1.3], beta=[0.1], mu=[1.0], outputs=["multiplier"]).multiplier.item()
    monkeypatch.setattr(maps, "keep_sectors", lambda *_: None)
    whole = fm.sweep(system, r=[1.3], beta=[0.1], mu=[1.0], outputs=["multiplier"]).multiplier.item()
    assert found == whole


def test_the_moving_start_is_alike_in_the_sectors_too(monkeypatch):
    """With a place of its own for the contact that rests."""
    system = _ring(4, 1, [_BETWEEN, {**_GROUND, "ratio": 2.0}])
    found, whole = _both(system, monkeypatch, r=[1.5], beta=[0.5], start="moving")
    for name in ("contact_peak_to_peak", "contact_midpoint", "midpoint"):
        assert np.nanmax(np.abs(found[name].values - whole[name].values)) <= 1e-10, name


def test_a_start_that_is_not_alike_in_all_sectors_is_not_reduced():
    system = _ring(4, 1, [_BETWEEN, _GROUND])
    problem, modal = problem_of(system, np.array([1.5]), loops=True)
    starts = np.zeros((1, 3, modal.squares.size))
    assert keep_sectors(system, problem, starts) is not None
    starts[0, 0] = np.arange(modal.squares.size)
    assert keep_sectors(system, problem, starts) is None
