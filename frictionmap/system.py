"""What is simulated: masses, springs, damping, load and the one contact."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from . import checks
from .errors import InputError

CONTACTS = ("fixed-wall", "joined-base-wall", "between-masses")


def _ratios(values: object, name: str) -> tuple[float, ...]:
    if isinstance(values, (str, bytes)) or not isinstance(values, (Sequence, np.ndarray)):
        raise InputError(f"{name} must be a list of numbers; got {values!r}")
    if len(values) == 0:
        raise InputError(f"{name} must have at least one value; got none")
    ratios = tuple(checks.number(value, f"{name}[{index}]", above=0.0) for index, value in enumerate(values))
    if ratios[0] != 1.0:
        raise InputError(f"{name}[0] must be 1, the unit of the others; got {ratios[0]:g}")
    return ratios


@dataclass(frozen=True)
class System:
    """A mass on a spring with viscous damping and one dry-friction contact, shaken at one frequency.

    Parameters
    ----------
    contact : {"fixed-wall", "joined-base-wall"}
        Where the friction acts: between the mass and the ground while a load shakes the mass (or the
        base shakes it through the spring: the same problem), or between the mass and a wall that moves
        with the shaken base.
    contact_masses : sequence of int
        The mass in contact, counted from 1.
    load_mass : int
        The mass the harmonic load acts on, counted from 1.
    mass_ratios, stiffness_ratios : sequence of float
        gamma_i = m_i/m_1 and kappa_i = k_i/k_1 [-], > 0, the first one 1.
    damping_ratios : float or sequence of float
        Viscous damping ratio zeta [-], >= 0, relative to the ground; 1 and more is legal.

    Raises
    ------
    InputError
        A value is out of range, or the system has more than one mass.

    Notes
    -----
    Dimensionless equation of motion: theory's (2.12), (3.3), with z the motion in the contact,
    r^2 z'' + 2 zeta r z' + z + beta sgn(z') = Re(F exp(i tau)), F from `contact_load`.
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
        if len(springs) != len(masses):
            raise InputError(
                f"stiffness_ratios must have as many values as mass_ratios ({len(masses)}); "
                f"got {len(springs)}"
            )
        if len(masses) > 1:
            raise InputError(
                f"mass_ratios must have one value: this version covers one mass; got {len(masses)}"
            )
        checks.choice(self.contact, "contact", CONTACTS)
        if self.contact == "between-masses":
            raise InputError(
                "contact must be fixed-wall or joined-base-wall for one mass; got 'between-masses'"
            )
        contact_masses = self.contact_masses
        if isinstance(contact_masses, (str, bytes)) or not isinstance(contact_masses, (Sequence, np.ndarray)):
            raise InputError(f"contact_masses must be a list; got {contact_masses!r}")
        if len(contact_masses) != 1:
            raise InputError(
                f"contact_masses must name one mass for {self.contact}; got {list(contact_masses)}"
            )
        joint = checks.whole(contact_masses[0], "contact_masses[0]", least=1, most=len(masses))
        checks.whole(self.load_mass, "load_mass", least=1, most=len(masses))
        damping = self.damping_ratios
        if isinstance(damping, (Sequence, np.ndarray)) and not isinstance(damping, (str, bytes)):
            if len(damping) != len(masses):
                raise InputError(
                    f"damping_ratios must be one number or one a mode ({len(masses)}); got {len(damping)}"
                )
            zeta = checks.number(damping[0], "damping_ratios[0]", least=0.0, most=checks.LARGEST_DAMPING)
        else:
            zeta = checks.number(damping, "damping_ratios", least=0.0, most=checks.LARGEST_DAMPING)
        object.__setattr__(self, "contact_masses", (joint,))
        object.__setattr__(self, "mass_ratios", masses)
        object.__setattr__(self, "stiffness_ratios", springs)
        object.__setattr__(self, "damping_ratios", zeta)

    @property
    def zeta(self) -> float:
        """Damping ratio of the mode."""
        return float(self.damping_ratios)  # type: ignore[arg-type]

    @property
    def base_motion(self) -> int:
        """s: 1 if the contact moves with the base, else 0."""
        return int(self.contact == "joined-base-wall")

    def contact_load(self, r: np.ndarray) -> np.ndarray:
        """Phasor F of the load in the contact when it is held, over P (complex, shape of r).

        1 for a fixed wall; r^2 - 2 i zeta r for a joined base-wall, T(3.24) with damping.
        """
        if self.base_motion:
            return r * (r - 2j * self.zeta)
        return np.ones_like(r, dtype=complex)

    def describe(self) -> str:
        """The system in words."""
        where = {
            "fixed-wall": "friction between the mass and a fixed wall, harmonic load on the mass",
            "joined-base-wall": "friction between the mass and a wall that moves with the base, "
            "harmonic base motion through the spring",
        }[self.contact]
        damping = f"damping ratio {self.zeta:g}" if self.zeta else "no viscous damping"
        return f"one mass; {where}; {damping}"
