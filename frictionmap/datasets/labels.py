"""Names, units and meanings of everything that is put into a dataset (CF conventions).

Files have them: they may grow, not change.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import xarray as xr

from .. import checks, regimes
from ..model.settings import Solver
from ..model.system import System
from ..version import __version__
from .provenance import made_by

REFERENCES = (
    "Dynamic analysis of mechanical systems with Coulomb friction, doctoral thesis, University of "
    "Oxford, 2021; J. P. Den Hartog, Forced vibrations with combined Coulomb and viscous friction, "
    "Trans. ASME 53 (1931) 107-115"
)


#: Dimensions of what is told of every cell, and of what depends on frequency only.
CELL = ("mu", "r", "beta")
CURVE = ("mu", "r")


class Label(NamedTuple):
    """One variable: type, dimensions, description, and the values it may have."""

    dtype: type
    long_name: str
    dims: tuple[str, ...]  # in this order; those that a file lacks are the one value of a coordinate
    codes: tuple[regimes.Code, ...] = ()
    comment: str = ""
    flags: str = "flag_values"
    least: float = -np.inf
    most: float = np.inf
    nan: bool = False  # whether NaN is legal
    inf: bool = False
    unresolved: float = np.nan  # of a cell of a map, before it is decided
    needs: str = ""  # beyond the steady state of a cell: its "details", or "coexistence" with others


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
    "tau": Label(np.float64, "excitation phase, omega t", ("tau",), least=0.0),
    "dof": Label(np.int64, "mass, counted from 1", ("dof",), least=1),
}

CELL_VARIABLES = {
    "regime": Label(
        np.int8,
        "motion regime of the steady state",
        CELL,
        regimes.REGIMES,
        unresolved=regimes.UNRESOLVED,
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
        comment="0 where no steady state was found",
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
    "also_reachable": Label(
        np.int8,
        "every regime that was found stable in the cell",
        CELL,
        regimes.REACHABLE,
        flags="flag_masks",
        unresolved=0,
        needs="coexistence",
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
        comment="largest modulus over the steady state; infinite at a resonance, NaN where unresolved",
        least=0.0,
        nan=True,
        inf=True,
        needs="details",
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
        comment="thesis (5.65) with (5.55); equal to beta_lim for one mass",
        least=0.0,
        inf=True,
    ),
    "beta_stick": Label(np.float64, "boundary to permanent sticking", CURVE, least=0.0, inf=True),
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
        comment="thesis (6.2), (6.26); with damping (7.62), approximate",
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
    "invariant_point": Label(
        np.float64,
        "frequency ratios where friction leaves the motion in the contact as it is",
        ("invariant",),
        comment="zeros of U, thesis (6.9); with damping they are invariant for the phase only",
        least=0.0,
    ),
    "mass_invariant_point": Label(
        np.float64,
        "frequency ratios where friction leaves the monoharmonic amplitude of a mass as it is",
        ("dof", "mass_invariant"),
        comment="zeros of U_k and thesis (6.10), undamped; NaN fills up where a mass has fewer",
        least=0.0,
        nan=True,
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

HISTORY_VARIABLES = {
    "x": Label(np.float64, "displacement of the masses, over P/k1 (Y)", ("dof", "tau")),
    "v": Label(np.float64, "velocity of the masses, dx/dtau, over P/k1 (Y)", ("dof", "tau")),
    "z": Label(np.float64, "motion in the contact, over P/k1 (Y)", ("tau",)),
    "friction": Label(np.float64, "friction force against the motion in the contact, over P", ("tau",)),
    "phase": Label(np.int8, "sense of the motion in the contact", ("tau",), _SENSES),
    "event_tau": Label(
        np.float64, "excitation phase at which a phase of the motion begins", ("event",), least=0.0
    ),
    "event_phase": Label(np.int8, "phase of the motion that begins", ("event",), _SENSES),
    "event_z": Label(np.float64, "motion in the contact at the event, over P/k1 (Y)", ("event",)),
}

LABELS = {**CELL_VARIABLES, **CURVES, **HISTORY_VARIABLES}


def coordinate(name: str, values: np.ndarray | float) -> xr.Variable:
    """A labelled axis, or a labelled scalar."""
    dims = (name,) if np.ndim(values) else ()
    return xr.Variable(dims, values, {"long_name": COORDINATES[name].long_name, "units": "1"})


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


def label_variable(name: str, values: np.ndarray | float) -> xr.Variable:
    """A labelled variable, of one cell without the cell's dimensions; the values are not copied."""
    dims = LABELS[name].dims
    return xr.Variable(dims[len(dims) - np.ndim(values) :], values, attributes(name))


def stamp(
    ds: xr.Dataset,
    function: str,
    title: str,
    system: System,
    axes: Mapping[str, np.ndarray | float],
    solver: Solver | None = None,
) -> xr.Dataset:
    """Add the global attributes to what a function of the package computed on these axes."""
    ds.attrs = {
        "Conventions": "CF-1.11",
        "title": title,
        "source": f"frictionmap {__version__}",
        "references": REFERENCES,
        "system": system.describe(),
        **made_by(function, title, system, axes, solver),
    }
    return ds
