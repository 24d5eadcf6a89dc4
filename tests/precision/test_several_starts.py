"""`also_reachable` of systems of the general engine: the regimes of both starts."""

import pytest

import frictionmap as fm

FALLING = {"speed": [0.0, 0.185], "factor": [1.0, 0.737]}


def one_mass(zeta, **contact):
    return fm.System(damping_ratios=zeta, contacts=[fm.Contact("fixed-wall", [1], **contact)])


def test_falling_friction_keeps_a_large_motion_going():
    """A row of an independent program never stops; from rest there are stops."""
    asked = {"r": [0.901], "beta": [0.979], "outputs": ["regime", "also_reachable", "unique"]}
    ds = fm.sweep(one_mass(0.027, law=FALLING), **asked)
    assert ds.also_reachable.item() == 1 << fm.regimes.STICK_SLIP | 1 << fm.regimes.CONTINUOUS
    assert fm.sweep(one_mass(0.027, law=FALLING), start="moving", **asked).also_reachable.item() == 6
    flat = fm.sweep(one_mass(0.027, force=0.3), r=[0.901], beta=[0.979], outputs=["regime", "also_reachable"])
    assert flat.also_reachable.item() == 1 << flat.regime.item()


@pytest.mark.parametrize("mu", [1.0, 1.6])
def test_the_engine_of_one_contact_finds_these_too(mu):
    """It tries more starts; where mu = 1 there is one regime."""
    r, beta = [0.5, 0.8, 1.3], [0.3, 0.8, 1.1]
    outputs = ["regime", "also_reachable"]
    plain = fm.sweep(fm.System(damping_ratios=0.1), r, beta, mu=mu, outputs=outputs).also_reachable.values
    general = fm.sweep(one_mass(0.1, ratio=1.0), r, beta, mu=mu, outputs=outputs)
    found = general.also_reachable.values
    assert (found & ~plain == 0).all()
    assert (found & (1 << general.regime.values) != 0).all()
    assert ((found & (found - 1)) != 0).any() == (mu > 1.0)


def test_one_way_sliding_has_a_bit():
    ds = fm.sweep(one_mass(0.1, wall_speed=3.0), [0.5], [0.2], outputs=["regime", "also_reachable"])
    assert ds.also_reachable.item() == 1 << fm.regimes.ONE_WAY_SLIDING
    assert ds.also_reachable.attrs["flag_masks"].tolist() == [1, 2, 4, 8]
    assert fm.sweep(fm.System(), [0.5], [0.2], outputs=["also_reachable"]).also_reachable.attrs[
        "flag_masks"
    ].tolist() == [1, 2, 4]


def test_a_response_is_of_one_start():
    assert "also_reachable" not in fm.response(one_mass(0.027, law=FALLING), 0.901, 0.979)
