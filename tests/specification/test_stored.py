"""What a dataset remembers of how it was made."""

import numpy as np
import pytest
import xarray as xr

import frictionmap as fm
from frictionmap.files.stored import stored_start, stored_system

CHAIN = """
title = "start = 'moving'"  # a title is not a setting
[system]
contact_masses = [2]
mass_ratios = [1.0, 0.5]
stiffness_ratios = [1.0, 0.5]
"""


def remembering(text):
    return xr.Dataset(attrs={"config": text})


def test_the_system_is_that_of_the_configuration():
    expected = fm.System(contact_masses=[2], mass_ratios=[1.0, 0.5], stiffness_ratios=[1.0, 0.5])
    found = stored_system(remembering(CHAIN))
    assert found.describe() == expected.describe()
    np.testing.assert_array_equal(found.modes.w, expected.modes.w)


@pytest.mark.parametrize(
    ("solver", "start"),
    [
        ("", "rest"),
        ("[solver]\ncycles = 10", "rest"),
        ('[solver]\nstart = "moving"', "moving"),
        ("[solver]\nstart = 'rest'", "rest"),
    ],
)
def test_the_start_is_that_of_the_configuration(solver, start):
    assert stored_start(remembering(CHAIN + solver)) == start


@pytest.mark.parametrize(
    "text",
    [
        "",
        "not TOML",
        "[grid]\nr = [1.0]",
        "system = 3",
        '[system]\nwhat = "?"',
        "[system]\nmass_ratios = [-1.0]",
    ],
)
def test_nothing_is_made_up(text):
    assert stored_system(remembering(text)) is None


def test_a_system_of_matrices_is_not_looked_for():
    assert stored_system(remembering('[system]\nmatrices = "frame.npz"')) is None
    assert stored_start(remembering('[system]\nmatrices = "frame.npz"')) == "rest"


def test_without_a_configuration_there_is_nothing():
    assert stored_system(xr.Dataset()) is None
    assert stored_start(xr.Dataset()) is None
