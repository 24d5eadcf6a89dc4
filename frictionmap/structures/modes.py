"""Modes of a structure at named points: natural frequencies, damping, shapes, and what modes left out add."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import checks
from ..errors import InputError
from .dofs import POINT, Dofs

#: Modes at most, rigid-body modes among them.
MOST_MODES = 200

#: Largest imaginary part of a shape over its real part, after the turn that makes it most real: shapes of
#: tests with less are real ones with errors of measurement.
MOST_IMAGINARY = 0.1

#: Largest difference of a residual flexibility from its transpose, over its largest entry.
_ASYMMETRY = 1e-6


#: What is given of a base that moves.
OF_BASE = ("participation", "influence", "base_residual")


@dataclass(frozen=True, eq=False, repr=False)
class Modes:
    """Modes of a linear structure at some of its points: those with contacts, loads and outputs.

    Parameters
    ----------
    w : sequence of float
        Natural frequencies [rad per unit of time], increasing; 0 for rigid-body modes.
    zeta : float or sequence of float, optional
        Damping ratios [-] of all modes, or one per mode; 0 for rigid-body modes.  Default: those of `System`.
    shapes : array, shape (points, modes)
        Displacements of the points in the modes, of unit modal mass.  Complex shapes are turned; imaginary
        parts of up to a tenth of the real ones are left out.
    points : sequence of str, optional
        Names of the points; default: "1", "2", ...
    residual : array, shape (points, points), optional
        Residual flexibility: displacements of the points by unit forces, less those of these modes.
    compliance : array, shape (points, points), optional
        Instead: the static displacements by unit forces, those of these modes included.
    participation : array, shape (modes,), optional
        phi.M iota: loads on the modes by a base that moves the whole structure with unit acceleration, with
        which motions under records of the base are followed; unit sqrt(mass), as a participation factor of a
        finite-element program for shapes of unit modal mass.
    influence : array, shape (points,), optional
        iota at the points: their displacements by a unit displacement of the base as of a rigid body.
        Default: 1, points that are measured along the motion of the base.
    base_residual : array, shape (points,), optional
        Beside a residual: displacements of the points by the load M iota, less those of these modes.

    Raises
    ------
    InputError
        A value is out of range, or arrays do not fit each other.

    Examples
    --------
    >>> import frictionmap as fm
    >>> rig = fm.Modes([20.0, 125.0], 0.01, [[2.0, -2.0], [0.7, 1.4]], ["tip", "shaker"])
    >>> rig.frequencies, rig.points
    (array([ 20., 125.]), ('tip', 'shaker'))
    """

    w: Any
    zeta: Any = None
    shapes: Any = None
    points: Any = None
    residual: Any = None
    compliance: Any = None
    source: str = ""
    imaginary: float = 0.0  # largest part of a complex shape that was left out
    optional: bool = False  # whether the residual may be left out where contacts are rigid
    geometry: Any = None  # the beam or plate that has them, for pictures
    participation: Any = None
    influence: Any = None
    base_residual: Any = None

    def __post_init__(self) -> None:
        w = checks.array(self.w, "modes: w")
        if w.ndim != 1 or w.dtype.kind not in "iuf" or not w.size:
            raise InputError("modes", f": w must be a list of frequencies; got {checks.one_line(self.w)}")
        w = w.astype(float)
        if w.size > MOST_MODES:
            raise InputError("modes", f"must be at most {MOST_MODES}; got {w.size}")
        if not np.isfinite(w).all() or (np.diff(w) < 0.0).any() or w[0] < 0.0:
            raise InputError("modes", f": w must be >= 0 and increasing; got {checks.one_line(w.tolist())}")
        if w[-1] == 0.0:
            raise InputError("modes", ": w must have a frequency > 0; got rigid-body modes only")
        self._put("w", w)
        self._put("zeta", self._damping(w))
        self._put("shapes", self._shapes(w))
        object.__setattr__(self, "points", self._names(len(self.shapes)))
        self._put("residual", self._flexibility())
        object.__setattr__(self, "compliance", None)
        for name in OF_BASE:
            self._put(name, self._numbers(name))

    def _put(self, name: str, value: np.ndarray | None) -> None:
        if value is not None:
            value = np.ascontiguousarray(value)
            value.setflags(write=False)
        object.__setattr__(self, name, value)

    def _damping(self, w: np.ndarray) -> np.ndarray | None:
        if self.zeta is None:
            return None
        given = checks.array(self.zeta, "modes: zeta")
        if given.dtype.kind not in "iuf" or given.shape not in ((), w.shape):
            raise InputError(
                "modes", f": zeta must be one number, or one per mode ({w.size}); got {given.tolist()}"
            )
        zeta = np.where(w > 0.0, given, 0.0) if given.shape == () else given.astype(float)
        if not np.isfinite(zeta).all() or zeta.min() < 0.0 or zeta.max() > checks.LARGEST_DAMPING:
            raise InputError(
                "modes",
                f": zeta must be 0 to {checks.LARGEST_DAMPING:g}; got {checks.one_line(zeta.tolist())}",
            )
        if zeta[w == 0.0].any():
            raise InputError("modes", f": zeta must be 0 for rigid-body modes; got {zeta[w == 0.0].max():g}")
        return zeta

    def _shapes(self, w: np.ndarray) -> np.ndarray:
        given = checks.array(self.shapes, "modes: shapes")
        if given.dtype.kind not in "iufc" or given.ndim != 2 or not given.size:
            raise InputError("modes", f": shapes must be (points, modes); got {checks.one_line(self.shapes)}")
        if given.shape[1] != w.size:
            raise InputError(
                "modes", f": shapes must be points x {w.size} modes; got {given.shape[0]} x {given.shape[1]}"
            )
        if not np.isfinite(given).all():
            raise InputError("modes", f": shapes must be finite; got {given[~np.isfinite(given)][0]}")
        if given.dtype.kind == "c" and self.participation is not None:
            raise InputError(
                "cannot use",
                "participation",
                "with complex shapes: their signs change where they are made real; give real shapes",
            )
        shapes = self._real(given) if given.dtype.kind == "c" else given.astype(float)
        if not shapes.any(axis=1).all():
            name = self._names(len(shapes))[int(np.flatnonzero(~shapes.any(axis=1))[0])]
            raise InputError("modes", f": shapes must move every point; got zeros at {name}")
        return shapes

    def _real(self, shapes: np.ndarray) -> np.ndarray:
        """Real parts of complex shapes (points, modes), each turned so that the sum of its squares is > 0."""
        square = (shapes**2).sum(axis=0)
        turned = shapes * np.exp(-0.5j * np.angle(square))
        sizes = np.linalg.norm(turned.real, axis=0)
        part = np.linalg.norm(turned.imag, axis=0) / np.where(sizes > 0.0, sizes, 1.0)
        worst = int(np.argmax(part))
        if part[worst] > MOST_IMAGINARY:
            raise InputError(
                "modes",
                f": shapes must be real to {MOST_IMAGINARY:g}; got mode {worst + 1} with an imaginary part "
                f"of {part[worst]:.2g} times the real one: damping couples it to others; give matrices",
            )
        object.__setattr__(self, "imaginary", float(part[worst]))
        return np.asarray(turned.real)

    def _names(self, count: int) -> tuple[str, ...]:
        if self.points is None:
            return tuple(str(k) for k in range(1, count + 1))
        names = self.points
        if isinstance(names, str) or not isinstance(names, Sequence | np.ndarray):
            raise InputError("modes", f": points must be a list of names; got {checks.one_line(names)}")
        found = tuple(str(name).strip() for name in names)
        if len(found) != count or len(set(found)) < count or not all(found):
            raise InputError(
                "modes", f": points must be {count} different names, one per row of shapes; got {list(found)}"
            )
        return found

    def _numbers(self, name: str) -> np.ndarray | None:
        """Numbers of the modes, or of the points, for a base that moves; None if they are not given."""
        given = getattr(self, name)
        if given is None:
            return None
        if self.participation is None:
            raise InputError(
                "cannot use", name, "without participation: both are of a base that moves; omit it"
            )
        size, each = (self.w.size, "mode") if name == OF_BASE[0] else (len(self.points), "point")
        values = checks.array(given, f"modes: {name}")
        if values.dtype.kind not in "iuf" or values.shape != (size,) or not np.isfinite(values).all():
            raise InputError(
                "modes",
                f": {name} must be one finite number per {each} ({size}); got {checks.one_line(given)}",
            )
        return values.astype(float)

    def _flexibility(self) -> np.ndarray | None:
        """The residual flexibility (points, points), or None."""
        if self.residual is not None and self.compliance is not None:
            raise InputError(
                "cannot use", "compliance", "with residual: one follows from the other; omit one"
            )
        name = "residual" if self.compliance is None else "compliance"
        given = getattr(self, name)
        if given is None:
            return None
        matrix, count = checks.array(given, f"modes: {name}"), len(self.shapes)
        if matrix.dtype.kind not in "iuf" or matrix.shape != (count, count) or not np.isfinite(matrix).all():
            raise InputError(
                "modes", f": {name} must be {count} x {count} finite numbers; got {checks.one_line(given)}"
            )
        difference = float(np.abs(matrix - matrix.T).max())
        if difference > _ASYMMETRY * float(np.abs(matrix).max()):
            raise InputError("modes", f": {name} must be symmetric; got a difference of {difference:.3g}")
        found = 0.5 * (matrix + matrix.T)
        return np.asarray(found - self.static() if name == "compliance" else found)

    def static(self) -> np.ndarray:
        """Displacements of the points by unit forces that the elastic modes contribute, (points, points)."""
        parts = self.shapes[:, self.rigid_modes :] / self.frequencies
        return np.asarray(parts @ parts.T)

    @property
    def rigid_modes(self) -> int:
        """Number of rigid-body modes, which come first."""
        return int(np.count_nonzero(self.w == 0.0))

    @property
    def frequencies(self) -> np.ndarray:
        """Natural frequencies of the elastic modes [rad per unit of time]."""
        return np.asarray(self.w[self.rigid_modes :])

    @property
    def dofs(self) -> Dofs:
        """The points, by number and by name."""
        return Dofs(tuple(range(1, len(self.points) + 1)), self.points, POINT)

    def _content(self) -> tuple[Any, ...]:
        arrays = (self.w, self.zeta, self.shapes, self.residual, *(getattr(self, name) for name in OF_BASE))
        return (self.points, *(None if one is None else (one + 0.0).tobytes() for one in arrays))

    def __eq__(self, other: object) -> bool:
        return self._content() == other._content() if isinstance(other, Modes) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._content())

    def __repr__(self) -> str:
        source = f" from {self.source}" if self.source else ""
        more = "" if self.residual is None else ", residual flexibility"
        return f"<{self.w.size} modes at {len(self.points)} points{source}{more}>"
