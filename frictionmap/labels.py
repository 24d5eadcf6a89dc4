"""Names, units and meanings of everything that is put into a dataset (CF conventions)."""

from typing import NamedTuple

import numpy as np
import xarray as xr

from . import regimes
from .system import System
from .version import __version__

REFERENCES = (
    "Dynamic analysis of mechanical systems with Coulomb friction, doctoral thesis, University of "
    "Oxford, 2021; J. P. Den Hartog, Forced vibrations with combined Coulomb and viscous friction, "
    "Trans. ASME 53 (1931) 107-115"
)


class Label(NamedTuple):
    """Type and description of one variable."""

    dtype: type
    long_name: str
    codes: tuple[regimes.Code, ...] = ()
    comment: str = ""
    flags: str = "flag_values"


COORDINATES = {
    "mu": "ratio of static to kinetic friction force",
    "r": "ratio of excitation frequency to first natural frequency",
    "beta": "ratio of kinetic friction force to load amplitude",
    "tau": "excitation phase, omega t",
    "dof": "mass, counted from 1",
}

CELL_VARIABLES = {
    "regime": Label(np.int8, "motion regime of the steady state", regimes.REGIMES),
    "stops_per_cycle": Label(
        np.float32,
        "stops that begin per excitation period",
        comment="a stop has a positive duration; 0 where continuous, NaN where stuck or unresolved",
    ),
    "contact_amplitude": Label(
        np.float64,
        "amplitude of the motion in the contact, over P/k1 (Y)",
        comment="0 where stuck, infinite at an undamped resonance",
    ),
    "stuck_fraction": Label(np.float32, "share of the steady period spent sticking"),
    "period": Label(
        np.int16,
        "length of the steady state in excitation periods",
        comment="0 where no steady state was found",
    ),
    "origin": Label(np.int8, "how the cell was decided", regimes.ORIGINS),
    "cycles": Label(np.int32, "excitation periods integrated for the cell"),
    "status": Label(np.int8, "whether the steady state was found, and if not, why", regimes.STATUSES),
    "multiplier": Label(
        np.float64,
        "largest modulus of the Floquet multipliers over the steady period",
        comment="below 1: a disturbance dies out; NaN where stuck or none was computed",
    ),
    "asymmetry": Label(
        np.float32,
        "largest modulus of z(tau + pi) + z(tau), over contact_amplitude",
        comment="0 where the motion is antiperiodic; NaN where stuck or unresolved",
    ),
    "also_reachable": Label(
        np.int8, "every regime that was found stable in the cell", regimes.REACHABLE, flags="flag_masks"
    ),
    "sliding_limit": Label(
        np.float64,
        "largest friction ratio for which a sliding steady state was found",
        comment="followed along the branch; beta_stick where mu = 1",
    ),
    "amplitude": Label(
        np.float64,
        "amplitude of the displacement of each mass, over P/k1 (Y)",
        comment="largest modulus over the steady state; infinite at a resonance, NaN where unresolved",
    ),
}

CURVES = {
    "beta_lim": Label(np.float64, "boundary between continuous and stick-slip motion", comment="exact"),
    "beta_lim_modal": Label(
        np.float64,
        "lower bound of beta_lim by the sum of modal maxima",
        comment="thesis (5.65) with (5.55); equal to beta_lim for one mass",
    ),
    "beta_stick": Label(np.float64, "boundary to permanent sticking"),
    "V": Label(np.float64, "response function of the motion in the contact, real part"),
    "V_imag": Label(np.float64, "response function of the motion in the contact, imaginary part"),
    "U": Label(np.float64, "first damping function"),
    "G": Label(np.float64, "second damping function"),
    "H": Label(np.float64, "damping term of the boundary, thesis section 7.2.5"),
    "natural_frequency": Label(np.float64, "natural frequencies, in units of r"),
    "peak_threshold": Label(
        np.float64,
        "least friction ratio for a finite resonant peak",
        comment="thesis (6.2), (6.26); with damping (7.62), approximate",
    ),
    "held_frequency": Label(np.float64, "natural frequencies with the contact held, in units of r"),
    "held_response": Label(
        np.float64,
        "amplitude of the displacement of each mass with the contact held, over P/k1 (Y)",
        comment="infinite where the held structure resonates",
    ),
    "invariant_point": Label(
        np.float64,
        "frequency ratios where friction leaves the motion in the contact as it is",
        comment="zeros of U, thesis (6.9); with damping they are invariant for the phase only",
    ),
    "mass_invariant_point": Label(
        np.float64,
        "frequency ratios where friction leaves the monoharmonic amplitude of a mass as it is",
        comment="zeros of U_k and thesis (6.10), undamped; NaN fills up where a mass has fewer",
    ),
    "beta_lim_high": Label(np.float64, "limit of beta_lim for r to infinity"),
    "beta_stick_high": Label(np.float64, "limit of beta_stick for r to infinity"),
    "S": Label(np.float64, "largest value of the sliding condition over half a period"),
}

HISTORY_VARIABLES = {
    "x": Label(np.float64, "displacement of the masses, over P/k1 (Y)"),
    "v": Label(np.float64, "velocity of the masses, dx/dtau, over P/k1 (Y)"),
    "z": Label(np.float64, "motion in the contact, over P/k1 (Y)"),
    "friction": Label(np.float64, "friction force against the motion in the contact, over P"),
    "phase": Label(
        np.int8,
        "sense of the motion in the contact",
        (
            regimes.Code(-1, "sliding_down", "the contact slides towards smaller z"),
            regimes.Code(0, "sticking", "the contact sticks"),
            regimes.Code(1, "sliding_up", "the contact slides towards larger z"),
        ),
    ),
    "event_tau": Label(np.float64, "excitation phase at which a phase of the motion begins"),
    "event_phase": Label(np.int8, "phase of the motion that begins"),
    "event_z": Label(np.float64, "motion in the contact at the event, over P/k1 (Y)"),
}
HISTORY_VARIABLES["event_phase"] = HISTORY_VARIABLES["event_phase"]._replace(
    codes=HISTORY_VARIABLES["phase"].codes
)

LABELS = {**CELL_VARIABLES, **CURVES, **HISTORY_VARIABLES}


def cell_dims(name: str) -> tuple[str, ...]:
    """Dimensions of a cell variable."""
    if name == "sliding_limit":
        return ("mu", "r")
    return ("mu", "r", "beta", "dof") if name == "amplitude" else ("mu", "r", "beta")


def coordinate(name: str, values: np.ndarray | float) -> xr.Variable:
    """A labelled axis, or a labelled scalar."""
    dims = (name,) if np.ndim(values) else ()
    return xr.Variable(dims, values, {"long_name": COORDINATES[name], "units": "1"})


def attributes(name: str) -> dict[str, object]:
    """CF attributes of a variable."""
    label = LABELS[name]
    result: dict[str, object] = {"long_name": label.long_name}
    if label.codes:
        result[label.flags] = np.array([code.value for code in label.codes], dtype=label.dtype)
        result["flag_meanings"] = " ".join(code.name for code in label.codes)
        result["comment"] = "; ".join(f"{code.name}: {code.meaning}" for code in label.codes)
    else:
        result["units"] = "1"
        if label.comment:
            result["comment"] = label.comment
    return result


def label_variable(name: str, dims: tuple[str, ...], values: np.ndarray) -> xr.Variable:
    """A labelled variable; the values are taken as they are, not copied."""
    return xr.Variable(dims, values, attributes(name))


def stamp(ds: xr.Dataset, title: str, system: System) -> xr.Dataset:
    """Add the global attributes."""
    ds.attrs = {
        "Conventions": "CF-1.11",
        "title": title,
        "source": f"frictionmap {__version__}",
        "references": REFERENCES,
        "system": system.describe(),
    }
    return ds
