"""Kernels that are compiled when a run calls them first, not together with the kernels that call them.

A kernel for something that most systems never meet costs them nothing: its caller holds an address that is
zero at first, and a call through it asks `_provide` for the kernel.  The types of the result are declared,
because the caller is compiled without it.
"""

import _thread
import contextlib
import ctypes
import inspect
import pickle
import threading
import time
from functools import update_wrapper
from importlib import import_module
from os import _exit
from typing import Any, NoReturn, get_type_hints

from llvmlite import binding, ir
from numba import types
from numba.core import cgutils
from numba.core.serialize import dumps
from numba.core.typing.templates import make_concrete_template
from numba.extending import lower_builtin

from . import plain
from .mode import mode
from .notices import log

_NUMBERS = {None: types.none, bool: types.boolean, int: types.intp, float: types.float64}

_ANY, _SIZE = ir.IntType(8).as_pointer(), ir.IntType(64)

#: Name under which compiled code finds `_provide`.
_SYMBOL = "frictionmap_provide"

#: Seconds after which an interrupt is repeated: in `_provide`, called by compiled code, it would be lost.
_SOON = 0.05


def result_type(declared: Any) -> Any:
    """Return numba's type of a declared result: None, bool, int, float, or a (named) tuple of these."""
    if isinstance(declared, tuple):
        return types.BaseTuple.from_types([result_type(part) for part in declared])
    if isinstance(declared, type) and issubclass(declared, tuple):
        parts = [result_type(part) for part in get_type_hints(declared).values()]
        return types.BaseTuple.from_types(parts, declared)
    return _NUMBERS[declared]


class Late:
    """A kernel that is compiled at its first call; numba's compiler asks it as it asks a compiled function.

    kernel : the kernel itself
    result : numba's type of its result
    """

    is_compiling = False  # a question for the kernel

    def __init__(self, kernel: Any, returns: Any) -> None:
        update_wrapper(self, kernel.py_func)
        self.py_func = kernel.py_func
        self.kernel = kernel
        self.result = result_type(returns)
        self._numba_type_ = types.Dispatcher(self)
        lower_builtin(self, types.VarArg(types.Any))(self._write)

    def get_call_template(self, args: tuple, kws: dict) -> Any:
        """Return the signature of a call, without compiling anything."""
        if mode.plain:
            return self.kernel.get_call_template(args, kws)
        signature = self.result(*map(types.unliteral, args))
        template = make_concrete_template(self.__name__, self, [signature])
        return template, inspect.signature(self.py_func), signature.args, kws

    def get_overload(self, args: tuple) -> Any:
        """Return the key under which numba finds `_write`."""
        return self.kernel.get_overload(args) if mode.plain else self

    def __call__(self, *_: Any) -> NoReturn:
        raise TypeError(f"{self.__name__} can be called by kernels only; Python calls an entry")

    def compiled(self, args: tuple) -> int:
        """Return the address of the kernel for these types of arguments."""
        self.kernel.compile(self.result(*args))
        return _address(self.kernel, args)

    def compiled_plainly(self, args: tuple, error: Exception) -> int:
        """Return the address of the same kernel compiled by plain numba, after an error of the compiler."""
        with mode.plain_instead(error):
            plain.prepare()
            form = plain.dispatcher(self.py_func)
            form.compile(self.result(*args))
        _kept.append(form)
        return _address(form, args)

    def _write(self, context: Any, builder: ir.IRBuilder, signature: Any, arguments: tuple) -> ir.Value:
        """Write a call through the address, which is asked for if it is zero."""
        convention = context.call_conv
        kind = convention.get_function_type(signature.return_type, signature.args).as_pointer()
        wanted = dumps((self.__module__, self.__qualname__, signature.args))
        slot = _slot(builder.module, f"late.{self.__module__}.{self.__qualname__}{signature.args}")
        with cgutils.if_unlikely(builder, cgutils.is_null(builder, builder.load(slot))):
            text = context.insert_const_bytes(builder.module, wanted)
            provide = ir.FunctionType(ir.VoidType(), [slot.type, _ANY, _SIZE])
            function = cgutils.get_or_insert_function(builder.module, provide, _SYMBOL)
            builder.call(function, [slot, text, ir.Constant(_SIZE, len(wanted))])
        callee = builder.bitcast(builder.load(slot), kind)
        status, result = convention.call_function(
            builder, callee, signature.return_type, signature.args, arguments
        )
        with cgutils.if_unlikely(builder, status.is_error):
            convention.return_status_propagate(builder, status)
        return result


def _slot(module: ir.Module, name: str) -> ir.GlobalVariable:
    """The place of an address in a module."""
    if name not in module.globals:
        variable = cgutils.add_global_variable(module, _ANY, name)
        variable.linkage, variable.initializer = "internal", ir.Constant(_ANY, None)
    return module.globals[name]


def _address(compiled: Any, args: tuple) -> int:
    result = compiled.overloads[args]
    return int(result.library.get_pointer_to_function(result.fndesc.llvm_func_name))


#: Kernels that only addresses point to.
_kept: list[Any] = []


def _find(late: Late, args: tuple) -> int:
    """Return the address of a kernel; an interrupt meanwhile comes afterwards, as the caller cannot end."""
    interrupted = False
    while True:
        try:
            address = late.compiled(args)
            break
        except KeyboardInterrupt:
            interrupted = True
        except Exception as error:  # whatever another numba does differently
            address = late.compiled_plainly(args, error)
            break
    if interrupted:
        threading.Thread(target=_interrupt_soon, daemon=True).start()
    return address


def _interrupt_soon() -> None:
    time.sleep(_SOON)
    _thread.interrupt_main()


def _provide(slot: int, text: int, length: int) -> None:
    """Write the address of the kernel that a text names into a slot of the kernel that calls it."""
    try:
        module, name, args = pickle.loads(ctypes.string_at(text, length))
        address = _find(getattr(import_module(module), name), args)
        ctypes.c_void_p.from_address(slot).value = address
    except BaseException as error:  # no compiler takes it, and the caller cannot go on without it
        with contextlib.suppress(Exception):
            log.critical("frictionmap: a kernel cannot be compiled: %s", error, exc_info=error)
        _exit(1)


_provider = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t)(_provide)
binding.add_symbol(_SYMBOL, ctypes.cast(_provider, ctypes.c_void_p).value)
