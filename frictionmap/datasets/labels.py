"""Names, units and descriptions of all variables of a dataset (CF conventions).

They are stored in files: new ones may be added, existing ones must not change.
"""

import re
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .. import checks, regimes

if TYPE_CHECKING:
    import xarray as xr

REFERENCES = (
    "Dynamic analysis of mechanical systems with Coulomb friction, doctoral thesis, University of "
    "Oxford, 2021; J. P. Den Hartog, Forced vibrations with combined Coulomb and viscous friction, "
    "Trans. ASME 53 (1931) 107-115"
)


#: In stores: 1 for every block of rows that is computed.
MARKS = "block_done"

#: Dimensions of variables of every cell, of boundaries, and of motions on a boundary.
CELL = ("mu", "r", "beta")
CURVE = ("mu", "r")
LIMIT = (*CURVE, "dof")

#: Boundaries of the regimes over r, which every map has.
BOUNDARIES = ("beta_lim", "beta_stick")


#: Kinds of borders between numbers of stops, see `stop_counts.orbits`.
BORDER_KINDS = ("graze", "slip-in-stop", "turn/stop", "graze-of-slide-end", "fold", "doubling")
_BORDER_POINT = ("border", "point")
_OF_ORBIT = "mu > 1: of the periodic motion that ends at the border; NaN on the side where it does not exist"


class Label(NamedTuple):
    """One variable: type, dimensions, description, and valid values."""

    dtype: type
    long_name: str
    dims: tuple[str, ...]  # in this order; a dimension that a file lacks is a scalar coordinate
    codes: tuple[regimes.Code, ...] = ()
    comment: str = ""
    flags: str = "flag_values"
    least: float = -np.inf
    most: float = np.inf
    nan: bool = False  # whether NaN is valid
    inf: bool = False
    unresolved: float = np.nan  # value of a cell of a map before it is decided
    needs: str = ""  # what it requires beyond the steady state of a cell: "details", "cycle" or "coexistence"
    units: str = "1"
    texts: tuple[str, ...] = ()  # valid values of an axis of texts, in order
    also: tuple[regimes.Code, ...] = ()  # further codes of general systems only


#: Axes; strictly increasing and finite.
COORDINATES = {
    "mu": Label(np.float64, "ratio of static to kinetic friction force", ("mu",), least=1.0),
    "r": Label(
        np.float64,
        "ratio of excitation frequency to first natural frequency",
        ("r",),
        least=0.0,
        most=checks.LARGEST_RATIO,
    ),
    "beta": Label(np.float64, "ratio of kinetic friction force to load amplitude", ("beta",), least=0.0),
    # at most: far above the longest steady state, of 256 periods
    "tau": Label(np.float64, "excitation phase, omega t", ("tau",), least=0.0, most=1e6),
    "dof": Label(np.int64, "mass, counted from 1", ("dof",), least=1),
    "harmonic": Label(
        np.int64, "harmonic of the excitation frequency; 0 is the mean", ("harmonic",), least=0
    ),
    "spring": Label(np.int64, "piecewise linear spring, counted from 1", ("spring",), least=1),
    "segment": Label(np.int64, "segment of the friction over the speed", ("segment",), least=1),
    "part": Label(np.str_, "part of a complex number", ("part",), texts=("real", "imaginary")),
    "outcome": Label(
        np.str_, "regime", ("outcome",), texts=tuple(code.name for code in regimes.BELT_REGIMES)
    ),
    "quantile": Label(np.float64, "share of the samples below", ("quantile",), least=0.0, most=1.0),
}

_PER_CYCLE = "per excitation cycle, over P^2/k1"


def _cell_label(long_name: str, comment: str = "", *further: str, least: float = -np.inf) -> Label:
    """Label of a number, or several, for every cell; infinite at an undamped resonance."""
    return Label(
        np.float64,
        long_name,
        (*CELL, *further),
        comment=comment,
        least=least,
        nan=True,
        inf=True,
        needs="cycle",
    )


def _phase_label(long_name: str, comment: str, *further: str, most: float = np.pi) -> Label:
    """Label of a phase, or several, for every cell."""
    return Label(
        np.float64, long_name, (*CELL, *further), comment=comment, least=-np.pi, most=most, nan=True,
        needs="cycle", units="radian",
    )  # fmt: skip


CELL_VARIABLES = {
    "regime": Label(
        np.int8,
        "motion regime of the steady state",
        CELL,
        regimes.REGIMES,
        unresolved=regimes.UNRESOLVED,
        also=regimes.BELT_REGIMES[len(regimes.REGIMES) :],
    ),
    "stops_per_cycle": Label(
        np.float32,
        "stops that begin per excitation period",
        CELL,
        comment="a stop has a positive duration; 0 where continuous, NaN where stuck or unresolved",
        least=0.0,
        nan=True,
    ),
    "contact_amplitude": Label(
        np.float64,
        "amplitude of the motion in the contact, over P/k1 (Y)",
        CELL,
        comment="0 where stuck, infinite at an undamped resonance",
        least=0.0,
        nan=True,
        inf=True,
    ),
    "stuck_fraction": Label(
        np.float32, "share of the steady period spent sticking", CELL, least=0.0, most=1.0, nan=True
    ),
    "period": Label(
        np.int16,
        "length of the steady state in excitation periods",
        CELL,
        comment="up to 256; 0 where the motion is irregular or unresolved",
        least=0,
        unresolved=0,
    ),
    "origin": Label(
        np.int8, "how the cell was decided", CELL, regimes.ORIGINS, unresolved=regimes.CLOSED_FORM
    ),
    "cycles": Label(np.int32, "excitation periods integrated for the cell", CELL, least=0, unresolved=0),
    "status": Label(
        np.int8,
        "whether the steady state was found, and if not, why",
        CELL,
        regimes.STATUSES,
        unresolved=regimes.NOT_COMPUTED,
    ),
    "multiplier": Label(
        np.float64,
        "largest modulus of the Floquet multipliers over the steady period",
        CELL,
        comment="below 1: a disturbance dies out; NaN where stuck or none was computed",
        least=0.0,
        nan=True,
        inf=True,
        needs="details",
    ),
    "asymmetry": Label(
        np.float32,
        "largest modulus of z(tau + pi) + z(tau), over contact_amplitude",
        CELL,
        comment="0 where the motion is antiperiodic; NaN where stuck or unresolved",
        least=0.0,
        nan=True,
        needs="details",
    ),
    "stops_per_cycle_error": Label(
        np.float32,
        "standard error of stops_per_cycle",
        CELL,
        comment="of an irregular motion, from the cycles followed; 0 of a steady state, NaN where stuck or "
        "unresolved",
        least=0.0,
        nan=True,
        inf=True,
    ),
    "stuck_fraction_error": Label(
        np.float32,
        "standard error of stuck_fraction",
        CELL,
        comment="of an irregular motion, from the cycles followed; 0 of a steady state, NaN where unresolved",
        least=0.0,
        nan=True,
        inf=True,
    ),
    "lyapunov_exponent": Label(
        np.float64,
        "largest Lyapunov exponent of the motion, per excitation period",
        CELL,
        comment="above 0: chaotic; of a steady state log(multiplier)/period, of an irregular motion the mean "
        "over the cycles followed; NaN where stuck or unresolved",
        nan=True,
        inf=True,
        needs="exponent",
    ),
    "lyapunov_exponent_error": Label(
        np.float64,
        "standard error of lyapunov_exponent",
        CELL,
        comment="0 of a steady state",
        least=0.0,
        nan=True,
        inf=True,
        needs="exponent",
    ),
    "also_reachable": Label(
        np.int8,
        "every regime that was found stable in the cell",
        CELL,
        regimes.REACHABLE,
        flags="flag_masks",
        unresolved=0,
        needs="coexistence",
        also=regimes.REACHABLE_ON_BELTS[len(regimes.REACHABLE) :],
    ),
    "sliding_limit": Label(
        np.float64,
        "largest friction ratio for which a sliding steady state was found",
        CURVE,
        comment="followed along the branch; beta_stick where mu = 1",
        least=0.0,
        nan=True,
        inf=True,
        needs="coexistence",
    ),
    "amplitude": Label(
        np.float64,
        "amplitude of the displacement of each mass, over P/k1 (Y)",
        (*CELL, "dof"),
        comment="largest modulus over the steady state, where the contact sticks measured from the static "
        "offset; infinite at a resonance, NaN where unresolved",
        least=0.0,
        nan=True,
        inf=True,
        needs="details",
    ),
    "sliding_distance": _cell_label(
        "distance that the contact slides", "per excitation cycle, over P/k1 (Y); 0 where stuck", least=0.0
    ),
    "work_friction": _cell_label("work dissipated by friction", _PER_CYCLE, least=0.0),
    "work_input": _cell_label(
        "work of the load, or of what moves the base", f"{_PER_CYCLE}; a joined wall is moved with the base"
    ),
    "work_damping": _cell_label("work dissipated by viscous damping", _PER_CYCLE, least=0.0),
    "equivalent_damping": _cell_label(
        "equivalent viscous damping of the contact, c omega/k1",
        "work of friction over pi times the contact amplitude squared; NaN where stuck",
    ),
    "contact_first_harmonic_amplitude": _cell_label(
        "amplitude of the first harmonic of the motion in the contact, over P/k1 (Y)", least=0.0
    ),
    "contact_first_harmonic_phase": _phase_label(
        "lag of the first harmonic of the motion in the contact behind the load", "NaN where stuck"
    ),
}


def _range_label(long_name: str, *further: str, comment: str = "", least: float = -np.inf) -> Label:
    """Label of a length for every cell, and for every contact or mass of a general system."""
    return Label(np.float64, long_name, (*CELL, *further), comment=comment, least=least, nan=True, inf=True)


_UNIQUE = (
    regimes.Code(0, "not_proved", "another start may lead to another steady state"),
    regimes.Code(1, "proved", "every start leads to the same motion; contacts at rest may have other places"),
)

_RELEASE_ORDERS = (
    regimes.Code(regimes.UNRESOLVED, "unresolved", "no steady state found; see status"),
    regimes.Code(0, "same", "no event leads to another pattern if all overloaded contacts let go at once"),
    regimes.Code(
        1,
        "differs",
        "at some event, letting all overloaded contacts go at once leads to another pattern of sliding and "
        "stuck contacts than letting them go one by one, which is the rule (mu > 1); of an irregular motion, "
        "in the cycles that are averaged",
    ),
)

#: Variables of cells that general systems have.  Systems of several contacts have further a last dimension
#: `contact` in these, and in those of `PER_CONTACT`.
GENERAL_VARIABLES = {
    "contact_regime": CELL_VARIABLES["regime"]._replace(
        long_name="motion regime of each contact",
    ),
    "turns_per_cycle": Label(
        np.float32,
        "changes of the sliding direction without a stop, per excitation period",
        CELL,
        comment="NaN where stuck or unresolved",
        least=0.0,
        nan=True,
    ),
    "slips_per_cycle": Label(
        np.float32,
        "slips of an elastic contact that begin per excitation period",
        CELL,
        comment="NaN for a rigid contact and where unresolved",
        least=0.0,
        nan=True,
    ),
    "slip_reversals_per_cycle": Label(
        np.float32,
        "slips of an elastic contact against the direction of the one before, per excitation period",
        CELL,
        comment="unlike the slips, they do not grow with the contact stiffness",
        least=0.0,
        nan=True,
    ),
    "elastic_fraction": Label(
        np.float32,
        "share of the steady period in which an elastic contact does not slip",
        CELL,
        least=0.0,
        most=1.0,
        nan=True,
    ),
    "least_slip": Label(
        np.float64,
        "least sliding distance of a single slip of an elastic contact, over P/k1 (Y)",
        CELL,
        comment="over the steady period; the distance per excitation period where it slips throughout, 0 "
        "where it does not slip, NaN for a rigid contact and where unresolved",
        least=0.0,
        nan=True,
    ),
    "segment_crossings": Label(
        np.float32,
        "break points of the friction law that the sliding speed passes, per excitation period",
        CELL,
        comment="NaN where stuck or unresolved",
        least=0.0,
        nan=True,
    ),
    "equivalent_stiffness": _range_label(
        "equivalent stiffness of the contact over k1",
        comment="real part of the first harmonic of the friction force over that of the motion",
    ),
    "contact_peak_to_peak": _range_label("range of the motion in the contact, over P/k1 (Y)", least=0.0),
    "contact_midpoint": _range_label(
        "middle of the range of the motion in the contact, over P/k1 (Y)",
        comment="depends on the initial state where the contact stays stuck",
    ),
    "peak_to_peak": _range_label("range of the displacement of each mass, over P/k1 (Y)", "dof", least=0.0),
    "midpoint": _range_label("middle of the range of the displacement of each mass, over P/k1 (Y)", "dof"),
    "work_wall": _range_label("work of the moving wall", comment=_PER_CYCLE),
    "drift": _range_label(
        "amplitude of the drift of the storey below each mass, over P/k1 (Y)",
        "dof",
        comment="half the range of the displacement of a mass beside the one before it, of the first beside "
        "the base",
        least=0.0,
    ),
    "acceleration_amplitude": _range_label(
        "amplitude of the acceleration of each mass, over omega_1^2 P/k1 (Y)",
        "dof",
        comment="largest modulus; with a moving base the absolute acceleration",
        least=0.0,
    ),
    "base_force": _range_label(
        "largest modulus of the force on the base, and on walls beside it, over P",
        comment="sum of the loads less the inertia of the masses",
        least=0.0,
    ),
    "mean_velocity": _range_label(
        "mean velocity in the contact, of a structure that no spring holds at a place",
        comment="dz/dtau over P/k1 (Y): at one that is not 0 the structure drifts, and amplitudes are NaN",
    ),
    "segment_fraction": Label(
        np.float32,
        "share of the steady period in which a contact slides at the speeds of each segment of its friction",
        (*CELL, "segment"),
        comment="NaN where unresolved, and beyond the last segment",
        least=0.0,
        most=1.0,
        nan=True,
    ),
    "open_fraction": Label(
        np.float32,
        "share of the steady period for which the contact is open",
        CELL,
        comment="NaN for a contact whose normal force does not move, and where unresolved",
        least=0.0,
        most=1.0,
        nan=True,
    ),
    "separations_per_cycle": Label(
        np.float32,
        "separations of the contact that begin per excitation period",
        CELL,
        comment="NaN for a contact whose normal force does not move, and where unresolved",
        least=0.0,
        nan=True,
    ),
    "normal_force_min": _range_label("least normal force in the contact, over P", least=0.0),
    "normal_force_max": _range_label("largest normal force in the contact, over P", least=0.0),
    "spring_crossings": Label(
        np.float32,
        "knots of a piecewise linear spring that its displacement passes, per excitation period",
        (*CELL, "spring"),
        least=0.0,
        nan=True,
    ),
    "spring_force_max": _range_label(
        "largest modulus of the force of a piecewise linear spring, over P", "spring", least=0.0
    ),
    "unique": Label(
        np.int8,
        "whether it is proved that every start leads to this steady state: mu = 1, and damping outweighs "
        "the fall of the friction with the speed",
        CELL,
        _UNIQUE,
        unresolved=0,
    ),
    "release_order": Label(
        np.int8,
        "whether the pattern after some event of the steady state depends on the order in which contacts "
        "are released",
        CELL,
        _RELEASE_ORDERS,
        unresolved=regimes.UNRESOLVED,
    ),
}

#: Of these, the ones that are not of single contacts.
_OF_ALL_CONTACTS = (
    "peak_to_peak", "midpoint", "release_order", "drift", "acceleration_amplitude", "base_force", "unique",
    "spring_crossings", "spring_force_max",
)  # fmt: skip

#: Variables of all maps that have one value per contact where there are several.
PER_CONTACT = (
    "stops_per_cycle", "stuck_fraction", "contact_amplitude", "sliding_distance", "work_friction",
    "contact_first_harmonic_amplitude", "contact_first_harmonic_phase", "contact_harmonic",
    "friction_harmonic",
    "equivalent_damping",
    "beta_stick_contact", "stops_per_cycle_error", "stuck_fraction_error",
    *(name for name in GENERAL_VARIABLES if name not in _OF_ALL_CONTACTS),
)  # fmt: skip

#: Variables over time that have one row per contact where there are several.
CONTACT_TRACES = ("z", "friction", "direction", "y", "normal_force", "open")


def with_contact(dims: tuple[str, ...]) -> tuple[str, ...]:
    """Dimensions of a variable that has one value per contact: `contact` follows those of the cells."""
    cell = tuple(dim for dim in dims if dim in CELL)
    return (*cell, "contact", *dims[len(cell) :])


def regime_of_choice(ds: "xr.Dataset") -> str:
    """Name of the variable with the regimes: of the contact that was chosen, or of all together."""
    chosen = "contact_regime" in ds and "contact" not in ds["contact_regime"].dims
    return "contact_regime" if chosen else "regime"


_PLATEAU = "the load's phase, counted from its maximum; NaN where the maximum is not held over a stop"

#: Variables of every cell of response curves, in addition to outputs of a map.
CYCLE_VARIABLES = {
    "phase_lag": _phase_label(
        "lag of the maximum of the displacement of each mass behind that of the load",
        "where the largest modulus is at a minimum, half a period later; NaN where it is held over a stop "
        "(phase_begin, phase_end) and where the period is not 1",
        "dof",
    ),
    "phase_begin": _phase_label("start of the stop that holds a mass at its maximum", _PLATEAU, "dof"),
    "phase_end": _phase_label(
        "end of the stop that holds a mass at its maximum", _PLATEAU, "dof", most=np.inf
    ),
    "contact_phase": _phase_label(
        "lag of the maximum of the motion in the contact behind that of the load",
        "as `phase_lag`; NaN where it is held over a stop (contact_phase_begin, contact_phase_end)",
    ),
    "contact_phase_begin": _phase_label("start of the stop that holds the contact at its maximum", _PLATEAU),
    "contact_phase_end": _phase_label(
        "end of the stop that holds the contact at its maximum", _PLATEAU, most=np.inf
    ),
    "first_harmonic_amplitude": _cell_label(
        "amplitude of the first harmonic of the displacement of each mass, over P/k1 (Y)",
        "frequency-based transmissibility, thesis (4.4)",
        "dof",
        least=0.0,
    ),
    "first_harmonic_phase": _phase_label(
        "lag of the first harmonic of the displacement of each mass behind the load",
        "thesis (4.5), counted positive; NaN where there is no motion",
        "dof",
    ),
    "displacement_harmonic": _cell_label(
        "harmonics X of the displacement of each mass, over P/k1 (Y)",
        "x = X_0 + Re sum X_n exp(i n tau); subharmonics are left out",
        "dof",
        "harmonic",
        "part",
    ),
    "contact_harmonic": _cell_label(
        "harmonics of the motion in the contact, over P/k1 (Y)",
        "as displacement_harmonic",
        "harmonic",
        "part",
    ),
    "friction_harmonic": _cell_label(
        "harmonics of the friction force against the motion in the contact, over P",
        "as displacement_harmonic",
        "harmonic",
        "part",
    ),
    "transmitted_force": _cell_label(
        "largest modulus of the force transmitted to the ground, over P",
        "sum of the loads less the inertia",
        least=0.0,
    ),
    "transmitted_first_harmonic": _cell_label(
        "amplitude of the first harmonic of the force transmitted to the ground, over P",
        "sum of the loads less the inertia",
        least=0.0,
    ),
    "rms": _cell_label(
        "root mean square of the displacement of each mass, over P/k1 (Y)",
        "over the steady period, its mean included",
        "dof",
        least=0.0,
    ),
    "distortion": _cell_label(
        "distortion of the displacement of each mass",
        "root mean square of all but the mean and the first harmonic, over that of the first harmonic",
        "dof",
        least=0.0,
    ),
}

CURVES = {
    "beta_lim": Label(
        np.float64,
        "boundary between continuous and stick-slip motion",
        CURVE,
        comment="exact",
        least=0.0,
        inf=True,
    ),
    "beta_lim_modal": Label(
        np.float64,
        "lower bound of beta_lim by the sum of modal maxima",
        CURVE,
        comment="thesis (5.65) with (5.55); equal to beta_lim for one mass, NaN where C couples modes",
        nan=True,
        least=0.0,
        inf=True,
    ),
    "beta_stick": Label(np.float64, "boundary to permanent sticking", CURVE, least=0.0, inf=True),
    "beta_stick_contact": Label(
        np.float64,
        "friction ratio at or above which each contact can stay stuck",
        CURVE,
        comment="half the range of its force with all contacts held, over its static friction per beta",
        least=0.0,
        inf=True,
    ),
    "limiting_contact": Label(
        np.int64,
        "contact that stops first, at beta_lim",
        CURVE,
        comment="counted from 1; 0: motion without stops has no such limit",
        least=0,
    ),
    "limit_kind": Label(
        np.int8, "what ends the motion without stops at beta_lim", CURVE, codes=regimes.LIMIT_KINDS
    ),
    "beta_slope_lim": Label(
        np.float64,
        "friction ratio times slope of its fall over speed from which steady sliding on a belt is unstable",
        (),
        least=0.0,
        inf=True,
    ),
    "beta_slope_certificate": Label(
        np.float64,
        "friction ratio times steepest slope of its fall up to which the steady state is unique for mu = 1",
        (),
        least=0.0,
        inf=True,
    ),
    "wall_speed_lim": Label(
        np.float64,
        "wall speed over omega_1 P/k1 from which one-way sliding in the last segment of the law is a motion",
        (),
        least=0.0,
        inf=True,
    ),
    "beta_noslip": Label(
        np.float64, "friction ratio at or above which no elastic contact slips", ("r",), least=0.0, inf=True
    ),
    "self_locking": Label(
        np.int8,
        "whether a contact with a normal force that moves with the structure locks itself",
        ("mu",),
        (
            regimes.Code(0, "no", "a load can be too large to be held"),
            regimes.Code(1, "yes", "a constant force in the contact can hold any load"),
        ),
    ),
    "friction_lim": Label(
        np.float64,
        "friction coefficient from which steady sliding on a belt is unstable",
        (),
        comment="of a contact with a normal force that moves with the structure; phi, at any preload",
        least=0.0,
        inf=True,
    ),
    "friction_lim_kind": Label(
        np.int8, "what makes steady sliding unstable at friction_lim", (), regimes.SLIDING_LIMIT_KINDS
    ),
    "no_stop_begin": Label(
        np.float64,
        "start of each interval of the friction ratio without stops",
        (*CURVE, "interval"),
        comment="padded with NaN",
        least=0.0,
        nan=True,
    ),
    "no_stop_end": Label(
        np.float64,
        "end of each interval of the friction ratio without stops",
        (*CURVE, "interval"),
        comment="padded with NaN",
        least=0.0,
        nan=True,
        inf=True,
    ),
    "wall_velocity_lim": Label(
        np.float64,
        "wall velocity at or above which the contact slides one way, over omega P/k1",
        ("r",),
        least=0.0,
        inf=True,
    ),
    "V": Label(
        np.float64, "response function of the motion in the contact, real part", ("r",), nan=True, inf=True
    ),
    "V_imag": Label(
        np.float64,
        "response function of the motion in the contact, imaginary part",
        ("r",),
        nan=True,
        inf=True,
    ),
    "U": Label(np.float64, "first damping function", ("r",), nan=True, inf=True),
    "G": Label(np.float64, "second damping function", ("r",), nan=True, inf=True),
    "H": Label(np.float64, "damping term of the boundary, thesis section 7.2.5", ("r",), nan=True, inf=True),
    "S": Label(
        np.float64, "largest value of the sliding condition over half a period", ("r",), nan=True, inf=True
    ),
    "natural_frequency": Label(np.float64, "natural frequencies, in units of r", ("mode",), least=0.0),
    "peak_threshold": Label(
        np.float64,
        "least friction ratio for a finite resonant peak",
        ("mode",),
        comment="thesis (6.2), (6.26); with damping (7.62), approximate; NaN for modes that C couples",
        nan=True,
        least=0.0,
        inf=True,
    ),
    "held_frequency": Label(
        np.float64, "natural frequencies with the contact held, in units of r", ("held_mode",), least=0.0
    ),
    "held_response": Label(
        np.float64,
        "amplitude of the displacement of each mass with the contact held, over P/k1 (Y)",
        ("dof", "r"),
        comment="infinite where the held structure resonates",
        least=0.0,
        inf=True,
    ),
    "held_phase": Label(
        np.float64,
        "lag of each mass behind the load with the contact held",
        ("dof", "r"),
        comment="of the phasor whose modulus is held_response; NaN of a mass at rest, and at a resonance",
        least=-np.pi,
        most=np.pi,
        nan=True,
        units="radian",
    ),
    "limit_amplitude": Label(
        np.float64,
        "amplitude of the displacement of each mass at beta_lim, over P/k1 (Y)",
        LIMIT,
        comment="of the continuous motion; its limit at an undamped resonance",
        least=0.0,
        inf=True,
    ),
    "limit_phase": Label(
        np.float64,
        "lag of the largest displacement of each mass at beta_lim behind the load",
        LIMIT,
        comment="NaN of a mass at rest, or with infinite amplitude",
        least=-np.pi,
        most=np.pi,
        nan=True,
        units="radian",
    ),
    "limit_first_harmonic_amplitude": Label(
        np.float64,
        "amplitude of the first harmonic of each mass at beta_lim, over P/k1 (Y)",
        LIMIT,
        comment="frequency-based amplitude, thesis (4.4)",
        least=0.0,
        inf=True,
    ),
    "limit_first_harmonic_phase": Label(
        np.float64,
        "lag of the first harmonic of each mass at beta_lim behind the load",
        LIMIT,
        comment="frequency-based phase, thesis (4.5); NaN of a mass at rest, or with infinite amplitude",
        least=-np.pi,
        most=np.pi,
        nan=True,
        units="radian",
    ),
    "invariant_point": Label(
        np.float64,
        "frequency ratios where friction does not change the motion in the contact",
        ("invariant",),
        comment="zeros of U, thesis (6.9); with damping they are invariant for the phase only",
        least=0.0,
    ),
    "mass_invariant_point": Label(
        np.float64,
        "frequency ratios where friction does not change the monoharmonic amplitude of a mass",
        ("dof", "mass_invariant"),
        comment="zeros of U_k and thesis (6.10), undamped; padded with NaN where a mass has fewer",
        least=0.0,
        nan=True,
    ),
    "invariant_first_harmonic": Label(
        np.float64,
        "frequency ratios where friction does not change the first harmonic's amplitude of a mass",
        ("dof", "root"),
        comment="undamped; padded with NaN where a mass has fewer",
        least=0.0,
        nan=True,
    ),
    "contact_invariant_first_harmonic": Label(
        np.float64,
        "frequency ratios where friction does not change the first harmonic's amplitude in the contact",
        ("contact_root",),
        comment="undamped; those of the natural frequencies with the contact held leave its phase, too",
        least=0.0,
    ),
    "border_r": Label(
        np.float64,
        "frequency ratios of borders between numbers of stops",
        _BORDER_POINT,
        comment="increasing along a border; padded with NaN",
        least=0.0,
        nan=True,
    ),
    "border_beta": Label(
        np.float64,
        "friction ratios of borders between numbers of stops",
        _BORDER_POINT,
        comment="padded with NaN",
        least=0.0,
        nan=True,
    ),
    "border_kind": Label(np.str_, "kind of the border", ("border",), texts=BORDER_KINDS),
    "border_mu": Label(
        np.float64,
        "ratio of static to kinetic friction",
        ("border",),
        comment="mu = 1: the number of stops changes there; mu > 1: a periodic motion ends there, whether or "
        "not a motion from rest reaches it; the number of stops from one initial state also changes where "
        "that state leaves the basin of its motion",
        least=1.0,
    ),
    "stops_below": Label(
        np.float32, "stops per cycle below the border", ("border",), comment=_OF_ORBIT, least=0.0, nan=True
    ),
    "stops_above": Label(
        np.float32, "stops per cycle above the border", ("border",), comment=_OF_ORBIT, least=0.0, nan=True
    ),
    "beta_lim_high": Label(np.float64, "limit of beta_lim for r to infinity", ("mu",), least=0.0, inf=True),
    "beta_stick_high": Label(
        np.float64, "limit of beta_stick for r to infinity", ("mu",), least=0.0, inf=True
    ),
}

_SENSES = (
    regimes.Code(-1, "sliding_down", "the contact slides towards smaller z"),
    regimes.Code(0, "sticking", "the contact sticks"),
    regimes.Code(1, "sliding_up", "the contact slides towards larger z"),
)

_OPEN = (
    regimes.Code(0, "closed", "the contact is closed"),
    regimes.Code(1, "open", "the contact is open: it has no normal force"),
)

HISTORY_VARIABLES = {
    "x": Label(np.float64, "displacement of the masses, over P/k1 (Y)", ("dof", "tau")),
    "v": Label(np.float64, "velocity of the masses, dx/dtau, over P/k1 (Y)", ("dof", "tau")),
    "z": Label(np.float64, "motion in the contact, over P/k1 (Y)", ("tau",)),
    "friction": Label(np.float64, "friction force against the motion in the contact, over P", ("tau",)),
    "friction_on_mass": Label(np.float64, "sum of the friction forces on a mass, over P", ("dof", "tau")),
    "direction": Label(np.int8, "direction of the motion in the contact", ("tau",), _SENSES),
    "event_tau": Label(
        np.float64, "excitation phase at which a slide or a stop begins", ("event",), least=0.0
    ),
    "event_direction": Label(
        np.int8, "direction of the motion in the contact that begins", ("event",), _SENSES
    ),
    "event_z": Label(np.float64, "motion in the contact at the event, over P/k1 (Y)", ("event",)),
    "elongation": Label(
        np.float64,
        "elongation of the spring of each element of a bank at tau = 0, over P/k1 (Y)",
        ("element",),
        comment="elements of one contact in the order in which they slip",
    ),
    "load": Label(np.float64, "sum of the loads on the masses, over P", ("tau",)),
    "event_contact": Label(np.int64, "contact that the event is of, counted from 1", ("event",), least=1),
    "normal_force": Label(np.float64, "normal force in the contact, over P", ("tau",), least=0.0, nan=True),
    "open": Label(np.int8, "whether the contact is open", ("tau",), _OPEN),
    "spring_force": Label(np.float64, "force of a piecewise linear spring, over P", ("spring", "tau")),
    "event_open": Label(np.int8, "whether the contact is open after the event", ("event",), _OPEN),
    "y": Label(
        np.float64, "displacement of the slider of an elastic contact, over P/k1 (Y)", ("tau",), nan=True
    ),
}

#: Older names of variables, by kind of dataset.  Files of version 0.2.0 have only these; files of today have
#: both, with the same values.
OLDER_NAMES = {
    "curves": {"phase": "phase_lag"},
    "response": {"phase": "direction", "event_phase": "event_direction"},
}


def _older(what: str) -> dict[str, Label]:
    """Labels of the older names in a kind of dataset."""
    now = {**CYCLE_VARIABLES, **HISTORY_VARIABLES}
    return {
        old: now[new]._replace(long_name=f"older name of {new}: {now[new].long_name}")
        for old, new in OLDER_NAMES[what].items()
    }


def _quantiles(name: str) -> Label:
    """Label of the quantiles of a map's variable over the samples of a structure."""
    label = {**CELL_VARIABLES, **CURVES}[name]
    return Label(
        np.float64,
        f"quantiles over the samples of the {label.long_name}",
        ("quantile", *label.dims),
        comment="between neighbours of the ordered samples; NaN where no sample has one",
        least=label.least,
        nan=True,
        inf=True,
    )


#: Probabilities, computed from many samples of a structure.
SHARES = {
    "regime_share": Label(
        np.float64, "share of the samples with this regime", ("outcome", *CELL), least=0.0, most=1.0
    ),
    "beta_lim_quantile": _quantiles("beta_lim"),
    "beta_stick_quantile": _quantiles("beta_stick"),
    "contact_amplitude_quantile": _quantiles("contact_amplitude"),
}

#: Comment on a motion in time that is irregular.
EXCERPT = (
    "the motion is irregular: x, v, z, friction and events cover the last {shown} of the {followed} periods "
    "followed; the scalars are averages over the last two thirds of them"
)

#: Variables with a counterpart in SI units where the reference values are known, by measure.
MEASURES = {
    "length": (
        "contact_amplitude", "amplitude", "sliding_distance", "contact_first_harmonic_amplitude",
        "first_harmonic_amplitude", "displacement_harmonic", "contact_harmonic", "rms", "held_response",
        "limit_amplitude", "limit_first_harmonic_amplitude", "x", "z", "event_z", "contact_peak_to_peak",
        "contact_midpoint", "peak_to_peak", "midpoint", "least_slip",
        "drift", "elongation",
    ),
    "force": (
        "beta_lim", "beta_lim_modal", "beta_stick", "sliding_limit", "beta_lim_high", "beta_stick_high",
        "peak_threshold", "friction_harmonic", "transmitted_force", "transmitted_first_harmonic", "friction",
        "beta_stick_contact", "beta_noslip", "no_stop_begin", "no_stop_end", "border_beta",
        "base_force", "friction_on_mass",
        "normal_force_min", "normal_force_max", "spring_force_max", "normal_force", "spring_force",
    ),
    "work": ("work_friction", "work_input", "work_damping", "work_wall"),
    "frequency": (
        "border_r", "natural_frequency", "held_frequency", "invariant_point", "mass_invariant_point",
        "invariant_first_harmonic", "contact_invariant_first_harmonic",
    ),
    "velocity": ("v",),
    "acceleration": ("acceleration_amplitude",),
    "time": ("event_tau",),
}  # fmt: skip

#: Measure of each of these variables.
MEASURE_OF = {name: measure for measure, names in MEASURES.items() for name in names}

#: SI units as written in CF conventions, and the suffixes of variables in these units.
SI = {
    "length": ("m", "m"), "force": ("N", "N"), "work": ("J", "J"), "frequency": ("Hz", "Hz"),
    "velocity": ("m s-1", "m_s"),
    "acceleration": ("m s-2", "m_s2"), "time": ("s", "s"),
}  # fmt: skip

#: Global attributes with the reference values that convert ratios, by measure.
SCALES = {"frequency": "frequency_scale_Hz", "force": "force_scale_N", "length": "length_scale_m"}


def in_si(name: str, measure: str) -> str:
    """Name of a variable in its SI unit."""
    return f"{name}_{SI[measure][1]}"


def si_units(measure: str) -> str:
    """SI unit of a measure, as written in CF conventions."""
    return SI[measure][0]


def _si_label(label: Label, measure: str) -> Label:
    """Label of a variable in its SI unit."""
    name = re.sub(r", (over P.*|over omega_1.*|dx/dtau.*|in units of r)$", "", label.long_name)
    name = name.replace("frequency ratios", "frequencies").replace("excitation phase at", "time at")
    what = ", kinetic friction force" if measure == "force" and "over" not in label.long_name else ""
    return label._replace(long_name=f"{name}{what}", comment="", units=SI[measure][0], unresolved=np.nan)


_RATIOS = {
    **CELL_VARIABLES, **GENERAL_VARIABLES, **CYCLE_VARIABLES, **CURVES, **HISTORY_VARIABLES,
    **_older("response"),
    **SHARES,
}  # fmt: skip
IN_SI = {
    in_si(name, measure): _si_label(_RATIOS[name], measure)
    for measure, names in MEASURES.items()
    for name in names
}
LABELS = {**_RATIOS, **IN_SI}

#: Coordinates along an axis: the axis in its SI unit; the contacts and their names.
BESIDE = {
    "contact": Label(np.int64, "contact, counted from 1", ("contact",), least=1),
    "contact_name": Label(np.str_, "name of the contact", ("contact",)),
    "point_name": Label(np.str_, "name of the point", ("dof",)),
    "spring_name": Label(np.str_, "name of the spring", ("spring",)),
    "frequency": Label(np.float64, "excitation frequency", ("r",), least=0.0, units="Hz"),
    "friction_force": Label(np.float64, "kinetic friction force", ("beta",), least=0.0, units="N"),
    "friction_coefficient": Label(np.float64, "coefficient of kinetic friction", ("beta",), least=0.0),
    "time": Label(np.float64, "time since a maximum of the load", ("tau",), least=0.0, units="s"),
}


#: Names that no further axis may have.
NAMES = frozenset(
    (
        *LABELS,
        *COORDINATES,
        *BESIDE,
        MARKS,
        "row_block",
        *(dim for label in LABELS.values() for dim in label.dims),
    )
)


def labels_of(what: str) -> dict[str, Label]:
    """Labels for a kind of dataset, see `schema.kind`."""
    if what != "curves":
        return LABELS
    held = {
        name: LABELS[name]._replace(dims=("r", "dof"))
        for name in ("held_response", "held_phase", in_si("held_response", "length"))
    }
    return {**LABELS, **_older("curves"), **held}


def attributes(label: Label) -> dict[str, object]:
    """CF attributes of a variable."""
    return _attributes(label).copy()


@lru_cache(maxsize=256)
def _attributes(label: Label) -> dict[str, object]:
    result: dict[str, object] = {"long_name": label.long_name}
    if label.codes:
        codes: np.ndarray = np.array([code.value for code in label.codes], dtype=label.dtype)
        codes.setflags(write=False)  # all variables with this label share it
        result[label.flags] = codes
        result["flag_meanings"] = " ".join(code.name for code in label.codes)
        result["comment"] = "; ".join(f"{code.name}: {code.meaning}" for code in label.codes)
    else:
        result["units"] = label.units
        if label.comment:
            result["comment"] = label.comment
    return result
