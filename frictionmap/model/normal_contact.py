"""Normal force that moves with the structure: N = max(0, N0 + k_n d.x), where 0 is an open contact."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import checks
from ..errors import InputError
from ..structures.dofs import Dofs
from .shown import Shown

#: The keys of the table `normal`; one of the first three gives d.
KEYS = ("mass", "masses", "vector", "stiffness", "friction", "side", "preload")
_DIRECTIONS = KEYS[:3]


@dataclass(frozen=True, eq=False)  # comparing arrays gives no single truth value
class MovingNormal:
    """A normal force over the masses of a system, in its units.

    N = max(0, N0 + k_n d.x), |f| <= phi N; the force d (N - max(0, N0)) acts on the structure, whose x is
    measured from the equilibrium with N0.
    """

    direction: np.ndarray  # (n,) d; d.x > 0 presses
    stiffness: float  # k_n over k_1, > 0
    friction: float  # phi [-], >= 0
    preload: float | None  # N0 over P; negative: a gap -N0/k_n; None: N0 = F/phi of the friction F at preload

    def preload_at(self, friction: Any) -> Any:
        """N0 for the friction at preload F of the contact, over P."""
        return friction / self.friction if self.preload is None else self.preload + 0.0 * friction


@dataclass(frozen=True, repr=False)
class NormalForce(Shown):
    """Normal force of a contact that follows the structure: its key `normal`.

    Parameters
    ----------
    mass : int or str, optional
        The mass whose displacement presses the contact, counted from 1, or its label.
    masses : sequence of int or str, optional
        Instead: two masses [A, B], A < B, whose distance x_B - x_A does.
    vector : sequence of float, optional
        Instead: d, one number per mass; the displacement d.x does.
    stiffness : float
        k_n over k_1 [-], > 0: the normal force per displacement.
    friction : float
        phi [-], >= 0: the friction force per normal force.
    side : {1, -1}
        Whether a positive displacement presses the contact, or a negative one.
    preload : float, optional
        N0 over P [-]; negative: a gap of -N0/k_n.  Default: that of the friction at preload, N0 = beta/phi.

    Raises
    ------
    InputError
        A value has the wrong type or is out of range, or two exclude each other.

    Examples
    --------
    Mass 2 presses the contact of mass 1, which opens in every cycle: its least normal force is 0.

    >>> import frictionmap as fm
    >>> wedge = fm.NormalForce(mass=2, stiffness=1.0, friction=0.3, preload=1.0)
    >>> pair = fm.System(
    ...     contacts=[fm.Contact(masses=[1], normal=wedge)],
    ...     mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.05,
    ... )
    >>> ds = fm.sweep(pair, r=[0.8], beta=[0.3], outputs=["regime", "normal_force_min"])
    >>> ds.normal_force_min.values.ravel().round(4)
    array([0.])
    """

    mass: int | str | None = None
    masses: Sequence[int | str] | None = None
    vector: Sequence[float] | None = None
    stiffness: float | None = None
    friction: float | None = None
    side: int = 1
    preload: float | None = None

    def __post_init__(self) -> None:
        given = [name for name in _DIRECTIONS if getattr(self, name) is not None]
        if not given:
            raise InputError("mass", "must be given, or masses or vector: what presses the contact; got none")
        if len(given) > 1:
            raise InputError("cannot use", given[1], f"with {given[0]}: both define the direction; omit one")
        for name in ("stiffness", "friction"):
            if getattr(self, name) is None:
                raise InputError(name, f"must be given in a table {{ {', '.join(KEYS)} }}; got none")
        self._set("stiffness", checks.number(self.stiffness, "stiffness", above=0.0))
        self._set("friction", checks.number(self.friction, "friction", least=0.0))
        side = checks.number(self.side, "side")
        if side not in (1.0, -1.0):
            raise InputError("side", f"must be 1 or -1; got {side:g}")
        self._set("side", int(side))
        self._check_preload()
        if self.masses is not None:
            listed = isinstance(self.masses, Sequence) and not isinstance(self.masses, str)
            if not listed or len(self.masses) != 2:
                got = checks.one_line(self.masses)
                raise InputError("masses", f"must be two masses [A, B]; got {got}")
            self._set("masses", tuple(self.masses))
        if self.vector is not None:
            self._set("vector", checks.number_list(self.vector, "vector"))

    def _set(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def _check_preload(self) -> None:
        if self.preload is not None:
            self._set("preload", checks.number(self.preload, "preload"))
        elif self.friction == 0.0:
            raise InputError(
                "preload", "must be given with friction = 0, where beta gives no normal force; got none"
            )

    def on(self, dofs: Dofs, key: str) -> MovingNormal:
        """The normal force over the masses of a system.

        key : name of the table, for messages
        """
        stiffness, friction = float(self.stiffness or 0.0), float(self.friction or 0.0)  # None is refused
        return MovingNormal(self.side * self._direction(dofs, key), stiffness, friction, self.preload)

    def _direction(self, dofs: Dofs, key: str) -> np.ndarray:
        if self.vector is not None:
            if len(self.vector) != dofs.n:
                raise InputError(
                    f"{key}.vector", f"must have one number per mass ({dofs.n}); got {len(self.vector)}"
                )
            return np.array(self.vector)
        found = np.zeros(dofs.n)
        if self.masses is None:
            found[dofs.row(dofs.number(self.mass, f"{key}.mass"))] = 1.0
            return found
        a, b = (dofs.number(mass, f"{key}.masses[{k}]") for k, mass in enumerate(self.masses))
        if a >= b:
            raise InputError(f"{key}.masses", f"must be [A, B] with A < B; got {list(self.masses)}")
        found[dofs.rows((a, b))] = -1.0, 1.0
        return found


def normal_force(given: Any) -> NormalForce:
    """The normal force of a key `normal`: a mapping, or a `NormalForce`."""
    if isinstance(given, NormalForce):
        return given
    if not isinstance(given, Mapping):
        raise InputError("normal", f"must be {{ {', '.join(KEYS)} }}; got {checks.one_line(given)}")
    for key in given:
        if key not in KEYS:
            raise InputError(
                f"unknown key {f'normal.{key}'!r}{checks.nearest(str(key), KEYS)}; valid: {', '.join(KEYS)}"
            )
    try:
        return NormalForce(**given)
    except InputError as error:
        raise error.renamed(f"normal.{error.where}") from None
