"""What goes on after a record: bases that keep a velocity, and motions that go on under another load."""

import numpy as np
import pytest

import frictionmap as fm

#: The base moves at the velocity 1 from t = 2 on, where its place is 1.
KICK = fm.Record([0.0, 1.0, 0.0], 1.0)

CHAIN = {"mass_ratios": [1.0, 0.7], "stiffness_ratios": [1.0, 1.3], "damping_ratios": 0.05}
BANK = {"stiffness": [1.5], "ratio": [1.0], "bank": "contact"}
FAR = [{"masses": [1, 2], "backlash": 1e3, "stiffness": 1.0}]


@pytest.mark.parametrize("contact", [{}, {"stiffness": 1e3}, BANK | {"stiffness": [1e3]}])
@pytest.mark.parametrize("scale", [1.0, -2.0])
def test_a_base_that_moves_on_drags_its_mass_along_the_wall(contact, scale):
    """A mass that its wall holds in space slips where the spring to the base, over its place, needs beta."""
    system = fm.System(
        excitation="base", damping_reference="base", damping_ratios=0.05,
        contacts=[fm.Contact("fixed-wall", 1, **contact)],
    )  # fmt: skip
    ds = fm.history(system, KICK, beta=5.0, scale=scale, samples="none")
    velocity = abs(scale)
    held = (5.0 - 0.1 * velocity) / velocity  # place of the base over its velocity: 2 zeta of the damper
    assert ds.first_motion.item() == pytest.approx(1.0 + held, rel=1e-2 if contact else 1e-12)
    assert ds.status.item() == 2  # it slides permanently, ever less relative to the base
    assert ds.residual.item() == pytest.approx(-5.0 * np.sign(scale), rel=1e-9)
    assert np.isinf(ds.beta_hold.item())
    assert np.isfinite(fm.history(system, KICK, beta=5.0, after=10.0, samples="none").beta_hold.item())


@pytest.mark.parametrize("contact", [{}, {"stiffness": 1.5}, BANK])
@pytest.mark.parametrize("springs", [[], FAR])
def test_dampers_to_the_ground_hold_masses_aside_of_a_base_that_moves_on(contact, springs):
    if springs and "bank" in contact:
        return
    system = fm.System(
        excitation="base", contacts=[fm.Contact("joined-base-wall", 2, **contact)], springs=springs or None,
        **CHAIN,
    )  # fmt: skip
    for scale in (1.0, -3.0):
        ds = fm.history(system, KICK, beta=0.3, scale=scale, samples="none")
        late = fm.history(system, KICK, beta=0.3, scale=scale, after=400.0)
        assert ds.status.item() == 0
        rest = late.x.values[..., -1].ravel()
        np.testing.assert_allclose(ds.residual.values.ravel(), rest, rtol=0.0, atol=1e-7)
        forces = system.modes.stiffness @ rest + scale * system.modes.damping.sum(axis=1)
        assert forces[0] == pytest.approx(0.0, abs=1e-7)


@pytest.mark.parametrize("springs", [[], FAR])
@pytest.mark.parametrize("zeta", [0.05, 2.0])
def test_beta_hold_counts_dampers_over_which_a_base_moves_on(springs, zeta):
    system = fm.System(
        excitation="base", contacts=[fm.Contact("joined-base-wall", 2)], springs=springs or None,
        **CHAIN | {"damping_ratios": zeta},
    )  # fmt: skip
    gentle = fm.Record([0.0, 0.05, 0.0], 20.0)
    hold = fm.history(system, gentle, samples="none").beta_hold.item()
    options = {"samples": "none", "beta_hold": False}
    above, below = (fm.history(system, gentle, beta=hold * (1.0 + e), **options) for e in (1e-9, -1e-9))
    assert np.isnan(above.first_motion.item())
    assert np.isfinite(below.first_motion.item())


def _steady():
    """A rigid contact that sticks at tau = 0, after the peak of the load."""
    system = fm.System(contacts=[fm.Contact(masses=[2])], load=[0.6 + 0.8j, 0.0], **CHAIN)
    ds = fm.response(system, 0.4, 0.5)
    assert ds.direction.values.ravel()[0] == 0
    return ds


@pytest.mark.parametrize("springs", [[], FAR])
@pytest.mark.parametrize("load", [-1.0, -3.0, 2.0])
def test_the_law_decides_at_once_where_a_motion_continues_under_another_load(springs, load):
    """As from the same displacements and velocities."""
    steady = _steady()
    system = fm.System(contacts=[fm.Contact(masses=[2])], springs=springs or None, **CHAIN)
    record = fm.Record([load, load, 0.0], 0.4, quantity="force", mass=2)
    state = {name: rate * steady[name].values.reshape(2, -1)[:, 0] for name, rate in (("x", 1.0), ("v", 0.4))}
    one, two = (fm.history(system, record, beta=0.5, start=start) for start in (steady, state))
    assert np.abs(one.friction.values).max() <= 0.5 * (1.0 + 1e-9)
    for name in ("x_max", "x_min", "residual", "work_friction", "stops", "first_motion"):
        np.testing.assert_allclose(one[name], two[name], rtol=1e-9, atol=1e-9, err_msg=name)


@pytest.mark.parametrize("springs", [[], FAR])
@pytest.mark.parametrize("time", [1, 2, 4])
def test_springs_slip_at_once_where_a_motion_continues_with_less_friction(springs, time):
    """As a bank of one element does, whose elongations are limited where it begins."""
    values = np.array([1.0, 2.0, -1.0, 1.5, -2.0, 1.0])
    found = []
    for own in ({"stiffness": 1.5}, BANK):
        there = springs if own is not BANK and springs else None
        system = fm.System(contacts=[fm.Contact(masses=[2], **own)], springs=there, **CHAIN)
        first = fm.Record(values[: time + 1], 0.9, quantity="force", mass=2)
        second = fm.Record(values[time:], 0.9, quantity="force", mass=2)
        one = fm.history(system, first, beta=0.6, after=0.0)
        found += [fm.history(system, second, beta=beta, after=3.0, start=one) for beta in (0.2, 0.6, 1.0)]
    for one, two in zip(found[:3], found[3:], strict=True):
        assert one.status.item() == two.status.item() == 0
        for name in ("x_max", "x_min", "energy", "work_load"):
            np.testing.assert_allclose(one[name], two[name], rtol=1e-9, atol=1e-9, err_msg=name)
        np.testing.assert_allclose(one.x.values[..., -1], two.x.values[..., -1], rtol=0.0, atol=1e-9)
