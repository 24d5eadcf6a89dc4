"""Frequency and damping over amplitude of decays whose turning points are known."""

import numpy as np
import pytest

import frictionmap as fm

SILENCE = fm.Record([0.0, 0.0], 0.05, quantity="force")


def test_a_linear_mode_has_its_own_numbers_at_every_amplitude():
    zeta, k = 0.03, 1.5
    system = fm.System(damping_ratios=zeta, contact_stiffness=k)
    ds = fm.history(system, SILENCE, beta=100.0, start={"x": [0.0], "v": [1.0]}, after=60.0)
    found, own = fm.ring_down(ds), np.sqrt(1.0 + k)
    assert found.turn.size > 20
    np.testing.assert_allclose(found.damping_ratio, zeta / own, rtol=1e-6)
    np.testing.assert_allclose(found.frequency, np.sqrt(own**2 - zeta**2), rtol=1e-6)
    shares = found.amplitude / found.amplitude[0]
    np.testing.assert_allclose(np.abs(found.x / found.x[0]), shares, rtol=1e-6)


def test_dry_friction_takes_the_same_from_every_swing():
    """Turning points of a mass without damping: 2 beta nearer each time, half a natural period apart."""
    beta, x0 = 0.1, 3.05
    ds = fm.history(fm.System(), SILENCE, beta=beta, start={"x": [x0], "v": [0.0]})
    found = fm.ring_down(ds)
    n = np.arange(found.turn.size)
    np.testing.assert_allclose(np.abs(found.x), x0 - 2.0 * beta * (n + 1.0), rtol=1e-8)
    swings = 2.0 * (x0 - beta - 2.0 * beta * np.arange(n.size + 1.0))
    np.testing.assert_allclose(found.amplitude, 0.5 * np.sqrt(swings[:-1] * swings[1:]), rtol=1e-8)
    np.testing.assert_allclose(found.frequency, 1.0, rtol=1e-8)


def test_a_decay_in_seconds_has_hertz():
    units = fm.Units(natural_frequency="4 Hz", stiffness="1000 N/m", load="1 N")
    silence = fm.Record([0.0, 0.0], 0.002, quantity="force", unit="N")
    ds = fm.history(fm.System(), silence, beta=0.1, start={"x": [3.05], "v": [0.0]}, units=units)
    found = fm.ring_down(ds)
    assert found.frequency.attrs["units"] == "Hz"
    np.testing.assert_allclose(found.frequency, 4.0, rtol=1e-8)
    np.testing.assert_allclose(found.time, 0.125 * (1.0 + np.arange(found.turn.size)), rtol=1e-8)


def test_it_begins_where_the_load_ends():
    pulse = fm.Record.pulse("half-sine", 2.0, 3.0, quantity="force")
    ds = fm.history(fm.System(damping_ratios=0.01), pulse, beta=0.02, after=40.0)
    found = fm.ring_down(ds)
    assert found.time.values[0] > 3.0
    assert fm.ring_down(ds, start=20.0).time.values[0] > 20.0


def test_the_damping_of_a_lap_joint_is_what_its_elements_lose():
    """Nothing else loses energy, and the frequency rises towards that of all springs."""
    k = np.full(20, 0.05)
    joint = fm.Contact(stiffness=k.tolist(), ratio=(k * np.linspace(0.1, 2.0, 20)).tolist(), bank="contact")
    ds = fm.history(
        fm.System(contacts=[joint]), SILENCE, beta=1.0, start={"x": [1.5], "v": [0.0]}, after=80.0
    )
    found = fm.ring_down(ds)
    assert (np.diff(found.amplitude) < 0.0).all()
    assert (np.diff(found.frequency) > -1e-6).all()
    assert 1.0 < found.frequency.values[0] < found.frequency.values[-1] < np.sqrt(2.0)
    one = ds.squeeze()
    time, total = one.time.values, (one.stored_energy + one.lost_friction).values
    assert np.ptp(total) < 1e-12 * total[0]
    # an element that has turned slips again after twice its limit
    lost = np.diff(np.interp(found.time, time, one.lost_friction.values))
    u, swings = np.linspace(0.1, 2.0, 20), np.abs(np.diff(found.x))[:, np.newaxis]
    np.testing.assert_allclose(lost, (k * u * np.maximum(swings - 2.0 * u, 0.0)).sum(axis=1), atol=1e-9)


REFUSED = [
    ({"samples": "none"}, {}, "ds must be of history with its samples; got no"),
    ({"beta": [0.1, 0.2]}, {}, "ds must be one motion; got 2 of beta"),
    ({}, {"dof": 2}, r"dof must be one of \[1\]; got 2"),
    ({}, {"start": 9.9}, "start must leave three turning points at least; got"),
]  # fmt: skip


@pytest.mark.parametrize(("given", "asked", "message"), REFUSED)
def test_what_is_refused_of_a_ring_down(given, asked, message):
    given = {"beta": 0.1, "start": {"x": [1.05], "v": [0.0]}, **given}
    with pytest.raises(fm.InputError, match=message):
        fm.ring_down(fm.history(fm.System(), SILENCE, **given), **asked)
