"""What is simulated: masses, springs, damping, load and the one contact."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from . import checks
from .errors import InputError
from .modes import ModalModel, modal_damping, solve_modes

CONTACTS = ("fixed-wall", "joined-base-wall", "between-masses")


def _sequence(values: Any, name: str, what: str) -> Sequence:
    """`values`, if it is a list, a tuple or an array."""
    if isinstance(values, (str, bytes)) or not isinstance(values, (Sequence, np.ndarray)):
        raise InputError(f"{name} must be a list of {what}; got {values!r}")
    return list(values)


def _ratios(values: object, name: str) -> tuple[float, ...]:
    values = _sequence(values, name, "numbers")
    if len(values) == 0:
        raise InputError(f"{name} must have at least one value; got none")
    ratios = tuple(checks.number(value, f"{name}[{index}]", above=0.0) for index, value in enumerate(values))
    if ratios[0] != 1.0:
        raise InputError(f"{name}[0] must be 1, the unit of the others; got {ratios[0]:g}")
    return ratios


def _contact_masses(values: object, contact: str, n: int) -> tuple[int, ...]:
    values = _sequence(values, "contact_masses", "whole numbers")
    count = 2 if contact == "between-masses" else 1
    if len(values) != count:
        wanted = "two masses [A, B]" if count == 2 else "one mass"
        raise InputError(f"contact_masses must name {wanted} for {contact}; got {list(values)}")
    masses = tuple(
        checks.whole(value, f"contact_masses[{index}]", least=1, most=n) for index, value in enumerate(values)
    )
    if count == 2 and masses[0] >= masses[1]:
        raise InputError(f"contact_masses must be [A, B] with A < B; got {list(masses)}")
    return masses


def _damping(values: object, n: int) -> tuple[float, ...]:
    bounds = {"least": 0.0, "most": checks.LARGEST_DAMPING}
    if isinstance(values, (str, bytes)) or not isinstance(values, (Sequence, np.ndarray)):
        return (checks.number(values, "damping_ratios", **bounds),) * n
    if len(values) != n:
        raise InputError(f"damping_ratios must be one number or one a mode ({n}); got {len(values)}")
    return tuple(
        checks.number(value, f"damping_ratios[{index}]", **bounds) for index, value in enumerate(values)
    )


@dataclass(frozen=True)
class System:
    """A chain of masses and springs with one dry-friction contact, shaken at one frequency.

    Spring 1 ties mass 1 to the ground (or to the base), spring i mass i to mass i - 1.

    Parameters
    ----------
    contact : {"fixed-wall", "joined-base-wall", "between-masses"}
        Where the friction acts: between a mass and the ground, between a mass and a wall that moves with
        the shaken base, or between two masses.
    contact_masses : sequence of int
        The mass in contact, or the two, A < B; counted from 1.
    load_mass : int
        The mass the harmonic load acts on, counted from 1; with a joined base-wall always 1, through the
        first spring.
    mass_ratios, stiffness_ratios : sequence of float
        gamma_i = m_i/m_1 and kappa_i = k_i/k_1 [-], > 0, the first one 1.
    damping_ratios : float or sequence of float
        Damping ratio zeta [-] of every mode, or one a mode, >= 0, relative to the ground; 1 and more is
        legal.

    Raises
    ------
    InputError
        A value is out of range.

    Notes
    -----
    Dimensionless equations of motion: theory.md 1; T(5.4), (5.8) for chains, T(2.12), (3.3) for one mass.
    """

    contact: str = "fixed-wall"
    contact_masses: Sequence[int] = (1,)
    load_mass: int = 1
    mass_ratios: Sequence[float] = (1.0,)
    stiffness_ratios: Sequence[float] = (1.0,)
    damping_ratios: float | Sequence[float] = 0.0

    def __post_init__(self) -> None:
        masses = _ratios(self.mass_ratios, "mass_ratios")
        springs = _ratios(self.stiffness_ratios, "stiffness_ratios")
        n = len(masses)
        if len(springs) != n:
            raise InputError(
                f"stiffness_ratios must have as many values as mass_ratios ({n}); got {len(springs)}"
            )
        checks.choice(self.contact, "contact", CONTACTS)
        if self.contact == "between-masses" and n == 1:
            raise InputError(
                "contact must be fixed-wall or joined-base-wall for one mass; got 'between-masses'"
            )
        contact_masses = _contact_masses(self.contact_masses, self.contact, n)
        checks.whole(self.load_mass, "load_mass", least=1, most=n)
        if self.base_motion and self.load_mass != 1:
            raise InputError(
                f"load_mass must be 1 for joined-base-wall: the base loads mass 1 through the first "
                f"spring; got {self.load_mass}"
            )
        object.__setattr__(self, "contact_masses", contact_masses)
        object.__setattr__(self, "mass_ratios", masses)
        object.__setattr__(self, "stiffness_ratios", springs)
        object.__setattr__(self, "damping_ratios", _damping(self.damping_ratios, n))

    @property
    def n(self) -> int:
        """Number of masses."""
        return len(self.mass_ratios)

    @property
    def zeta(self) -> float:
        """Damping ratio of the mode of one mass."""
        return float(self.damping_ratios[0])  # type: ignore[index]

    @property
    def base_motion(self) -> int:
        """s: 1 if the contact moves with the base, else 0."""
        return int(self.contact == "joined-base-wall")

    @property
    def contact_vector(self) -> np.ndarray:
        """c, shape (n,): z = c.x - s cos(tau)."""
        c = np.zeros(self.n)
        c[self.contact_masses[-1] - 1] = 1.0
        if self.contact == "between-masses":
            c[self.contact_masses[0] - 1] = -1.0
        return c

    @cached_property
    def modes(self) -> ModalModel:
        """Modes and participation factors; they do not depend on r."""
        springs = np.array(self.stiffness_ratios)
        stiffness = np.diag(springs) + np.diag(np.append(springs[1:], 0.0))
        stiffness -= np.diag(springs[1:], 1) + np.diag(springs[1:], -1)
        load = np.zeros(self.n, dtype=complex)
        load[self.load_mass - 1] = 1.0
        mass = np.diag(self.mass_ratios)
        w, phi = solve_modes(mass, stiffness)
        zeta = np.array(self.damping_ratios)
        return ModalModel(
            w=w,
            phi=phi,
            zeta=zeta,
            contact=self.contact_vector,
            load=load,
            base_motion=self.base_motion,
            mass=mass,
            stiffness=stiffness,
            damping=modal_damping(mass, w, phi, zeta),
        )

    def contact_load(self, r: np.ndarray) -> np.ndarray:
        """Phasor F of the load in the contact when it is held, over P (complex, shape of r).

        One mass: 1 for a fixed wall; r^2 - 2 i zeta r for a joined base-wall, T(3.24) with damping.
        More: theory.md 4.
        """
        if self.n > 1:
            return self.modes.held_load(r)
        if self.base_motion:
            return r * (r - 2j * self.zeta)
        return np.ones_like(r, dtype=complex)

    def describe(self) -> str:
        """The system in words."""
        if self.n == 1:
            where = {
                "fixed-wall": "friction between the mass and a fixed wall, harmonic load on the mass",
                "joined-base-wall": "friction between the mass and a wall that moves with the base, "
                "harmonic base motion through the spring",
            }[self.contact]
            damping = f"damping ratio {self.zeta:g}" if self.zeta else "no viscous damping"
            return f"one mass; {where}; {damping}"
        a, b = self.contact_masses[0], self.contact_masses[-1]
        where = {
            "fixed-wall": f"friction between mass {b} and a fixed wall",
            "joined-base-wall": f"friction between mass {b} and a wall that moves with the base",
            "between-masses": f"friction between masses {a} and {b}",
        }[self.contact]
        load = "base motion" if self.base_motion else f"harmonic load on mass {self.load_mass}"
        masses = ", ".join(f"{value:g}" for value in self.mass_ratios)
        springs = ", ".join(f"{value:g}" for value in self.stiffness_ratios)
        ratios = ", ".join(f"{value:g}" for value in dict.fromkeys(self.damping_ratios))  # type: ignore[arg-type]
        damping = "no viscous damping" if ratios == "0" else f"modal damping ratios {ratios}"
        return f"chain of {self.n} masses ({masses}), springs ({springs}); {where}; {load}; {damping}"
