"""Which module may know which: cheap start, kernels without objects, pictures in one place."""

import ast
import functools
import importlib
import os
import pkgutil
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import frictionmap as fm

PACKAGE = Path(fm.__file__).parent
#: Modules of kernels: those that compile them are none.
KERNELS = sorted(path for path in (PACKAGE / "_kernels").rglob("*.py") if path.parent.name != "compiler")
SOURCES = sorted(PACKAGE.rglob("*.py"))
HEAVY = ("numba", "xarray", "matplotlib", "scipy", "netCDF4", "pandas")


@functools.cache
def imported(path):
    """Absolute names of the modules a source file imports."""
    package = ["frictionmap", *path.relative_to(PACKAGE).parts[:-1]]
    found = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            module = ".".join(base + (node.module.split(".") if node.module else []))
            found += [f"{module}.{alias.name}" for alias in node.names]
    return found


def run(code):
    search = os.pathsep.join([str(PACKAGE.parent), os.environ.get("PYTHONPATH", "")])
    return subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | {"PYTHONPATH": search},
        capture_output=True,
        text=True,
        timeout=600,
        check=True,
    ).stdout


@pytest.mark.parametrize("arguments", [["--help"], ["map", "--help"], ["map"], ["--version"]])
def test_help_and_usage_errors_import_nothing_heavy(arguments):
    code = f"""
import contextlib, io, sys
import frictionmap, frictionmap.command_line.cli
text = io.StringIO()
with contextlib.redirect_stdout(text), contextlib.redirect_stderr(text), contextlib.suppress(SystemExit):
    frictionmap.command_line.cli.main({arguments!r})
print([name for name in {HEAVY!r} if name in sys.modules])
"""
    assert run(code) == "[]\n"


@pytest.mark.parametrize(("given", "expected"), [(None, "1"), ("3", "3")])
def test_the_program_uses_one_blas_thread_by_default(given, expected, monkeypatch):
    """This is settled before numpy is imported, which would not see it later."""
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)
    if given:
        monkeypatch.setenv("OPENBLAS_NUM_THREADS", given)
    code = """
import os, sys
import frictionmap.__main__ as program
sys.argv = ["frictionmap", "--version"]
program.run()
print(os.environ["OPENBLAS_NUM_THREADS"], "numpy" in sys.modules)
"""
    assert run(code).splitlines()[-1] == f"{expected} False"


def test_a_configuration_is_checked_without_anything_heavy(tmp_path):
    (tmp_path / "bad.toml").write_text("[sistem]")
    code = f"""
import contextlib, io, sys
import frictionmap.files.config
try:
    frictionmap.load_config({str(tmp_path / "bad.toml")!r})
except frictionmap.InputError as error:
    print(error)
print([name for name in {HEAVY!r} if name in sys.modules])
"""
    message, heavy = run(code).splitlines()
    assert message.startswith("unknown key 'sistem' (did you mean system?)")
    assert heavy == "[]"


def test_a_page_shows_its_first_map_and_motion_without_what_they_do_not_need():
    """Importing xarray takes as long as all else, and so does what the compiler knows beside our kernels."""
    code = """
import sys, frictionmap as fm
from frictionmap.explorer.scene import scene_of_system
from frictionmap.explorer.server import Page
page = Page(scene_of_system(fm.System(), (0.1, 2.0), (0.0, 1.2), 1.0, "rest", "", None))
page.warm()
asked = ("/scene", "/map?columns=4&rows=4", "/motion?at=0.3,0.5", "/others?at=0.3,0.5")
statuses = [page.answer(target, lambda: False).status for target in asked]
heavy = [name for name in ("xarray", "pandas", "scipy.linalg", "numba.np.arraymath") if name in sys.modules]
print(statuses, heavy)
"""
    run(code)  # whatever is to be compiled has been
    assert run(code) == "[200, 200, 200, 200] []\n"


def test_functions_for_any_system_load_no_engine_before_they_are_called():
    """That of several contacts alone takes a third of a second of every first call for one mass."""
    code = """
import sys, frictionmap as fm
print(len([fm.sweep, fm.boundaries, fm.curves, fm.response]))
rooms = ("frictionmap.general.", "frictionmap.phases.", "frictionmap.banks.")
print([name for name in sys.modules if name.startswith(rooms)])
"""
    assert run(code).splitlines() == ["4", "[]"]


def test_kernels_know_numbers_and_codes_only():
    legal = (
        "numpy",
        "numba",
        "cmath",
        "math",
        "typing",
        "collections.abc",
        "frictionmap.regimes",
        "frictionmap._kernels",
    )
    assert len(KERNELS) > 70
    used = [(path.name, name) for path in KERNELS for name in imported(path)]
    assert [one for one in used if not f"{one[1]}.".startswith(tuple(f"{name}." for name in legal))] == []


def test_imports_are_read_right():
    """The check above sees relative imports as what they are."""
    names = set(imported(PACKAGE / "_kernels" / "engine" / "fill.py"))
    assert "frictionmap._kernels.compiler.entry" in names
    assert any(name.startswith("frictionmap.regimes") for path in KERNELS for name in imported(path))


@pytest.mark.parametrize(
    ("module", "home"),
    [
        ("argparse", {"arguments.py"}),
        ("tomllib", {"config.py"}),
        ("netCDF4", set()),
    ],
)
def test_one_home(module, home):
    users = {path.name for path in SOURCES if any(name.split(".")[0] == module for name in imported(path))}
    assert users == home


@pytest.mark.parametrize(("module", "folder"), [("numba", "_kernels/compiler"), ("matplotlib", "pictures")])
def test_one_folder(module, folder):
    users = [path for path in SOURCES if any(name.split(".")[0] == module for name in imported(path))]
    assert users
    assert [path for path in users if not path.is_relative_to(PACKAGE / folder)] == []


def test_the_page_takes_classes_and_their_colours_from_the_pictures():
    used = {name for path in SOURCES if "explorer" in path.parts for name in imported(path)}
    pictures = {".".join(name.split(".")[:3]) for name in used if name.startswith("frictionmap.pictures")}
    assert pictures == {"frictionmap.pictures.classes", "frictionmap.pictures.palette"}


# Public names

#: Public names that are modules by intent.
MODULES = {"design", "features", "identify", "regimes"}


def test_public_names_stay_what_they_are_whatever_is_imported():
    """`fm.sweep` is the function, also once all modules, some with similar names, are loaded."""
    before = {name: getattr(fm, name) for name in fm.__all__}
    for module in pkgutil.walk_packages(fm.__path__, "frictionmap."):
        if module.name != "frictionmap.__main__":
            importlib.import_module(module.name)
    for name, value in before.items():
        assert getattr(fm, name) is value
        assert isinstance(value, ModuleType) == (name in MODULES), name
        assert isinstance(value, (str, ModuleType)) or callable(value)
        assert isinstance(value, str) or value.__doc__, name


def test_public_names_with_a_module_imported_first():
    names = set(fm.__all__) - MODULES
    types = f"import frictionmap as fm; print(*(type(getattr(fm, name)) for name in {names!r}))"
    assert "module" not in run(f"import frictionmap.steady.sweep; {types}")


def test_lazy_names_are_public_and_listed_once():
    assert set(fm._HOME) <= set(fm.__all__)
    assert len(set(fm.__all__)) == len(fm.__all__)


def test_an_unknown_name():
    with pytest.raises(AttributeError, match=r"module 'frictionmap' has no attribute 'sweeep'"):
        fm.sweeep  # noqa: B018


def test_one_place_decides_which_engine_answers():
    """All else asks the engine, or the contacts and loads in the one form that every system has."""
    asking = re.compile(r"\.general is (not )?None|\b(if|else|not|and|or) \w*system\.general\b")
    found = {
        path.relative_to(PACKAGE).as_posix() for path in SOURCES if asking.search(path.read_text("utf-8"))
    }
    assert found == {"solvers/choose.py", "model/general.py", "general/problem.py"}
