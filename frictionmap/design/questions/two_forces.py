"""The two friction forces with the least largest response over a band."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from ...datasets.amounts import amounts_of
from ...datasets.design_labels import FRICTION, RESPONSE, beta_label, size_label
from ...datasets.labels import Label
from ...files.key import Key, number, several, whole
from ...model.system import System
from ...units.scales import Units
from .keys import BAND, OF_PEAKS
from .record import Question
from .rows import answer_rows, change_rows, peak_rows
from .sentences import peak_sentences, range_of_regimes

if TYPE_CHECKING:
    import xarray as xr


def two_forces(
    system: System,
    band: Any,
    second: int = 2,
    ratio: Any = (0.0, 2.0),
    mass: int = 1,
    mu: float = 1.0,
    *,
    quantity: str = "amplitude",
    contact: int = 1,
    beta: Any = None,
    threads: int | None = None,
    units: Units | None = None,
) -> "xr.Dataset":
    """Find the two friction forces with the least largest response over a band of frequencies.

    The friction of all contacts is scaled by beta, as in `least_peak`, and the ratio of one contact is varied
    as well.  It takes tens of seconds, because each ratio is a question of its own.

    Parameters
    ----------
    system : System
        With a list of contacts.
    band, mass, mu, quantity, contact, beta, threads, units : as in `least_peak`
        Without `beta` the friction is searched in the range of the given ratio.
    second : int
        Contact whose ratio is varied, counted from 1.
    ratio : array_like, shape (2,)
        Range of its ratio [-], >= 0, in place of the one that it has.

    Returns
    -------
    xarray.Dataset
        As of `least_peak`, for the best ratio; `second_ratio`, that ratio, to 1e-4 of its range; on
        `ratio_search` the least peak of other ratios, `peak_of_ratio`, and its friction, `beta_of_ratio`.

    Raises
    ------
    InputError
        An argument has the wrong type or is out of range, or the contact has a force of its own.
    NoSteadyState
        Cells of the band have no periodic steady state: the largest response may be among them.

    Examples
    --------
    >>> import frictionmap as fm
    >>> pair = fm.System(
    ...     contacts=[fm.Contact(masses=[1]), fm.Contact(masses=[2])],
    ...     mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.02,
    ... )
    >>> ds = fm.design.two_forces(pair, band=[0.3, 2.2], ratio=[0.5, 1.5])  # doctest: +SKIP
    >>> ds.beta.item(), ds.second_ratio.item()  # doctest: +SKIP
    """
    from ..answers import peaks_answer
    from ..force_plane import checked_plane, find_in_plane
    from ..task import checked_task

    task = checked_task(system, band, (quantity, mass, contact), mu, beta, threads, units)
    plane = checked_plane(task.system, second, ratio)
    task, curve, optimum, ridge = find_in_plane(task, plane)
    k = int(np.argmin(ridge.peak))
    further = {
        "ratio_search": ridge.ratio, "peak_of_ratio": ridge.peak, "beta_of_ratio": ridge.beta,
        "second_ratio": ridge.ratio[k],
    }  # fmt: skip
    asked = {"second": plane.contact, "ratio": [plane.low, plane.high]}
    return peaks_answer("two-forces", task, curve, optimum, asked, further)


def _ratio_rows(ds: "xr.Dataset") -> Iterator[tuple[str, str]]:
    """The ratio of the second contact, and its force where that of beta is known."""
    if {"second", "second_ratio"} <= set(ds.variables):
        ratio = float(ds["second_ratio"])
        force = amounts_of(ds).friction_and_ratio(ratio * float(ds["beta"]))
        yield f"friction of contact {int(ds['second'])}", f"{force}, ratio {ratio:.4g}"


_SECOND = Key("second", "for two-forces: contact whose ratio is varied, counted from 1", whole(least=1), 2)
_RATIO = Key(
    "ratio",
    "for two-forces: range of the ratio of that contact",
    several(number(least=0.0), 2, maxItems=2),
    [0.0, 2.0],
    words="two numbers >= 0, increasing",
)

TWO_FORCES = Question(
    name="two-forces",
    title="Two friction forces with the least peak",
    function=two_forces,
    needed=(BAND,),
    optional=(*OF_PEAKS, _SECOND, _RATIO),
    labels={
        "second": Label(np.int64, "contact whose ratio is varied, counted from 1", (), least=1),
        "second_ratio": Label(
            np.float64, "friction of the second contact over beta: the answer", (), least=0.0
        ),
        "ratio_search": Label(
            np.float64, "ratio of the second contact, searched", ("ratio_search",), least=0.0
        ),
        "peak_of_ratio": size_label(f"{RESPONSE}, least over the friction at each ratio", ("ratio_search",)),
        "beta_of_ratio": beta_label(f"{FRICTION} with the least peak at each ratio", ("ratio_search",)),
    },
    rows=(answer_rows, _ratio_rows, peak_rows, change_rows),
    panels=("performance", "responses", "ridge"),
    sentences=(peak_sentences, range_of_regimes),
)
