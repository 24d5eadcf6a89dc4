"""Named tuples that kernels pass on by their address.

numba passes every array of a named tuple as some seven numbers on the stack, and a motion has sixty arrays:
a call would cost more than the kernel that it calls.  `packed` keeps a tuple in the memory of the function
that calls it; kernels get its address, and read an array where they use it.
"""

from typing import Any, TypeVar

from llvmlite import ir
from numba import types
from numba.core.typing.templates import AttributeTemplate
from numba.extending import (
    infer_getattr,
    lower_builtin,
    lower_getattr_generic,
    models,
    register_model,
    type_callable,
)

_Group = TypeVar("_Group", bound=tuple)

_INT = ir.IntType(32)


def packed(group: _Group) -> _Group:
    """Return a named tuple for kernels to pass on; valid until the calling function returns.

    Its attributes are those of the tuple; a named tuple in it is passed on by its address as well; a tuple
    that is packed already is returned as it is.  Nothing can replace an attribute, so that a kernel reads it
    once and not in every turn of a loop.  For the same reason `packed` must not be called in a loop: all its
    turns would share one place in memory.

    References of the arrays are not counted, so that somebody else must keep them.  A kernel may pack
    anything, because the entry that made the arrays keeps them; an entry only its arguments, which its caller
    keeps.
    """
    return group


class Packed(types.Type):
    def __init__(self, group: types.BaseNamedTuple) -> None:
        self.group = group
        super().__init__(name=f"packed({group.name})")

    @property
    def key(self) -> Any:
        return self.group

    def __hash__(self) -> int:
        return hash(self.name)  # a string keeps its hash; that of the group goes through all its members

    @property
    def instance_class(self) -> type:
        """The class of the tuple, as numba's type of the tuple has it."""
        return self.group.instance_class  # type: ignore[no-any-return]


@register_model(Packed)
class _Address(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Packed) -> None:
        super().__init__(manager, kind, manager[kind.group].get_data_type().as_pointer())


@type_callable(packed)
def _type_of_packed(_: Any) -> Any:
    def typed(group: Any) -> Any:
        if isinstance(group, Packed):
            return group
        return Packed(group) if isinstance(group, types.BaseNamedTuple) else None

    return typed


@lower_builtin(packed, types.BaseNamedTuple)
def _write_packed(context: Any, builder: ir.IRBuilder, signature: Any, arguments: tuple) -> ir.Value:
    (group,) = arguments
    model = context.data_model_manager[signature.args[0]]
    with builder.goto_entry_block():
        memory = builder.alloca(model.get_data_type())
    builder.store(model.as_data(builder, group), memory)
    # What `_read` reads is declared as constant, so that LLVM may read it at any time.  The address therefore
    # comes out of an instruction (an empty one) of which LLVM knows only that it follows the stores above.
    kind = ir.FunctionType(memory.type, [memory.type])
    return builder.asm(kind, "", "=r,0,~{memory}", [memory], side_effect=True)


@lower_builtin(packed, Packed)
def _keep_packed(context: Any, builder: ir.IRBuilder, signature: Any, arguments: tuple) -> ir.Value:
    return arguments[0]


@infer_getattr
class _Attributes(AttributeTemplate):
    key = Packed

    def generic_resolve(self, packed: Packed, name: str) -> Any:
        if name not in packed.group.fields:
            return None
        kind = packed.group[packed.group.fields.index(name)]
        return Packed(kind) if isinstance(kind, types.BaseNamedTuple) else kind


@lower_getattr_generic(Packed)
def _write_attribute(
    context: Any, builder: ir.IRBuilder, kind: Packed, address: ir.Value, name: str
) -> ir.Value:
    index = kind.group.fields.index(name)
    member = kind.group[index]
    place = builder.gep(address, [ir.Constant(_INT, 0), ir.Constant(_INT, index)], inbounds=True)
    if isinstance(member, types.BaseNamedTuple):
        return place
    value = _read(context, builder, member, place)
    if context.enable_nrt:  # plain numba counts references in all functions
        context.nrt.incref(builder, member, value)
    return value


def _read(context: Any, builder: ir.IRBuilder, kind: Any, place: ir.Value) -> ir.Value:
    """Read a member of a tuple that never changes."""
    block = builder.block
    before = len(block.instructions)
    value = context.data_model_manager[kind].load_from_data_pointer(builder, place)
    for instruction in block.instructions[before:]:
        if instruction.opname == "load":
            instruction.set_metadata("invariant.load", builder.module.add_metadata([]))
    return value
