"""The maps of the folders: each lists what is there, in the order of imports; CONTRIBUTING repeats them."""

import ast
import functools
import re
import sys

from conftest import ROOT

sys.path.append(str(ROOT / "docs"))
import rooms

FOLDERS = rooms.folders()


def place(folder):
    return folder.relative_to(rooms.PACKAGE.parent).as_posix()


def is_kept(path):
    """Whether a folder holds more than what Python leaves there."""
    return any(inside.is_file() and "__pycache__" not in inside.parts for inside in path.rglob("*"))


def test_the_map_of_a_folder_lists_what_is_in_it():
    assert len(FOLDERS) > 30
    for folder in FOLDERS:
        modules = {path.stem for path in folder.glob("*.py")} - {"__init__"}
        within = {path.name for path in folder.iterdir() if path.is_dir() and is_kept(path)}
        assert set(rooms.map_of(folder)) == modules | within, place(folder)


def test_the_map_begins_with_a_sentence():
    for folder in FOLDERS:
        text = ast.get_docstring(ast.parse((folder / "__init__.py").read_text(encoding="utf-8")))
        assert re.match(r"[A-Z].*\.$", text.splitlines()[0]), place(folder)


@functools.cache
def imported(path):
    """Names that a source file imports from the package, absolute."""
    package = path.relative_to(rooms.PACKAGE.parent).parts[:-1]
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level:
            module = [*package[: len(package) - node.level + 1], *(node.module or "").split(".")]
            found |= {".".join([*filter(None, module), alias.name]) for alias in node.names}
    return found


def below(folder):
    """(module or folder, what it imports from below itself in the map of the folder) of all that do."""
    order = list(rooms.map_of(folder))
    prefix = f"{place(folder).replace('/', '.')}."
    for number, name in enumerate(order):
        module = folder / f"{name}.py"
        sources = [module] if module.exists() else sorted((folder / name).rglob("*.py"))
        names = {used for source in sources for used in imported(source)}
        used = {used.removeprefix(prefix).split(".")[0] for used in names if used.startswith(prefix)}
        if later := used & set(order[number + 1 :]):
            yield name, later


def test_nothing_imports_what_stands_below_it():
    assert [(place(folder), *found) for folder in FOLDERS for found in below(folder)] == []


def test_imports_from_below_are_found(tmp_path, monkeypatch):
    folder = tmp_path / "frictionmap"
    (folder / "inner").mkdir(parents=True)
    bar = "=====  ===\n"
    (folder / "__init__.py").write_text(
        f'"""Some.\n\n{bar}module  what is in it\n{bar}inner  a\nouter  b\n{bar}"""\n'
    )
    (folder / "inner" / "one.py").write_text("from ..outer import x\n")
    (folder / "outer.py").write_text("from .inner.two import y\n")
    monkeypatch.setattr(rooms, "PACKAGE", folder)
    assert list(rooms.map_of(folder)) == ["inner", "outer"]
    assert list(below(folder)) == [("inner", {"outer"})]


def test_contributing_has_the_maps_as_they_are():
    assert rooms.PAGE.read_text(encoding="utf-8") == rooms.page(), "run python docs/rooms.py"
