"""Files of modes: NPZ, MAT, CSV, and data sets 55 of universal files."""

import csv
import zipfile
import zlib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from .. import checks
from ..errors import InputError
from ..mat_files import read_mat
from ..packages import package, read_by
from .modes import OF_BASE, Modes

#: What arrays of NPZ and MAT files, and columns of CSV files, may be called.
_NAMES = {
    "w": ("w", "omega"),
    "frequency_Hz": ("frequency_Hz", "frequencies_Hz", "f_Hz"),
    "zeta": ("zeta", "damping_ratio", "damping_ratios"),
    "shapes": ("shapes", "phi"),
    "points": ("points",),
    "residual": ("residual",),
    "compliance": ("compliance",),
    **{name: (name,) for name in OF_BASE},
    "modal_mass": ("modal_mass", "modal_masses"),
    "normalised": ("normalised",),
}

#: Analysis types of data sets 55: normal modes, and complex modes of first order.
_NORMAL, _COMPLEX = 2, 3

#: Components of data at a node.
_COMPONENTS = ("r1", "r2", "r3", "r4", "r5", "r6")

#: Modal masses that programs write where they know none.
_UNKNOWN_MASSES = (0.0, 1.0)


#: Nothing is known of a base that moves.
_NO_BASE: Mapping[str, Any] = {}


class FileModes(NamedTuple):
    """Modes as a file has them."""

    w: np.ndarray  # rad/s
    zeta: Any
    shapes: np.ndarray  # (points, modes)
    points: Sequence[str] | None
    masses: np.ndarray | None  # modal masses; None: not stated
    normalised: bool = False  # whether the file states unit modal masses
    residual: Any = None
    compliance: Any = None
    of_base: Mapping[str, Any] = _NO_BASE  # by the names of `OF_BASE`; of unit modal masses


def read_modes(path: Path, keep: Sequence[str] | None = None, normalised: bool = False) -> Modes:
    """The modes of a file.

    Parameters
    ----------
    path : Path
    keep : points to keep, in this order; default: all that move
    normalised : whether shapes are of unit modal mass although the file does not state it

    Raises
    ------
    InputError
        The file cannot be read, does not state modal masses, or lacks a point.
    """
    ending = path.suffix.lower()
    if ending not in _READERS:
        raise InputError("modes", f"must be a file that ends in {', '.join(_READERS)}; got {path.name!r}")
    try:
        found = _READERS[ending](path)
    except OSError as error:
        reason = error.strerror or error
        raise InputError("modes", f": cannot read {path}: {reason}; check the path") from None
    shapes = found.shapes if normalised or found.normalised else _scaled_shapes(found, path)
    order = np.argsort(found.w, kind="stable")
    zeta = None if found.zeta is None else np.asarray(found.zeta)
    zeta = zeta if zeta is None or zeta.ndim == 0 else zeta[order]
    points = [str(k) for k in range(1, len(shapes) + 1)] if found.points is None else list(found.points)
    rows = _rows(points, shapes, keep, path)
    residual, compliance = (
        None if one is None else np.asarray(one)[np.ix_(rows, rows)]
        for one in (found.residual, found.compliance)
    )
    names = [points[row] for row in rows]
    of_base: dict[str, Any] = {name: _numbers_in(found, name, order, rows, path) for name in found.of_base}
    return Modes(
        found.w[order], zeta, shapes[rows][:, order], names, residual, compliance, f"file {path.name}",
        **of_base,
    )  # fmt: skip


def _numbers_in(found: FileModes, name: str, order: np.ndarray, rows: list[int], path: Path) -> np.ndarray:
    """What a file says of a base that moves: of its modes, or of the points that are kept."""
    values, of_modes = np.ravel(found.of_base[name]), name == OF_BASE[0]
    count = order.size if of_modes else len(found.shapes)
    if values.size != count:
        each = "mode" if of_modes else "point"
        raise InputError(
            "modes", f": {name} in {path.name} must be a number per {each} ({count}); got {values.size}"
        )
    return np.asarray(values[order if of_modes else rows])


def _rows(points: list[str], shapes: np.ndarray, keep: Sequence[str] | None, path: Path) -> list[int]:
    """Rows of the points to keep, or of all that move."""
    if len(points) != len(shapes):
        raise InputError("modes", f": {path.name} must have one name per row of shapes ({len(shapes)}); got "
                                  f"{len(points)}")  # fmt: skip
    if keep is None:
        return np.flatnonzero(np.any(shapes != 0.0, axis=1)).tolist()
    for name in keep:
        if name not in points:
            shown = ", ".join(points[:12]) + ", ..." * (len(points) > 12)
            raise InputError(
                "modes.points",
                f"must be points of {path.name}, such as {shown}; got {checks.one_line(name)}"
                f"{checks.nearest(str(name), points)}",
            )
    return [points.index(name) for name in keep]


def _scaled_shapes(found: FileModes, path: Path) -> np.ndarray:
    """Shapes over the roots of their modal masses."""
    masses = found.masses
    known = masses is not None and bool(masses.all()) and not np.isin(masses, _UNKNOWN_MASSES).all()
    if masses is None or not known:
        got = "none" if masses is None else checks.one_line(np.real_if_close(masses).tolist())
        raise InputError(
            "modes",
            f": {path.name} must state modal masses, which are unknown where all are 0 or 1, or be declared "
            f'{{ file = "{path.name}", normalised = "mass" }}; got {got}',
        )
    if masses.shape != (found.shapes.shape[1],) or not np.isfinite(masses).all():
        raise InputError("modes", f": modal masses must be one number per mode; got {masses.tolist()}")
    if masses.dtype.kind != "c" and (masses < 0.0).any():
        raise InputError("modes", f": modal masses must be > 0; got {masses.min():g}")
    return np.asarray(found.shapes / np.sqrt(masses))


def _named(arrays: Mapping[str, Any], path: Path) -> FileModes:
    """Modes from arrays by name."""
    found: dict[str, Any] = {}
    for name, valid in _NAMES.items():
        there = [one for one in valid if one in arrays]
        if there:
            found[name] = arrays[there[0]]
    rates = "w" in found
    if rates == ("frequency_Hz" in found) or "shapes" not in found:
        raise InputError(
            "modes",
            f": {path.name} must have shapes, and either w in rad/s or frequency_Hz; "
            f"got {', '.join(arrays) or 'nothing'}",
        )
    w = np.ravel(found["w"] if rates else found["frequency_Hz"]).astype(float)
    shapes = np.atleast_2d(np.asarray(found["shapes"]))
    stated = str(np.ravel(found["normalised"])[0]).strip() if "normalised" in found else ""
    masses = np.ravel(found["modal_mass"]) if "modal_mass" in found else None
    names = None
    if "points" in found:  # cells of MATLAB hold arrays
        names = [str(np.ravel(one)[0]).strip() for one in np.ravel(found["points"])]
    zeta = np.ravel(found["zeta"]) if "zeta" in found else None
    return FileModes(
        w if rates else 2.0 * np.pi * w,
        zeta[0] if zeta is not None and zeta.size == 1 else zeta,
        shapes,
        names,
        masses,
        stated == "mass" or (rates and masses is None),  # `Modes` itself has unit modal masses
        found.get("residual"),
        found.get("compliance"),
        {name: found[name] for name in OF_BASE if name in found},
    )


def _read_npz(path: Path) -> FileModes:
    """Never a pickled object, which could run any program."""
    try:
        with open(path, "rb") as file, np.load(file, allow_pickle=False) as opened:
            arrays = {name: opened[name] for name in opened.files}
    except (ValueError, EOFError, AttributeError, TypeError, zipfile.BadZipFile, zlib.error):
        raise InputError(
            "modes", f": cannot read {path}: it is no .npz file of plain arrays; save it with numpy.savez"
        ) from None
    return _named(arrays, path)


def _read_mat(path: Path) -> FileModes:
    arrays, _ = read_mat(path)
    return _named({name.rpartition(".")[2]: one for name, one in arrays.items()}, path)


def _read_csv(path: Path) -> FileModes:
    """A row per mode: frequency_Hz, perhaps damping_ratio, modal_mass, participation; a column per point."""
    with open(path, encoding="utf-8-sig", newline="") as file:
        try:
            rows = [row for row in csv.reader(file) if any(cell.strip() for cell in row)]
        except (csv.Error, UnicodeDecodeError) as error:
            raise InputError("modes", f": cannot read {path}: {error}; save it as CSV in UTF-8") from None
    header = [cell.strip() for cell in rows[0]] if rows else []
    own = ("frequency_Hz", "damping_ratio", "modal_mass", OF_BASE[0])
    points = [name for name in header if name not in own]
    if "frequency_Hz" not in header or len(set(header)) < len(header) or not points or len(rows) < 2:
        raise InputError(
            "modes",
            f": {path.name} must have a row per mode, with the column frequency_Hz, damping_ratio and "
            f"modal_mass if they are known, and a column per point; got {', '.join(header) or 'nothing'}",
        )
    values = np.empty((len(rows) - 1, len(header)))
    for k, row in enumerate(rows[1:]):
        try:
            values[k] = [float(cell) for cell in row]
        except ValueError:
            raise InputError(
                "modes",
                f": row {k + 2} of {path.name} must have {len(header)} numbers; got {checks.one_line(row)}",
            ) from None
    columns = dict(zip(header, values.T, strict=True))
    return FileModes(
        2.0 * np.pi * columns["frequency_Hz"], columns.get("damping_ratio"),
        np.array([columns[name] for name in points]), points, columns.get("modal_mass"),
        of_base={name: columns[name] for name in OF_BASE[:1] if name in columns},
    )  # fmt: skip


def _read_universal(path: Path) -> FileModes:
    """Data sets 55 of normal or complex modes; points are node.1 to node.6."""
    if not path.exists():
        raise FileNotFoundError(2, "No such file or directory")
    pyuff = package("pyuff", path, "lab")
    sets = read_by(path, "universal file", lambda: pyuff.UFF(str(path)).read_sets())
    every = [one for one in (sets if isinstance(sets, list) else [sets]) if one.get("type") == 55]
    modes = [one for one in every if one.get("analysis_type") in (_NORMAL, _COMPLEX)]
    modes = [one for one in modes if one["analysis_type"] == _NORMAL or one["eig"].imag > 0.0]
    if not modes:
        raise InputError(
            f"cannot read {path}: it has no set 55 of normal or vibrating complex modes; export mode shapes"
        )
    nodes = np.asarray(modes[0]["node_nums"]).astype(int)
    kinds = {one["analysis_type"] for one in modes}
    if len(kinds) > 1 or any(not np.array_equal(one["node_nums"], modes[0]["node_nums"]) for one in modes):
        raise InputError(f"cannot read {path}: its sets 55 have different nodes or kinds; export one model")
    known = [name for name in _COMPONENTS if all(name in one for one in modes)]
    shapes = np.array([[one[name] for one in modes] for name in known])  # (components, modes, nodes)
    points = [f"{node}.{_COMPONENTS.index(name) + 1}" for name in known for node in nodes]
    by_point = shapes.transpose(0, 2, 1).reshape(-1, len(modes))
    return FileModes(*_rates(modes), by_point, points, _masses(modes))


def _rates(modes: Sequence[Mapping[str, Any]]) -> tuple[np.ndarray, np.ndarray]:
    """Natural frequencies [rad/s] and damping ratios of data sets 55."""
    if modes[0]["analysis_type"] == _NORMAL:
        frequencies = np.array([float(one["freq"]) for one in modes])
        return 2.0 * np.pi * frequencies, np.array([float(one["modal_damp_vis"]) for one in modes])
    roots = np.array([complex(one["eig"]) for one in modes])
    return np.abs(roots), -roots.real / np.abs(roots)


def _masses(modes: Sequence[Mapping[str, Any]]) -> np.ndarray:
    """Modal masses of data sets 55; of complex modes modal A over 2 i times the damped frequency."""
    if modes[0]["analysis_type"] == _NORMAL:
        return np.array([float(one["modal_m"]) for one in modes])
    return np.array([complex(one["modal_a"]) / (2j * complex(one["eig"]).imag) for one in modes])


_READERS: dict[str, Callable[[Path], FileModes]] = {
    ".npz": _read_npz, ".mat": _read_mat, ".csv": _read_csv, ".uff": _read_universal,
    ".unv": _read_universal,
}  # fmt: skip
