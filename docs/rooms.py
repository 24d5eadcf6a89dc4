"""Where things are: the table of CONTRIBUTING.md, made of the maps that the folders of the package have.

The docstring of every `__init__` has a table with a line for each module and folder beside it, in the order
in which data flows.  After a change to one of them,

    python docs/rooms.py

writes the table of CONTRIBUTING.md again.
"""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "frictionmap"
PAGE = ROOT / "CONTRIBUTING.md"

_BEGIN, _END = "<!-- made by docs/rooms.py -->\n", "<!-- to here -->\n"

_BAR = r"^=+  =+\n"
_TABLE = re.compile(rf"{_BAR}module +what is in it\n{_BAR}(?P<rows>(?:.+\n)+?){_BAR}", re.MULTILINE)


def folders() -> list[Path]:
    """All folders of the package that hold modules."""
    return sorted(path.parent for path in PACKAGE.rglob("__init__.py"))


def map_of(folder: Path) -> dict[str, str]:
    """What is in each module and folder of a folder, by its docstring; empty if that has no table."""
    source = (folder / "__init__.py").read_text(encoding="utf-8")
    found = _TABLE.search(f"{ast.get_docstring(ast.parse(source))}\n")
    rows = found["rows"].splitlines() if found else []
    return dict(re.split(r"  +", row, maxsplit=1) for row in rows)


def places(folder: Path = PACKAGE) -> Iterator[tuple[str, str]]:
    """Every module at the top of the package, and every folder at any depth, with what is in it."""
    for name, content in map_of(folder).items():
        inside = folder / name
        if inside.is_dir():
            yield f"{inside.relative_to(PACKAGE).as_posix()}/", content
            if (inside / "__init__.py").exists():
                yield from places(inside)
        elif folder == PACKAGE:
            yield name, content


def table() -> str:
    """The table of CONTRIBUTING.md."""
    lines = ["| place in `frictionmap/` | what is in it |", "| --- | --- |"]
    return "\n".join(lines + [f"| `{name}` | {content} |" for name, content in places()])


def page() -> str:
    """CONTRIBUTING.md with the table as it should be."""
    before, rest = PAGE.read_text(encoding="utf-8").split(_BEGIN)
    return f"{before}{_BEGIN}\n{table()}\n\n{_END}{rest.split(_END)[1]}"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
