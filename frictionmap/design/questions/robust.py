"""The friction whose worst response within its spread, or over samples, is least."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from ...datasets.amounts import UP, amounts_of
from ...datasets.design_labels import FRICTION, RESPONSE, beta_label, size_label
from ...datasets.labels import Label
from ...errors import InputError
from ...files.key import Key, number
from ...model.system import System
from ...units.scales import Units
from ..samples import Samples, checked_spread
from .keys import BAND, OF_PEAKS
from .least_peak import least_peak
from .record import Question
from .rows import answer_rows, change_rows, peak_rows
from .sentences import peak_sentences, range_of_regimes

if TYPE_CHECKING:
    import xarray as xr


def robust(
    system: System,
    band: Any,
    spread: float | Samples = 0.2,
    mass: int = 1,
    mu: float = 1.0,
    *,
    quantity: str = "amplitude",
    contact: int = 1,
    beta: Any = None,
    threads: int | None = None,
    units: Units | None = None,
) -> "xr.Dataset":
    """Find the friction whose worst response within its relative spread, or over samples, is least.

    Parameters and results are those of `least_peak`; the peaks are those at the worse end of the spread,
    `worst_of_beta` on `worst_search` is the curve that was minimised, and the response curves are those at
    both ends of the spread.
    With `design.Samples` they are those of the sample at the quantile; `peak_of_sample` on `sample` is the
    largest response of each, `beta_no_stop` and `beta_stuck` hold for all samples, and the response curves
    are those of the nominal structure; `response_of_sample` is that of the sample `deciding_sample`, whose
    peak is the answer.

    Examples
    --------
    The best friction if it may be off by 20 % to either side, and the largest amplitude in the worst case:

    >>> import frictionmap as fm
    >>> pair = fm.System(contact_masses=[2], mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.01)
    >>> ds = fm.design.robust(pair, band=[0.3, 2.2], spread=0.2)
    >>> round(ds.beta.item(), 3), round(ds.peak.values[0].item(), 3)
    (1.47, 2.944)
    """
    if not isinstance(spread, Samples) and checked_spread(spread) == 0.0:
        raise InputError("spread", "must be > 0; got 0")
    return least_peak(
        system, band, mass, mu, spread, quantity=quantity, contact=contact, beta=beta, threads=threads,
        units=units,
    )  # fmt: skip


def _sample_rows(ds: "xr.Dataset") -> Iterator[tuple[str, str]]:
    """The largest responses of the samples."""
    if {"quantile", "peak_of_sample"} <= set(ds.variables):
        sizes = ds["peak_of_sample"].values
        most = amounts_of(ds).response(float(sizes.max()), UP)
        share = f"{100.0 * float(ds['quantile']):g} %"
        yield "samples", f"{sizes.size}; {share} of them stay below the peak, all stay below {most}"


_SPREAD = Key(
    "spread",
    "for robust: relative uncertainty of the friction, up and down",
    number(least=0.0, below=1.0),
    example="0.2",
    words="a number from 0 to below 1",
)
_QUANTILE = Key(
    "quantile",
    "for robust with samples in [axes]: share of samples whose response stays below the peak",
    number(above=0.0, most=1.0),
    0.95,
    words="a number above 0, up to 1",
)

ROBUST = Question(
    name="robust",
    title="Friction with the least peak within its spread",
    function=robust,
    needed=(BAND,),
    optional=(*OF_PEAKS, _SPREAD, _QUANTILE),
    labels={
        "spread": Label(np.float64, "relative spread of the friction", (), least=0.0, most=1.0),
        "quantile": Label(
            np.float64,
            "share of the samples whose response is at most that of the answer",
            (),
            least=0.0,
            most=1.0,
        ),
        "worst_search": beta_label(f"{FRICTION}, searched", ("worst_search",), inf=False),
        "worst_of_beta": size_label(f"{RESPONSE}, the worst within the spread", ("worst_search",)),
        "deciding_sample": Label(np.int64, "sample whose peak is that of the answer", (), least=1),
        "response_of_sample": size_label(
            "response of that sample at the answer, over P/k1 (Y), or of a force over P",
            ("r_search",),
            nan=True,
        ),
        "sample": Label(np.int64, "sample of the structure, counted from 1", ("sample",), least=1),
        "peak_of_sample": size_label(f"{RESPONSE}, of each sample at the answer", ("sample",)),
    },
    rows=(answer_rows, peak_rows, _sample_rows, change_rows),
    panels=("performance", "responses"),
    sentences=(peak_sentences, range_of_regimes),
)
