"""A few kernels of every sort, for tests of the compiler."""

from typing import NamedTuple

import numpy as np

from frictionmap._kernels.compiler import by_class, entry, inner_kernel, kernel


class Number(NamedTuple):
    number: float


class Row(NamedTuple):
    row: np.ndarray


@inner_kernel
def power(x, n):
    return x**n


@kernel
def of_number(number, x):
    return number.number * power(x, 2)


@kernel
def of_row(row, x):
    return row.row[0] * power(x, 3)


@by_class((Number, of_number), (Row, of_row))
def value(_, x):
    """The square or the cube of x, times a factor."""


@kernel
def pair(factor, x):
    return value(factor, x) + value(factor, 2 * x)


@entry
def total(factor, xs):
    found = np.zeros(1)
    for x in xs:
        found[0] += pair(factor, x)
    return found


def _twice(factor, xs):
    return 2.0 * total(factor, xs)


#: The first is loaded from disk if it can be, the second is compiled in every process.
twice = entry(_twice)
twice_compiled = entry(_twice, keep=False)

#: 5 (0 + 1 + 4 + 9), 9 (0 + 1 + 8 + 27), and twice the first.
ANSWERS = [70.0, 324.0, 140.0]


def answers(double=twice):
    """The values of the entries."""
    xs = np.arange(4.0)
    found = total(Number(1.0), xs), total(Row(np.ones(2)), xs), double(Number(1.0), xs)
    return [float(value[0]) for value in found]
