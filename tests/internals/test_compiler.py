"""The fall-back of the compiler: another numba, or a forced choice, costs compile time and no answers."""

import ast
import gc
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import example_kernels
import numba
import pytest
from numba.core import event

import frictionmap as fm
from frictionmap._kernels.closed_form import damping_functions
from frictionmap._kernels.compiler import decorators, fast, kernel, mode
from frictionmap._kernels.compiler.linking import KernelLibrary, _KernelFlags, compiler
from frictionmap._kernels.compiler.private_names import NAMES

TESTS = Path(__file__).parent.parent
COMPILER = Path(decorators.__file__).parent
PAGE = TESTS.parent / "docs" / "compiler.md"

pytestmark = [
    pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled"),
    pytest.mark.skipif(mode.requested() == "plain", reason="the fast compiler is tested"),
]

FOUND_AT_ONCE = [(group.owner, name) for group in NAMES for name in group.names]
FOUND_IN_USE = [(group.owner, name) for group in NAMES for name in group.on_objects]
DIFFERENCES = ["other_dispatcher", "other_type", "other_library", "longer_result"]


def run(*arguments, place, directory=None, asked="", **environment):
    """A new process that keeps its kernels in a place; what it prints and what it reports."""
    search = os.pathsep.join([str(TESTS.parent), str(TESTS)])
    kept = os.environ | {"PYTHONPATH": search, "NUMBA_CACHE_DIR": str(place), **environment}
    done = subprocess.run(
        [sys.executable, *arguments], env=kept, input=asked, cwd=directory or place,
        capture_output=True, text=True, timeout=1800,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout, done.stderr


def is_tested():
    try:
        mode.check_version()
    except mode.UntestedNumba:
        return False
    return True


@pytest.mark.skipif(not is_tested(), reason="a new numba: the weekly job tests it")
def test_this_numba_has_all_that_the_fast_compiler_needs():
    assert decorators.compiler_in_use() == "fast"


# Each private name taken away


@pytest.fixture(scope="module")
def taken_away(tmp_path_factory):
    """What came of taking each name away, with compiled kernels on disk."""
    if os.name == "nt":
        pytest.skip("children of a process are needed")
    place = tmp_path_factory.mktemp("kernels")
    run("-c", "import example_kernels as e; e.answers(); e.answers(e.twice_compiled)", place=place)
    asked = [(*found, False) for found in FOUND_AT_ONCE] + [(*found, True) for found in FOUND_IN_USE]
    return json.loads(run(str(TESTS / "taken_away.py"), place=place, asked=json.dumps(asked))[0])


@pytest.mark.slow
def test_nothing_is_missed_if_nothing_is_taken_away(taken_away):
    assert taken_away["nothing"] == {"answers": example_kernels.ANSWERS, "compiler": "fast", "warnings": []}


@pytest.mark.slow
@pytest.mark.parametrize("name", [*map(".".join, FOUND_AT_ONCE + FOUND_IN_USE), *DIFFERENCES])
def test_without_a_private_name_plain_numba_gives_the_answers_and_one_warning(taken_away, name):
    found = taken_away[name]
    assert (found.get("answers"), found.get("compiler")) == (example_kernels.ANSWERS, "plain"), found
    (warning,) = found["warnings"]
    assert warning.startswith(
        f"frictionmap: cannot use the fast kernel compiler with numba {numba.__version__} ("
    )
    assert "\n" not in warning
    if name in map(".".join, FOUND_AT_ONCE):
        assert f"{name.replace(':', '.')} is missing" in warning or "cannot import name" in warning


def test_the_page_lists_every_private_name():
    """With the purpose that the table in the code states."""
    rows = re.findall(
        r"^\| `(numba[^`]*|llvmlite[^`]*)` \| (.*) \| (.*) \|$", PAGE.read_text(encoding="utf-8"), re.M
    )
    listed = {owner: (set(re.findall(r"`(\w+)`", names)), purpose) for owner, names, purpose in rows}
    assert listed == {
        group.owner.replace(":", "."): ({*group.names, *group.on_objects}, group.purpose) for group in NAMES
    }


def imports_of(path):
    """(module, name) of what a source file imports from numba and llvmlite."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] in ("numba", "llvmlite"):
            yield from ((node.module, alias.name) for alias in node.names)


#: What numba documents for its users.
PUBLIC = {
    ("numba", "config"), ("numba", "njit"), ("numba", "types"), ("numba.extending", "overload"),
    ("numba.core", "event"), ("llvmlite", "ir"), ("numba.extending", "lower_builtin"),
    ("numba.extending", "models"), ("numba.extending", "register_model"),
    ("numba.extending", "type_callable"), ("numba.extending", "infer_getattr"),
    ("numba.extending", "lower_getattr_generic"), ("numba.extending", "NativeValue"),
    ("numba.extending", "typeof_impl"), ("numba.extending", "unbox"),
    ("numba.core.typing.templates", "AttributeTemplate"),  # of which `infer_getattr` registers a class
}  # fmt: skip


def test_the_list_of_private_names_has_all_that_are_imported():
    owners = {group.owner for group in NAMES}
    listed = {f"{group.owner}.{name}" for group in NAMES for name in group.names}
    for path in sorted(COMPILER.glob("*.py")):
        for module, name in set(imports_of(path)) - PUBLIC:
            known = {f"{module}:{name}", f"{module}.{name}"} & (owners | listed)
            assert known or f"{module}.{name}" in owners, f"{path.name}: {module}.{name}"


def own_names(nodes):
    """Names that a module defines: functions, classes, fields, attributes of `self`."""
    for node in nodes:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            yield node.name
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            yield node.target.id
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            yield node.attr if getattr(node.value, "id", "") == "self" else ""


def test_the_list_of_private_names_has_all_attributes_with_an_underscore():
    """Of objects that are not the package's own."""
    listed = {name for group in NAMES for name in (*group.names, *group.on_objects)}
    for path in sorted(COMPILER.glob("*.py")):
        nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
        used = {node.attr for node in nodes if isinstance(node, ast.Attribute)}
        private = {name for name in used if name.startswith("_") and not name.endswith("__")}
        assert private - set(own_names(nodes)) <= listed, path.name


def is_ours(value):
    """A function or property that the package wrote; a metaclass of numba writes some more."""
    return str(getattr(getattr(value, "fget", value), "__module__", "")).startswith("frictionmap.")


def test_replaced_methods_are_in_the_list():
    """numba would not call a method that it has renamed."""
    listed = {name for group in NAMES for name in group.names}
    for own in (fast._Kernel, fast._Entry, fast._Compiled, KernelLibrary, _KernelFlags, compiler(None)):
        foreign = next(base for base in own.__mro__ if not base.__module__.startswith("frictionmap"))
        written = {name for name, value in vars(own).items() if is_ours(value)} - {"__init__"}
        replaced = {name for name in written if hasattr(foreign, name)}
        assert replaced, own
        assert replaced <= listed, own


# Faults of kernels


@kernel
def _wrong(x):
    return x.no_such_attribute


def test_a_kernel_that_no_compiler_takes_is_at_fault_itself(caplog):
    """It is no reason to change the compiler."""

    def call(x):
        return _wrong(x)

    with pytest.raises(numba.TypingError, match="no_such_attribute"):
        decorators.entry(call, keep=False)(1.0)
    assert decorators.compiler_in_use() == "fast"
    assert caplog.messages == []


# Python's garbage collector


def _compile_a_new_entry():
    """Compile an entry; whether the collector was on whenever a compilation began or ended."""
    seen = []

    class Listener(event.Listener):
        def on_start(self, event):
            seen.append(gc.isenabled())

        def on_end(self, event):
            seen.append(gc.isenabled())

    with event.install_listener("numba:compile", Listener()):
        assert decorators.entry(lambda x: x + 1.0, keep=False)(1.0) == 2.0
    return seen


@pytest.mark.parametrize("on", [True, False])
def test_the_garbage_collector_is_off_during_a_compilation(on):
    """Afterwards it is on again, if it was before."""
    was_on = gc.isenabled()
    try:
        (gc.enable if on else gc.disable)()
        assert set(_compile_a_new_entry()) == {False}
        assert gc.isenabled() is on
    finally:
        (gc.enable if was_on else gc.disable)()


def test_the_garbage_collector_is_on_after_a_failure():
    with pytest.raises(numba.TypingError):
        decorators.entry(lambda x: _wrong(x), keep=False)(1.0)
    assert gc.isenabled()


def test_frozen_objects_stay_frozen():
    gc.freeze()
    try:
        frozen = gc.get_freeze_count()
        _compile_a_new_entry()
        assert 0 < gc.get_freeze_count() <= frozen
    finally:
        gc.unfreeze()
    _compile_a_new_entry()
    assert gc.get_freeze_count() == 0


# The choice


CALL = (
    "import example_kernels as e; from frictionmap._kernels.compiler.decorators import compiler_in_use as c;"
)


def test_the_environment_chooses_plain_numba(tmp_path):
    """Without a warning; in a second process everything is found on disk."""
    for _ in range(2):
        count = "import numba.core.event as v; n = v.RecordingListener(); v.register('numba:compile', n);"
        end = "print(e.answers(), c(), len(n.buffer))"
        out, err = run("-c", f"{count} {CALL} {end}", place=tmp_path, FRICTIONMAP_COMPILER="plain")
        assert err == ""
    assert out == f"{example_kernels.ANSWERS} plain 0\n"


@pytest.mark.parametrize("version", ["0.59.1", "0.99.0rc1", "1.0.0", "0.6.0"])
def test_a_numba_that_was_not_tested_compiles_plainly_unless_asked(tmp_path, version):
    other = f"import numba; numba.__version__ = {version!r}; {CALL} print(c())"
    out, err = run("-c", other, place=tmp_path, FRICTIONMAP_COMPILER="")
    assert out == "plain\n"
    assert err.startswith(
        f"frictionmap: cannot use the fast kernel compiler with numba {version} (UntestedNumba: tested are "
        f"{mode.TESTED[0]} to {mode.TESTED[-1]}; FRICTIONMAP_COMPILER=fast uses it nevertheless); plain numba"
    )
    assert run("-c", other, place=tmp_path, FRICTIONMAP_COMPILER="fast") == ("fast\n", "")


def test_the_oldest_numba_that_may_be_installed_was_tested():
    versions = dict(re.findall(r'"(numba)>=([\d.]+)"', (TESTS.parent / "pyproject.toml").read_text()))
    assert versions["numba"] == mode.TESTED[0]


def test_an_unknown_compiler_is_refused(monkeypatch):
    monkeypatch.setenv("FRICTIONMAP_COMPILER", "quick")
    with pytest.raises(fm.InputError, match="unknown FRICTIONMAP_COMPILER 'quick'; valid: fast, plain"):
        mode.requested()


def test_plain_numba_announces_compilations_and_gives_the_same_bits(tmp_path):
    code = """
from frictionmap._kernels.closed_form import damping_functions
from frictionmap._kernels.compiler.notices import listeners
heard = []
listeners.append(lambda: heard.append(1))
damping_functions(1.0, 0.05, 0.7)
first = len(heard)
print(first > 0, *damping_functions(1.0, 0.05, 0.5), len(heard) == first)
"""
    u, g = damping_functions(1.0, 0.05, 0.5)
    assert run("-c", code, place=tmp_path, FRICTIONMAP_COMPILER="plain") == (f"True {u} {g} True\n", "")


# Whole maps

MAP = """
import hashlib, sys
import numpy as np
import frictionmap as fm
from frictionmap._kernels.compiler.decorators import compiler_in_use
systems = {
    "one mass": fm.System(contact="joined-base-wall"),
    "structure": fm.System(mass_ratios=[1.0, 0.7], stiffness_ratios=[1.0, 1.3], damping_ratios=0.03),
}
ds = fm.sweep(systems[sys.argv[1]], np.linspace(0.1, 2.4, 8), np.linspace(0.05, 1.2, 6), [1.0, 1.5])
digest = hashlib.sha256(b"".join(np.ascontiguousarray(ds[name]).tobytes() for name in sorted(ds.variables)))
print(compiler_in_use(), sorted(set(ds.regime.values.ravel().tolist())), digest.hexdigest())
"""


@pytest.mark.slow
@pytest.mark.skipif(
    "FRICTIONMAP_TEST_PLAIN" not in os.environ,
    reason="compiles for two minutes of CPU time; FRICTIONMAP_TEST_PLAIN=1 runs it",
)
@pytest.mark.parametrize("system", ["one mass", "structure"])
def test_maps_are_equal_to_the_bit(system):
    """With kernels kept where those of the package are."""
    place = TESTS.parent
    kept = os.environ.get("NUMBA_CACHE_DIR", "")
    fast_map, plain_map = (
        run("-c", MAP, system, place=kept, directory=place, FRICTIONMAP_COMPILER=name)[0].split(" ", 1)
        for name in ("fast", "plain")
    )
    assert (fast_map[0], plain_map[0]) == ("fast", "plain")
    assert fast_map[1] == plain_map[1]
    assert len(json.loads(fast_map[1].rpartition(" ")[0])) == 3  # regimes: all of them were met
