"""The least friction that holds over a band."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from ...datasets.amounts import UP, amounts_of, band_of
from ...model.system import System
from ...units.scales import Units
from .keys import BAND, MU
from .record import Goal, Question, Ranges
from .rows import answer_rows
from .sentences import whole_sentence

if TYPE_CHECKING:
    import xarray as xr


#: Said of contacts whose normal force moves with the structure.
_OTHERS = (
    "other motions may exist beside contacts at rest, since normal forces move with the structure: a map "
    'with solver.start = "moving" shows those that begin with a large motion'
)


def stuck(system: System, band: Any, mu: float = 1.0, *, units: Units | None = None) -> "xr.Dataset":
    """Find the least friction that holds over a band: the largest beta_stick, or beta_noslip, theory.md 4.

    With mu > 1 it holds whatever the initial state: mu beta_stick, with which kinetic friction is enough and
    every motion comes to rest, theory.md 6.

    Parameters
    ----------
    system, band, mu, units
        As in `least_peak`.

    Returns
    -------
    xarray.Dataset
        `beta`, infinite where a structure that is held resonates without damping, and `at_r`, the frequency
        that decides; `beta_lim_of_r` and `beta_stick_of_r` on `r_search`.  With mu > 1 also
        `beta_stuck_some_starts`, the largest beta_stick, with which contacts that are stuck stay so (one
        mass: from rest), and `beta_stuck_of_r`.  Where normal forces move with the structure the contacts can
        rest from `beta` on; other motions may exist beside that, which a map from both starts shows.

    Raises
    ------
    InputError
        An argument has the wrong type or is out of range.

    Examples
    --------
    >>> import frictionmap as fm
    >>> fm.design.stuck(fm.System(contact="joined-base-wall"), band=[0.5, 1.5]).beta.item()
    2.25
    """
    from ..answers import answer, boundaries_over
    from ..limits import largest_stick, refuse_unknown_stick, starts_matter
    from ..task import checked_boundary

    checked, scales = checked_boundary(system, band, mu, units)
    refuse_unknown_stick(system, "find friction that holds")
    beta, r = largest_stick(system, checked, None)
    found = {"beta": beta, "at_r": r, "mu": mu, **boundaries_over(system, checked, mu)}
    if starts_matter(system, mu):
        found["beta_stuck_some_starts"] = largest_stick(system, checked, mu).beta
    ds = answer("stuck", system, checked, found, {"mu": mu}, units, scales)
    return ds.assign_attrs(warnings=_OTHERS) if system.contact_system.has_phases else ds


def _holding(ds: "xr.Dataset", _: Any) -> Ranges:
    """The friction that holds."""
    beta = float(ds["beta"])
    return [(beta, math.inf)] if math.isfinite(beta) else []


def _sentence(ds: "xr.Dataset") -> Iterator[str]:
    """The least friction that holds, and the frequency that decides."""
    beta, words = float(ds["beta"]), amounts_of(ds)
    where = words.frequency(float(ds["at_r"])) if "at_r" in ds else ""
    if math.isinf(beta):
        at = f" at {where}" if where else ""
        yield (
            f"No friction holds{band_of(ds)}: the held structure resonates without damping{at}, a belt moves "
            "a contact, or friction falls to 0 at a speed."
        )
    else:
        decides = f" ({where} decides)" if where else ""
        what = "all contacts can rest" if ds.attrs.get("warnings") == _OTHERS else "everything is stuck"
        yield whole_sentence(f"from {words.friction(beta, UP)} {what}{band_of(ds)}{decides}")


STUCK = Question(
    name="stuck",
    title="Least friction that holds",
    function=stuck,
    needed=(BAND,),
    optional=(MU,),
    rows=(answer_rows,),
    sentences=(_sentence,),
    panels=("limits",),
    mark="least friction that holds",
    goal=Goal("always stuck", _holding),
)
