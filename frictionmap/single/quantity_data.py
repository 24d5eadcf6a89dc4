"""Quantities over a cycle: data for the kernels, and the arrays for the results."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from .._kernels.engine.dissipation import Dampers
from .._kernels.engine.extremes import (
    FOUND,
    PHASE,
    PHASE_BEGIN,
    PHASE_END,
    VALUE,
    OutputMatrices,
    UncoupledResponse,
)
from .._kernels.engine.quantities import (
    BY_DAMPING,
    BY_FRICTION,
    BY_LOAD,
    DISTANCE,
    DISTORTION,
    EQUIVALENT,
    LAG,
    MODULUS,
    RMS,
    WORK_TERMS,
    Balance,
    Linear,
    Quantities,
    Results,
)
from .._kernels.structure.state import STATIC_SHAPE
from ..datasets.labels import COORDINATES
from ..model.modes import ModalModel, times
from ..model.system import System
from .kernel_data import StructureArrays

#: Location of every variable in the results: kind of result, rows, and column.
_MASSES, _FORCE, _CONTACT, _CELL = "masses", "force", "contact", "cell"
_LOCATIONS = {
    "amplitude": ("extremes", _MASSES, VALUE),
    "phase_lag": ("extremes", _MASSES, PHASE),
    "phase_begin": ("extremes", _MASSES, PHASE_BEGIN),
    "phase_end": ("extremes", _MASSES, PHASE_END),
    "contact_phase": ("extremes", _CONTACT, PHASE),
    "contact_phase_begin": ("extremes", _CONTACT, PHASE_BEGIN),
    "contact_phase_end": ("extremes", _CONTACT, PHASE_END),
    "transmitted_force": ("extremes", _FORCE, VALUE),
    "first_harmonic_amplitude": ("firsts", _MASSES, MODULUS),
    "first_harmonic_phase": ("firsts", _MASSES, LAG),
    "contact_first_harmonic_amplitude": ("firsts", _CONTACT, MODULUS),
    "contact_first_harmonic_phase": ("firsts", _CONTACT, LAG),
    "transmitted_first_harmonic": ("firsts", _FORCE, MODULUS),
    "displacement_harmonic": ("harmonics", _MASSES, None),
    "contact_harmonic": ("harmonics", _CONTACT, None),
    "friction_harmonic": ("harmonics", _FORCE, None),
    "sliding_distance": ("work_terms", _CELL, DISTANCE),
    "work_friction": ("work_terms", _CELL, BY_FRICTION),
    "work_input": ("work_terms", _CELL, BY_LOAD),
    "work_damping": ("work_terms", _CELL, BY_DAMPING),
    "equivalent_damping": ("work_terms", _CELL, EQUIVALENT),
    "rms": ("distortions", _MASSES, RMS),
    "distortion": ("distortions", _MASSES, DISTORTION),
}


#: Variables of every quantity, in the order of the file.
VARIABLES: dict[str, tuple[str, ...]] = {
    "amplitude": ("amplitude",),
    "phase": (
        "phase_lag", "phase_begin", "phase_end", "contact_phase", "contact_phase_begin", "contact_phase_end",
    ),
    "first_harmonic": (
        "first_harmonic_amplitude", "first_harmonic_phase", "contact_first_harmonic_amplitude",
        "contact_first_harmonic_phase",
    ),
    "energy": ("sliding_distance", "work_friction", "work_input", "work_damping", "equivalent_damping"),
    "harmonics": ("displacement_harmonic", "contact_harmonic", "friction_harmonic"),
    "transmitted_force": ("transmitted_force", "transmitted_first_harmonic"),
    "distortion": ("rms", "distortion"),
}  # fmt: skip

PARTS = np.array(COORDINATES["part"].texts)


@dataclass(frozen=True)
class QuantityRequest:
    """Results requested for every cell."""

    kinds: frozenset[str]  # names of fields of `Results`
    harmonics: int = 1  # highest harmonic kept
    force: bool = False  # whether the extremes of the transmitted force are requested


def quantity_request(names: Iterable[str], harmonics: int = 1) -> QuantityRequest:
    """Request the results from which these variables are read."""
    names = set(names)
    return QuantityRequest(
        frozenset(_LOCATIONS[name][0] for name in names), harmonics, "transmitted_force" in names
    )


def read_result(name: str, found: Results) -> np.ndarray:
    """Read a variable over (mu, r, beta[, dof][, harmonic, part])."""
    kind, rows, column = _LOCATIONS[name]
    array = getattr(found, kind)
    if rows == _CELL:
        return np.ascontiguousarray(array[..., column])
    masses = array.shape[3] - (0 if kind == "distortions" else 2)
    row = {_MASSES: slice(masses), _FORCE: masses, _CONTACT: masses + 1}[rows]
    chosen = np.ascontiguousarray(array[:, :, :, row])
    if column is None:
        return chosen.view(float).reshape(*chosen.shape, 2)
    return np.ascontiguousarray(chosen[..., column])


def results(cells: tuple[int, int, int], masses: int, request: QuantityRequest) -> Results:
    """Allocate the requested results over (mu, r, beta), NaN until they are filled."""

    def array(kind: str, *further: int, dtype: type = float) -> np.ndarray:
        if kind not in request.kinds:
            return np.empty((0,) * (3 + len(further)), dtype)
        return np.full((*cells, *further), np.nan, dtype)

    rows = masses + 2
    return Results(
        array("extremes", rows, FOUND), array("firsts", rows, 2),
        array("harmonics", rows, request.harmonics + 1, dtype=complex), array("work_terms", WORK_TERMS),
        array("distortions", masses, 2),
    )  # fmt: skip


def _wall_mass(system: System) -> int:
    """Mass whose displacement equals z, counted from 0; -1 if there is none."""
    return system.contact_rows[0] if system.contact == "fixed-wall" else -1


def _with_force(outputs: OutputMatrices, found: StructureArrays, modes: ModalModel) -> OutputMatrices:
    """Add the row of the transmitted force, the loads less the inertia forces, to the output matrices.

    The inertia forces follow from the modal equations of motion; in a stop the friction force balances the
    load.
    """
    participating, model = found.participating, found.model
    mass = modes.phi[:, participating].T @ modes.mass.sum(axis=0)
    stiff, rate = (
        mass * modes.w[participating] ** 2,
        mass * 2.0 * modes.zeta[participating] * modes.w[participating],
    )
    coupling = modes.participating_coupling()
    if coupling is not None:
        rate += mass @ coupling
    row = np.concatenate((stiff, rate)) @ modes.free.to_modes
    friction = float(mass @ modes.chi[participating])
    held = row @ model.to_free - friction * model.watch
    static = float(row[: mass.size] @ model.modes[STATIC_SHAPE]) - friction * model.stiffness
    return OutputMatrices(
        np.vstack((outputs.free, row)), np.vstack((outputs.held, held)),
        np.append(outputs.static_shape, static), np.append(outputs.friction, friction),
    )  # fmt: skip


def _column(rows: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Complex rows (n_r, n) times real weights (n,), each row rounded independently of the others; (n_r,)."""
    return times(rows, weights[:, np.newaxis])[:, 0]


def _scaled(values: np.ndarray, factors: np.ndarray) -> np.ndarray:
    """Complex values times real factors, each rounded independently of the others, as in `times`."""
    found = np.empty_like(values)
    found.real, found.imag = values.real * factors, values.imag * factors
    return found


def _uncoupled_response(
    found: StructureArrays, modes: ModalModel, r: np.ndarray, balance: Balance, force: bool
) -> UncoupledResponse:
    """Response that the contact does not influence, of the masses and, if requested, of the transmitted
    force.
    """
    if not force:
        return UncoupledResponse(found.uncoupled, found.uncoupled)
    participating, model = found.participating, found.model
    mass = modes.phi[:, participating].T @ modes.mass.sum(axis=0)
    loads = np.ascontiguousarray(modes.relative_participation(r)[:, participating])
    sliding = balance.load - _column(loads, mass)
    sliding += _scaled(_column(found.uncoupled, modes.mass.sum(axis=0)), r * r)
    chi = modes.chi[participating]
    held = sliding + _column(loads, chi * (float(mass @ chi) / model.inverse_mass))
    return UncoupledResponse(
        np.column_stack((found.uncoupled, sliding)), np.column_stack((found.uncoupled, held))
    )


def _base_share(system: System) -> float:
    """Coefficient of the base velocity in the dashpots, beside the velocities that the kernels follow.

    The latter are relative to the base with a joined base-wall; dashpots may be connected to ground or base.
    """
    return float(system.base_motion) - float(system.damping_reference == "base")


def _dampers(modes: ModalModel, found: StructureArrays, base: np.ndarray) -> Dampers:
    """Dashpots of the participating modes; `base` (n,) is the share of the base motion, by modes.

    One dashpot per mode; where the damping couples modes, one for each principal direction of it.
    """
    which = found.participating
    coupling, n = modes.participating_coupling(), which.size
    weights, forms = 2.0 * modes.zeta[which] * modes.w[which], np.eye(n)
    if coupling is not None:
        rates, directions = np.linalg.eigh(np.diag(weights) + coupling)
        weights, forms = np.maximum(rates, 0.0), directions.T
    place, speed = forms @ modes.free.to_modes[:n], forms @ modes.free.to_modes[n:]
    return Dampers(weights, place, speed, speed @ found.model.to_free, forms @ base)


def _balance(system: System, found: StructureArrays, r: np.ndarray) -> Balance:
    """Data for forces and work."""
    modes = system.modes
    loads = modes.total_load(r)
    to_base = system.damping_reference == "base"
    share, total_mass = _base_share(system), modes.mass.sum(axis=0)
    participating = np.isin(np.arange(modes.w.size), found.participating)
    mass = modes.phi.T @ total_mass
    moving = modes.modal_responses(r, np.where(participating, 0.0, modes.relative_participation(r)))
    uncoupled = np.where(participating, 0.0, np.where(np.isinf(moving), 0.0, moving) + share * mass)
    held = np.where(np.isfinite(found.held), found.held, 0.0) - float(to_base)
    dashpot_force = times(held, modes.damping)
    held_rate = (held.real * dashpot_force.real + held.imag * dashpot_force.imag).sum(axis=1)
    return Balance(
        load=loads.sum(axis=1),
        inertia=r[:, np.newaxis] ** 2 * total_mass,
        power=-(loads if to_base else loads.conj()),
        base_power=loads.sum(axis=1) if to_base else np.zeros(r.size, complex),
        base_motion=float(system.base_motion),
        dampers=_dampers(modes, found, share * mass[participating]),
        damped=bool(modes.zeta[found.participating].any()),
        damping_uncoupled=np.pi * r * modes.damping_form(uncoupled),
        damping_held=np.pi * r * held_rate,
    )  # fmt: skip


def _growth(system: System, found: StructureArrays, r: np.ndarray) -> np.ndarray:
    """Directions (n_r, n_dof + 2) of masses, transmitted force and contact that grow at an undamped
    resonance.

    They lag the load on the mode by a quarter of a period; 0 elsewhere.
    """
    modes = system.modes
    resonant = (modes.dynamic_stiffness(r)[:, found.participating] == 0.0) & (r > 0.0)[:, np.newaxis]
    growing = -1j * np.where(resonant, modes.participation(r)[:, found.participating], 0.0)
    phi = modes.phi[:, found.participating]
    masses = times(growing, np.ascontiguousarray(phi.T))
    contact = times(growing, modes.chi[found.participating][:, np.newaxis])
    return np.column_stack((masses, times(masses, modes.mass.sum(axis=0)[:, np.newaxis]), contact))


def quantity_arrays(
    system: System,
    r: np.ndarray,
    found: StructureArrays,
    request: QuantityRequest,
    out: Results,
) -> Quantities:
    """Build the data for the quantities of a system's cells at frequencies r."""
    modes = system.modes
    balance = _balance(system, found, r)
    outputs = _with_force(found.outputs, found, modes) if request.force else found.outputs
    linear = Linear(found.held, modes.held_load(r), _growth(system, found, r))
    return Quantities(
        _wall_mass(system), outputs, _uncoupled_response(found, modes, r, balance, request.force), linear,
        balance, out, request.harmonics,
    )  # fmt: skip
