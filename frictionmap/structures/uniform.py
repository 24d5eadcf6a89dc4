"""Uniform beams and rectangular plates with their dimensions, as modes at points."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from .. import checks
from ..errors import InputError
from . import beam, plate
from .modes import MOST_MODES, Modes

#: Largest error of a natural frequency of a plate: its relative change with fewer functions.
_MOST_ERROR = 1e-2

#: Other names of a supported edge.
_SUPPORTED = ("pinned", "simply-supported")


def _positive(given: object, name: str) -> float:
    if given is None:
        raise InputError(name, "must be given; got nothing")
    return checks.number(given, name, above=0.0)


def _alone(owner: object, name: str, others: Sequence[str]) -> None:
    """Refuse a value that others define, too."""
    for other in others:
        if getattr(owner, other) is not None:
            raise InputError("cannot use", other, f"with {name}: both define the same; omit one")


#: Unit of the places of points: configurations convert to SI units.
_METRES = " (in m, or as you give lengths)"


def _points(given: object, what: str) -> Mapping[str, Any]:
    if not isinstance(given, Mapping) or not given:
        raise InputError(
            "points", f"must be names with {what}, such as {{ tip = ... }}; got {checks.one_line(given)}"
        )
    return {str(name): place for name, place in given.items()}


@dataclass(frozen=True, eq=False)
class Beam:
    """A uniform beam in bending, exactly; numbers are in SI units, or any consistent ones.

    Parameters
    ----------
    ends : str
        Left and right end, such as "clamped-free": clamped, pinned, free, or guided (no slope, no shear
        force).
    length : float
        Length L.
    bending_stiffness : float, optional
        EI.  Instead: E, with width and height (in the direction of the vibration), or with a diameter.
    mass_per_length : float, optional
        rho A.  Instead: density, with the same dimensions of the section.
    points : mapping
        Points with contacts, loads or outputs, by name: their distances from the left end.
    modes : int
        Number of elastic modes, 1 to 198.
    end_springs, end_masses : sequence of float, optional
        Stiffness of a spring to the ground, and mass of a body, at the left and at the right end, >= 0; at
        ends that can move, and if no rigid-body mode is left.
    with_residual : bool, optional
        Whether the flexibility of all other modes is added, which needs a contact with a stiffness.  Default:
        where no contact is rigid.

    Raises
    ------
    InputError
        A value is out of range, missing, or given twice; a point is off the beam, or at an end at rest.

    Examples
    --------
    >>> import frictionmap as fm
    >>> beam = fm.Beam("clamped-free", length=1.0, bending_stiffness=1.0, mass_per_length=1.0,
    ...                points={"tip": 1.0})
    >>> round(float(beam.frequencies[0]), 6), round(float(beam.shapes[0, 0]), 6)
    (3.516015, 2.0)
    """

    ends: str = "clamped-free"
    length: Any = None
    bending_stiffness: Any = None
    mass_per_length: Any = None
    points: Any = None
    modes: int = 12
    E: Any = None
    width: Any = None
    height: Any = None
    diameter: Any = None
    density: Any = None
    end_springs: Any = None
    end_masses: Any = None
    with_residual: bool | None = None

    def __post_init__(self) -> None:
        self._put("length", _positive(self.length, "length"))
        self._put("modes", checks.whole(self.modes, "modes", least=1, most=MOST_MODES - 2))
        area, inertia = self._section()
        if self.bending_stiffness is None:
            self._put("bending_stiffness", _positive(self.E, "E") * inertia)
        else:
            _alone(self, "bending_stiffness", ("E",))
            self._put("bending_stiffness", _positive(self.bending_stiffness, "bending_stiffness"))
        if self.mass_per_length is None:
            self._put("mass_per_length", _positive(self.density, "density") * area)
        else:
            _alone(self, "mass_per_length", ("density",))
            self._put("mass_per_length", _positive(self.mass_per_length, "mass_per_length"))
        for name in ("end_springs", "end_masses"):
            self._put(name, self._end_values(name))
        if self.tips != beam.BARE and beam.rigid_left(self.kinds, self.tips):
            raise InputError(
                "end_springs",
                f"must leave no rigid-body mode of a {self.ends} beam with springs or masses at its ends; "
                f"got {list(self.end_springs)}",
            )
        _ = self._roots  # refuses extreme masses
        self._put("points", self._places())

    def _put(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def _end_values(self, name: str) -> tuple[float, float]:
        """Springs or masses at both ends; 0 without."""
        given = getattr(self, name)
        if given is None:
            return 0.0, 0.0
        if not isinstance(given, Sequence | np.ndarray) or isinstance(given, str) or len(given) != 2:
            raise InputError(name, f"must be two numbers, left and right; got {checks.one_line(given)}")
        left, right = (checks.number(one, f"{name}[{k}]", least=0.0) for k, one in enumerate(given))
        for k, (value, kind) in enumerate(zip((left, right), self.kinds, strict=True)):
            if value and 0 in beam.ENDS[kind]:
                raise InputError(
                    f"{name}[{k}]", f"must be 0 at a {kind} end, which is at rest; got {value:g}"
                )
        return left, right

    @cached_property
    def tips(self) -> beam.Tips:
        """Springs and masses at the ends, over EI/L^3 and over the mass of the beam."""
        stiffness = self.bending_stiffness / self.length**3
        springs, masses = self.end_springs, self.end_masses
        return beam.Tips(
            (springs[0] / stiffness, springs[1] / stiffness), (masses[0] / self.mass, masses[1] / self.mass)
        )

    @cached_property
    def kinds(self) -> beam.Ends:
        """Kinds of the two ends."""
        words = self.ends.split("-") if isinstance(self.ends, str) else []
        if len(words) != 2 or not set(words) <= set(beam.ENDS):
            raise InputError(
                "ends", f"must be two of {', '.join(beam.ENDS)}, such as 'clamped-free'; got {self.ends!r}"
            )
        return beam.Ends(*words)

    def _section(self) -> tuple[float, float]:
        """Area and second moment of area; 1 where they are not needed."""
        sides = ("width", "height", "diameter")
        if self.bending_stiffness is not None and self.mass_per_length is not None:
            _alone(self, "bending_stiffness and mass_per_length", sides)
            return 1.0, 1.0
        if self.diameter is not None:
            _alone(self, "diameter", sides[:2])
            d = _positive(self.diameter, "diameter")
            return 0.25 * math.pi * d**2, math.pi * d**4 / 64.0
        width, height = _positive(self.width, "width"), _positive(self.height, "height")
        return width * height, width * height**3 / 12.0

    def _places(self) -> dict[str, float]:
        found = {}
        at_rest = [
            end for end, kind in zip((0.0, self.length), self.kinds, strict=True) if 0 in beam.ENDS[kind]
        ]
        for name, place in _points(self.points, "distances from the left end").items():
            value = checks.number(place, f"points.{name}")
            if not 0.0 <= value <= self.length:
                raise InputError(
                    f"points.{name}", f"must be on the beam, 0 to {self.length:g}{_METRES}; got {value:g}"
                )
            if value in at_rest:
                raise InputError(
                    f"points.{name}", f"must move: the {self.ends} beam is at rest there; got {value:g}"
                )
            found[name] = value
        return found

    @property
    def _x(self) -> np.ndarray:
        return np.array(list(self.points.values())) / self.length

    @property
    def mass(self) -> float:
        """Mass of the beam."""
        return float(self.mass_per_length * self.length)

    @cached_property
    def _roots(self) -> np.ndarray:
        if self.tips != beam.BARE:
            return beam.roots_with_tips(self.kinds, self.tips, self.modes)
        return beam.roots(self.kinds, self.modes)

    @property
    def frequencies(self) -> np.ndarray:
        """Natural frequencies of the elastic modes [rad per unit of time]."""
        rate = math.sqrt(self.bending_stiffness / self.mass_per_length) / self.length**2
        return np.asarray(self._roots**2 * rate)

    @cached_property
    def shapes(self) -> np.ndarray:
        """Elastic modes at the points, of unit modal mass, (points, modes)."""
        return beam.shapes(self.kinds, self._roots, self._x, self.tips) / math.sqrt(self.mass)

    def shapes_at(self, x: np.ndarray) -> np.ndarray:
        """Elastic modes at distances x (k,) from the left end, of unit modal mass, (k, modes)."""
        places = np.asarray(x) / self.length
        return beam.shapes(self.kinds, self._roots, places, self.tips) / math.sqrt(self.mass)

    @property
    def rigid_shapes(self) -> np.ndarray:
        """Rigid-body modes at the points, of unit modal mass, (points, 0 to 2)."""
        if self.tips != beam.BARE:  # there are none
            return np.empty((len(self.points), 0))
        return beam.rigid_shapes(self.kinds, self._x) / math.sqrt(self.mass)

    @cached_property
    def residual(self) -> np.ndarray:
        """Flexibility of all other modes at the points, (points, points)."""
        unit = beam.shapes(self.kinds, self._roots, self._x, self.tips) / self._roots**2
        rest = beam.compliance(self.kinds, self._x, self.tips) - unit @ unit.T
        return np.asarray(0.5 * (rest + rest.T) * (self.length**3 / self.bending_stiffness))

    @property
    def participation(self) -> np.ndarray | None:
        """Loads on the modes by a unit acceleration of the supports, (modes,); None of a beam without any."""
        held = any(0 in beam.ENDS[kind] for kind in self.kinds) or any(self.end_springs)
        if not held:
            return None
        rigid = beam.rigid_participation(self.kinds) if self.tips == beam.BARE else np.empty(0)
        elastic = beam.participation(self.kinds, self._roots, self.tips)
        return np.concatenate((rigid, elastic)) * math.sqrt(self.mass)

    @property
    def base_residual(self) -> np.ndarray:
        """Displacements of the points by that acceleration, less those of these modes, (points,)."""
        unit = beam.shapes(self.kinds, self._roots, self._x, self.tips) / self._roots**4
        rest = beam.sag(self.kinds, self._x, self.tips)
        rest -= unit @ beam.participation(self.kinds, self._roots, self.tips)
        return np.asarray(rest * (self.mass * self.length**3 / self.bending_stiffness))

    def describe(self) -> str:
        """Describe the beam in a few words."""
        more = "" if self.tips == beam.BARE else " with springs or masses at its ends"
        return f"{self.ends} beam of length {self.length:g}{more}"

    def as_modes(self) -> Modes:
        """The beam as modes at its points."""
        return _as_modes(self)


@dataclass(frozen=True, eq=False)
class Plate:
    """A uniform rectangular plate in bending, by Ritz's method; numbers are in SI units, or consistent ones.

    Parameters
    ----------
    edges : sequence of str
        The edges x = 0, x = a, y = 0, y = b: clamped, supported (or pinned) or free.
    size : sequence of float
        Sides [a, b].
    thickness : float, optional
        Thickness, with E and density.
    bending_stiffness, mass_per_area : float, optional
        Instead: D and rho h.
    nu : float
        Poisson's ratio, 0 <= nu < 0.5.
    points : mapping
        Points with contacts, loads or outputs, by name: [x, y].
    modes : int
        Number of elastic modes, 1 to 100.
    with_residual : bool, optional
        Whether the flexibility of all other modes is added, which needs a contact with a stiffness.  Default:
        where no contact is rigid.

    Raises
    ------
    InputError
        A value is out of range, missing, or given twice; a point is off the plate, or on an edge at rest; the
        modes are not resolved.

    Notes
    -----
    `frequency_error` is the relative change of each natural frequency with fewer functions.  It is 1e-9 or
    less of the lowest modes, or some 1e-5 with a corner of a clamped and a free edge.

    Examples
    --------
    A square plate on simple supports has the frequencies (i^2 + j^2) pi^2:

    >>> import numpy as np
    >>> import frictionmap as fm
    >>> plate = fm.Plate(
    ...     edges=["supported"] * 4, size=[1.0, 1.0], bending_stiffness=1.0, mass_per_area=1.0,
    ...     points={"centre": [0.5, 0.5]}, modes=3,
    ... )
    >>> (plate.frequencies / np.pi**2).round(6)
    array([2., 5., 5.])
    """

    edges: Any = ("clamped", "free", "free", "free")
    size: Any = None
    thickness: Any = None
    bending_stiffness: Any = None
    mass_per_area: Any = None
    nu: float = 0.3
    points: Any = None
    modes: int = 12
    E: Any = None
    density: Any = None
    with_residual: bool | None = None

    def __post_init__(self) -> None:
        size = checks.array(self.size, "size")
        if size.shape != (2,) or size.dtype.kind not in "iuf":
            raise InputError("size", f"must be the two sides [a, b]; got {checks.one_line(self.size)}")
        self._put("size", tuple(_positive(side, f"size[{k}]") for k, side in enumerate(size.tolist())))
        self._put("nu", checks.number(self.nu, "nu", least=0.0))
        if self.nu >= 0.5:
            raise InputError("nu", f"must be < 0.5; got {self.nu:g}")
        self._put("modes", checks.whole(self.modes, "modes", least=1, most=MOST_MODES // 2))
        if self.bending_stiffness is None:
            h = _positive(self.thickness, "thickness")
            stiffness = _positive(self.E, "E") * h**3 / (12.0 * (1.0 - self.nu**2))
            self._put("bending_stiffness", stiffness)
        else:
            _alone(self, "bending_stiffness", ("E",))
            self._put("bending_stiffness", _positive(self.bending_stiffness, "bending_stiffness"))
        if self.mass_per_area is None:
            mass = _positive(self.density, "density") * _positive(self.thickness, "thickness")
            self._put("mass_per_area", mass)
        else:
            _alone(self, "mass_per_area", ("density",))
            self._put("mass_per_area", _positive(self.mass_per_area, "mass_per_area"))
        self._put("points", self._places())
        self._check_error()

    def _put(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    @cached_property
    def kinds(self) -> plate.Edges:
        """Kinds of the four edges."""
        given = self.edges if isinstance(self.edges, Sequence) and not isinstance(self.edges, str) else ()
        words = ["supported" if word in _SUPPORTED else word for word in given]
        if len(words) != 4 or not set(words) <= set(plate.EDGES):
            raise InputError(
                "edges",
                f"must be four of {', '.join(plate.EDGES)}, for x = 0, x = a, y = 0, y = b; "
                f"got {checks.one_line(self.edges)}",
            )
        return plate.Edges(*words)

    def _places(self) -> dict[str, tuple[float, float]]:
        found = {}
        kinds = self.kinds
        for name, place in _points(self.points, "places [x, y]").items():
            given = checks.array(place, f"points.{name}")
            if given.shape != (2,) or given.dtype.kind not in "iuf":
                raise InputError(f"points.{name}", f"must be [x, y]; got {checks.one_line(place)}")
            for axis, value, side, pair in zip("xy", given, self.size, (kinds[:2], kinds[2:]), strict=True):
                if not 0.0 <= value <= side:
                    raise InputError(
                        f"points.{name}",
                        f"must be on the plate, {axis} from 0 to {side:g}{_METRES}; got {value:g}",
                    )
                for end, kind in zip((0.0, side), pair, strict=True):
                    if value == end and kind != "free":
                        raise InputError(
                            f"points.{name}",
                            f"must move: the edge {axis} = {end:g} is {kind}; got {given.tolist()}",
                        )
            found[name] = (float(given[0]), float(given[1]))
        return found

    @property
    def _place(self) -> np.ndarray:
        """Points over the side along x, (points, 2)."""
        return np.array(list(self.points.values())) / self.size[0]

    @cached_property
    def solution(self) -> plate.PlateModes:
        """Modes as sums of functions."""
        return _solve(self.kinds, self.size[1] / self.size[0], self.nu, plate.FUNCTIONS)

    @property
    def _kept(self) -> slice:
        first = self.solution.rigid
        return slice(first, first + self.modes)

    @cached_property
    def frequency_error(self) -> np.ndarray:
        """Estimated relative errors of the natural frequencies, (modes,)."""
        fewer = _solve(self.kinds, self.size[1] / self.size[0], self.nu, plate.FUNCTIONS - plate.FEWER)
        return np.abs(fewer.w[self._kept] / self.solution.w[self._kept] - 1.0)

    def _check_error(self) -> None:
        worst = int(np.argmax(self.frequency_error))
        if self.frequency_error[worst] > _MOST_ERROR:
            raise InputError(
                "modes",
                f"must be resolved to {_MOST_ERROR:g}: the frequency of mode {worst + 1} is known to "
                f"{self.frequency_error[worst]:.1g} only; got {self.modes}",
            )

    @property
    def mass(self) -> float:
        """Mass of the plate."""
        return float(self.mass_per_area * self.size[0] * self.size[1])

    @property
    def frequencies(self) -> np.ndarray:
        """Natural frequencies of the elastic modes [rad per unit of time]."""
        rate = math.sqrt(self.bending_stiffness / self.mass_per_area) / self.size[0] ** 2
        return np.asarray(self.solution.w[self._kept] * rate)

    @cached_property
    def _unit_shapes(self) -> np.ndarray:
        """Modes at the points, of unit mass over a^2, (points, rigid-body and elastic modes)."""
        return self.solution.shapes(self._place, self.solution.rigid + self.modes)

    def shapes_at(self, places: np.ndarray) -> np.ndarray:
        """Elastic modes at places (k, 2), of unit modal mass, (k, modes)."""
        first = self.solution.rigid
        found = self.solution.shapes(np.asarray(places) / self.size[0], first + self.modes)[:, first:]
        return np.asarray(found / (self.size[0] * math.sqrt(self.mass_per_area)))

    @property
    def shapes(self) -> np.ndarray:
        """Elastic modes at the points, of unit modal mass, (points, modes)."""
        size = self.size[0] * math.sqrt(self.mass_per_area)
        return np.asarray(self._unit_shapes[:, self.solution.rigid :] / size)

    @property
    def rigid_shapes(self) -> np.ndarray:
        """Rigid-body modes at the points, of unit modal mass, (points, 0 to 3)."""
        size = self.size[0] * math.sqrt(self.mass_per_area)
        return np.asarray(self._unit_shapes[:, : self.solution.rigid] / size)

    @cached_property
    def residual(self) -> np.ndarray:
        """Flexibility of all other modes at the points, (points, points)."""
        if self.kinds.supported:
            parts = self._unit_shapes / self.solution.w[: self.modes]
            rest = plate.supported_compliance(self._place, self.solution.aspect) - parts @ parts.T
        else:
            rest = self.solution.compliance(self._place, self.modes)
        return np.asarray(0.5 * (rest + rest.T) * (self.size[0] ** 2 / self.bending_stiffness))

    @property
    def participation(self) -> np.ndarray | None:
        """Loads on the modes by a unit acceleration of the supports, (modes,); None of a free plate."""
        if set(self.kinds) == {"free"}:
            return None
        found = self.solution.participation[: self._kept.stop]
        return np.asarray(found * (self.size[0] * math.sqrt(self.mass_per_area)))

    @property
    def base_residual(self) -> np.ndarray:
        """Displacements of the points by that acceleration, less those of these modes, (points,)."""
        rest = self.solution.sag(self._place, self._kept.stop)
        return np.asarray(rest * (self.size[0] ** 4 * self.mass_per_area / self.bending_stiffness))

    def describe(self) -> str:
        """Describe the plate in a few words."""
        letters = "".join(kind[0].upper() for kind in self.kinds)
        return f"plate {self.size[0]:g} by {self.size[1]:g}, edges {letters}"

    def as_modes(self) -> Modes:
        """The plate as modes at its points."""
        return _as_modes(self)


@lru_cache(maxsize=8)  # seconds each
def _solve(edges: plate.Edges, aspect: float, nu: float, functions: int) -> plate.PlateModes:
    return plate.solve_plate(edges, aspect, nu, functions)


def _as_modes(owner: Beam | Plate) -> Modes:
    rigid, participation = owner.rigid_shapes, owner.participation
    softer = owner.with_residual is not False
    return Modes(
        np.concatenate((np.zeros(rigid.shape[1]), owner.frequencies)),
        None,
        np.hstack((rigid, owner.shapes)),
        tuple(owner.points),
        owner.residual if softer else None,
        source=owner.describe(),
        optional=owner.with_residual is None,
        geometry=owner,
        participation=participation,
        base_residual=None if participation is None or not softer else owner.base_residual,
    )
