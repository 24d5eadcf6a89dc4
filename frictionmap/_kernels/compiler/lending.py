"""Named tuples that Python makes and lends to entries by their address.

An entry that takes a named tuple of a hundred arrays, or makes one, costs seconds to compile: numba writes
code for each of some seven numbers per array, and for the references of every array.  `made` runs what
allocates as a Python function, and `lent` puts a tuple into memory in the form of `packed`: the entry takes
one address.
"""

import math
import struct
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from ctypes import addressof, c_char
from functools import cache
from types import FunctionType, SimpleNamespace
from typing import Any, Generic, TypeVar

import numba
import numpy as np
from numba import config
from numba.extending import NativeValue, typeof_impl, unbox

from .packed import Packed

T = TypeVar("T")

#: Bytes that arrays begin at a multiple of: a vector then lies in one line of the processor's memory.
_LINE = 64

#: Bytes that are allocated at once for small arrays.
_CUT = 1 << 16


class _Lent:
    """A named tuple in memory, as long as this object lives.

    address : of the tuple, laid out as LLVM does it
    kind : numba's type
    """

    def __init__(self, group: tuple) -> None:
        values: list[Any] = []
        alike = _describe(group, values)
        if alike not in _LAYOUTS:
            _LAYOUTS[alike] = struct.Struct("@" + _layout(group)), Packed(numba.typeof(group))
        layout, self.kind = _LAYOUTS[alike]
        self._group = group  # its arrays must live as long
        self._memory = np.frombuffer(layout.pack(*values), np.uint8)
        self.address = self._memory.ctypes.data


#: Layouts of tuples, and their types in numba, by the result of `_describe`: numba takes milliseconds.
_LAYOUTS: dict[tuple, tuple[struct.Struct, Packed]] = {}


def _describe(group: tuple, values: list[Any]) -> tuple:
    """Append the values that a named tuple is laid out with; return what decides on its layout and type."""
    kinds: list[Any] = [group.__class__]
    for one in group:
        if isinstance(one, np.ndarray):
            # without an owner, so that no references are counted
            values += (0, 0, one.size, one.itemsize, _address(one), *one.shape, *one.strides)
            kinds.append((one.dtype, one.ndim, one.flags.num))
        elif isinstance(one, tuple):
            kinds.append(_describe(one, values))
        else:
            values.append(one)
            kinds.append(one.__class__)
    return tuple(kinds)


def _address(array: np.ndarray) -> int:
    """Where an array lies; a fifth of the time of `array.ctypes.data` for those that `made` makes."""
    if array.size and array.flags.carray:  # others have no buffer for ctypes
        return addressof(c_char.from_buffer(array))
    return array.ctypes.data


def _layout(group: tuple) -> str:
    """The layout of a named tuple as a format of `struct`."""
    found = "0q"  # a tuple begins, and ends, at a multiple of eight bytes
    for one in group:
        if isinstance(one, np.ndarray):
            found += f"2P2qP{2 * one.ndim}q"
        elif isinstance(one, tuple):
            found += _layout(one)
        else:
            whole = isinstance(one, (int, np.integer))
            found += "?" if isinstance(one, (bool, np.bool_)) else "q" if whole else "d"
    return found + "0q"


@typeof_impl.register(_Lent)
def _type_of_lent(lent: _Lent, _: Any) -> Packed:
    return lent.kind


@unbox(Packed)
def _unbox_lent(kind: Packed, lent: Any, context: Any) -> NativeValue:
    number = context.pyapi.object_getattr_string(lent, "address")
    address = context.pyapi.long_as_voidptr(number)
    context.pyapi.decref(number)
    return NativeValue(context.builder.bitcast(address, context.context.get_value_type(kind)))


def lent(group: Any) -> Any:
    """Return a named tuple of arrays, numbers and such tuples for entries to take.

    Kernels read its attributes as those of a packed tuple.  Arrays of the tuple may change, the tuple not.
    What is lent already is returned as it is.
    """
    return group if config.DISABLE_JIT or isinstance(group, _Lent) else _Lent(group)


class _Block(threading.local):
    """Memory that small arrays of one thread are cut from; each keeps the block that it lies in."""

    memory = np.zeros(0, np.uint8)
    free = 0  # bytes at its end


_BLOCK = _Block()


def _aligned(shape: Any, dtype: Any = float) -> np.ndarray:
    """Allocate zeros that begin at a multiple of _LINE bytes."""
    kind = np.dtype(dtype)
    size = (math.prod(shape) if isinstance(shape, tuple) else int(shape)) * kind.itemsize
    lines = max(1, -(-size // _LINE)) * _LINE
    if lines > _BLOCK.free:
        memory = np.zeros(max(lines, _CUT) + _LINE, np.uint8)
        first = -memory.ctypes.data % _LINE
        if lines > _CUT:
            return np.ndarray(shape, kind, memory, first)
        _BLOCK.memory, _BLOCK.free = memory[first : first + _CUT], _CUT
    array: np.ndarray = np.ndarray(shape, kind, _BLOCK.memory, _CUT - _BLOCK.free)
    _BLOCK.free -= lines
    return array


def _filled(shape: Any, value: Any) -> np.ndarray:
    found = _aligned(shape, np.asarray(value).dtype)
    found[...] = value
    return found


#: What entries that allocate call of numpy.
_NUMPY = SimpleNamespace(
    zeros=_aligned, empty=_aligned, full=_filled, ones=lambda shape: _filled(shape, 1.0), int64=np.int64,
    bool_=np.bool_, uint8=np.uint8, inf=np.inf, nan=np.nan,
)  # fmt: skip


@cache
def _in_python(function: Any) -> Callable:
    """A kernel, and all that it calls, as Python functions."""
    python = getattr(function, "py_func", function)
    names = python.__code__.co_names
    known = {name: value for name, value in python.__globals__.items() if name in names}
    for name, value in known.items():
        if value is np:
            known[name] = _NUMPY
        elif hasattr(value, "py_func"):
            known[name] = _in_python(value)
    return FunctionType(python.__code__, known, python.__name__, python.__defaults__, python.__closure__)


def made(entry: Callable[..., T], *arguments: Any) -> T:
    """Call an entry that allocates as a Python function, without compiling it."""
    found: T = _in_python(entry)(*arguments)
    return found


class Memories(Generic[T]):
    """Memory for jobs side by side: each takes what no other uses.

    make : allocates one
    """

    def __init__(self, make: Callable[[], T]) -> None:
        self._make = make
        self._free: list[T] = []

    @contextmanager
    def one(self) -> Iterator[T]:
        """Lend one for the time of a job; what an earlier job left in it must not matter."""
        try:
            memory = self._free.pop()
        except IndexError:
            memory = self._make()
        yield memory
        self._free.append(memory)
