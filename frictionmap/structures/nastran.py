"""Files of Nastran, through pyyeti of the extra `fe`: OP4 and DMIG cards of a punch file.

Several matrices may be in one file: M is one called M, MASS, or M and the letters of a set, such as MAAX or
MGG; so are K, STIF or KAAX, and C, B, DAMP or BAAX.
"""

import re
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..packages import package, read_by
from .entries import Matrix, text_of

#: Forms and types of DMIG matrices.
_SYMMETRIC, _COMPLEX = 6, (3, 4)

#: What M, K and C are called.
_CALLED = {
    "M": re.compile(r"m|mass|m([a-z])\1x?", re.IGNORECASE),
    "K": re.compile(r"k|stiff?|k([a-z])\1x?", re.IGNORECASE),
    "C": re.compile(r"[bc]|damp|[bc]([a-z])\1x?", re.IGNORECASE),
}


def read_op4(path: Path) -> dict[str, Matrix]:
    """The matrices of an OP4 file, text or binary, by M, K and C; they have no labels.

    Raises
    ------
    InputError
        The file or a name is not as it should be, or pyyeti is not installed.
    """
    op4 = package("pyyeti.nastran.op4", path, "fe")
    names, matrices, _, _ = read_by(
        path, "OP4 file of Nastran", lambda: op4.OP4().listload(str(path), sparse=None)
    )
    return {name: Matrix(values) for name, values in _called(path, names, matrices).items()}


def read_punch(path: Path) -> dict[str, Matrix]:
    """The DMIG matrices of a punch file by M, K and C; their labels are grid point and component.

    Raises
    ------
    InputError
        As `read_op4`; or a matrix is not square, or not real, or has an entry twice.
    """
    bulk = package("pyyeti.nastran.bulk", path, "fe")
    if not re.search(r"^DMIG", text_of(path), re.MULTILINE | re.IGNORECASE):
        raise InputError(f"cannot read {path}: it has no DMIG cards; write the matrices as DMIG")

    def read() -> dict[str, Any]:
        cards = bulk.rdcards(str(path), name="dmig", return_var="list", blank="", follow_includes=False)
        _check_entries(path, cards)
        return bulk.rddmig(str(path), square=True, follow_includes=False)

    tables = read_by(path, "punch file of Nastran", read)
    found = {}
    for name, table in _called(path, list(tables), list(tables.values())).items():
        if table.index.nlevels != table.columns.nlevels or not table.index.equals(table.columns):
            raise InputError(f"cannot read {path}: matrix {name} must be square; got {table.shape}")
        labels = tuple((int(node), int(dof)) for node, dof in table.index)
        found[name] = Matrix(table.to_numpy(), labels)
    return found


def _check_entries(path: Path, cards: list[list[Any]]) -> None:
    """Refuse an M, K or C that is complex or has an entry twice, of which pyyeti takes the last.

    The first card of a matrix has name, 0, form and type, any other name, label and a column of label, entry,
    label, entry, each after an empty field.
    """
    symmetric, seen = False, set[Any]()
    for name, first, second, *fields in cards:
        if not any(pattern.fullmatch(name) for pattern in _CALLED.values()):
            continue
        if first == 0:
            if fields[0] in _COMPLEX:
                raise InputError(f"cannot read {path}: {name} is complex; write real matrices")
            symmetric, seen = second == _SYMMETRIC, set()
            continue
        column = (first, second)
        for row in zip(fields[1::4], fields[2::4], strict=False):
            place = (min(row, column), max(row, column)) if symmetric else (row, column)
            if place in seen:
                words = ", ".join(f"{node}.{dof}" for node, dof in (row, column))
                raise InputError(f"cannot read {path}: an entry of {name} is given twice; got {words}")
            seen.add(place)


def _called(path: Path, names: list[str], matrices: list[Any]) -> dict[str, Any]:
    """Matrices by M, K and C; refused is a file with two of one."""
    found = {}
    for name, pattern in _CALLED.items():
        those = [k for k, one in enumerate(names) if pattern.fullmatch(one)]
        if len(those) > 1:
            listed = ", ".join(names[k].upper() for k in those)
            raise InputError(f"cannot read {path}: more than one matrix may be {name}; got {listed}")
        if those:
            found[name] = matrices[those[0]]
    if not found:
        raise InputError(
            f"cannot read {path}: matrices must be called M, K and C, or such as MAAX; got "
            f"{', '.join(name.upper() for name in names) or 'none'}"
        )
    return found
