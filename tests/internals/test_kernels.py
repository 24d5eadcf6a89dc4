"""The rules that kernels are compiled under."""

import numpy as np
import pytest
from kernels import callable_kernel
from numba import config, njit

from frictionmap._kernels.compiler import entry, kernel

compiled_only = pytest.mark.skipif(bool(config.DISABLE_JIT), reason="nothing is compiled")


@kernel
def _power(x, n):
    return x**n


@entry
def _powers(x, n):
    return _power(x, 2) + _power(x, n)


@kernel
def _row(table):
    return 0, (table[0],)


@compiled_only
def test_python_calls_entries_only():
    with pytest.raises(TypeError, match="_power can be called by kernels only; Python calls an entry"):
        _power(2.0, 3)
    assert _powers(2.0, 3) == 12.0
    with pytest.raises(TypeError, match="_power can be called by kernels only"):
        _power(2.0, 3)  # still, after it was compiled


@compiled_only
def test_a_constant_does_not_compile_a_kernel_anew():
    njit(lambda x, n: _power(x, 2) + _power(x, n))(3.0, 3)
    assert len(_power.overloads) == 1


@compiled_only
def test_a_kernel_must_not_return_an_array():
    with pytest.raises(TypeError, match="_row must not return an array"):
        callable_kernel(_row)(np.zeros((2, 3)))
