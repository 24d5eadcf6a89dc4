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
from ..explanations import Cause, Outcome, added, doubts
from ..parameters import (
    ALIKE,
    CHANNELS,
    CONTACT_STIFFNESS,
    checked_free,
    checked_known,
    is_elastic,
    refuse_mu,
)
from ..statistics.estimates import verdict
from ..statistics.levels import FOUND
from ..statistics.robust import LOSSES
from .alternatives import Task, Tried, explained, with_others
from .cautions import fit_warnings
from .data import ForcedTable, Values, checked_table
from .labels import friction_forces, labelled, spring_stiffness
from .lags import friction_ratios, impossible, refuse_impossible, without
from .model import DELAY, F_N, PLACES, ZETA

#: What can be fitted or held; beta is that of every set.
PARAMETERS = ("beta", "f_n", "zeta", "mu", CONTACT_STIFFNESS, *CHANNELS)

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
        (kt/k1 of a spring in the contact, as of `System`), delay [s] and gain > 0 of the masses behind and
        over the load, by their channels.  Others are fitted, but the contact is rigid, and the channels
        agree, unless `free` or `known` names contact_stiffness, delay or gain, or the data cannot be
        explained without one.
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
        Parameters to be fitted, all that are not known; needed only to name contact_stiffness, delay or
        gain, or so that none of them is added.

    Returns
    -------
    xarray.Dataset
        On parameter (beta, or beta_<label> of every set; f_n, zeta, mu or contact_stiffness, and delay and
        gain if they were named or added) and on sample
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

    Where residuals are larger than errors that are given, or one parameter more explains much of them, the
    model is fitted again with a spring, a delay or a gain, and without each known value.  If one of the first
    three alone explains the data it is added, and the verdict names it.  Otherwise the verdict is
    `explained_otherwise` or `not_explained`, and the estimates must not be used.

    Examples
    --------
    A rig with a natural frequency of 3 Hz and beta = 0.3, with noise:

    >>> import numpy as np
    >>> import frictionmap as fm
    >>> rig = fm.System(excitation="base", damping_reference="base", damping_ratios=0.01)
    >>> r = np.array([0.6, 0.75, 0.9, 0.97, 1.03, 1.1, 1.3, 1.6])
    >>> ds = fm.curves(rig, r, [0.3], quantities=["first_harmonic"]).squeeze()
    >>> rng = np.random.default_rng(1)
    >>> lags = np.degrees(ds.first_harmonic_phase.values) + rng.normal(0.0, 0.5, r.size)
    >>> ratios = ds.first_harmonic_amplitude.values * rng.normal(1.0, 0.01, r.size)
    >>> fit = fm.identify.forced(3.0 * r, lags, ratios)
    >>> fit.estimate.sel(parameter=["f_n", "beta"]).values.round(2)
    array([3. , 0.3])
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
    held = _checked_known(given, system, len(table.labels), elastic, free or ())
    warnings = []
    if not (~table.samples.is_phase).any() and np.isnan(held[F_N]):
        held[F_N] = _passing(table)
        warnings.append(
            f"phase data alone cannot determine f_n: it is held at {held[F_N]:.6g} Hz, where lags pass 90 deg"
        )
    robust = checks.choice(loss, "loss", LOSSES) == "soft_l1"
    drop = checks.choice(unreachable, "unreachable", ("refuse", "drop")) == "drop"
    task = Task(table, system, held, elastic, robust)
    if _rubs_rigidly(elastic, held):
        task = task._replace(table=_reachable(table, system, held[F_N], drop, warnings))
    said = (*given, *(free or ()))
    doubtful = [name for name in (*CHANNELS, *given) if (name in CHANNELS) != (name in said)]
    task, outcome = _explained(task, doubtful, free is None, drop, warnings)
    table, fit = task.table, outcome.chosen.fit
    found, causes = with_others(outcome, table)
    hidden = [name for name in CHANNELS if name not in (*said, outcome.chosen.name)]
    ds = labelled(table, fit, found, unit if load is not None else None, hidden)
    ds = ds.assign({} if fit.model.elastic else friction_ratios(fit))
    if stiffness is not None:
        newtons = checks.number(stiffness, "stiffness", above=0.0)
        ds = ds.assign(friction_forces(table, fit, found, unit, newtons) if load is not None else {})
        ds = ds.assign(spring_stiffness(fit, found, newtons))
    ds["verdict"] = verdict(*_verdict(outcome, causes))
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


def _checked_known(
    known: Mapping[str, float], system: System, sets: int, elastic: bool, free: Sequence[str]
) -> np.ndarray:
    """Parameters that are held, NaN of the others."""
    held = np.full(sets + 5, np.nan)
    held[DELAY:] = [np.nan if name in free else alike for name, alike in ALIKE.items()]
    for name, value in checked_known(known, PARAMETERS).items():
        if name == "beta":
            held[:F_N] = value
        elif name != "mu" or not elastic:
            held[PLACES[name]] = value
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
    lags = f"{wrong.size} lag{'s' * (wrong.size != 1)}"
    warnings.append(f"{lags} ignored: no friction ratio gives such a lag")
    return without(table, wrong)


def _rubs_rigidly(elastic: bool, values: np.ndarray) -> bool:
    """Whether lags have the range that friction gives: no spring in the contact, and channels in time."""
    return not elastic and bool(values[DELAY] == ALIKE["delay"])


def _explained(
    task: Task, doubtful: list[str], may_add: bool, drop: bool, warnings: list[str]
) -> tuple[Task, Outcome[Tried]]:
    """The model that is reported, and the table without lags that no friction gives."""
    _check_count(task.table, task.known)
    outcome = explained(task, doubtful, may_add)
    fit = outcome.chosen.fit
    if not _rubs_rigidly(fit.model.elastic, fit.solution.values):
        return task, outcome
    possible = _reachable(task.table, task.system, float(fit.solution.values[F_N]), drop, warnings)
    if possible is task.table:
        return task, outcome
    task = task._replace(table=possible)
    return task, explained(task, doubtful, may_add)


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


def _verdict(outcome: Outcome[Tried], causes: list[Cause]) -> tuple[int, dict[str, str]]:
    """A code and the meanings of all codes."""
    fit, more = outcome.chosen.fit, added(outcome, causes)
    meanings = {name: words + more for name, words in _VERDICTS.items()} | doubts(outcome, causes)
    if not outcome.chosen.explains:
        return list(meanings).index("explained_otherwise" if outcome.alike else "not_explained"), meanings
    found = fit.solution.values > FOUND * fit.errors.standard_error
    friction = bool(found[:F_N].all())
    if not fit.problem.free[ZETA]:
        return 4 + int(friction), meanings
    return int(friction) + 2 * int(found[ZETA]), meanings
