"""Chains, contacts and axes that are refused."""

import pytest

import frictionmap as fm

pytestmark = pytest.mark.plain


@pytest.mark.parametrize(
    ("r", "message"),
    [
        ([], "r must have at least one value"),
        ([1e9], "r must be <= 1e"),
        ("fast", "r must be numbers"),
    ],
)
def test_bad_axes(r, message):
    with pytest.raises(fm.InputError, match=message):
        fm.boundaries(fm.System(), r)


def test_bad_mu():
    with pytest.raises(fm.InputError, match=r"mu must be >= 1; got 0\.5"):
        fm.boundaries(fm.System(), [1.0], [0.5])


def test_bad_contacts_of_many():
    many = {"mass_ratios": [1, 1, 1], "stiffness_ratios": [1, 1, 1]}
    with pytest.raises(fm.InputError, match="with A < B"):
        fm.System(contact="between-masses", contact_masses=[2, 2], **many)
    with pytest.raises(fm.InputError, match="two masses"):
        fm.System(contact="between-masses", contact_masses=[2], **many)
    with pytest.raises(fm.InputError, match="load_mass must be 1 for joined-base-wall"):
        fm.System(contact="joined-base-wall", load_mass=2, **many)
