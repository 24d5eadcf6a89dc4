"""Definition of a system: a structure, its damping, its load and its one contact."""

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field, replace
from functools import cached_property
from typing import Any, Literal, NamedTuple

import numpy as np

from .. import checks
from ..errors import InputError
from ..structures.accuracy import Accuracy
from ..structures.craig_bampton import Reduce, checked_reduce
from ..structures.dofs import Dofs
from ..structures.files import NAMES
from ..structures.modes import Modes
from ..structures.reduction import Reduction, reduce_structure
from ..structures.structure import Structure, read_structure
from .contact import CONTACTS, Contact, numbers
from .coupled_modes import CoupledModel, coupled_model
from .decoupling import Decoupling
from .general import (
    ACCELERATION,
    BASE_CONTROLS,
    DISPLACEMENT,
    ContactSystem,
    base_is_meant,
    check_contacts,
    contact_rows,
    contact_system,
    describe_contacts,
    describe_springs,
    format_orders,
    mass_key,
    uses_general,
)
from .given_modes import ModesArgument, damping_of, describe_modes, modes_of, on_modes
from .html import as_table
from .matrices import Matrices, full_matrices, reduced_matrices
from .modes import (
    ModalModel,
    align_with_contact,
    damped_modes,
    load_rate,
    modal_damping,
    solve_chain_modes,
    solve_modes,
)
from .periodic_load import PeriodicLoad
from .rigid_modes import FreeModel, check_free, free_model, sort_rigid, without_rigid
from .shown import Shown
from .spring_element import Spring, SpringElement, checked_springs

EXCITATIONS = ("force", "base")
DAMPING_REFERENCES = ("ground", "base")

#: Largest coupling of the modes by C, relative to their own damping, that is neglected: it can result from
#: the digits of a matrix in a file, and is far below the accuracy of any measured damping.
_MOST_COUPLING = 1e-9

_EPS = float(np.finfo(float).eps)


def _sequence(values: Any, name: str, what: str) -> Sequence:
    """Convert `values` to a list if it is a list, a tuple or an array."""
    if checks.is_array(values):
        given = checks.array(values, name)
        if given.ndim == 1:
            return list(given)
    elif isinstance(values, Sequence) and not isinstance(values, (str, bytes)):
        return list(values)
    raise InputError(name, f"must be a list of {what}; got {checks.one_line(values)}")


def _ratios(values: object, name: str) -> tuple[float, ...]:
    values = _sequence(values, name, "numbers")
    if len(values) == 0:
        raise InputError(name, "must have at least one value; got none")
    free = name == "stiffness_ratios" and not isinstance(values[0], bool) and values[0] == 0
    first = int(free)  # number of the ratio that is the unit of the others
    ratios = tuple(
        checks.number(value, f"{name}[{index}]", above=0.0)
        for index, value in enumerate(values[first:], first)
    )
    if ratios and ratios[0] != 1.0:
        other = ", or 0 for no spring to the ground" * (name == "stiffness_ratios" and not free)
        raise InputError(f"{name}[{first}]", f"must be 1, the unit of the others{other}; got {ratios[0]:g}")
    return (0.0,) * first + ratios


def _damping(values: object, n: int) -> tuple[float, ...]:
    bounds = {"least": 0.0, "most": checks.LARGEST_DAMPING}
    listed = isinstance(values, Sequence) and not isinstance(values, (str, bytes))
    if not listed and not (checks.is_array(values) and checks.array(values, "damping_ratios").ndim):
        return (checks.number(values, "damping_ratios", **bounds),) * n
    values = _sequence(values, "damping_ratios", "numbers")
    if len(values) != n:
        raise InputError("damping_ratios", f"must be one number, or one per mode ({n}); got {len(values)}")
    return tuple(
        checks.number(value, f"damping_ratios[{index}]", **bounds) for index, value in enumerate(values)
    )


def _complex(value: object, name: str) -> complex:
    """Convert `value` to a complex number with finite parts."""
    if isinstance(value, (complex, np.complexfloating)):
        return complex(checks.number(value.real, name), checks.number(value.imag, name))
    return complex(checks.number(value, name))


def _load(values: object, n: int) -> tuple[complex, ...]:
    values = _sequence(values, "load", "numbers")
    if len(values) != n:
        raise InputError("load", f"must have one number per mass ({n}); got {len(values)}")
    load = tuple(_complex(value, f"load[{index}]") for index, value in enumerate(values))
    if not any(load):
        raise InputError("load", "must have a value that is not zero; got none")
    return load


def _format_values(values: Sequence[complex]) -> str:
    """Format numbers, separated by commas; real ones without their imaginary part."""
    return ", ".join(f"{value.real if value.imag == 0.0 else value:g}" for value in values)


def _chain_matrix(values: np.ndarray) -> np.ndarray:
    """Matrix (n, n) of springs or dashpots of a chain: the first one ends at the ground."""
    matrix = np.diag(values) + np.diag(np.append(values[1:], 0.0))
    matrix -= np.diag(values[1:], 1) + np.diag(values[1:], -1)
    return matrix


#: Natural frequencies that a notebook shows.
_FREQUENCIES_SHOWN = 10


class _DampedModes(NamedTuple):
    """Frequencies, modes, damping ratios; C1 where it couples modes, or the decoupling that replaces it."""

    w: np.ndarray
    phi: np.ndarray
    zeta: np.ndarray
    coupled: np.ndarray | None = None
    left_out: Decoupling | None = None


@dataclass(frozen=True, repr=False)
class System(Shown):
    """A linear structure with dry-friction contacts under a periodic load.

    The structure is a chain of masses and springs, defined by ratios, or any linear structure, defined by M
    and K.  In a chain spring 1 connects mass 1 to the ground (or to the base), spring i connects mass i to
    mass i - 1.

    Parameters
    ----------
    contact : {"fixed-wall", "joined-base-wall", "between-masses"}
        Where friction acts: between a mass and the ground, between a mass and a wall that moves with the
        base, or between two masses.
    contact_masses : sequence of int or str
        The mass in contact, or the two masses, A < B, counted from 1.  Masses are degrees of freedom.  For
        matrices from a file with labels, a label NODE.DOF, such as "112.1", may replace a number.
    load_mass : int or str, optional
        The mass on which the harmonic load acts, counted from 1, or its label; default: the first.  With base
        excitation it is always the first.
    mass_ratios, stiffness_ratios : sequence of float, optional
        gamma_i = m_i/m_1 and kappa_i = k_i/k_1 [-] of a chain, > 0, the first one 1; default: one mass.  The
        first stiffness ratio may be 0: no spring holds the chain at a place, and k_2, with the ratio 1,
        takes the place of k_1.  A single mass without a spring has the unit k_1 = m_1 omega_1^2 with any
        omega_1, and r = omega/omega_1.
    damping_ratios : float or sequence of float, optional
        Damping ratio zeta [-] of all modes, or one value per mode in the order of the natural frequencies, 0
        to 100; values >= 1 are allowed.  Default 0.
    dampers : sequence of float, optional
        Instead of damping_ratios: dashpots d_i/sqrt(k_1 m_1) [-] of a chain, >= 0, each beside the spring of
        its number; the first one ends at the ground, or at the base (see damping_reference).
    matrices : path or mapping, optional
        Instead of the ratios: M and K and optionally C, shape (n, n), in consistent units.  Either the path
        of a file with all of them (.npz, .mat; .op4 and .pch of Nastran), or a mapping of arrays, dense or
        sparse, or of paths: Matrix Market or Abaqus (.mtx), Harwell-Boeing (.hb, .rb, .rsa, .rua).  An array
        `dofs` (n,) next to M and K gives the numbers of the degrees of freedom, instead of 1 to n.  The
        matrices are real and symmetric; M is positive definite, K positive semi-definite: its zero
        eigenvalues are rigid-body modes.  C replaces damping_ratios: it is positive semi-definite, and may
        couple the undamped modes, as single dashpots do.
    frequency_scale : float, optional
        With matrices: r = omega/frequency_scale, in the units of sqrt(K/M); default: the first natural
        frequency, before any reduction, of those above 0.  For a chain it is sqrt(k_1/m_1).
    stiffness_scale : float, optional
        With matrices or modes: displacements are in P/stiffness_scale, in the units of K; default: 1, for
        beams and plates m omega_1^2 with their mass.  For a chain it is k_1.
    modes : Modes, Beam, Plate or mapping, optional
        Instead of matrices: natural frequencies and shapes at named points, with contacts, loads and outputs
        at these.  contact_masses, load_mass and the masses of contacts are names of points.  A residual
        flexibility needs contacts that all have a stiffness.  The attribute of this name is the modal model
        of any system.
    excitation : {"force", "base"}, optional
        "base": the structure stands on a base that moves by Y cos(tau), and P = stiffness_scale Y (k_1 Y for
        a chain); all degrees of freedom of given matrices are then displacements in the direction of the base
        motion.  Default: "base" with a joined base-wall, which allows no other value, else "force".
    damping_reference : {"ground", "base"}
        Whether the damping acts on absolute velocities, or on velocities relative to the base; the latter
        requires base excitation.
    load : sequence of complex, optional
        Instead of load_mass: the phasors p_k [P] of loads Re(p_k e^{i tau}) on all n masses.
    reduce : mapping, optional
        With matrices: ``{"keep": [17, 112], "modes": 16}`` reduces them by the Craig-Bampton method to these
        degrees of freedom, those in all contacts and under all loads, and this many modes with all these
        held.  Contacts, loads and results keep the numbers of the file.  Within the requested range of r the
        errors of natural frequencies and compliances must not exceed "allow", by default 0.001; otherwise an
        InputError states how many modes suffice.  Boundaries of continuous motion may need more modes,
        because higher harmonics of friction excite modes above that range: the attribute `reduction_check` of
        datasets states what changes with all modes, or at least 100.  On a finer mesh these boundaries and
        the number of stops of a rigid contact change again; the guide on own structures shows why, and
        recommends a contact stiffness.
    rayleigh : sequence of float, optional
        With matrices, instead of damping_ratios and C: [a, b] of C = a M + b K, >= 0, in their units.
    decouple : float, optional
        With a C that couples the undamped modes: replace C by its diagonal in modal coordinates, if this
        changes linear responses, with the contact free or held, by no more than this relative error in the
        range of r.
    contacts : sequence of Contact or mapping, optional
        Instead of contact and contact_masses: 1 to 64 contacts, each with its own friction.
    contact_stiffness : float or sequence of float, optional
        Stiffness k_t over k_1 [-], > 0, of a spring in series with the contact; default: rigid.  Several are
        a bank of elements in parallel, as in `Contact`.
    wall_velocity : float
        Velocity of a fixed wall over omega P/k_1 [-], as of a belt.
    wall_speed : float
        Instead: a speed of the wall that is the same at all frequencies, over omega_1 P/k_1 [-].
    base_control : {"displacement", "acceleration"}
        What the moving base holds constant over frequency.  With "acceleration" its amplitude is Y/r^2, and
        P = k_1 Y belongs to r = 1: it is m_1 times the acceleration, for a chain.
    normal_load : mapping or sequence of mapping, optional
        Harmonics of the normal load, as in `Contact`.
    load_harmonics : mapping, sequence of mapping, or PeriodicLoad, optional
        Instead of load_mass: harmonics of the load [P] by their order n, as phasors on all n masses, or as
        {"n", "mass", "amplitude", "phase_deg"}; without "mass" those of the base motion.
    load_file : path, optional
        The same as a table with the header n, mass, amplitude, phase_deg.
    waveform : str or path, optional
        "square", "sawtooth", "triangle", or a CSV file of one period, acting on load_mass, with so many
        `harmonics`.
    load_offset : sequence of float, optional
        Constant forces [P] on all n masses; they move positions only.
    springs : sequence of Spring or mapping, optional
        1 to 8 piecewise linear springs: gaps, backlash, bilinear springs.

    Raises
    ------
    InputError
        A value is out of range or incompatible with another; a file cannot be read.

    Notes
    -----
    Dimensionless equations of motion: theory.md 1, in general 11; T(5.4), (5.8) for chains, T(2.12), (3.3)
    for one mass.  With base excitation the load is p = K ones, which is e_1 for a chain; with damping
    relative to the base i r C1 ones is added, so that p = 1 + 2 i zeta r for one mass.

    Examples
    --------
    Two equal masses on equal springs; the second one rubs on a wall.  Natural frequencies over sqrt(k_1/m_1):

    >>> import frictionmap as fm
    >>> chain = {"mass_ratios": [1, 1], "stiffness_ratios": [1, 1]}
    >>> frame = fm.System(contact_masses=[2], damping_ratios=0.01, **chain)
    >>> frame.modes.w.round(6)
    array([0.618034, 1.618034])
    """

    contact: Literal["fixed-wall", "joined-base-wall", "between-masses"] = "fixed-wall"
    contact_masses: Sequence[int | str] = (1,)
    load_mass: int | str | None = None
    mass_ratios: Sequence[float] | None = None
    stiffness_ratios: Sequence[float] | None = None
    damping_ratios: float | Sequence[float] | None = None
    _: KW_ONLY
    matrices: str | os.PathLike | Mapping[str, Any] | Structure | Matrices | Modes | None = None
    frequency_scale: float | None = field(default=None, compare=False)  # `_scale` holds the resulting value
    stiffness_scale: float = None  # type: ignore[assignment]  # filled: 1, or that of a beam or plate
    excitation: Literal["force", "base"] | None = None
    damping_reference: Literal["ground", "base"] = "ground"
    load: Sequence[complex] | None = None
    # not compared: the reduced matrices are
    reduce: Mapping[str, Any] | Reduce | None = field(default=None, compare=False)
    rayleigh: Sequence[float] | None = None
    decouple: float | None = None
    contacts: Sequence[Contact | Mapping[str, Any]] | None = None
    contact_stiffness: float | Sequence[float] | None = None
    wall_velocity: float = 0.0
    wall_speed: float = 0.0
    base_control: Literal["displacement", "acceleration"] = "displacement"
    normal_load: Any = None
    load_harmonics: Mapping[int, Any] | Sequence[Mapping[str, Any]] | PeriodicLoad | None = None
    load_file: str | os.PathLike | None = None
    waveform: str | os.PathLike | None = None
    harmonics: int | None = None
    load_offset: Sequence[float] | None = None
    dampers: Sequence[float] | None = None
    springs: Sequence[Spring | Mapping[str, Any]] | None = None
    modes: ModesArgument = field(default=ModesArgument(), compare=False, repr=False)
    _scale: float | None = field(default=None, init=False, repr=False)
    _contact_system: ContactSystem = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        previous = self.matrices.reduction if isinstance(self.matrices, Matrices) else None
        self._take_modes()
        if self.matrices is None:
            self._check_chain()
        else:
            self._check_matrices()
        if self.contact_stiffness is not None:
            self._set("contact_stiffness", numbers(self.contact_stiffness, "contact_stiffness", above=0.0))
        self._set("contacts", check_contacts(self))
        if self.springs is not None:
            self._set("springs", checked_springs(self.springs))
        self._check_contact()
        self._check_load()
        if isinstance(self.matrices, Structure) and self.reduce is None:
            self._set("matrices", full_matrices(self.matrices))
        self._set("_contact_system", contact_system(self))
        if isinstance(self.matrices, Structure):
            reduction = self._reduced(self.matrices, previous)
            self._set("matrices", reduced_matrices(reduction))
            self._set("_contact_system", self._contact_system.at(reduction.reduced.rows))
        if self.rigid_modes:  # known only now that the matrices are checked
            self._set("_contact_system", replace(self._contact_system, free=True))
        scale = self.frequency_scale
        if scale is None and self.reduction is not None:  # r does not depend on the reduction
            scale = self.reduction.first_frequency
        self._set("_scale", scale)
        if isinstance(self.matrices, Modes):
            modes, frequency = self.matrices, self._frequency_scale
            self._set("_contact_system", on_modes(self, modes, self._contact_system, frequency))
        self._check_damping()
        if self.reduce is not None and self.rigid_modes:
            raise InputError(
                "cannot use", "reduce", "with a free structure: it needs all degrees of freedom; omit it"
            )
        given = (self.matrices, self.dampers)
        if self.n > 1 or self.rigid_modes or any(one is not None for one in given):
            _ = self.modes  # errors that only the modes reveal are raised here
        if self.rigid_modes:
            check_free(self, self.modes)

    def _filled(self) -> Mapping[str, object]:
        one = (1.0,) if self.matrices is None and self.n == 1 else None
        return {
            "stiffness_scale": 1.0,
            "contact_masses": (1,), "load_mass": 1, "mass_ratios": one, "stiffness_ratios": one,
            "damping_ratios": None if self.dampers else (0.0,) * self._mode_count,
            "excitation": "base" if self.contact == "joined-base-wall" else "force",
        }  # fmt: skip

    def _set(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def _take_modes(self) -> None:
        """Take the argument `modes` as the structure; fill the default of stiffness_scale."""
        given, scale = self.__dict__.pop("given_modes"), 1.0
        if given is not None:
            modes, scale = modes_of(self, given)
            if modes is not None:
                modes, ratios = damping_of(modes, self.damping_ratios)
                self._set("matrices", modes)
                self._set("damping_ratios", ratios)
        if self.stiffness_scale is None:
            self._set("stiffness_scale", scale)

    def _check_chain(self) -> None:
        for name in ("reduce", "rayleigh", "decouple"):
            if getattr(self, name) is not None:
                raise InputError("cannot use", name, "without matrices: a chain needs no such key; omit it")
        for name, default in (("frequency_scale", None), ("stiffness_scale", 1.0)):
            given = getattr(self, name)
            if isinstance(given, bool) or given != default:  # True == 1.0
                raise InputError(
                    "cannot use",
                    name,
                    f"= {given!r} without matrices: its units are those of the first mass "
                    f"and spring; omit it",
                )
        masses = _ratios((1.0,) if self.mass_ratios is None else self.mass_ratios, "mass_ratios")
        springs = _ratios(
            (1.0,) if self.stiffness_ratios is None else self.stiffness_ratios, "stiffness_ratios"
        )
        if len(springs) != len(masses):
            raise InputError(
                "stiffness_ratios",
                f"must have as many values as mass_ratios ({len(masses)}); got {len(springs)}",
            )
        self._set("mass_ratios", masses)
        self._set("stiffness_ratios", springs)

    def _check_matrices(self) -> None:
        for name in ("mass_ratios", "stiffness_ratios", "dampers"):
            given = getattr(self, name)
            if given is not None:
                raise InputError(
                    "cannot use",
                    name,
                    f"= {checks.one_line(given)} with matrices: both define the structure; omit one",
                )
        given = self.matrices
        if isinstance(given, Modes):
            for name in ("reduce", "rayleigh", "decouple"):
                if getattr(self, name) is not None:
                    raise InputError("cannot use", name, "with modes: it is for matrices; omit one")
        elif isinstance(given, Matrices):
            if given.reduction is not None:
                self._set("matrices", given.reduction.structure)
                self._set("reduce", self.reduce or given.reduction.asked)
            elif self.reduce is not None:
                arrays = {name: given.arrays[name] for name in NAMES if name in given.arrays}
                self._set("matrices", Structure(arrays, given.dofs, given.source, 0))
        elif not isinstance(given, Structure):
            self._set("matrices", read_structure(given))
        if self.reduce is not None:
            self._set("reduce", checked_reduce(self.reduce, self.dofs))
        if self.frequency_scale is not None:
            self._set("frequency_scale", checks.number(self.frequency_scale, "frequency_scale", above=0.0))
        self._set("stiffness_scale", checks.number(self.stiffness_scale, "stiffness_scale", above=0.0))

    def _reduced(self, structure: Structure, previous: Reduction | None) -> Reduction:
        """Reduce the structure; a previous reduction that fits is used again."""
        assert isinstance(self.reduce, Reduce)
        used = (self.dofs.numbers[row] for row in self._contact_system.rows)
        kept = tuple(sorted({*used, *self.reduce.keep}))
        asked = self.reduce, kept, self._contact_system.independent, self.excitation == "base"
        if previous is not None and previous.like(*asked):
            return previous
        return reduce_structure(structure, *asked)

    def _check_rayleigh(self) -> None:
        if self.rayleigh is None:
            return
        values = _sequence(self.rayleigh, "rayleigh", "two numbers")
        if len(values) != 2:
            raise InputError("rayleigh", f"must be two numbers [a, b], C = a M + b K; got {list(values)}")
        if self.damping_ratios is not None:
            raise InputError(
                "cannot use", "damping_ratios", "with rayleigh: both define the damping; omit one"
            )
        pair = tuple(checks.number(one, f"rayleigh[{k}]", least=0.0) for k, one in enumerate(values))
        self._set("rayleigh", pair)

    def _check_dampers(self) -> None:
        if self.damping_ratios is not None:
            raise InputError(
                "cannot use", "damping_ratios", "with dampers: both define the damping; omit one"
            )
        values = _sequence(self.dampers, "dampers", "numbers")
        if len(values) != self.n:
            raise InputError("dampers", f"must have one number per spring ({self.n}); got {len(values)}")
        pairs = enumerate(values)
        self._set("dampers", tuple(checks.number(one, f"dampers[{k}]", least=0.0) for k, one in pairs))

    def _check_damping(self) -> None:
        if self.dampers is not None:
            self._check_dampers()
            return
        self._check_rayleigh()
        if self.decouple is not None:
            self._set("decouple", checks.number(self.decouple, "decouple", above=0.0, most=1.0))
        given = self.damping_ratios
        if isinstance(self.matrices, Matrices) and self.matrices.damping is not None:
            for name, ratios in (("damping_ratios", given), ("rayleigh", self.rayleigh)):
                if ratios is not None:
                    raise InputError("cannot use", name, "with matrices: C defines the damping; omit one")
        elif self.rayleigh is None:
            self._set("damping_ratios", _damping(0.0 if given is None else given, self._mode_count))

    def _check_contact(self) -> None:
        if self.contacts is not None:
            first = self.contacts[0]
            self._set("contact", first.kind)  # type: ignore[union-attr]
            self._set("contact_masses", first.masses)  # type: ignore[union-attr]
        checks.choice(self.contact, "contact", CONTACTS)
        if self.contact == "between-masses" and self.n == 1:
            raise InputError(
                "contact", "must be fixed-wall or joined-base-wall for one mass; got 'between-masses'"
            )
        masses = _sequence(self.contact_masses, "contact_masses", "whole numbers")
        self._set("contact_masses", contact_rows(masses, self.contact, self.dofs, mass_key(self, 1)))

    def _check_load(self) -> None:
        if self.excitation is None:
            self._set("excitation", "base" if self.base_motion or base_is_meant(self) else "force")
        checks.choice(self.excitation, "excitation", EXCITATIONS)
        checks.choice(self.damping_reference, "damping_reference", DAMPING_REFERENCES)
        checks.choice(self.base_control, "base_control", BASE_CONTROLS)
        if self.base_control != DISPLACEMENT and self.excitation != "base":
            raise InputError(
                "base_control", "must be displacement without base excitation; got 'acceleration'"
            )
        if self.base_motion and self.excitation != "base":
            raise InputError(
                "excitation",
                "must be base for a joined-base-wall, whose base loads the structure; "
                f"got {self.excitation!r}",
            )
        base = self.excitation == "base"
        if self.damping_reference == "base" and not base:
            raise InputError("damping_reference", "must be ground for a force-excited structure; got 'base'")
        if self.load is not None:
            for wrong, (other, why) in (
                (base, ("base excitation", "the base loads all masses")),
                (self.load_mass is not None, ("load_mass", "both define the load")),
            ):
                if wrong:
                    raise InputError("cannot use", "load", f"with {other}: {why}; omit one of them")
            self._set("load", _load(self.load, self.n))
            return
        first = self.dofs.numbers[0]
        mass = first if self.load_mass is None else self.load_mass
        self._set("load_mass", self.dofs.number(mass, "load_mass"))
        if base and self.load_mass != first:
            cause = "joined-base-wall" if self.base_motion else "base excitation"
            raise InputError(
                "load_mass",
                f"must be {first} for {cause}: the base loads the structure through its springs to "
                f"the ground; got {self.load_mass}; omit load_mass",
            )

    @property
    def by_modes(self) -> bool:
        """Whether the structure is given by modes."""
        return isinstance(self.matrices, Modes)

    @property
    def contact_system(self) -> ContactSystem:
        """All contacts and loads, whichever keys they are given by."""
        return self._contact_system

    @property
    def general(self) -> ContactSystem | None:
        """Data of the general engine; None for one rigid contact under one harmonic load."""
        by_modes = self._contact_system.points is not None
        return self._contact_system if uses_general(self) or self.rigid_modes or by_modes else None

    @property
    def spring_elements(self) -> tuple[SpringElement, ...]:
        """The piecewise linear springs over the present masses."""
        return self._contact_system.springs

    @property
    def rigid_modes(self) -> int:
        """Number of rigid-body modes, against which no spring acts: 0 unless the structure is free."""
        if isinstance(self.matrices, Matrices | Modes):
            return self.matrices.rigid_modes
        return int(self.matrices is None and self.stiffness_ratios[0] == 0.0)  # type: ignore[index]

    @property
    def varies(self) -> bool:
        """Whether the dimensionless system changes with r: a wall of constant speed, a shaker of constant
        acceleration.
        """
        groups = self._contact_system.groups
        return self.base_control != DISPLACEMENT or any(group.first.wall_speed for group in groups)

    def at_frequency(self, r: float) -> "System":
        """The system at one frequency ratio > 0, over the same P and k_1."""
        changed: dict[str, Any] = {"base_control": DISPLACEMENT}
        if self.contacts is not None:
            changed["contacts"] = tuple(one.at_frequency(r) for one in self.contacts)  # type: ignore[union-attr]
        elif self.wall_speed:
            changed |= {"wall_velocity": self.wall_speed / r, "wall_speed": 0.0}
        if self.base_control == ACCELERATION:
            changed |= dict.fromkeys(("load_file", "waveform", "harmonics"))
            base = self._contact_system.base
            changed["load_harmonics"] = {n: u / (r * r) for n, u in base.items()}
        return replace(self, **changed)

    @property
    def n(self) -> int:
        """Number of masses (degrees of freedom), or of points of a structure given by modes."""
        return self.dofs.n

    @property
    def _mode_count(self) -> int:
        """Number of modes."""
        return self.matrices.w.size if isinstance(self.matrices, Modes) else self.n

    @property
    def dofs(self) -> Dofs:
        """Numbers or labels of the masses: counted from 1, or as in the file, possibly with gaps."""
        if isinstance(self.matrices, (Structure, Matrices, Modes)):
            return self.matrices.dofs
        return Dofs.counted(len(self.mass_ratios))  # type: ignore[arg-type]

    @property
    def zeta(self) -> float:
        """Damping ratio of the first mode, the only mode of one mass."""
        return float(self.modes.zeta[0])

    @property
    def base_motion(self) -> int:
        """s: 1 if the wall of the contact moves with the base, else 0."""
        return int(self.contact == "joined-base-wall")

    @property
    def reduction(self) -> Reduction | None:
        """Reduction of a larger structure to this one, if any."""
        return self.matrices.reduction if isinstance(self.matrices, Matrices) else None

    @property
    def loads(self) -> tuple[complex, ...] | None:
        """`load` on the present masses: a reduced structure has fewer masses than its file."""
        if self.load is None or self.reduction is None:
            return self.load  # type: ignore[return-value]
        return tuple(self.load[row] for row in self.reduction.reduced.rows)

    def accuracy(self, r: np.ndarray) -> Accuracy | None:
        """Errors of the reduction in the range of r; None without reduction.

        Raises
        ------
        InputError
            An error exceeds the allowed one.
        """
        if self.reduction is None:
            return None
        low, high = (float(end) * self._frequency_scale for end in (r[0], r[-1]))
        return self.reduction.checked(low, high)

    def decoupling(self, r: np.ndarray) -> float | None:
        """Error of replacing C by its diagonal in the range of r; None if C is not replaced.

        Raises
        ------
        InputError
            The error exceeds the allowed one.
        """
        left_out = self._damped_modes.left_out
        return None if left_out is None else left_out.error(self.modes, r)

    def costs(self, r: np.ndarray, hertz: bool = False) -> dict[str, str]:
        """Describe the errors of reduction and decoupling in the range of r.

        hertz : whether frequencies of modes are in SI units

        Raises
        ------
        InputError
            An error exceeds the allowed one.
        """
        words = {}
        reduced, decoupled = self.accuracy(r), self.decoupling(r)
        where = f", for r = {r[0]:g} to {r[-1]:g}"
        if self.by_modes:
            words["modes"] = describe_modes(self, hertz)
        if reduced is not None:
            words["reduction"] = f"{reduced.describe()}{where}; {reduced.beyond()}"
        if decoupled is not None:
            words["decoupling"] = (
                f"C, replaced by its modal diagonal, changes linear responses by {decoupled:.1e}{where}"
            )
        return words

    @property
    def contact_rows(self) -> list[int]:
        """Rows of the masses in contact, counted from 0."""
        return self.dofs.rows(self.contact_masses)  # type: ignore[arg-type]

    @property
    def contact_vector(self) -> np.ndarray:
        """c, shape (n,): z = c.x - s cos(tau)."""
        c = np.zeros(self.n)
        rows = self.contact_rows
        c[rows[-1]] = 1.0
        if self.contact == "between-masses":
            c[rows[0]] = -1.0
        return c

    @property
    def normalised(self) -> bool:
        """Whether the system is one unit mass on a unit spring, as the formulas for one mass assume."""
        one = self.n == 1 == self._mode_count
        return one and self.modes.mass[0, 0] == 1.0 == self.modes.stiffness[0, 0]

    @property
    def omega_1(self) -> float:
        """Frequency omega at r = 1, in the units of sqrt(K/M) of the matrices; 1 for a chain."""
        return 1.0 if self.matrices is None else self._frequency_scale

    @cached_property
    def _frequency_scale(self) -> float:
        """Frequency omega at r = 1 of a structure given by matrices."""
        if self._scale is not None:
            return self._scale
        if isinstance(self.matrices, Modes):
            return float(self.matrices.frequencies[0])
        assert isinstance(self.matrices, Matrices)
        if self.rigid_modes == self.n:
            raise InputError(
                "frequency_scale",
                "must be given for K = 0, which gives no natural frequency as its unit; got none",
            )
        w, _ = self._solve(self.matrices.mass, self.matrices.stiffness)
        return float(w[self.rigid_modes])

    def _solve(self, mass: np.ndarray, stiffness: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Solve for frequencies and modes; refuse if the lowest frequency is below the rounding error of the
        highest.
        """
        if isinstance(self.matrices, Modes):
            return self.matrices.w / self._frequency_scale, mass.copy()  # the coordinates are the modes
        if self.matrices is None and self.n > 1:
            w, phi = solve_chain_modes(np.array(self.mass_ratios), np.array(self.stiffness_ratios))
        else:
            w, phi = solve_modes(mass, stiffness)
        rigid = self.rigid_modes
        if rigid:
            w[:rigid] = 0.0
        if rigid < self.n and not w[rigid] > math.sqrt(w.size * _EPS) * w[-1]:
            name = "mass_ratios and stiffness_ratios" if self.matrices is None else "matrices"
            raise InputError(
                f"cannot compute the natural frequencies: the highest, {w[-1]:.3g}, exceeds the lowest by "
                f"more than double precision resolves; change {name}"
            )
        return w, phi

    def _structure(self) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
        """Dimensionless M, K and, where it was given, C1; in modes of a structure given by them."""
        if isinstance(self.matrices, Modes):
            w = self.matrices.w / self._frequency_scale
            return np.eye(w.size), np.diag(w**2), None
        if isinstance(self.matrices, Matrices):
            mass, stiffness, damping = self.matrices.scaled(self._frequency_scale, self.stiffness_scale)
            if self.n == 1 and self._scale is None:
                mass = stiffness.copy()  # w = 1 by definition; scaling would give it with a rounding error
            return mass, stiffness, damping
        stiffness = _chain_matrix(np.array(self.stiffness_ratios))
        damping = None if self.dampers is None else _chain_matrix(np.array(self.dampers))
        return np.diag(np.array(self.mass_ratios)), stiffness, damping

    def _load_vector(self, stiffness: np.ndarray) -> np.ndarray:
        """Part of p that does not depend on r, complex (n,)."""
        if isinstance(self.matrices, Modes):
            none = np.zeros(self._mode_count, dtype=complex)
            return np.array(self._contact_system.forces.get(1, none))
        if self.load is not None:
            return np.array(self.loads)
        if self.excitation == "base" and self.matrices is not None:
            return stiffness.sum(axis=1).astype(complex)
        load = np.zeros(self.n, dtype=complex)  # only the first spring of a chain ends at the base
        if self.reduction is not None and self.load_mass not in self.dofs.numbers:  # other loads are given
            return np.array(self._contact_system.forces.get(1, load))
        load[self.dofs.row(self.load_mass)] = 1.0  # type: ignore[arg-type]
        return load

    def _rayleigh_ratios(self, w: np.ndarray) -> np.ndarray:
        """Damping ratios of C = a M + b K."""
        a, b = self.rayleigh  # type: ignore[misc]
        omega = w * self._frequency_scale
        elastic = omega > 0.0
        zeta = np.where(elastic, 0.5 * (a / np.where(elastic, omega, 1.0) + b * omega), 0.0)
        if zeta.max() > checks.LARGEST_DAMPING:
            raise InputError(
                "rayleigh", f"must make damping ratios <= {checks.LARGEST_DAMPING:g}; got {zeta.max():.3g}"
            )
        return zeta

    def _check_ratios(self, zeta: np.ndarray) -> None:
        worst = int(np.argmax(zeta))
        if zeta[worst] > checks.LARGEST_DAMPING:
            of_matrices = self.dampers is None
            raise InputError(
                "matrices" if of_matrices else "dampers",
                f"{': C ' if of_matrices else ''}must make damping ratios <= {checks.LARGEST_DAMPING:g}; got "
                f"{zeta[worst]:.3g} of mode {worst + 1}",
            )

    @cached_property
    def _damped_modes(self) -> _DampedModes:
        mass, stiffness, given = self._structure()
        w, phi = self._solve(mass, stiffness)
        if given is None:
            zeta = np.array(self.damping_ratios) if self.rayleigh is None else self._rayleigh_ratios(w)
            return _DampedModes(w, phi, zeta)
        if self.rigid_modes:
            if self.decouple is not None:
                raise InputError("cannot use", "decouple", "with a free structure: C is used whole; omit it")
            return _DampedModes(w, phi, np.zeros(self.n), coupled=given)
        zeta, phi, coupling = damped_modes(given, w, phi)
        self._check_ratios(zeta)
        if coupling <= _MOST_COUPLING:
            return _DampedModes(w, phi, zeta)
        if self.decouple is None:
            return _DampedModes(w, phi, zeta, coupled=given)
        return _DampedModes(w, phi, zeta, left_out=Decoupling(given, self.decouple))

    @cached_property
    def modal_model(self) -> ModalModel:
        """Modes and participation factors; they do not depend on r."""
        mass, stiffness, _ = self._structure()
        w, phi, zeta, coupled, _ = self._damped_modes
        parts: dict[str, Any] = {
            "contact": self._contact_system.groups[0].vector if self.by_modes else self.contact_vector,
            "load": self._load_vector(stiffness),
            "base_motion": self.base_motion,
            "mass": mass,
            "stiffness": stiffness,
        }
        to_base = self.damping_reference == "base"
        if self.rigid_modes:
            return self._free_model(mass, w, phi, zeta, coupled, parts)
        if coupled is not None:
            return coupled_model(w, phi, coupled, to_base, parts)
        phi = align_with_contact(w, zeta, phi, parts["contact"])
        damping = modal_damping(mass, w, phi, zeta)
        springs = np.array(self.stiffness_ratios) if self.matrices is None else None
        rate = load_rate(damping, to_base)
        return ModalModel(w, phi, zeta, load_rate=rate, damping=damping, springs=springs, **parts)

    def _free_model(
        self, mass: np.ndarray, w: np.ndarray, phi: np.ndarray, zeta: np.ndarray, given: np.ndarray | None,
        parts: dict[str, Any],
    ) -> FreeModel:  # fmt: skip
        """The model of a structure with rigid-body modes."""
        damping = modal_damping(mass, w, phi, zeta) if given is None else given
        if self.rayleigh is not None:  # C = a M + b K also damps rigid-body modes
            rates = self.rayleigh[0] / self._frequency_scale, self.rayleigh[1] * self._frequency_scale
            damping = rates[0] * mass + rates[1] * parts["stiffness"]
        rigid = phi[:, : self.rigid_modes]
        rigid = sort_rigid(rigid, self.contact_system.vectors, damping)
        parts["stiffness"] = without_rigid(mass, parts["stiffness"], rigid)
        turned = np.hstack((rigid, phi[:, self.rigid_modes :]))
        rate = load_rate(damping, self.damping_reference == "base")
        return free_model(w, turned, damping, rate, parts)

    def contact_load(self, r: np.ndarray) -> np.ndarray:
        """Phasor F of the load in the contact when it is held, over P (complex, shape of r).

        One mass: p(r) for a fixed wall; p(r) - (w^2 - r^2 + 2 i zeta w r)/phi^2 for a joined base-wall, which
        is r^2 - 2 i zeta r, T(3.24), (3.32) with damping, or r^2 if the damping acts relative to the base.
        More masses: theory.md 4.
        """
        r = np.asarray(r, dtype=float)
        flat = r.ravel()
        several = self.modes.w.size > 1
        found = self.modes.held_load(flat) if several else self.modes.relative_load(flat)[:, 0]
        return found.reshape(r.shape)

    def describe(self) -> str:
        """Describe the system in one line."""
        return self._description

    def describe_unloaded(self) -> str:
        """Describe the system in one line, without its load."""
        return self._describe_with("no load")

    @cached_property
    def _description(self) -> str:
        return self._describe_with(self._describe_load())

    def _describe_with(self, load: str) -> str:
        contacts = describe_contacts(self.contact_system, self.dofs)
        if self.springs is not None:
            contacts = f"{contacts}; {describe_springs(self.springs, self.dofs)}"  # type: ignore[arg-type]
        words = (contacts, load, self._describe_damping())
        if self.n == 1 and self.matrices is None:
            spring = " without a spring" * self.rigid_modes
            return f"one mass{spring}; {words[0]}, {words[1]}; {words[2]}"
        return "; ".join((self._describe_structure(), *words))

    def _repr_html_(self) -> str:
        frequencies = [f"{w:.5g}" for w in self.modes.w[:_FREQUENCIES_SHOWN]]
        more = ", ..." * (self.modes.w.size > _FREQUENCIES_SHOWN)
        rows = {
            "description": self.describe(),
            "natural frequencies (r)": f"{', '.join(frequencies)}{more}",
        }
        return as_table("System", rows)

    def _describe_structure(self) -> str:
        if isinstance(self.matrices, Modes):
            return self._describe_modes(self.matrices)
        if isinstance(self.matrices, Matrices):
            plural = "s" if self.n > 1 else ""
            source = f" from {self.matrices.source}" if self.matrices.source else ""
            if self.reduction is not None:
                of = f" of {self.matrices.source}" if self.matrices.source else ""
                number, modes = self.reduction.structure.n, self.reduction.asked.modes
                source = f" reduced from the {number}{of} with {modes} fixed-interface modes"
            first = " (the first natural frequency)" if self.frequency_scale is None else ""
            return (
                f"structure of {self.n} degree{plural} of freedom{source}, r = omega/"
                f"{self._frequency_scale:g}{first}, displacements in P/{self.stiffness_scale:g}"
            )
        masses = _format_values(self.mass_ratios)  # type: ignore[arg-type]
        springs = _format_values(self.stiffness_ratios)  # type: ignore[arg-type]
        return f"chain of {self.n} masses ({masses}), springs ({springs})"

    def _describe_modes(self, modes: Modes) -> str:
        """Describe a structure given by modes."""
        plural, many = "s" * (modes.w.size > 1), "s" * (self.n > 1)
        source = f" of the {modes.source}" if modes.source else ""
        points = self._contact_system.points
        residual = " and residual flexibility" * (points is not None and points.residual is not None)
        first = " (the first natural frequency)" if self.frequency_scale is None else ""
        return (
            f"{modes.w.size} mode{plural}{residual}{source} at {self.n} point{many}, r = omega/"
            f"{self._frequency_scale:g}{first}, displacements in P/{self.stiffness_scale:g}"
        )

    def _describe_load(self) -> str:
        one = self.n == 1 and not self.by_modes
        if self.contact_system.orders != (1,):
            return f"periodic load, harmonics {format_orders(self.contact_system.orders)}"
        if self.excitation == "base":
            through = "the spring" if one else "the springs"
            if self.damping_reference == "base":
                through += " and dashpot" if one else " and dashpots"
            elif not one or self.rigid_modes:
                return "base motion"
            return f"harmonic base motion through {through}"
        if self.load is not None:
            where = "the mass" if one else "the masses"
            return f"harmonic load ({_format_values(self.load)}) on {where}"
        return (
            "harmonic load on the mass"
            if one
            else f"harmonic load on {self.dofs.noun} {self.dofs.word(self.load_mass)}"  # type: ignore[arg-type]
        )

    def _describe_damping(self) -> str:
        if not self.modes.zeta.any():
            return "no viscous damping"
        if self._mode_count == 1:
            return f"damping ratio {self.zeta:g}"
        if self.rayleigh is not None:
            zeta, (a, b) = self.modes.zeta, self.rayleigh
            return f"modal damping ratios {zeta.min():g} to {zeta.max():g}, from C = {a:g} M + {b:g} K"
        source = "C" if self.dampers is None else f"dampers ({_format_values(self.dampers)})"
        if isinstance(self.modes, CoupledModel):
            zeta = self.modes.free.zeta
            return f"damping that couples modes, ratios {zeta.min():g} to {zeta.max():g}, from {source}"
        if self.damping_ratios is None:
            zeta = self.modes.zeta
            return f"modal damping ratios {zeta.min():g} to {zeta.max():g}, from {source}"
        return f"modal damping ratios {_format_values(tuple(dict.fromkeys(self.damping_ratios)))}"  # type: ignore[arg-type]
