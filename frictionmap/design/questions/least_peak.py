"""The friction with the smallest peak response over a band of frequencies."""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ...model.system import System
from ...units.scales import Units
from ..samples import Samples, checked_spread
from .at_most import allowed_ranges
from .keys import BAND, OF_PEAKS
from .record import Goal, Question, Ranges
from .rows import answer_rows, change_rows, peak_rows
from .sentences import peak_sentences, range_of_regimes

if TYPE_CHECKING:
    import xarray as xr

#: How far above the least peak counts as near it.
_NEAR = 1.05


def least_peak(
    system: System,
    band: Any,
    mass: int = 1,
    mu: float = 1.0,
    spread: float | Samples = 0.0,
    *,
    quantity: str = "amplitude",
    contact: int = 1,
    beta: Any = None,
    threads: int | None = None,
    units: Units | None = None,
) -> "xr.Dataset":
    """Find the friction with the smallest peak response over a band of frequencies.

    Parameters
    ----------
    system : System
    band : array_like, shape (2,)
        Frequency ratios from which and up to which the load acts, > 0; with units also frequencies.
    mass : int
        Mass whose response is made small, counted from 1.
    mu : float
        Ratio of static to kinetic friction [-], >= 1.  Above 1 the larger of the steady states that are
        reached from rest and from a large sliding motion counts.
    spread : float or design.Samples
        Relative spread of the friction, 0 to below 1.  Above 0 the largest response between (1 - spread) and
        (1 + spread) times the friction is made small, as `robust` does.  With samples of an uncertain
        structure their quantile of the largest response is made small.
    quantity : str
        "amplitude" or "first_harmonic" of the mass, "contact": the displacement in a contact, or
        "transmitted_force", the force on the ground.
    contact : int
        Contact of quantity "contact", counted from 1.
    beta : array_like, shape (2,), optional
        Range of friction ratios F/P to search; default: from 0 to 1.25 times the friction that holds over the
        band, further with a spread.  Without damping it begins where all peaks in the band are finite.
    threads : int, optional
        Number of threads; default: all processors of the process.  The result does not depend on it.
    units : Units, optional
        Reference values that convert ratios to Hz and N, as in `sweep`.

    Returns
    -------
    xarray.Dataset
        `beta`, the friction ratio; on `peak` the largest responses over frequency there, from the highest
        down (equal ones by frequency), with `peak_r`, `peak_regime` and `peak_stops`; `kind` of the optimum;
        of a "threshold", at or above which nothing moves, the peak is 0, and `at_r`, the frequency that
        decides, takes the place of these;
        `second_beta` and
        `second_peak` of another minimum within 5 %; `peak_at_offset`, the response with 2 % and 20 % more and
        less friction; `peak_of_beta` on `beta_search`, the performance curve; `beta_no_stop` and
        `beta_stuck` of the band, with mu > 1 also `beta_no_stop_some_starts` and `beta_stuck_some_starts`;
        `response_of_r` (curve, r_search), response curves.  With units also `friction_force` [N],
        `peak_frequency` [Hz] and `peak_m` [m].  Attribute `warnings`: irregular motions that were left out.

    Raises
    ------
    InputError
        An argument has the wrong type or is out of range, or nothing moves in the band.
    NoSteadyState
        Cells of the band have no periodic steady state, and the largest response may be among them: an
        irregular motion of which three quarters of the peak or more were seen, or none that was found.

    Examples
    --------
    >>> import frictionmap as fm
    >>> chain = fm.System(
    ...     contact_masses=[2], mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.01
    ... )
    >>> ds = fm.design.least_peak(chain, band=[0.3, 2.2])
    >>> round(ds.beta.item(), 4), round(ds.peak.values[0].item(), 9), ds.kind.item()
    (1.4019, 2.727102937, 'smooth')
    """
    from ..answers import answer_for_samples, peaks_answer
    from ..optimum import find_optimum, find_robust
    from ..task import checked_task

    if not isinstance(spread, Samples):
        spread = checked_spread(spread)
    wide = 0.0 if isinstance(spread, Samples) else spread
    task = checked_task(system, band, (quantity, mass, contact), mu, beta, threads, units, wide)
    if isinstance(spread, Samples):
        return answer_for_samples(task, spread, widen=beta is None)
    curve = task.performance()
    if spread > 0.0:
        return peaks_answer("robust", task, curve, find_robust(task, curve, spread), {"spread": spread})
    return peaks_answer("least-peak", task, curve, find_optimum(task, curve), {})


def _near_it(ds: "xr.Dataset", at_most: Callable[[float], "xr.Dataset"]) -> Ranges:
    """The friction at which the peak is at most `_NEAR` times the least one."""
    peak = float(ds["peak"][0])
    if peak == 0.0:
        return [(float(ds["beta"]), math.inf)]
    return allowed_ranges(at_most(_NEAR * peak)) if math.isfinite(peak) else []


LEAST_PEAK = Question(
    name="least-peak",
    title="Friction with the least peak",
    function=least_peak,
    needed=(BAND,),
    optional=OF_PEAKS,
    rows=(answer_rows, peak_rows, change_rows),
    panels=("performance", "responses"),
    goal=Goal("least peak of", _near_it),
    sentences=(peak_sentences, range_of_regimes),
)
