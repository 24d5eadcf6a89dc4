"""Piecewise linear springs between masses or to the ground: gaps, backlash, bilinear springs.

c F(c.x) acts on the structure; F is continuous, through the knots, with a slope beyond each end
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from .. import checks
from ..errors import InputError
from ..structures.dofs import Dofs
from .shown import Shown

#: Springs of a system, and knots of a spring, at most.
MOST_SPRINGS = 8
MOST_KNOTS = 24

#: The ways to write a spring, each with the keys that belong to it.
FORMS = {
    "gap": ("stiffness", "side"),
    "backlash": ("stiffness",),
    "displacement": ("force", "stiffness_below", "stiffness_above"),
}


@dataclass(frozen=True, eq=False)  # comparing arrays gives no single truth value
class SpringElement:
    """A piecewise linear spring over the masses of a system, in its units."""

    direction: np.ndarray  # (n,) c
    displacement: tuple[float, ...]  # (K,) knots over P/k_1, increasing, K >= 1
    force: tuple[float, ...]  # (K,) F there over P
    stiffness_below: float  # over k_1, >= 0: slope before the first knot
    stiffness_above: float  # and after the last one

    @property
    def slopes(self) -> tuple[float, ...]:
        """Slope of every piece, (K + 1,)."""
        inner = np.diff(self.force) / np.diff(self.displacement)
        return (self.stiffness_below, *map(float, inner), self.stiffness_above)

    def __call__(self, displacement: Any) -> np.ndarray:
        """F at displacements c.x."""
        u = np.asarray(displacement, dtype=float)
        below = self.stiffness_below * np.minimum(u - self.displacement[0], 0.0)
        above = self.stiffness_above * np.maximum(u - self.displacement[-1], 0.0)
        return np.interp(u, self.displacement, self.force) + below + above

    def energy(self, displacement: Any) -> np.ndarray:
        """Work of F from 0 to displacements c.x."""
        u = np.append(np.asarray(displacement, dtype=float), 0.0)
        knots, forces = np.array(self.displacement), np.array(self.force)
        stored = np.append(0.0, np.cumsum(0.5 * (forces[1:] + forces[:-1]) * np.diff(knots)))
        piece = np.searchsorted(knots, u)
        knot = np.maximum(piece - 1, 0)
        way = u - knots[knot]
        found = stored[knot] + (forces[knot] + 0.5 * np.array(self.slopes)[piece] * way) * way
        return np.asarray(found[:-1] - found[-1]).reshape(np.shape(displacement))


@dataclass(frozen=True, repr=False)
class Spring(Shown):
    """A piecewise linear spring of a system.

    Parameters
    ----------
    masses : int, str or sequence of them
        The mass that it connects to the ground, which a moving base does not move, or the two masses [A, B],
        A < B, counted from 1.  Its displacement is that of the mass, or x_B - x_A.
    gap : float, optional
        Free displacement [-] over P/k_1, >= 0, on the side of `side`: a stop that touches there.
    backlash : float, optional
        Instead: free displacement to either side, > 0; the play from stop to stop is twice this.
    stiffness : float, optional
        Stiffness over k_1 [-], > 0, beyond the gap or the backlash.
    side : {1, -1}
        Of a gap: whether it closes at a positive displacement, or at a negative one.
    displacement, force : sequence of float, optional
        Instead: knots over P/k_1 and forces there over P [-]; displacements increase, forces do not fall; 24
        at most.
    stiffness_below, stiffness_above : float, optional
        Stiffness over k_1 [-], >= 0, before the first knot and after the last one.
    name : str, optional
        Default: "spring" and the masses, such as "spring 1-2".

    Raises
    ------
    InputError
        A value has the wrong type or is out of range, or two exclude each other.

    Examples
    --------
    A stop at the distance 2 P/k_1, which the mass reaches near its resonance only:

    >>> import frictionmap as fm
    >>> system = fm.System(springs=[fm.Spring(gap=2.0, stiffness=5.0)], damping_ratios=0.05)
    >>> ds = fm.sweep(system, r=[0.4, 0.9], beta=[0.1], outputs=["regime", "spring_force_max"])
    >>> (ds.spring_force_max.values.ravel() > 0).tolist()
    [False, True]
    """

    masses: int | str | Sequence[int | str] = (1,)
    gap: float | None = None
    backlash: float | None = None
    stiffness: float | None = None
    side: int | None = None
    displacement: Sequence[float] | None = None
    force: Sequence[float] | None = None
    stiffness_below: float | None = None
    stiffness_above: float | None = None
    name: str | None = None

    def __post_init__(self) -> None:
        masses = self.masses
        if isinstance(masses, (int, str, np.integer)) and not isinstance(masses, bool):
            masses = (masses,)
        listed = isinstance(masses, (Sequence, np.ndarray)) and len(masses) in (1, 2)
        if not listed:
            raise InputError("masses", f"must be one mass, or two [A, B]; got {checks.one_line(masses)}")
        self._set("masses", tuple(masses))  # type: ignore[arg-type]
        if self.name is not None and not isinstance(self.name, str):
            raise InputError("name", f"must be text; got {checks.one_line(self.name)}")
        form = self._checked_form()
        if form == "displacement":
            self._check_knots()
            return
        ends: dict[str, float] = {"least": 0.0} if form == "gap" else {"above": 0.0}
        self._set(form, checks.number(getattr(self, form), form, **ends))
        self._set("stiffness", checks.number(self.stiffness, "stiffness", above=0.0))
        side = checks.number(1 if self.side is None else self.side, "side")
        if side not in (1.0, -1.0):
            raise InputError("side", f"must be 1 or -1; got {side:g}")
        if form == "gap":
            self._set("side", int(side))

    def _set(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def _checked_form(self) -> str:
        """The way that the spring is written in; refuse keys of another one, and missing ones."""
        given = [form for form in FORMS if getattr(self, form) is not None]
        if not given:
            raise InputError(
                "gap", "must be given, or backlash or displacement: a spring without them is linear; got none"
            )
        if len(given) > 1:
            raise InputError("cannot use", given[1], f"with {given[0]}: both define the spring; omit one")
        own = FORMS[given[0]]
        for key in dict.fromkeys(key for keys in FORMS.values() for key in keys):
            if key not in own and getattr(self, key) is not None:
                raise InputError("cannot use", key, f"with {given[0]}: it belongs to another form; omit it")
            if key in own and key != "side" and getattr(self, key) is None:
                raise InputError(key, f"must be given with {given[0]}; got none")
        return given[0]

    def _check_knots(self) -> None:
        for name in ("displacement", "force"):
            self._set(name, checks.number_list(getattr(self, name), name))
        for name in ("stiffness_below", "stiffness_above"):
            self._set(name, checks.number(getattr(self, name), name, least=0.0))
        u: Any = self.displacement
        force: Any = self.force
        if len(u) != len(force):
            raise InputError(
                "force", f"must have as many values as displacement ({len(u)}); got {len(force)}"
            )
        if len(u) > MOST_KNOTS:
            raise InputError("displacement", f"must have at most {MOST_KNOTS} knots; got {len(u)}")
        for k in range(1, len(u)):
            if u[k] <= u[k - 1]:
                raise InputError("displacement", f"must increase; got {u[k]:g} after {u[k - 1]:g}")
            if force[k] < force[k - 1]:
                raise InputError(
                    "force",
                    f"must not fall, as springs of negative stiffness are not offered; got {force[k]:g} "
                    f"after {force[k - 1]:g}",
                )

    @property
    def label(self) -> str:
        """Its name, or its masses."""
        return self.name or f"spring {'-'.join(map(str, self.masses))}"  # type: ignore[arg-type]

    def on(self, dofs: Dofs, key: str) -> SpringElement:
        """The spring over the masses of a system.

        key : name of the spring, for messages
        """
        masses: tuple = self.masses  # type: ignore[assignment]
        numbers = [dofs.number(mass, f"{key}.masses[{k}]") for k, mass in enumerate(masses)]
        if len(numbers) == 2 and numbers[0] >= numbers[1]:
            raise InputError(f"{key}.masses", f"must be [A, B] with A < B; got {list(masses)}")
        c = np.zeros(dofs.n)
        rows = dofs.rows(numbers)
        c[rows[-1]] = 1.0
        if len(rows) == 2:
            c[rows[0]] = -1.0
        return SpringElement(c, *self._pieces())

    def _pieces(self) -> tuple[tuple[float, ...], tuple[float, ...], float, float]:
        """Knots, forces there, and the slopes beyond the ends."""
        if self.displacement is not None:
            below, above = self.stiffness_below, self.stiffness_above
            return tuple(self.displacement), tuple(self.force), below, above  # type: ignore[arg-type, return-value]
        k = float(self.stiffness)  # type: ignore[arg-type]
        if self.backlash is not None:
            return (-self.backlash, self.backlash), (0.0, 0.0), k, k
        gap = self.side * self.gap  # type: ignore[operator]
        return (gap,), (0.0,), k if self.side == -1 else 0.0, k if self.side == 1 else 0.0


def checked_springs(given: object) -> tuple[Spring, ...]:
    """Check a list of springs; a mapping is one as in a configuration."""
    if not isinstance(given, Sequence) or isinstance(given, (str, bytes)) or not given:
        raise InputError("springs", f"must be a list of springs; got {checks.one_line(given)}")
    if len(given) > MOST_SPRINGS:
        raise InputError("springs", f"must be at most {MOST_SPRINGS}; got {len(given)}")
    return tuple(_spring(one, f"springs[{k}]") for k, one in enumerate(given, 1))


def _spring(given: object, name: str) -> Spring:
    if isinstance(given, Spring):
        return given
    if not isinstance(given, Mapping):
        raise InputError(name, f"must be a table of a spring; got {checks.one_line(given)}")
    valid = [one.name for one in fields(Spring)]
    for key in given:
        if key not in valid:
            raise InputError(
                f"unknown key {f'{name}.{key}'!r}{checks.nearest(str(key), valid)}; valid: {', '.join(valid)}"
            )
    try:
        return Spring(**given)
    except InputError as error:
        raise error.renamed(f"{name}.{error.where}") from None
