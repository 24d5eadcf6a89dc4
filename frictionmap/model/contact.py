"""A friction contact of a system that has several, or one with a spring, a belt or a varying normal load."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, Literal

import numpy as np

from .. import checks
from ..errors import InputError
from .friction_law import friction_law, law_table
from .normal_contact import normal_force
from .periodic_load import scalar_harmonics
from .shown import Shown

CONTACTS = ("fixed-wall", "joined-base-wall", "between-masses")

#: Keys of a wall that moves: over the velocity of the load at its frequency, or at that of r = 1.
WALLS = ("wall_velocity", "wall_speed")

#: Contacts of a system at most, and elements of banks that are contacts of their own.
MOST_CONTACTS = 64

#: Elements of one bank at most.
MOST_ELEMENTS = 200

#: What the contacts of a bank are: its elements, or one contact.
BANKS = ("elements", "contact")


def without_wall(kind: str, name: str, given: object) -> InputError:
    """The error about a moving wall of a contact that has none."""
    return InputError(name, f"must be 0 for {kind}, which has no wall of its own; got {given}")


@dataclass(frozen=True, repr=False)
class Contact(Shown):
    """One friction contact.

    Parameters
    ----------
    kind : {"fixed-wall", "joined-base-wall", "between-masses"}
        Where friction acts: between a mass and the ground, between a mass and a wall that moves with the
        base, or between two masses.
    masses : int, str or sequence of them
        The mass in contact, or the two masses, A < B, counted from 1.
    ratio : float or sequence of float
        Its friction force is this multiple of the grid's beta [-], >= 0.  The elements of a bank share it
        equally; a list, > 0, has one value per element.
    force : float or sequence of float, optional
        Instead of `ratio`: its own friction ratio F/P [-], >= 0, which the grid does not change.
    mu : float, optional
        Its static-to-kinetic friction ratio [-], >= 1; default: that of the grid.
    name : str, optional
        Default: the kind and the masses, such as "between-masses 2-3".
    stiffness : float or sequence of float, optional
        Stiffness k_t/k_1 [-] of a spring in series with the slider, > 0 (Jenkins element); default: rigid.
        A list makes a bank of as many elements in parallel (Iwan model), 200 at most.
    bank : {"elements", "contact"}, optional
        Whether the elements of a bank are contacts, with results of their own, or the bank is one contact;
        default: "elements" of systems with up to 64 of them in all, else "contact".
    wall_velocity : float
        Velocity of the wall over omega P/k_1 [-]; "fixed-wall" only.
    wall_speed : float
        Instead: a speed of the wall that is the same at all frequencies, over omega_1 P/k_1 [-].
    normal_load : mapping or sequence, optional
        Harmonics of the normal load: friction beta nu(tau), nu = 1 + Re sum nu_n e^{i n tau} >= 0.  A mapping
        {n: phasor}, or a list of { n, amplitude, phase_deg }.
    normal_record : Record, optional
        For `history` only: friction beta nu(t), nu = 1 + its value >= 0.
    law : FrictionLaw or mapping, optional
        Friction over the sliding speed: { speed, factor, slope }, or { formula, kinetic, speed, viscous,
        error } with the formula "exponential", "gauss", "hyperbolic" or "lorentz"; speeds over
        omega_1 P/k_1.  Default: the same at all speeds.
    law_file : path, optional
        Instead: a CSV file with the columns speed, factor.
    normal : NormalForce or mapping, optional
        A normal force that moves with the structure, and lets the contact open: { mass, stiffness, friction,
        side, preload }, or `masses` or `vector` instead of `mass`; see `NormalForce`.  Its friction at
        preload is beta, or phi times the preload if that is given.

    Raises
    ------
    InputError
        A value has the wrong type or is out of range, or two exclude each other.

    Examples
    --------
    A damper with a spring of half the stiffness k_1 in series with its slider slips with little friction
    only:

    >>> import frictionmap as fm
    >>> damper = fm.Contact(masses=[2], stiffness=0.5)
    >>> frame = fm.System(contacts=[damper], mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.01)
    >>> fm.sweep(frame, r=[0.6], beta=[0.1, 5.0]).slips_per_cycle.values.ravel()
    array([2., 0.], dtype=float32)
    """

    kind: Literal["fixed-wall", "joined-base-wall", "between-masses"] = "fixed-wall"
    masses: int | str | Sequence[int | str] = (1,)
    ratio: float | Sequence[float] | None = None
    force: float | Sequence[float] | None = None
    mu: float | None = None
    name: str | None = None
    stiffness: float | Sequence[float] | None = None
    wall_velocity: float = 0.0
    normal_load: Any = None
    wall_speed: float = 0.0
    normal_record: Any = None
    law: Any = None
    law_file: Any = None
    normal: Any = None
    bank: Literal["elements", "contact"] | None = None
    nu: Mapping[int, complex] = field(init=False, repr=False, compare=False, default_factory=dict)

    def __post_init__(self) -> None:
        checks.choice(self.kind, "kind", CONTACTS)
        masses = self.masses
        if isinstance(masses, (int, str, np.integer)) and not isinstance(masses, bool):
            masses = (masses,)
        self._set("masses", tuple(masses) if isinstance(masses, (Sequence, np.ndarray)) else masses)
        if self.ratio is not None and self.force is not None:
            raise InputError("cannot use", "ratio", "with force: both define the friction force; omit one")
        for name, ends in (
            ("ratio", {"least": 0.0}), ("force", {"least": 0.0}), ("mu", {"least": 1.0}),
            ("stiffness", {"above": 0.0}),
        ):  # fmt: skip
            if getattr(self, name) is not None:
                self._set(name, numbers(getattr(self, name), name, **ends))
        if self.normal is not None:
            self._check_normal()
        if self.ratio is None and self.force is None and not self.has_preload:
            self._set("ratio", 1.0)
        self._check_bank()
        for name in WALLS:
            self._set(name, checks.number(getattr(self, name), name))
            if getattr(self, name) and self.kind != "fixed-wall":
                raise without_wall(self.kind, name, f"{getattr(self, name):g}")
        if self.wall_velocity and self.wall_speed:
            raise InputError(
                "cannot use", "wall_speed", "with wall_velocity: both are the motion of the wall; omit one"
            )
        if self.name is not None and not isinstance(self.name, str):
            raise InputError("name", f"must be text; got {checks.one_line(self.name)}")
        if self.stiffness is not None and self.mu not in (None, 1.0):
            raise InputError(
                "mu",
                "must be 1 for a contact with stiffness: its spring would jump at break-away; omit it, or "
                f"put a small mass between the spring and a rigid contact; got {self.mu:g}",
            )
        if self.law is not None or self.law_file is not None:
            self._check_law()
        if self.normal_record is not None:
            self._check_normal_record()
        if self.normal_load is not None:
            self._set("nu", scalar_harmonics(self.normal_load, "normal_load", "the mean normal load"))
            self._check_normal_load()

    def _set(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def _check_bank(self) -> None:
        """Refuse friction per element without as many elements, and keys of banks without one."""
        if isinstance(self.stiffness, tuple) and len(self.stiffness) > MOST_ELEMENTS:
            raise InputError(
                "stiffness", f"must have at most {MOST_ELEMENTS} elements; got {len(self.stiffness)}"
            )
        if self.bank is not None:
            checks.choice(self.bank, "bank", BANKS)
            if not isinstance(self.stiffness, tuple):
                raise InputError(
                    "cannot use", "bank", "without a list of stiffness: it is for banks; omit it"
                )
        for name in ("ratio", "force"):
            given = getattr(self, name)
            if not isinstance(given, tuple):
                continue
            if not isinstance(self.stiffness, tuple):
                raise InputError(
                    name,
                    f"must be one number unless stiffness is a list, with one value per element; "
                    f"got {list(given)}",
                )
            if len(given) != len(self.stiffness):
                raise InputError(
                    name, f"must have as many values as stiffness ({len(self.stiffness)}); got {len(given)}"
                )

    @property
    def has_preload(self) -> bool:
        """Whether its friction at preload is phi N0, and neither `ratio` nor `force`."""
        return self.normal is not None and self.normal.preload is not None

    def _check_normal(self) -> None:
        """Read the normal force, and refuse it where another key defines it."""
        self._set("normal", normal_force(self.normal))
        for name, why in (
            ("law", "friction over speed needs a constant normal force"),
            ("law_file", "friction over speed needs a constant normal force"),
            ("normal_load", "both define the normal force"),
            ("normal_record", "both define the normal force"),
        ):
            if getattr(self, name) is not None:
                raise InputError("cannot use", "normal", f"with {name}: {why}; omit one")
        for name in ("ratio", "force"):
            if self.has_preload and getattr(self, name) is not None:
                raise InputError(
                    "cannot use",
                    "normal.preload",
                    f"with {name}: both define the friction at preload, phi N0; omit one",
                )
        if isinstance(self.stiffness, tuple):
            raise InputError(
                "stiffness",
                f"must be one number with normal, as banks share a constant normal force; "
                f"got {list(self.stiffness)}",
            )

    def _check_law(self) -> None:
        """Read the law, and refuse it where it is another model; a flat law is none."""
        if self.law is not None and self.law_file is not None:
            raise InputError("cannot use", "law_file", "with law: both define the friction; omit one")
        law = friction_law(self.law) if self.law_file is None else law_table(self.law_file)
        self._set("law", None if law.is_flat else law)
        self._set("law_file", None)
        for name, why in (
            ("stiffness", "friction that falls with the speed of a slider behind a spring has no motion"),
            ("normal_load", "friction over speed needs a constant normal load"),
            ("normal_record", "friction over speed needs a constant normal load"),
        ):
            if self.law is not None and getattr(self, name) is not None:
                raise InputError("cannot use", "law", f"with {name}: {why}; omit one")

    def _check_normal_record(self) -> None:
        if type(self.normal_record).__name__ != "Record":
            got = checks.one_line(self.normal_record)
            raise InputError("normal_record", f"must be a frictionmap.Record; got {got}")
        if self.normal_load is not None:
            raise InputError("cannot use", "normal_record", "with normal_load: both define it; omit one")

    def _check_normal_load(self) -> None:
        least = least_value(self.nu)
        if least < -1.0:
            raise InputError(
                "normal_load",
                f"must leave 1 + normal_load(tau) >= 0, as contacts that separate are another "
                f"model; got {1.0 + least:.3g} at its least",
            )

    @property
    def belt(self) -> float:
        """Velocity of the wall in either unit; 0 if it is at rest."""
        return self.wall_velocity or self.wall_speed

    def at_frequency(self, r: float) -> "Contact":
        """The contact at one frequency ratio, with the wall's velocity over omega P/k_1."""
        return replace(self, wall_velocity=self.wall_speed / r, wall_speed=0.0) if self.wall_speed else self

    @property
    def label(self) -> str:
        """Its name, or its kind and masses."""
        return self.name or f"{self.kind} {'-'.join(map(str, self.masses))}"  # type: ignore[arg-type]

    def static_ratio(self, mu: Any) -> Any:
        """Ratio of static to kinetic friction: its own, or that of the grid; 1 with a spring."""
        if self.stiffness is not None:
            return 1.0
        return mu if self.mu is None else self.mu

    @property
    def elements(self) -> tuple["Contact", ...]:
        """The contacts of one spring that a bank consists of; the contact itself if it is none."""
        if not isinstance(self.stiffness, tuple):
            return (self,)
        count = len(self.stiffness)
        return tuple(
            replace(
                self, name=f"{self.label}, element {k + 1}", stiffness=self.stiffness[k], bank=None,
                ratio=_share(self.ratio, k, count), force=_share(self.force, k, count),
            )
            for k in range(count)
        )  # fmt: skip


def _share(friction: Any, k: int, count: int) -> float | None:
    """Friction of element k of a bank."""
    if friction is None:
        return None
    return friction[k] if isinstance(friction, tuple) else friction / count


def numbers(given: Any, name: str, **ends: float) -> float | tuple[float, ...]:
    """Check a number in a range, or a list of numbers > 0."""
    listed = isinstance(given, Sequence) and not isinstance(given, (str, bytes))
    if not listed and not (checks.is_array(given) and checks.array(given, name).ndim):
        return checks.number(given, name, **ends)
    if len(given) == 0:
        raise InputError(name, "must have at least one value; got none")
    return tuple(checks.number(one, f"{name}[{k}]", above=0.0) for k, one in enumerate(given))


def least_value(harmonics: Mapping[int, complex]) -> float:
    """Least value of Re sum a_n e^{i n tau}, to rounding."""
    if not harmonics:
        return 0.0
    orders = np.array(list(harmonics))
    phasors = np.array(list(harmonics.values()))
    tau = np.linspace(0.0, 2.0 * np.pi, 64 * int(orders.max()) + 1)[:, np.newaxis]
    for _ in range(40):
        terms = phasors * np.exp(1j * orders * tau)
        slope, bend = -(orders * terms.imag).sum(axis=1), -(orders**2 * terms.real).sum(axis=1)
        step = np.where(bend > 0.0, -slope / np.where(bend > 0.0, bend, 1.0), 0.0)
        tau = tau + np.clip(step, -0.02 / orders.max(), 0.02 / orders.max())[:, np.newaxis]
    return float((phasors * np.exp(1j * orders * tau)).real.sum(axis=1).min())


def _name_contact(k: int, error: InputError) -> InputError:
    """Return an error about a key of a contact, with the contact named."""
    name = f"contacts[{k}]"
    return error.renamed(f"{name}.{error.where}") if error.where else InputError(name, f": {error}")


def checked_contacts(given: object) -> tuple[Contact, ...]:
    """Check a list of contacts; a mapping is one as in a configuration."""
    if not isinstance(given, Sequence) or isinstance(given, (str, bytes)) or not given:
        raise InputError("contacts", f"must be a list of contacts; got {checks.one_line(given)}")
    if len(given) > MOST_CONTACTS:
        raise InputError("contacts", f"must be at most {MOST_CONTACTS}; got {len(given)}")
    valid = [one.name for one in fields(Contact) if one.init]
    found = []
    for k, one in enumerate(given, 1):
        if isinstance(one, Mapping):
            for key in one:
                if key not in valid:
                    raise InputError(
                        f"unknown key {f'contacts[{k}].{key}'!r}{checks.nearest(str(key), valid)}; "
                        f"valid: {', '.join(valid)}"
                    )
            try:
                one = Contact(**one)
            except InputError as error:
                raise _name_contact(k, error) from None
        if not isinstance(one, Contact):
            raise InputError(f"contacts[{k}]", f"must be a Contact; got {checks.one_line(one)}")
        found.append(one)
    return tuple(found)
