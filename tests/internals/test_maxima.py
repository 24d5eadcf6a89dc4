"""Maxima of functions of one variable: smooth ones, kinks and jumps, many at a time."""

import numpy as np

from frictionmap.design.extremes import brackets_of, joined, refine_maxima

X = np.linspace(0.0, 1.0, 12)


def smooth(x):
    return 2.0 - (x - 0.3712) ** 2 * (1.0 + x)


def kink(x):
    return 1.5 - np.where(x < 0.6181, 3.0, 0.2) * np.abs(x - 0.6181)


def jump(x):
    return np.where(x <= 0.52340011, 1.0 + x, 0.5 + x)


def jump_down_from_below(x):
    return np.where(x >= 0.4441234, 2.0 - x, 0.1)


FUNCTIONS = (smooth, kink, jump, jump_down_from_below)
PLACES = (0.3712, 0.6181, 0.52340011, 0.4441234)


class Counted:
    """The functions, with the rounds and places that they were asked for."""

    def __init__(self):
        self.rounds, self.places = 0, np.zeros(len(FUNCTIONS), int)

    def __call__(self, which, x):
        self.rounds += 1
        np.add.at(self.places, which, 1)
        return np.array([float(FUNCTIONS[k](value)) for k, value in zip(which, x, strict=True)])


def test_every_kind_of_maximum_is_found():
    functions = Counted()
    parts = [brackets_of(X, function(X)) for function in FUNCTIONS]
    inside = [np.flatnonzero((part.m > 0.0) & (part.m < 1.0)) for part in parts]
    places, values = refine_maxima(
        functions,
        joined([type(part)(*(array[k] for array in part)) for part, k in zip(parts, inside, strict=True)]),
    )
    exact = np.array([function(place) for function, place in zip(FUNCTIONS, PLACES, strict=True)])
    assert np.abs(values / exact - 1.0).max() < 1e-9
    assert np.abs(places - PLACES).max() < 1e-5
    assert functions.rounds < 20


def test_lower_maxima_of_a_group_are_left_rough():
    parts = [brackets_of(X, function(X)) for function in FUNCTIONS[:2]]
    alone, together = Counted(), Counted()
    _, wanted = refine_maxima(alone, joined(parts))
    _, found = refine_maxima(together, joined(parts), np.zeros(2, int))
    assert found[0] == wanted[0]
    assert found[1] <= wanted[1] < wanted[0]
    assert together.places[1] < alone.places[1]
