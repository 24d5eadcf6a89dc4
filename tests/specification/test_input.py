"""Chains, contacts and axes that are refused."""

import math

import pytest

import frictionmap as fm

pytestmark = pytest.mark.plain


@pytest.mark.parametrize(
    ("r", "message"),
    [
        ([], "r must have at least one value"),
        ([0.5, 0.2], "r must be increasing; got 0.2 at index 1"),
        ([-1.0], "r must be >= 0; got -1"),
        ([math.nan], "r must be finite"),
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


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"mass_ratios": [1.0, 2.0]}, "stiffness_ratios must have as many values as mass_ratios"),
        ({"contact": "between-masses"}, "for one mass"),
        ({"contact_masses": [3]}, r"contact_masses\[0\] must be <= 1; got 3"),
        ({"contact_masses": [1, 1]}, "must name one mass"),
        ({"load_mass": 2}, "load_mass must be <= 1; got 2"),
        ({"mass_ratios": [1.0, -1.0], "stiffness_ratios": [1, 1]}, r"mass_ratios\[1\] must be > 0; got -1"),
        ({"mass_ratios": [2.0]}, "must be 1, the unit"),
        ({"damping_ratios": [0.1, 0.2]}, "one number, or one per mode"),
    ],
)
def test_bad_systems(arguments, message):
    with pytest.raises(fm.InputError, match=message):
        fm.System(**arguments)


def test_bad_contacts_of_many():
    many = {"mass_ratios": [1, 1, 1], "stiffness_ratios": [1, 1, 1]}
    with pytest.raises(fm.InputError, match="with A < B"):
        fm.System(contact="between-masses", contact_masses=[2, 2], **many)
    with pytest.raises(fm.InputError, match="two masses"):
        fm.System(contact="between-masses", contact_masses=[2], **many)
    with pytest.raises(fm.InputError, match="load_mass must be 1 for joined-base-wall"):
        fm.System(contact="joined-base-wall", load_mass=2, **many)
