"""The least belt speed without squeal."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from ...datasets.amounts import DIGITS, UP, amounts_of
from ...datasets.labels import Label, in_si
from ...errors import InputError
from ...model.system import System
from ...units.scales import Scales, Units
from .keys import BETA, MU
from .record import Question
from .rows import friction_rows

if TYPE_CHECKING:
    import xarray as xr

#: Variables that are speeds, with their meanings.
_SPEEDS = {
    "wall_speed": "least belt speed from which every motion ends in steady sliding: the answer",
    "sliding_speed_lim": "belt speed above which steady sliding is stable at every speed",
    "cycle_speed_lim": "largest belt speed with a stick-slip cycle",
    "proved_speed": "belt speed from which every motion is proved to end in steady sliding",
}

#: Belt speeds at which the growth is given, up to this multiple of the answer.
_COUNT, _SHOWN = 240, 1.6


def no_squeal(system: System, beta: Any, mu: float = 1.0, *, units: Units | None = None) -> "xr.Dataset":
    """Find the least belt speed without squeal: from there on every motion ends in steady sliding.

    Parameters
    ----------
    system : System
        With one contact, on a belt; its load is left out.
    beta : float
        Kinetic friction force just above speed 0 over P, > 0; with units also a force.
    mu : float
        Ratio of static to kinetic friction [-], >= 1.
    units : Units, optional
        As in `sweep`.

    Returns
    -------
    xarray.Dataset
        Belt speeds over omega_1 P/k1: `wall_speed`, the answer; `sliding_speed_lim`, above which it does not
        squeal by itself; `cycle_speed_lim`, above which it does not stick and slip after a push either;
        `proved_speed`, from which it is proved that nothing but steady sliding exists.  They are infinite
        where there is none.  `squeal_frequency`, of the vibration that grows first, over omega_1.
        `growth_of_speed` on `speed_search`: growth of small vibrations about steady sliding.

        Of one mass the answer is the largest speed with any cycle: those without stops are looked for at 400
        speeds up to `proved_speed`.  Of structures it is `proved_speed`, and the attribute `warnings` says
        between which speeds the growth alone is known.

    Raises
    ------
    InputError
        An argument has the wrong type or is out of range, or the system has several contacts, contacts that
        open or springs with pieces.

    Examples
    --------
    >>> import frictionmap as fm
    >>> falls = {"speed": [0.0, 0.2, 0.6, 1.2], "factor": [1.0, 0.8, 0.7, 0.68], "slope": 0.08}
    >>> pad = fm.System(damping_ratios=0.03, contacts=[fm.Contact("fixed-wall", [1], law=falls)])
    >>> ds = fm.design.no_squeal(pad, beta=1.0)
    >>> round(ds.wall_speed.item(), 9), ds.sliding_speed_lim.item()
    (1.12427343, 0.6)
    """
    from ...no_load.belts import is_one_mass
    from ...no_load.quiet import growths, quiet_speeds
    from ...no_load.sweep import checked
    from ..answers import unloaded_answer

    given = checked(system, 1.0, beta, mu, units)
    friction, ratio = _one(given.axes, "beta"), _one(given.axes, "mu")
    if friction == 0.0:
        raise InputError("beta", "must be > 0: without friction nothing squeals; got 0")
    _refuse(system, len(given.belts.groups))
    found = quiet_speeds(given)
    one = is_one_mass(system)
    speeds = dict(zip(_SPEEDS, (found.quiet, found.sliding, found.cycle, found.proved), strict=True))
    speeds = {name: value for name, value in speeds.items() if not np.isnan(value)}
    searched = _searched(speeds, given.belts.laws[0].speed[-1])
    values = {
        "beta": friction, "mu": ratio, **speeds, **_in_si(speeds, found.frequency, given.scales),
        "squeal_frequency": found.frequency,
        "speed_search": searched, "growth_of_speed": growths(given, searched),
    }  # fmt: skip
    ds = unloaded_answer("no-squeal", system, values, {"beta": friction, "mu": ratio}, units, given.scales)
    if one or found.sliding >= found.quiet:
        return ds
    return ds.assign_attrs(warnings=_unknown(amounts_of(ds).speed(found.sliding, UP)))


def _one(axes: dict[str, np.ndarray], name: str) -> float:
    """The only value of an axis."""
    if axes[name].size != 1:
        raise InputError(name, f"must be one number; got {axes[name].size}")
    return float(axes[name][0])


def _refuse(system: System, contacts: int) -> None:
    """Refuse systems without limits of the belt speed."""
    from ...no_load.belts import is_phases

    what = "cannot find the least belt speed without squeal"
    if is_phases(system):
        raise InputError(
            f"{what} with contacts that open or piecewise linear springs: what the speed does there is not "
            "known; compute a map over wall_speed"
        )
    if contacts > 1:
        raise InputError(
            f"{what} of several contacts: its limits are those of one; compute a map over wall_speed"
        )


def _unknown(speed: str) -> str:
    """The speeds between which only the growth of a structure is known, in words; `speed`: the lower one."""
    return (
        f"at {speed} or more small vibrations die out, but below the answer a push may begin a cycle that "
        "stays: compute a map over these speeds"
    )


def _searched(speeds: dict[str, float], last: float) -> np.ndarray:
    """Belt speeds at which the growth is given; `last`: last break point of the law."""
    known = (speeds["wall_speed"], speeds["sliding_speed_lim"], last, 1.0)
    top = _SHOWN * next(value for value in known if 0.0 < value < np.inf)
    return np.linspace(top / _COUNT, top, _COUNT)


def _in_si(speeds: dict[str, float], frequency: float, scales: Scales) -> dict[str, float]:
    """Speeds in m/s and the frequency in Hz, as far as the reference values are known."""
    velocity, hertz = scales.of("velocity"), scales.of("frequency")
    found = {in_si(name, "velocity"): value * velocity for name, value in speeds.items()} if velocity else {}
    return found | ({"squeal_frequency_Hz": frequency * hertz} if hertz else {})


def _sentence(ds: "xr.Dataset") -> Iterator[str]:
    """The belt speed from which nothing squeals."""
    if not {"wall_speed", "beta"} <= set(ds.variables):
        return
    speed, words = float(ds["wall_speed"]), amounts_of(ds)
    friction = words.friction(float(ds["beta"]), digits=DIGITS)
    if np.isinf(speed):
        yield f"No belt speed is known from which nothing squeals with {friction}."
    elif speed == 0.0:
        yield f"Nothing squeals with {friction}, at any belt speed."
    else:
        least = "least" if "cycle_speed_lim" in ds else "proved, perhaps not the least"
        yield f"From {words.speed(speed, UP)} nothing squeals with {friction} ({least})."


def _speed_rows(ds: "xr.Dataset") -> Iterator[tuple[str, str]]:
    """The friction, and the belt speeds."""
    yield from friction_rows(ds, "friction", "")
    one = "cycle_speed_lim" in ds
    names = {
        "wall_speed": f"{'least' if one else 'proved'} belt speed without squeal",
        "sliding_speed_lim": "squeals by itself up to",
        "cycle_speed_lim": "sticks and slips after a push to",
        "proved_speed": "proved without simulation from",
    }
    for name, text in names.items():
        if name in ds and (one or name != "proved_speed"):
            yield text, _speed(ds, name)
    if "squeal_frequency" in ds and float(ds.get("sliding_speed_lim", 0.0)) > 0.0:
        yield "frequency of the squeal", amounts_of(ds).frequency_and_ratio(float(ds["squeal_frequency"]))


def _speed(ds: "xr.Dataset", name: str) -> str:
    """A belt speed of an answer."""
    value, words = float(ds[name]), amounts_of(ds)
    if np.isinf(value):
        return "no speed" if name in ("wall_speed", "proved_speed") else "every speed"
    return words.speed(value, digits=DIGITS)


def _speed_labels() -> dict[str, Label]:
    return {
        name: Label(np.float64, f"{meaning}, over omega_1 P/k1", (), least=0.0, inf=True)
        for name, meaning in _SPEEDS.items()
    } | {
        in_si(name, "velocity"): Label(np.float64, meaning, (), least=0.0, inf=True, units="m s-1")
        for name, meaning in _SPEEDS.items()
    }  # fmt: skip


NO_SQUEAL = Question(
    name="no-squeal",
    title="Least belt speed without squeal",
    function=no_squeal,
    needed=(BETA,),
    optional=(MU,),
    labels={
        **_speed_labels(),
        "squeal_frequency": Label(
            np.float64, "frequency of the vibration that grows first, over omega_1", (), least=0.0, nan=True
        ),
        "squeal_frequency_Hz": Label(
            np.float64, "frequency of the vibration that grows first", (), least=0.0, nan=True, units="Hz"
        ),
        "speed_search": Label(np.float64, "belt speed, over omega_1 P/k1", ("speed_search",), least=0.0),
        "growth_of_speed": Label(
            np.float64,
            "growth rate of small vibrations about steady sliding, over omega_1",
            ("speed_search",),
        ),
    },
    rows=(_speed_rows,),
    sentences=(_sentence,),
    panels=("speeds",),
)
