"""Take private names of numba away, as a newer version might, and use kernels: a script for test_compiler.

Reads [owner, name, whether a kernel is to be compiled] as JSON.  Prints JSON: for each name or difference the
answers of the example kernels, the compiler, and the warnings.  Each case runs in a child of this process.
"""

import importlib
import json
import logging
import os
import sys
import tempfile
from functools import partial
from types import ModuleType

import numba
import numpy as np

_USER = "frictionmap._kernels.compiler."


def _by_us(depth=2):
    """Whether the package's compiler looks a name up: the frame that called the frame that asks."""
    return sys._getframe(depth).f_globals.get("__name__", "").startswith(_USER)


class _Hidden:
    """An attribute of a class that is there for numba, and not for the package."""

    def __init__(self, name, original):
        self.name, self.original = name, original

    def __get__(self, found, owner=None):
        if _by_us():
            raise AttributeError(f"{self.name} is hidden")
        if hasattr(type(self.original), "__get__"):
            return self.original.__get__(found, owner)
        if found is not None and self.name in vars(found):
            return vars(found)[self.name]
        return self.original

    def __set__(self, found, value):
        if _by_us():
            raise AttributeError(f"{self.name} is hidden")
        if hasattr(type(self.original), "__set__"):
            self.original.__set__(found, value)
        else:
            vars(found)[self.name] = value


def hide_attribute(owner, name):
    """Hide an attribute of a class, or of its objects."""
    original = next((vars(base)[name] for base in owner.__mro__ if name in vars(base)), None)
    setattr(owner, name, _Hidden(name, original))


def hide_global(module, hidden):
    """Hide a name of a module."""

    class Hiding(ModuleType):
        def __getattribute__(self, name):
            if name == hidden and _by_us():
                raise AttributeError(f"{name} is hidden")
            return super().__getattribute__(name)

    module.__class__ = Hiding


def hide(owner, name):
    """Hide a name of "module" or "module:class"."""
    module, _, inside = owner.partition(":")
    found = importlib.import_module(module)
    if not inside:
        hide_global(found, name)
    else:
        found = getattr(found, inside)
        hide_attribute(found if isinstance(found, type) else type(found), name)


def refuse(kind, depth=2):
    """Let a class refuse arguments that only the package gives."""
    original = kind.__init__

    def refusing(*arguments, **options):
        if _by_us(depth):
            raise TypeError("unexpected argument")
        original(*arguments, **options)

    kind.__init__ = refusing


def nothing_kept():
    """Have nothing on disk yet."""
    numba.config.CACHE_DIR = os.environ["NUMBA_CACHE_DIR"] = tempfile.mkdtemp(dir=os.getcwd())


def other_dispatcher():
    """Dispatchers take other arguments."""
    refuse(importlib.import_module("numba.core.registry").CPUDispatcher)


def other_type():
    """The type of a dispatcher takes other arguments."""
    nothing_kept()
    refuse(numba.types.Dispatcher, depth=3)  # a metaclass lies between


def other_library():
    """Libraries take other arguments."""
    refuse(importlib.import_module("numba.core.codegen").JITCodeLibrary)


def longer_result():
    """A result of the compiler has more parts."""
    nothing_kept()
    kind = importlib.import_module("numba.core.compiler").CompileResult
    original = kind._reduce
    kind._reduce = lambda self: (*original(self), "more") if _by_us() else original(self)


DIFFERENCES = (other_dispatcher, other_type, other_library, longer_result)


def case(change, compiled):
    """Use kernels, or compile one, after a change; what came of it."""
    warnings = []
    handler = logging.Handler()
    handler.emit = lambda record: warnings.append(record.getMessage())
    logging.getLogger("frictionmap").addHandler(handler)
    change()
    import example_kernels

    from frictionmap._kernels.compiler.decorators import compiler_in_use

    double = example_kernels.twice_compiled if compiled else example_kernels.twice
    return {"answers": example_kernels.answers(double), "compiler": compiler_in_use(), "warnings": warnings}


def in_child(change, compiled):
    """The same in a child of this process."""
    reading, writing = os.pipe()
    if os.fork() == 0:
        try:
            text = json.dumps(case(change, compiled))
        except BaseException as error:
            text = json.dumps({"error": f"{type(error).__name__}: {error}"})
        os.write(writing, text.encode())
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as pipe:
        text = pipe.read()
    os.wait()
    return json.loads(text) if text else {"error": "the process ended"}


def main():
    numba.njit(lambda x: x + 1.0)(np.float64(1.0))  # what all children need
    found = {"nothing": in_child(lambda: None, compiled=True)}
    for change in DIFFERENCES:
        found[change.__name__] = in_child(change, compiled=True)
    for owner, name, compiled in json.load(sys.stdin):
        found[f"{owner}.{name}"] = in_child(partial(hide, owner, name), compiled)
    print(json.dumps(found))


if __name__ == "__main__":
    main()
