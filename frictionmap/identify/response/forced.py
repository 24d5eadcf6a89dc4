"""Friction, natural frequency and damping from amplitudes and lags of forced responses."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from ... import checks
from ...datasets.provenance import system_text
from ...errors import InputError
from ...model.general import refuse_general
from ...model.system import System
from ..parameters import CONTACT_STIFFNESS, checked_free, is_elastic, refuse_mu
from ..spring import held_compliance
from ..statistics.estimates import verdict
from ..statistics.levels import FOUND
from ..statistics.robust import LOSSES
from .cautions import fit_warnings
from .data import ForcedTable, Values, checked_table
from .fit import TableFit, fit_forced
from .labels import friction_forces, labelled, spring_stiffness
from .lags import friction_ratios, impossible, refuse_impossible, without
from .model import F_N, LAW, ZETA

#: What can be fitted or held; beta is that of every set.
PARAMETERS = ("beta", "f_n", "zeta", "mu", CONTACT_STIFFNESS)

#: An error of all rows, or one of each.
Error = float | Sequence[float] | np.ndarray | None

_VERDICTS = {
    "neither_found": "neither friction nor viscous damping found",
    "friction_found": "friction found, viscous damping not",
    "viscous_damping_found": "viscous damping found, friction not",
    "both_found": "friction and viscous damping found",
    "friction_not_found": "no friction found, viscous damping held",
    "friction_found_damping_held": "friction found, viscous damping held",
}


def forced(
    frequency: Sequence[float] | np.ndarray,
    phase_lag: Values | None = None,
    amplitude_ratio: Values | None = None,
    *,
    system: System | None = None,
    load: Sequence[float] | np.ndarray | None = None,
    unit: str = "mm",
    sets: Sequence[object] | None = None,
    known: Mapping[str, float] | None = None,
    sigma_phase: Error = None,
    sigma_amplitude: Error = None,
    unreachable: object = "refuse",
    stiffness: float | None = None,
    loss: str = "linear",
    free: Sequence[str] | None = None,
) -> xr.Dataset:
    """Fit the exact steady states to first harmonics of forced responses, all friction forces at once.

    The arguments are the columns of a table and known parameters.

    Parameters
    ----------
    frequency : array, shape (rows,)
        Of the load or the base [Hz], > 0, in any order.
    phase_lag, amplitude_ratio : array, shape (rows,), or mapping of such
        First harmonics over the load's: lag [deg] and modulus, X/Y or X k1/P, > 0; of the only mass, or by
        mass, counted from 1.  At least one of the two.
    system : System
        Default: one mass on a shaken base, its dashpot between the two, and a fixed wall.  Damping that it
        has is held; else zeta of every mode is a parameter.  So is a contact_stiffness that it has.
    load : array, shape (rows,)
        Amplitude of the base or of the force, > 0, in `unit`; by default the same in every row.
    unit : str
        Of `load`, and of the friction, which is then given as a length F/k1 or as a force: "mm", say, or "N".
    sets : sequence, shape (rows,)
        Labels of tests; those of one label have one friction force.
    known : mapping
        Parameters to be held: beta (of all sets), f_n [Hz] > 0, zeta >= 0, mu >= 1, contact_stiffness > 0
        (kt/k1 of a spring in the contact, as of `System`).  Others are fitted, but the contact is rigid
        unless `free` or `known` names contact_stiffness.
    sigma_phase, sigma_amplitude : float or array, shape (rows,)
        Errors of the lags [deg], and relative ones of the amplitudes; by default from the residuals.
    unreachable : "refuse" or "drop"
        What is done about lags of one mass that no friction ratio gives, by five of their errors (5 deg if
        they are not given).  Not looked at for a contact with a spring.
    stiffness : float
        k1 [N/m] > 0 of the first spring; with the amplitudes of the base as `load` it gives the friction
        force k1 x_F of every set [N], and the stiffness of a spring in the contact [N/m].
    loss : "linear" or "soft_l1"
        What residuals cost: their squares, or less beyond their errors, for outliers.
    free : sequence of str
        Parameters to be fitted, all that are not known; needed only to name contact_stiffness.

    Returns
    -------
    xarray.Dataset
        On parameter (beta, or beta_<label> of every set; f_n, zeta, mu or contact_stiffness) and on sample
        as `free_decay`, see `quantity`: data and model are lags [deg] and amplitude ratios, residuals
        degrees and logarithms of ratios.  beta is the friction force over the mean load of its set.  Also on
        sample: frequency, mass, set, sigma, frequency_ratio, friction_ratio, `regime`, and `reached`, the
        initial states that lead to the motion; `lag_status`, what follows from a lag alone, see
        `friction_ratio`.  On answer: `lag_friction_ratio` with its error, and `lag_sample`, the sample that
        it is of.  Attribute `warnings`.

    Raises
    ------
    InputError
        An argument is invalid, there are fewer data than unknowns, or a parameter is not identifiable.

    Notes
    -----
    Motions are continuous, theory.md 2 and 9, or stick-slip; of several with mu > 1 that
    nearest to the data counts.  Phase data alone cannot determine f_n: it is then held where lags pass 90
    deg.

    Of a contact with a spring mu is 1, and its stiffness shows where the contact sticks for a large part of
    the cycle.  Far from there, or where it is large, the data exclude small values only: `upper` is then
    infinite, the standard error NaN, and a warning says so.  An estimate on its bound is a rigid contact.
    Single lags give no friction ratio then.
    """
    system = _default_system() if system is None else checks.instance(system, "system", System)
    system, given = _without_spring(system, known or {})
    damped = system.modes.zeta.any() and "zeta" not in (free or ())  # its damping is known, then
    checked_free(free, (*given, "zeta") if damped else given, PARAMETERS)
    elastic = is_elastic(free, given)
    if elastic:
        refuse_mu(free, given)
    table = checked_table(
        system, frequency, (phase_lag, amplitude_ratio), (sigma_phase, sigma_amplitude), load, sets, elastic
    )
    held = _checked_known(given, system, len(table.labels), elastic)
    warnings = []
    if not (~table.samples.is_phase).any() and np.isnan(held[F_N]):
        held[F_N] = _passing(table)
        warnings.append(
            f"phase data alone cannot determine f_n: it is held at {held[F_N]:.6g} Hz, where lags pass 90 deg"
        )
    robust = checks.choice(loss, "loss", LOSSES) == "soft_l1"
    drop = checks.choice(unreachable, "unreachable", ("refuse", "drop")) == "drop"
    if not elastic:
        table = _reachable(table, system, held[F_N], drop, warnings)
    _check_count(table, held)
    fit = fit_forced(table, system, held, elastic, robust)
    if not elastic:
        possible = _reachable(table, system, float(fit.solution.values[F_N]), drop, warnings)
        if possible is not table:
            table, fit = possible, fit_forced(possible, system, held, robust=robust)
    ds = labelled(table, fit, unit if load is not None else None)
    ds = ds.assign({} if elastic else friction_ratios(fit))
    if stiffness is not None:
        newtons = checks.number(stiffness, "stiffness", above=0.0)
        ds = ds.assign(friction_forces(table, fit, unit, newtons) if load is not None else {})
        ds = ds.assign(spring_stiffness(fit, newtons))
    ds["verdict"] = verdict(_verdict(fit), _VERDICTS)
    ds.attrs["title"] = "Forced responses"
    ds.attrs["system"] = fit.model.system_at(fit.solution.values).describe()
    ds.attrs["config"] = system_text(system)
    if stiffness is not None and load is None:
        warnings.append("no friction force in N: it needs the amplitudes of the base")
    ds.attrs["warnings"] = "; ".join(warnings + fit_warnings(table, fit))
    return ds


def _default_system() -> System:
    return System(excitation="base", damping_reference="base")


def _without_spring(system: System, known: Mapping[str, float]) -> tuple[System, dict[str, float]]:
    """The system with a rigid contact, and the known parameters with the stiffness of its spring."""
    given = dict(known)
    spring = system.contact_stiffness
    if spring is None:
        refuse_general(system, "identify friction")
        return system, given
    if not isinstance(spring, float):
        raise InputError(
            f"contact_stiffness must be one number to identify friction; got a bank of {len(spring)}"
        )
    if CONTACT_STIFFNESS in given:
        raise InputError("cannot use known.contact_stiffness: the system defines it; omit one of the two")
    rigid = replace(system, contact_stiffness=None)
    refuse_general(rigid, "identify friction")
    return rigid, given | {CONTACT_STIFFNESS: spring}


def _checked_known(known: Mapping[str, float], system: System, sets: int, elastic: bool) -> np.ndarray:
    """Parameters that are held, NaN of the others."""
    held = np.full(sets + 3, np.nan)
    for name, value in known.items():
        if name == "beta":
            held[:F_N] = checks.number(value, "known.beta", least=0.0)
        elif name == "f_n":
            held[F_N] = checks.number(value, "known.f_n", above=0.0)
        elif name == "zeta":
            held[ZETA] = checks.number(value, "known.zeta", least=0.0, most=checks.LARGEST_DAMPING)
        elif name == CONTACT_STIFFNESS:
            held[LAW] = held_compliance(value)
        else:
            checks.choice(name, "known", PARAMETERS)
            mu = checks.number(value, "known.mu", least=1.0)
            held[LAW] = held[LAW] if elastic else mu
    if system.modes.zeta.any():
        if not np.isnan(held[ZETA]):
            raise InputError("cannot use known.zeta: the system defines its damping; omit one of the two")
        held[ZETA] = system.zeta
    if not np.isnan(held).any():
        raise InputError("known must leave at least one parameter free; got all of beta, f_n, zeta, mu")
    return held


def _reachable(
    table: ForcedTable, system: System, f_n: float, drop: bool, warnings: list[str]
) -> ForcedTable:
    """The table without lags that no friction gives, if they may be left out; f_n may be unknown, NaN."""
    if np.isnan(f_n):
        return table
    wrong = impossible(table, system, f_n)
    if not wrong.size:
        return table
    if not drop:
        refuse_impossible(table, system, f_n, int(wrong[0]))
    warnings.append(f"{wrong.size} lags that no friction ratio gives were ignored")
    return without(table, wrong)


def _check_count(table: ForcedTable, held: np.ndarray) -> None:
    unknowns, count = int(np.isnan(held).sum()), table.samples.row.size
    if count <= unknowns:
        raise InputError(
            f"cannot fit {unknowns} unknowns to {count} data: more data than unknowns are needed; add data"
        )


def _passing(table: ForcedTable) -> float:
    """Frequency at which lags of the first mass pass 90 deg, the median over the sets [Hz]."""
    samples, rows = table.samples, table.rows
    found = []
    for one in range(len(table.labels)):
        chosen = (samples.mass == 0) & (rows.member[samples.row] == one)
        f, lag = rows.frequency[samples.row[chosen]], samples.value[chosen] - 0.5 * np.pi
        order = np.argsort(f, kind="stable")
        f, lag = f[order], lag[order]
        for k in np.flatnonzero((lag[:-1] < 0.0) & (lag[1:] >= 0.0)):
            found.append(f[k] - lag[k] * (f[k + 1] - f[k]) / (lag[k + 1] - lag[k]))
    if not found:
        raise InputError(
            "cannot determine f_n: phase data alone do not determine it, and the lags of mass 1 do not "
            "pass 90 deg; give known.f_n or amplitudes"
        )
    return float(np.median(found))


def _verdict(fit: TableFit) -> int:
    values, error = fit.solution.values, fit.errors.standard_error
    found = values > FOUND * error
    friction = bool(found[:F_N].all())
    if not fit.problem.free[ZETA]:
        return 4 + int(friction)
    return int(friction) + 2 * int(found[ZETA])
