"""Contacts that are held stay where they are, and the first motion is the first slide."""

from itertools import pairwise

import numpy as np
import pytest
from lcg_records import lcg

import frictionmap as fm

_CHAIN = {"mass_ratios": [1, 1, 1], "stiffness_ratios": [1, 1, 0.8], "damping_ratios": 0.03}
_BASE = {"excitation": "base", "damping_reference": "base"}
_VALUES = lcg(5, 20_000, [1.5, -0.7], [2000, 7000])
_VALUES = _VALUES - _VALUES.mean()
_FORCE = fm.Record(_VALUES, 0.1, quantity="force")
_ACCELERATION = fm.Record(_VALUES, 0.1)
_DISPLACEMENT = fm.Record(_VALUES, 0.1, quantity="displacement")
_PAIR = [fm.Contact("joined-base-wall", [1]), fm.Contact("between-masses", [2, 3], ratio=0.5)]
_WALL = [fm.Contact("fixed-wall", [1]), fm.Contact("between-masses", [2, 3], ratio=0.5)]


@pytest.mark.parametrize("spring", [None, 2.0])
@pytest.mark.parametrize(
    ("contacts", "record"),
    [(_PAIR, _ACCELERATION), (_WALL, _DISPLACEMENT)],
    ids=["joined to the base", "wall that moves past the base"],
)
def test_a_contact_that_is_held_stays_where_it_is(contacts, record, spring):
    """Rounding of the sum alone: places drifted by 1e-11 to 1e-10 while only accelerations were held."""
    more = [fm.Contact("fixed-wall", [3], stiffness=spring)] if spring else []
    system = fm.System(**_CHAIN, **_BASE, contacts=[*contacts, *more])
    ds = fm.history(system, record, beta=1e6, after=0.0, samples=10, beta_hold=False)
    z = ds.z.squeeze().values[:2]
    size = max(np.abs(ds.x).max().item(), np.abs(ds.drive).max().item())
    assert np.abs(z - z[:, :1]).max() <= 4e-15 * size


def test_a_contact_that_is_held_moves_with_its_belt():
    system = fm.System(**_CHAIN, contacts=[fm.Contact("fixed-wall", [1], wall_speed=0.01)])
    ds = fm.history(system, _FORCE, beta=1e6, after=0.0, samples=10, beta_hold=False)
    assert ds.stops.item() <= 1
    held = ds.direction.squeeze().values == 0
    way = (ds.z.squeeze() - 0.01 * ds.time).values[held]
    assert held.sum() > 1900
    assert np.abs(way - way[0]).max() <= 4e-15 * np.abs(ds.x).max().item()


def test_stops_stay_where_they_are():
    """Thousands of samples in a stop that a slide came before."""
    system = fm.System(**_CHAIN, **_BASE, contacts=_PAIR)
    ds = fm.history(system, _ACCELERATION, beta=1.0, after=0.0, beta_hold=False)
    assert ds.events.item() > 10
    size = np.abs(ds.x).max().item()
    for z, sense in zip(ds.z.squeeze().values, ds.direction.squeeze().values, strict=True):
        ends = np.flatnonzero(np.diff(sense, prepend=2, append=2))
        lengths = []
        for begin, end in pairwise(ends):
            if sense[begin] == 0:
                assert np.ptp(z[begin:end]) <= 4e-15 * size
                lengths.append(end - begin)
        assert max(lengths) > 2000


def test_peaks_between_samples_are_those_of_a_closed_form():
    """A mass on a spring under a ramp, and under a step: the first peak is pi/s after it."""
    system = fm.System(contacts=[fm.Contact("joined-base-wall", [1])], **_BASE)
    time = np.arange(400) * 0.1
    ds = fm.history(system, fm.Record(time, 0.1, quantity="acceleration"), beta=0.0, after=0.0)
    x = np.sin(time[-1]) - time[-1]
    assert ds.x_min.item() == pytest.approx(x, rel=1e-13)
    assert ds.amplitude_time.item() == pytest.approx(time[-1], rel=1e-13)
    damped, s = fm.System(contacts=system.contacts, damping_ratios=0.05, **_BASE), (1.0 - 0.05**2) ** 0.5
    pushed = fm.history(damped, fm.Record(np.ones(400), 0.1), beta=0.0, after=0.0)
    assert pushed.x_min.item() == pytest.approx(-1.0 - np.exp(-0.05 * np.pi / s), rel=1e-14)
    assert pushed.amplitude_time.item() == pytest.approx(np.pi / s, rel=1e-7)


def _first(system, values, step, **options):
    record = fm.Record(values, step, quantity="force")
    return fm.history(system, record, beta_hold=False, **options).first_motion.item()


def test_first_motion_is_the_begin_of_the_first_slide():
    mass, elastic = fm.System(), fm.System(contact_stiffness=1.0)
    ramp = [0.0, 1.0, 0.0]
    assert _first(mass, ramp, 2.0, beta=0.25) == pytest.approx(0.5, rel=1e-15)
    assert np.isnan(_first(mass, ramp, 2.0, beta=1.5))
    # a spring that the pulse stretches: 2 x = t/4 - sin(sqrt(2) t)/(4 sqrt(2)) is the force at its limit
    slip = _first(elastic, [0.0, 1.0, 0.0], 4.0, beta=0.1)
    assert (slip - np.sin(2.0**0.5 * slip) / 2.0**0.5) / 8.0 == pytest.approx(0.1, rel=1e-13)


def test_a_contact_that_slides_at_the_beginning_moves_first_then():
    """Its first event is a stop."""
    mass = fm.System()
    start = {"start": {"x": [0.0], "v": [0.5]}}
    record = fm.Record([0.0, 0.0], 0.5, quantity="force")
    ds = fm.history(mass, record, beta=0.3, **start)
    assert ds.event_kind.values.ravel()[0] == 0
    assert ds.first_motion.item() == 0.0
    assert ds.event_time.values.ravel()[0] > 0.0
    assert _first(mass, [1.0, 0.0], 2.0, beta=0.25) == 0.0  # the load jumps at the beginning
    belt = fm.System(wall_speed=0.2)
    assert _first(belt, [0.0, 0.1, 0.0], 1.0, beta=0.5) == 0.0


def test_splines_have_one_value_and_one_slope_at_a_sample():
    """The velocity of a wall that jumped by the rounding of times would be an impulse in every sample."""
    steps = np.where(np.arange(_VALUES.size - 1) % 3 == 0, 0.05, 0.125)
    for record in (_DISPLACEMENT, fm.Record(_VALUES, time=np.concatenate(([0.0], np.cumsum(steps))),
                                            quantity="displacement")):  # fmt: skip
        pieces = record.pieces
        rates = pieces.terms @ np.arange(pieces.terms.shape[1]) / pieces.steps
        size = np.abs(pieces.terms[:, 1] / pieces.steps).max()
        assert np.abs(pieces.ends[:-1] - pieces.terms[1:, 0]).max() <= 4e-16
        assert np.abs(rates[:-1] - pieces.terms[1:, 1] / pieces.steps[1:]).max() <= 1e-15 * size
