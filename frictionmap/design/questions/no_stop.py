"""The most friction without a stop anywhere in a band."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from ...datasets.amounts import DOWN, amounts_of, band_of
from ...model.system import System
from ...units.scales import Units
from .keys import BAND, MU
from .record import Goal, Question, Ranges
from .rows import answer_rows
from .sentences import whole_sentence

if TYPE_CHECKING:
    import xarray as xr


def no_stop(system: System, band: Any, mu: float = 1.0, *, units: Units | None = None) -> "xr.Dataset":
    """Find the most friction without a stop anywhere in a band: with mu = 1 the least beta_lim, theory.md 3.

    With mu > 1 motions are followed from many initial states, in which a contact is about to slip at any
    phase of the load: none of them goes on stopping.  That is no proof that no other one does.

    Parameters
    ----------
    system, band, mu, units
        As in `least_peak`.

    Returns
    -------
    xarray.Dataset
        `beta`, and `at_r`, the frequency that decides; `beta_lim_of_r` and `beta_stick_of_r` on `r_search`.
        With mu > 1 also `beta_no_stop_some_starts`, the least beta_lim: up to there motions without stops
        exist.

    Raises
    ------
    InputError
        An argument has the wrong type or is out of range, or a contact has a spring.

    Examples
    --------
    >>> import frictionmap as fm
    >>> ds = fm.design.no_stop(fm.System(damping_ratios=0.01), band=[0.3, 0.6])
    >>> round(ds.beta.item(), 9), round(ds.at_r.item(), 9)
    (0.005620882, 0.333310347)
    """
    from ..answers import answer, boundaries_at
    from ..limits import starts_matter
    from ..stops import least_with_stops
    from ..task import checked_boundary

    checked, scales = checked_boundary(system, band, mu, units)
    every, some, points = least_with_stops(system, checked, mu)
    found = {"beta": every.beta, "at_r": every.r, "mu": mu, **boundaries_at(system, mu, points)}
    if starts_matter(system, mu):
        found["beta_no_stop_some_starts"] = some.beta
    return answer("no-stop", system, checked, found, {"mu": mu}, units, scales)


def _without_stops(ds: "xr.Dataset", _: Any) -> Ranges:
    """The friction without a stop."""
    beta = float(ds["beta"])
    return [(0.0, beta)] if beta > 0.0 else []


def _sentence(ds: "xr.Dataset") -> Iterator[str]:
    """The most friction without a stop, and the frequency that decides."""
    beta, words = float(ds["beta"]), amounts_of(ds)
    where = f" ({words.frequency(float(ds['at_r']))} decides)" if "at_r" in ds else ""
    if beta == 0.0:
        yield whole_sentence(f"with any friction there are stops{band_of(ds)}{where}")
    else:
        yield whole_sentence(f"up to {words.friction(beta, DOWN)} there are no stops{band_of(ds)}{where}")


NO_STOP = Question(
    name="no-stop",
    title="Most friction without a stop",
    function=no_stop,
    needed=(BAND,),
    optional=(MU,),
    rows=(answer_rows,),
    sentences=(_sentence,),
    panels=("limits",),
    mark="most friction without a stop",
    goal=Goal("no stops", _without_stops),
)
