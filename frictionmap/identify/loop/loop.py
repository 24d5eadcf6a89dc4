"""Friction, stiffnesses and damping of a damper from its force over a given displacement or velocity."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from ... import checks
from ...errors import InputError
from ..parameters import checked_free
from ..signals.samples import finite_numbers, within
from ..statistics.estimates import estimates, number, verdict
from ..statistics.least_squares import Solution
from .fit import LoopFit, begun
from .held import nothing_slips
from .outcome import Outcome, slipping, without_slip
from .problem import NAMES, DamperTest, modelled_force
from .shape import displacement_of, reversals
from .verdict import VERDICTS

#: Most factors of a speed law.
FACTORS = tuple(f"factor_{k}" for k in range(1, 9))

#: What can be fitted or held; what is neither is absent: mu is 1, the others are 0.
FITTABLE = (*NAMES, *FACTORS)
USUAL = ("friction", "contact_stiffness", "offset")

#: Ranges of known values, as `checks.number` takes them.
_VALID: Mapping[str, Mapping[str, float]] = {
    "friction": {"above": 0.0}, "contact_stiffness": {"above": 0.0}, "mu": {"least": 1.0},
    "backlash": {"least": 0.0}, "asymmetry": {"above": -1.0, "most": 1.0}, "mass": {"least": 0.0},
    **{name: {"least": 0.0} for name in FACTORS},
}  # fmt: skip

#: What is estimated, and its unit.
MEANINGS = {
    "friction": ("kinetic friction force, the mean of both directions", "N"),
    "contact_stiffness": ("stiffness of the spring in the contact", "N/mm"),
    "mu": ("static over kinetic friction force", "1"),
    "backlash": ("play of the contact, from stop to stop", "mm"),
    "asymmetry": ("difference of the friction of both directions over their sum", "1"),
    "parallel_stiffness": ("stiffness of a spring beside the contact", "N/mm"),
    "slope": ("viscous damping, force over velocity", "N s/mm"),
    "mass": ("mass between the contact and the load cell", "kg"),
    "delay": ("time by which the force is measured later than the motion", "s"),
    "offset": ("force where the displacement reads zero, without friction", "N"),
    "drift": ("drift of the zero of the force", "N/s"),
} | {
    name: (f"friction at knot {k} of the speed law, over that at rest", "1")
    for k, name in enumerate(FACTORS, 1)
}

#: Share of the motion that is polarity, not noise.
_AGAINST = 0.02


def loop(
    time: Sequence[float] | np.ndarray,
    force: Sequence[float] | np.ndarray,
    *,
    displacement: Sequence[float] | np.ndarray | None = None,
    velocity: Sequence[float] | np.ndarray | None = None,
    known: Mapping[str, float] | None = None,
    free: Sequence[str] | None = None,
    law_speeds: Sequence[float] | None = None,
    window: object = None,
) -> xr.Dataset:
    """Fit the exact force of a spring with friction in series to a damper test, and its motion jointly.

    Parameters
    ----------
    time : array, shape (samples,)
        Times [s], increasing; equal steps are not needed.
    force : array, shape (samples,)
        Measured force [N], positive where the motion is.
    displacement, velocity : array, shape (samples,)
        What the actuator does [mm] or [mm/s]: one of both.
    known : mapping
        Parameters to be held, in the units of the results.
    free : sequence of str
        Parameters to be fitted; default: friction, contact_stiffness, offset, and the factors of a speed law,
        unless they are known.  What is neither fitted nor known is absent: mu is 1, all others are 0.
    law_speeds : sequence of numbers
        Knots [mm/s] of the speed law, increasing from 0: factor_1 at the second one, and so on.  Between
        knots it is linear; the last factor holds beyond the last knot.
    window : [begin, end]
        Times [s] of the part to be fitted; default: all.

    Returns
    -------
    xarray.Dataset
        On parameter: estimate, standard_error, lower and upper (95 %), `known`, unit; `correlation`; on
        sample: time, motion, motion_model, data, model and residual of the force; scalars `sigma_force`,
        `sigma_motion`, `slip_share`, `branches`, `slips` (branches that slip), `condition` (least over
        largest singular value of the scaled slopes), of motion and force `residual_correlation_` and
        `reduced_chi_square_` (over the noise from sample to sample), `verdict`; if nothing slips
        `stiffness_sum` and `friction_lower`.  Attribute `warnings`.  Of mu there is an interval only.  What
        the test does not determine is NaN, with a bound on one side where there is one.

    Raises
    ------
    InputError
        An argument is invalid; nothing moves back; the contact slips in one or two branches only; parameters
        are not identifiable; the force acts with the motion instead of against it.

    Notes
    -----
    The displacement is fitted together with the force, as its noise in a sampled model would be rectified:
    it would make the friction too large and the stiffness too small.

    Examples
    --------
    A damper with 60 N and 150 N/mm:

    >>> import numpy as np
    >>> import frictionmap as fm
    >>> t = np.arange(0.0, 3.0, 0.005)
    >>> x = 1.6 * np.sin(2 * np.pi * t)
    >>> force = [0.0]
    >>> for step in np.diff(x):
    ...     force.append(np.clip(force[-1] + 150.0 * step, -60.0, 60.0))
    ...
    >>> rng = np.random.default_rng(1)
    >>> noisy = force + rng.normal(0.0, 0.5, t.size)
    >>> fit = fm.identify.loop(t, noisy, displacement=x + rng.normal(0.0, 0.002, t.size))
    >>> fit.estimate.sel(parameter=["friction", "contact_stiffness"]).values.round(0)
    array([ 60., 150.])
    """
    test = _checked_test(time, force, displacement, velocity, law_speeds, window)
    held, named = _held(known or {}, free, test)
    _check_motion(test)
    begin = begun(test, held)
    result = without_slip(begin, held) if nothing_slips(begin, held) else slipping(begin, held, named)
    return _dataset(result, held, named)


def _checked_test(
    time: object, force: object, displacement: object, velocity: object, law_speeds: object, window: object
) -> DamperTest:
    """Samples within the window, finite, times increasing."""
    if (displacement is None) == (velocity is None):
        given = "none" if displacement is None else "both"
        raise InputError(f"loop must have displacement or velocity, one of both; got {given}")
    times = checks.axis(time, "time", least=-np.inf)
    name, moved = ("velocity", velocity) if displacement is None else ("displacement", displacement)
    inside = within(window, times)
    values = [
        finite_numbers(one, key, times.size, "time")[inside] for one, key in ((moved, name), (force, "force"))
    ]
    speeds = np.zeros(1) if law_speeds is None else checks.axis(law_speeds, "law_speeds", least=0.0)
    if speeds[0] != 0.0 or speeds.size > len(FACTORS) + 1:
        raise InputError(
            f"law_speeds must begin with 0 and have at most {len(FACTORS) + 1} knots; "
            f"got {checks.one_line(law_speeds)}"
        )
    return DamperTest(times[inside], values[0], values[1], int(displacement is None), speeds)


def _held(
    known: Mapping[str, float], free: Sequence[str] | None, test: DamperTest
) -> tuple[np.ndarray, list[str]]:
    """Values of held parameters, NaN of fitted ones, and the names that were given."""
    values = {}
    for name, value in known.items():
        checks.choice(name, "known", test.names)
        values[name] = checks.number(value, f"known.{name}", **_VALID.get(name, {}))
    usual = (*USUAL, *FACTORS[: test.factors])
    fitted = checked_free(free, values, test.names, optional=test.names)
    fitted = tuple(name for name in usual if name not in values) if fitted is None else fitted
    for name in (*USUAL[:2], *FACTORS[: test.factors]):
        if name not in fitted and name not in values:
            raise InputError(f"cannot hold {name}: its value is missing; add {name} to free or to known")
    if (
        "asymmetry" in fitted
        and "offset" in fitted
        and "backlash" not in fitted
        and not values.get("backlash")
    ):
        raise InputError(
            "cannot fit asymmetry together with offset without backlash: no sample shows the force without "
            "friction; hold offset, or fit friction alone, which is the mean of both directions"
        )
    if "friction" not in fitted and "contact_stiffness" not in fitted:
        raise InputError("free must hold friction or contact_stiffness; got neither")
    absent = {name: float(name == "mu") for name in test.names}
    held = np.array([np.nan if name in fitted else values.get(name, absent[name]) for name in test.names])
    return held, [name for name in test.names if name in fitted or name in values]


def _check_motion(test: DamperTest) -> None:
    """Refuse a motion that does not turn back, and a force that drives it."""
    turned = reversals(test.time, test.moved, test.order)
    if turned.size < 2:
        raise InputError(
            f"cannot fit a loop: the motion turns back {turned.size} times in {test.time.size} samples, 2 "
            "needed; measure at least one cycle"
        )
    u = displacement_of(test.time, test.moved, test.order)
    closed = slice(turned[0], turned[-1] + 1 if turned.size % 2 else turned[-2] + 1)
    if turned.size < 3:
        return
    work = float(np.trapezoid(test.force[closed], u[closed]))
    whole = float(np.ptp(test.force) * np.ptp(u)) * (turned.size // 2)
    if work < -_AGAINST * whole:
        raise InputError(
            f"the force must act against the motion of the damper; got work of {1e-3 * work:.4g} J: the "
            "polarity is reversed; give the column of the force scale = -1"
        )


def _force_residual(fit: LoopFit) -> np.ndarray:
    """Fitted less measured [N]."""
    return fit.solution.residual[fit.test.time.size :] * fit.test.sigma_force


def _dataset(result: Outcome, held: np.ndarray, named: list[str]) -> xr.Dataset:
    """The dataset of a fit, of the parameters that were named."""
    fit, test = result.fit, result.fit.test
    k = np.array([test.names.index(name) for name in named])
    found = result.errors
    found = found._replace(
        standard_error=found.standard_error[k], lower=found.lower[k], upper=found.upper[k],
        freedom=found.freedom[k], correlation=found.correlation[np.ix_(k, k)],
    )  # fmt: skip
    solution = Solution(
        result.values[k], _force_residual(fit), np.empty((0, k.size)), np.zeros(k.size, dtype=bool)
    )
    ds = estimates(
        {name: MEANINGS[name][0] for name in named}, [MEANINGS[name][1] for name in named], solution, found,
        np.isnan(held[k]), test.force, "N", test.sigma_force,
    )  # fmt: skip
    return _described(ds, result)


def _described(ds: xr.Dataset, result: Outcome) -> xr.Dataset:
    fit, test = result.fit, result.fit.test
    forces = modelled_force(test, fit.layout, fit.solution.values)
    unit = "mm/s" if test.order else "mm"
    kind = "velocity" if test.order else "displacement"
    ds["time"] = xr.Variable("sample", test.time, {"long_name": "time", "units": "s"})
    ds["motion"] = xr.Variable("sample", test.moved, {"long_name": f"measured {kind}", "units": unit})
    moved = test.moved + fit.solution.residual[: test.time.size] * test.sigma_moved
    ds["motion_model"] = xr.Variable("sample", moved, {"long_name": f"fitted {kind}", "units": unit})
    ds["sigma_force"] = number(test.sigma_force, "standard deviation of the noise of the force", "N")
    ds["sigma_motion"] = number(test.sigma_moved, f"standard deviation of the noise of the {kind}", unit)
    ds["slip_share"] = number(float(np.mean(forces.slips)), "share of the samples in which the contact slips")
    ds["branches"] = number(float(fit.layout.branches), "branches of the motion between turning points")
    ds["verdict"] = verdict(list(VERDICTS).index(result.code), VERDICTS)
    ds = ds.assign(result.more)
    ds.attrs["title"] = "Damper test"
    ds.attrs["warnings"] = "; ".join(result.warnings)
    return ds
