"""Intervals that tables pass are those that the series follow: walls that move, belts, uneven steps."""

import numpy as np
import pytest
from lcg_records import lcg

import frictionmap as fm
from frictionmap.motions import cells
from frictionmap.motions.pieces import levelled

#: Times that rounding decides: several slips reach one limit, and a contact rests at its extreme.
_TIES = ("friction_amplitude_time", "contact_amplitude_time")

_CHAIN = {"mass_ratios": [1, 1, 1], "stiffness_ratios": [1, 1, 0.8], "damping_ratios": 0.03}
_BASE = {"excitation": "base", "damping_reference": "base"}
_VALUES = lcg(5, 900, [1.5, -0.7], [90, 300])
_VALUES = _VALUES - _VALUES.mean()


_SYSTEMS = {
    "wall at rest": fm.System(
        **_CHAIN, **_BASE,
        contacts=[fm.Contact("fixed-wall", [1]), fm.Contact("between-masses", [2, 3], ratio=0.5)],
    ),
    "damping to the ground": fm.System(
        **_CHAIN, excitation="base", damping_reference="ground",
        contacts=[fm.Contact("fixed-wall", [2], mu=1.2), fm.Contact("joined-base-wall", [3], ratio=0.5)],
    ),
    "spring to a wall at rest": fm.System(
        **_CHAIN, **_BASE, contacts=[fm.Contact("fixed-wall", [1], stiffness=3.0)]
    ),
    "springs behind belts": fm.System(
        **_CHAIN,
        contacts=[
            fm.Contact("fixed-wall", [1], wall_speed=0.3, stiffness=2.0),
            fm.Contact("fixed-wall", [2], ratio=0.6, wall_speed=0.3),
            fm.Contact("between-masses", [2, 3], ratio=0.5, stiffness=3.0),
        ],
    ),
    "belts": fm.System(
        **_CHAIN,
        contacts=[
            fm.Contact("fixed-wall", [1], wall_speed=0.3),
            fm.Contact("fixed-wall", [3], ratio=0.5, wall_speed=-0.6),
        ],
    ),
}  # fmt: skip


def _records(quantity):
    steps = np.where(np.arange(_VALUES.size - 1) % 3 == 0, 0.05, 0.125)
    given = {"quantity": quantity}
    return {
        "linear": fm.Record(_VALUES, 0.1, **given),
        "cubic": fm.Record(_VALUES, 0.1, interpolation="cubic", **given),
        "uneven": fm.Record(_VALUES, time=np.concatenate(([0.0], np.cumsum(steps))), **given),
        "sweep": fm.Record.sweep(0.2, 2.0, 90.0, rise=20.0, fall=15.0, **given),
    }


def _follow(system, record, monkeypatch, tables):
    """The motion, and the number of intervals that tables passed."""
    passed = []
    monkeypatch.setattr(cells, "_MOST_LENGTHS", 64 if tables else 0)
    follow = cells.follow_record

    def counted(problem, friction, memory, *rest):
        found = follow(problem, friction, memory, *rest)
        passed.append(int((memory.tables.known > 0).sum()))
        return found

    monkeypatch.setattr(cells, "follow_record", counted)
    ds = fm.history(system, record, beta=0.3, after=30.0, samples=5, beta_hold=False, threads=1)
    monkeypatch.setattr(cells, "follow_record", follow)
    return ds, sum(passed)


@pytest.mark.parametrize("kind", ["linear", "cubic", "uneven", "sweep"])
@pytest.mark.parametrize("name", _SYSTEMS)
def test_tables_and_series_give_one_motion(name, kind, monkeypatch):
    system = _SYSTEMS[name]
    record = _records("force" if "belts" in name else "acceleration")[kind]
    fast, used = _follow(system, record, monkeypatch, True)
    slow, unused = _follow(system, record, monkeypatch, False)
    assert used > 0
    assert unused == 0
    assert slow.events.item() > 5
    for variable in slow.data_vars:
        if variable in _TIES:
            continue
        one, two = (ds[variable].values.astype(float) for ds in (fast, slow))
        size = np.nanmax(np.abs(two), initial=0.0)
        np.testing.assert_allclose(one, two, rtol=0, atol=2e-12 * size, err_msg=variable)


def test_steps_that_differ_by_the_rounding_of_times_are_equal():
    times = np.concatenate((np.arange(3000) * 0.01, 30.0 + np.arange(2000) * 0.005))
    steps = np.diff(times)
    assert np.unique(steps).size > 10
    found = levelled(steps, times[-1])
    assert np.unique(found).size == 2
    assert np.abs(found - steps).max() <= 4 * np.spacing(30.0)
    different = np.array([0.1, 0.1 + 1e-12, 0.1])
    np.testing.assert_array_equal(levelled(different, 0.3), different)


def test_the_friction_that_holds_is_found_where_it_is_asked_for():
    record = _records("acceleration")["linear"]
    with_hold = fm.history(_SYSTEMS["wall at rest"], record, beta=0.3, samples="none")
    without = fm.history(_SYSTEMS["wall at rest"], record, beta=0.3, samples="none", beta_hold=False)
    assert with_hold.beta_hold.item() > 0.3
    assert np.isnan(without.beta_hold.item())
    assert without.drop_vars("beta_hold").equals(with_hold.drop_vars("beta_hold"))
    with pytest.raises(fm.InputError, match="beta_hold must be true or false; got 1"):
        fm.history(_SYSTEMS["wall at rest"], record, beta_hold=1)
