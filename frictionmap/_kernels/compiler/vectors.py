"""Vectors of eight doubles that kernels compute with at once.

A vector is LLVM's `<8 x double>`: one register of AVX-512, two of AVX, four of SSE2.  Every operation rounds
each lane on its own and `total` adds the lanes in a fixed order, so that the bits are the same on all of
them.  With NUMBA_DISABLE_JIT=1 a vector is a numpy array of eight numbers, with the same bits again.

Vectors are added, subtracted and multiplied, with each other and with numbers, but not in place.  A kernel
keeps them in local variables only: it neither returns nor stores them, except by `store`.
"""

import inspect
import operator
from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba import config, types
from numba.extending import lower_builtin, models, register_model, type_callable

#: Numbers in a vector, and the numbers of the lanes.
LANES = 8
RAMP = np.arange(float(LANES))

#: Number of lanes from the first on in which a condition holds, for every mask of `mask_above`.
LEADING = np.array([next((i for i in range(LANES) if not mask >> i & 1), LANES) for mask in range(2**LANES)])


def filled(number):
    """Return a vector with the same number in all lanes."""
    return np.full(LANES, number)


def load(array, position):
    """Load eight numbers of a contiguous array; `position` is that of the first in its memory order."""
    lanes = array.reshape(-1)[position : position + LANES].copy()
    if position < 0 or lanes.size != LANES:
        raise IndexError(f"no {LANES} numbers at {position} in an array of {array.size}")
    return lanes


def store(vector, array, position):
    """Store a vector in a contiguous array; see `load`."""
    array.reshape(-1)[position : position + LANES] = vector


def lane(vector, i):
    """Return the number in lane i."""
    return float(vector[i])


def delayed(first, vector):
    """Move every lane up by one; `first` becomes lane 0 and the last lane is lost."""
    return np.concatenate(([first], vector[:-1]))


def least(a, b):
    """Return the smaller number of every lane; b where one is NaN."""
    return np.where(a < b, a, b)


def most(a, b):
    """Return the larger number of every lane; b where one is NaN."""
    return np.where(a > b, a, b)


def magnitude(a):
    """Return the absolute value of every lane."""
    return np.abs(a)


def root(a):
    """Return the square root of every lane."""
    return np.sqrt(a)


def total(vector):
    """Add all lanes: those four apart, then two apart, then the last two."""
    four = vector[:4] + vector[4:]
    two = four[:2] + four[2:]
    return float(two[0] + two[1])


def mask_above(a, b):
    """Return an integer whose bit i is 1 where lane i of `a` is above that of b; 0 where one is NaN."""
    return int(np.sum((a > b) * (1 << np.arange(LANES))))


_REGISTER = ir.VectorType(ir.DoubleType(), LANES)
_UNDEFINED = ir.Constant(_REGISTER, ir.Undefined)
_INT = ir.IntType(32)


class _VectorType(types.Type):
    def __init__(self) -> None:
        super().__init__(name=f"vector{LANES}")


_VECTOR = _VectorType()


@register_model(_VectorType)
class _VectorModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: types.Type) -> None:
        super().__init__(manager, kind, _REGISTER)


def _in_kernels(function: Callable, result: types.Type, *kinds: Any) -> Callable[[Callable], Callable]:
    """Let kernels call a function with arguments of these kinds; the decorated function writes its code.

    function : what plain Python runs
    result   : type of its result
    kinds    : types of its arguments, or types.Array for any contiguous array of doubles
    """

    def typed(*given: Any) -> Any:
        wanted = [
            a if kind is types.Array and isinstance(a, types.Array) else kind
            for kind, a in zip(kinds, given, strict=True)
        ]
        arrays = [kind for kind in wanted if isinstance(kind, types.Array)]
        if types.Array in wanted or any(a.layout != "C" or a.dtype is not types.float64 for a in arrays):
            return None
        vectors = [(kind is _VECTOR, a is _VECTOR) for kind, a in zip(wanted, given, strict=True)]
        return result(*wanted) if all(here == there for here, there in vectors) else None

    def declare(write: Callable) -> Callable:
        typed.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
            [inspect.Parameter(f"a{i}", inspect.Parameter.POSITIONAL_OR_KEYWORD) for i in range(len(kinds))]
        )
        type_callable(function)(lambda _: typed)
        lower_builtin(function, *kinds)(write)
        return write

    return declare


def _splat(builder: ir.IRBuilder, number: ir.Value) -> ir.Value:
    """Return a vector with the same number in all lanes."""
    first = builder.insert_element(_UNDEFINED, number, ir.Constant(_INT, 0))
    return builder.shuffle_vector(first, _UNDEFINED, _lanes([0] * LANES))


def _lanes(numbers: list[int]) -> ir.Constant:
    return ir.Constant(ir.VectorType(_INT, len(numbers)), numbers)


def _write_operator(instruction: str) -> Callable:
    def write(_: Any, builder: ir.IRBuilder, signature: Any, arguments: tuple) -> ir.Value:
        return getattr(builder, instruction)(*_vectors(builder, signature, arguments))

    return write


def _vectors(builder: ir.IRBuilder, signature: Any, arguments: tuple) -> list[ir.Value]:
    """Return the arguments with numbers as vectors."""
    return [
        value if kind is _VECTOR else _splat(builder, value)
        for kind, value in zip(signature.args, arguments, strict=True)
    ]


#: Kinds of the arguments of operators.
_PAIRS = ((_VECTOR, _VECTOR), (_VECTOR, types.float64), (types.float64, _VECTOR))

for _operator, _instruction in ((operator.add, "fadd"), (operator.sub, "fsub"), (operator.mul, "fmul")):
    for _kinds in _PAIRS:
        _in_kernels(_operator, _VECTOR, *_kinds)(_write_operator(_instruction))


@_in_kernels(filled, _VECTOR, types.float64)
def _write_filled(_: Any, builder: ir.IRBuilder, signature: Any, arguments: tuple) -> ir.Value:
    return _splat(builder, *arguments)


def _address(context: Any, builder: ir.IRBuilder, kind: Any, array: ir.Value, position: ir.Value) -> ir.Value:
    """Address of eight numbers of an array; IndexError if they are not in it, where that is checked."""
    view = context.make_array(kind)(context, builder, array)
    if config.BOUNDSCHECK:
        starts = builder.icmp_signed(">=", position, ir.Constant(position.type, 0))
        end = builder.add(position, ir.Constant(position.type, LANES))
        inside = builder.and_(starts, builder.icmp_signed("<=", end, view.nitems))
        with builder.if_then(builder.not_(inside), likely=False):
            context.call_conv.return_user_exc(builder, IndexError, ("vector is out of bounds",))
    return builder.bitcast(builder.gep(view.data, [position]), _REGISTER.as_pointer())


@_in_kernels(load, _VECTOR, types.Array, types.intp)
def _write_load(context: Any, builder: ir.IRBuilder, signature: Any, arguments: tuple) -> ir.Value:
    return builder.load(_address(context, builder, signature.args[0], *arguments), align=8)


@_in_kernels(store, types.none, _VECTOR, types.Array, types.intp)
def _write_store(context: Any, builder: ir.IRBuilder, signature: Any, arguments: tuple) -> ir.Value:
    vector, array, position = arguments
    builder.store(vector, _address(context, builder, signature.args[1], array, position), align=8)
    return context.get_dummy_value()


@_in_kernels(lane, types.float64, _VECTOR, types.intp)
def _write_lane(_: Any, builder: ir.IRBuilder, signature: Any, arguments: tuple) -> ir.Value:
    return builder.extract_element(*arguments)


@_in_kernels(delayed, _VECTOR, types.float64, _VECTOR)
def _write_delayed(_: Any, builder: ir.IRBuilder, signature: Any, arguments: tuple) -> ir.Value:
    first, vector = arguments
    return builder.shuffle_vector(vector, _splat(builder, first), _lanes([LANES, *range(LANES - 1)]))


def _write_choice(sign: str) -> Callable:
    def write(_: Any, builder: ir.IRBuilder, signature: Any, arguments: tuple) -> ir.Value:
        return builder.select(builder.fcmp_ordered(sign, *arguments), *arguments)

    return write


_in_kernels(least, _VECTOR, _VECTOR, _VECTOR)(_write_choice("<"))
_in_kernels(most, _VECTOR, _VECTOR, _VECTOR)(_write_choice(">"))


@_in_kernels(magnitude, _VECTOR, _VECTOR)
def _write_magnitude(_: Any, builder: ir.IRBuilder, signature: Any, arguments: tuple) -> ir.Value:
    whole = ir.VectorType(ir.IntType(64), LANES)
    without_sign = ir.Constant(whole, [2**63 - 1] * LANES)
    return builder.bitcast(builder.and_(builder.bitcast(arguments[0], whole), without_sign), _REGISTER)


@_in_kernels(root, _VECTOR, _VECTOR)
def _write_root(_: Any, builder: ir.IRBuilder, signature: Any, arguments: tuple) -> ir.Value:
    name = f"llvm.sqrt.v{LANES}f64"
    known = builder.module.globals.get(name)
    kind = ir.FunctionType(_REGISTER, [_REGISTER])
    return builder.call(known or ir.Function(builder.module, kind, name), arguments)


@_in_kernels(total, types.float64, _VECTOR)
def _write_total(_: Any, builder: ir.IRBuilder, signature: Any, arguments: tuple) -> ir.Value:
    (vector,) = arguments
    for apart in (4, 2, 1):
        other = builder.shuffle_vector(
            vector, ir.Constant(vector.type, ir.Undefined), _lanes([i + apart for i in range(apart)])
        )
        same = builder.shuffle_vector(
            vector, ir.Constant(vector.type, ir.Undefined), _lanes(list(range(apart)))
        )
        vector = builder.fadd(same, other)
    return builder.extract_element(vector, ir.Constant(_INT, 0))


def _write_mask_above(_: Any, builder: ir.IRBuilder, signature: Any, arguments: tuple) -> ir.Value:
    bits = builder.fcmp_ordered(">", *_vectors(builder, signature, arguments))
    return builder.zext(builder.bitcast(bits, ir.IntType(LANES)), ir.IntType(64))


for _kinds in _PAIRS:
    _in_kernels(mask_above, types.intp, *_kinds)(_write_mask_above)
