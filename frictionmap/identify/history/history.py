"""Natural frequency, damping and friction of one mass from a record of any shape."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from ... import checks
from ...datasets.provenance import system_text
from ...errors import InputError
from ...model.system import System
from ...units.table import MOTIONS
from ..statistics.estimates import estimates, friction_force, number, verdict
from ..statistics.least_squares import Errors, Solution
from ..time_series.labels import one_mass
from ..time_series.motion import CONTACTS
from .checks import (
    MOST_WITH_NOISE,
    check_slips,
    check_unit,
    checked_held,
    checked_measured,
    checked_reference,
    checked_sigma,
    size_of,
)
from .fit import Noise, fit_history
from .model import NAMES, PLACE, SPEED, X_F
from .outcome import VERDICTS, Outcome, judged, slides_of

#: Samples left out on either side of events of accelerations, unless it is said.
_MASK = 2

#: What is estimated, and its unit.
MEANINGS = {
    "f_n": ("natural frequency without friction and damping", "Hz"),
    "zeta": ("viscous damping ratio", "1"),
    "x_F": ("kinetic friction force over stiffness", "mm"),
    "mu": ("static over kinetic friction force", "1"),
    "contact_stiffness": ("stiffness of the spring in the contact over that of the mass", "1"),
    "stiffness": ("stiffness of the spring of the mass", "N/mm"),
    "offset_x": ("place of the unloaded mass where the base is at its zero", "mm"),
    "delay": ("time by which x is measured later than what drives the mass", "s"),
    "gain": ("gain of x over that of what drives the mass", "1"),
}


def history(
    time: Sequence[float] | np.ndarray,
    x: Sequence[float] | np.ndarray,
    *,
    base: Sequence[float] | np.ndarray | None = None,
    force: Sequence[float] | np.ndarray | None = None,
    units: tuple[str, str] | None = None,
    contact: str = "fixed-wall",
    damping_reference: str | None = None,
    known: Mapping[str, float] | None = None,
    free: Sequence[str] | None = None,
    window: object = None,
    sigma_x: float | None = None,
    sigma_drive: float | None = None,
    gate: float | None = None,
    mask_samples: int | None = None,
) -> xr.Dataset:
    """Fit the exact motion of one mass with friction, from its initial state, to a record of any shape.

    Parameters
    ----------
    time : array, shape (samples,)
        Times [s], increasing; equal steps are not needed.
    x : array, shape (samples,)
        Displacement, velocity or acceleration of the mass in space.
    base, force : array, shape (samples,)
        What drives the mass, one of both; a spline goes through its samples.
    units : (str, str)
        Of what drives the mass, and of x; default: mm or N, and mm.
    contact : "fixed-wall" or "joined-base-wall"
        Whether the mass rubs on a wall that stands still, or on one that moves with the base.  The base must
        be a displacement for the first one.
    damping_reference : "ground" or "base"
        Whether the damper acts on the velocity of the mass, or on that relative to the base.  Default:
        "ground"; "base" if the base is measured as an acceleration.
    known : mapping
        Parameters to be held: f_n [Hz], zeta, x_F [mm], mu >= 1, contact_stiffness (kt/k of a spring in the
        contact), stiffness k [N/mm], offset_x [mm], delay [s] and gain of x.
    free : sequence of str
        Parameters to be fitted; default: f_n, zeta, x_F, offset_x if x is a displacement, stiffness under a
        force, unless they are known.  mu, contact_stiffness, delay and gain are fitted if they are named.
    window : [begin, end]
        Times [s] of the part to be fitted; default: all.
    sigma_x, sigma_drive : float
        Standard deviations of the noise of x and of what drives the mass, in their units.  Default: from the
        residuals, and from the spectrum above the band.  sigma_drive = 0: it is exact.
    gate : float
        Where the modulus of the force is below this [N], it is 0.
    mask_samples : int
        Samples left out on either side of each event; default: 2 of accelerations, which jump there, else 0.

    Returns
    -------
    xarray.Dataset
        On parameter: estimate, standard_error, lower and upper (95 %; of mu from the profile of the sum),
        `known`, unit; `correlation`; on sample: time, drive, data, model, residual, sigma; scalars `slides`,
        `events`, `stuck_fraction` (`elastic_fraction` of a contact with a spring), `condition` (least over
        largest singular value of the scaled slopes), `drive_share` (of the variance of residuals), `sigma_x`,
        `sigma_drive`, `samples_left_out`, `start_place`, `start_speed`, `verdict`.  Attribute `warnings`.

    Raises
    ------
    InputError
        An argument is invalid; nothing slips, fewer than three slides, or slides to one side only; parameters
        are not identifiable.

    Notes
    -----
    The derivatives of the motion go through its events (H1).  Noise of the drive passes through the same
    motion: residuals have the covariance (H2), by which they are whitened.

    Examples
    --------
    A run-up through the resonance of a rig at 3 Hz; 0.02 g are x_F = 0.55 mm:

    >>> import numpy as np
    >>> import frictionmap as fm
    >>> t = np.arange(0.0, 5.0, 0.01)
    >>> base = 1.2 * np.sin(2 * np.pi * (1.0 + 0.4 * t) * t)  # mm, from 1 Hz to 5 Hz
    >>> rig = fm.System(contact="joined-base-wall", damping_ratios=0.01)
    >>> record = fm.Record(base, time=t, quantity="displacement", unit="mm")
    >>> ds = fm.history(rig, record, "0.02 g", units=fm.Units(natural_frequency="3 Hz"), after=0.0)
    >>> x = base + np.interp(t, ds.time, 1e3 * ds.x_m.squeeze())
    >>> x += np.random.default_rng(1).normal(0.0, 0.01, t.size)
    >>> rubs = {"contact": "joined-base-wall", "damping_reference": "base"}
    >>> fit = fm.identify.history(t, x, base=base, sigma_drive=0.0, **rubs)
    >>> fit.estimate.sel(parameter=["f_n", "x_F"]).values.round(2)
    array([3.  , 0.56])
    """
    if (base is None) == (force is None):
        got = "none" if base is None else "both"
        raise InputError(f"history must have base or force, one of both; got {got}")
    both = units or ("mm" if force is None else "N", "mm")
    check_unit(both[0], "units[0]", *(MOTIONS if force is None else ("force",)))
    check_unit(both[1], "units[1]", *MOTIONS)
    checks.choice(contact, "contact", CONTACTS)
    reference = checked_reference(damping_reference, both[0])
    held, shown, elastic = checked_held(known or {}, free, both)
    given = checked_measured(
        time, x, force if base is None else base, both, (contact, reference), gate, window, elastic
    )
    noise = _noise(sigma_x, sigma_drive, mask_samples, both, given.order)
    check_slips(given, held, noise.sigma_x)
    if noise.sigma_drive != 0.0 and given.time.size > MOST_WITH_NOISE:
        raise InputError(
            f"time must have at most {MOST_WITH_NOISE} samples if what drives the mass has noise; got "
            f"{given.time.size}: choose a window, or give sigma_drive = 0"
        )
    outcome = judged(fit_history(given, held, noise), shown, noise.sigma_x is not None)
    ds = _dataset(outcome, shown, both)
    if not given.drive.is_force and "stiffness" in (known or {}):
        newtons = 1e3 * float((known or {})["stiffness"])
        error = float(outcome.errors.standard_error[X_F])
        ds = ds.assign(friction_force(float(outcome.fit.solution.values[X_F]), error, newtons, "mm"))
    ds.attrs["config"] = system_text(
        System(excitation="force") if given.drive.is_force else one_mass(contact, reference)
    )
    return ds


def _noise(
    sigma_x: float | None, sigma_drive: float | None, mask: int | None, units: tuple[str, str], order: int
) -> Noise:
    left_out = (_MASK if order == 2 else 0) if mask is None else checks.whole(mask, "mask_samples", least=0)
    return Noise(
        checked_sigma(sigma_x, "sigma_x", units[1], False),
        checked_sigma(sigma_drive, "sigma_drive", units[0], True),
        left_out,
    )


def _dataset(outcome: Outcome, shown: list[str], units: tuple[str, str]) -> xr.Dataset:
    """Estimates of what was named; samples that were fitted."""
    fit, found = outcome.fit, outcome.errors
    k, keep, size = [NAMES.index(name) for name in shown], fit.whitening.keep, size_of(units[1])
    part = Errors(
        found.standard_error[k], found.lower[k], found.upper[k], found.freedom[k],
        found.correlation[np.ix_(k, k)], found.variance, found.lag_correlation, found.inflation,
    )  # fmt: skip
    residual = (fit.course.x - fit.given.x)[keep] / size
    solution = Solution(fit.solution.values[k], residual, np.empty((0, len(k))), fit.solution.at_bound[k])
    sigma = np.full(keep.size, fit.whitening.sigma_x)
    if fit.whitening.triangle is not None:
        sigma = np.linalg.norm(fit.whitening.triangle, axis=1)
    ds = estimates(
        {name: MEANINGS[name][0] for name in shown}, [MEANINGS[name][1] for name in shown], solution, part,
        np.isnan(fit.held[k]), fit.given.x[keep] / size, units[1], sigma / size,
    )  # fmt: skip
    ds["reduced_chi_square"] = number(found.variance, "reduced chi square of whitened residuals")
    ds["residual_correlation"] = number(found.lag_correlation, "lag-1 correlation of whitened residuals")
    return _described(ds, outcome, units)


def _described(ds: xr.Dataset, outcome: Outcome, units: tuple[str, str]) -> xr.Dataset:
    fit = outcome.fit
    keep, values = fit.whitening.keep, fit.solution.values
    drive = fit.given.drive
    ds["time"] = xr.Variable("sample", fit.given.time[keep], {"long_name": "time", "units": "s"})
    words = {"long_name": "force as used" if drive.is_force else "base, measured", "units": units[0]}
    ds["drive"] = xr.Variable("sample", drive.values[keep] / size_of(units[0]), words)
    share = ("elastic_fraction", "does not slip") if fit.given.elastic else ("stuck_fraction", "sticks")
    more = {
        share[0]: number(fit.course.stuck, f"share of the record in which the contact of the fit {share[1]}"),
        "slides": number(float(slides_of(fit)), "slides of the fitted motion"),
        "events": number(float(fit.course.motion.counts[0]), "stops, turns and starts of the fitted motion"),
        "condition": number(outcome.condition, "least over largest singular value of the scaled slopes"),
        "drive_share": number(fit.whitening.share, "share of the noise of the drive in that of residuals"),
        "sigma_x": number(fit.whitening.sigma_x / size_of(units[1]), "noise of x", units[1]),
        "sigma_drive": number(fit.sigma_drive / size_of(units[0]), "noise of the drive", units[0]),
        "samples_left_out": number(float(fit.given.time.size - keep.size), "samples left out of the fit"),
        "start_place": number(float(values[PLACE]), "place at the beginning, less offset_x", "mm"),
        "start_speed": number(float(values[SPEED]), "speed at the beginning", "mm/s"),
        "verdict": verdict(list(VERDICTS).index(outcome.code), VERDICTS),
    }
    ds = ds.assign(more)
    ds.attrs["title"] = "Record of any shape"
    ds.attrs["warnings"] = "; ".join(outcome.warnings)
    return ds
