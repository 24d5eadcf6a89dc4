"""Vectors of eight doubles: every operation compiled gives what numpy gives, to the bit."""

import platform

import numpy as np
import pytest

from frictionmap._kernels.compiler import entry, vectors
from frictionmap._kernels.compiler.vectors import (
    delayed,
    filled,
    lane,
    least,
    load,
    magnitude,
    mask_above,
    most,
    root,
    store,
    total,
)

pytestmark = pytest.mark.plain


def arithmetic(a, b, number, out):
    x, y = load(a, 0), load(b, 0)
    store(x + y * number - x * y, out, 0)
    store(number - x, out, 8)
    store(least(x, y), out, 16)
    store(most(x, y), out, 24)
    store(magnitude(x), out, 32)
    store(delayed(number, x), out, 40)
    store(root(magnitude(y)), out, 48)
    store(filled(number) + x, out, 56)
    return total(x), lane(y, 3), mask_above(x, y), mask_above(x, number), mask_above(number, y)


def moved(a, position, out):
    store(load(a, position), out, position)


compiled = entry(arithmetic, keep=False)


@pytest.mark.parametrize("seed", range(20))
def test_as_numpy(seed):
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=(2, 8)) * 10.0 ** rng.integers(-300, 300, size=(2, 8))
    a[rng.integers(8)] = rng.choice([np.nan, np.inf, -0.0, b[2]])
    number = float(rng.normal())
    out, other = np.zeros((8, 8)), np.zeros((8, 8))
    with np.errstate(all="ignore"):
        np.testing.assert_array_equal(compiled(a, b, number, out), arithmetic(a, b, number, other))
    np.testing.assert_array_equal(out.view(np.int64), other.view(np.int64))
    np.testing.assert_array_equal(out[2], np.where(a < b, a, b))


def test_position_counts_along_rows():
    a = np.arange(24.0).reshape(2, 12)
    out = np.zeros((2, 12))
    entry(moved, keep=False)(a, 9, out)
    np.testing.assert_array_equal(np.flatnonzero(out), np.arange(9, 17))
    moved(a, 3, out)
    np.testing.assert_array_equal(np.flatnonzero(out), np.arange(3, 17))


@pytest.mark.parametrize("position", [-1, 17, 30])
def test_positions_outside_are_refused_in_plain_python(position):
    with pytest.raises(IndexError, match="no 8 numbers"):
        vectors.load(np.zeros(24), position)


@pytest.mark.skipif(platform.machine() != "x86_64", reason="instructions of x86-64")
def test_instructions_work_on_whole_vectors():
    """Packed products, and no product joined with a sum, which would round once only."""
    if not hasattr(compiled, "inspect_asm"):
        pytest.skip("not compiled")
    out = np.zeros((8, 8))
    compiled(np.ones(8), np.ones(8), 1.0, out)
    assembly = "".join(compiled.inspect_asm().values())
    assert "mulpd" in assembly
    assert "fmadd" not in assembly
