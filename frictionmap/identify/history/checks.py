"""Records of any shape and their parameters, checked; records in which nothing slips are refused."""

from collections.abc import Mapping, Sequence

import numpy as np

from ... import checks
from ...errors import InputError
from ...units.table import MOTIONS, UNITS, units_of
from ..parameters import PARAMETERS, checked_free, is_elastic, refuse_mu
from ..signals.integration import derivative_order
from ..signals.samples import finite_numbers, within
from .drive import FORCE, Drive, gated
from .model import NAMED, NAMES, Measured

#: What can be fitted or held.
FITTABLE = NAMES[:NAMED]

#: What is fitted unless it is known or `free` names others.
_USUAL = ("f_n", "zeta", "x_F", "stiffness", "offset_x")
_HELD = {
    "mu": 1.0, "contact_stiffness": 0.0, "stiffness": 1.0, "offset_x": 0.0, "delay": 0.0, "gain": 1.0,
}  # fmt: skip

#: Fewest samples.
_SAMPLES = 30

#: Samples beyond which the covariance that noise of the drive makes takes too much memory.
MOST_WITH_NOISE = 5000

#: Standard deviations by which the variance of samples exceeds that of their noise where something moves.
_MOVES = 5.0


def size_of(unit: str) -> float:
    """Size of a unit of a motion in mm, mm/s, mm/s^2, or of a force in N."""
    of = UNITS[unit]
    return float(of.size * (1e3 if of.measures in MOTIONS else 1.0))


def order_of(unit: str) -> int:
    """Order of the derivative of a displacement that has this unit; FORCE of a force."""
    return FORCE if UNITS[unit].measures == "force" else derivative_order(unit)


def checked_measured(
    time: object, x: object, drive: object, units: tuple[str, str], place: tuple[str, str],
    gate: float | None, window: object, elastic: bool,
) -> Measured:  # fmt: skip
    """Samples within the window, in the units of the model.

    Parameters
    ----------
    time, x, drive : samples
    units : of the drive and of x
    place : contact, damping reference
    gate : below which a force is 0 [N]
    window : times, or None
    elastic : whether the contact has a spring
    """
    times = checks.axis(time, "time", least=-np.inf)
    is_force = order_of(units[0]) == FORCE
    name = "force" if is_force else "base"
    inside = within(window, times)
    channels = [
        finite_numbers(one, key, times.size, "time")[inside] for one, key in ((drive, name), (x, "x"))
    ]
    times = times[inside]
    if times.size < _SAMPLES:
        raise InputError(f"time must have at least {_SAMPLES} samples; got {times.size}")
    if np.ptp(channels[0]) == 0.0:
        raise InputError(f"{name} must move; got {channels[0][0]:g} in all samples")
    if gate is not None and not is_force:
        raise InputError("cannot use gate_N with a base motion: it is for forces; remove gate_N")
    values, noisy = gated(channels[0], None if gate is None else checks.number(gate, "gate_N", above=0.0))
    if not values.any():
        raise InputError(
            f"gate_N must be below the largest force, {np.abs(channels[0]).max():g}; got {gate:g}"
        )
    found = Drive(
        times, values * size_of(units[0]), order_of(units[0]), place[0] != "fixed-wall" and not is_force,
        place[1] == "base", noisy,
    )  # fmt: skip
    measured = Measured(found, times, channels[1] * size_of(units[1]), order_of(units[1]), elastic)
    _check_orders(measured, place)
    return measured


def _check_orders(given: Measured, place: tuple[str, str]) -> None:
    """Refuse drives whose displacement would be needed, but is not known."""
    drive = given.drive
    if drive.is_force:
        return
    if not drive.joined and drive.order:
        raise InputError(
            "base must be a displacement where the wall stands still; got a velocity or acceleration: "
            "integrate it first, or give contact = 'joined-base-wall' if the wall moves with the base"
        )
    if given.order < drive.order:
        raise InputError(
            "x must be measured as the base is, or as a higher derivative; got a base whose displacement is "
            "not known and the displacement or velocity of the mass in space"
        )
    if drive.order == 2 and place[1] == "ground":
        raise InputError(
            "damping_reference must be base if the base is measured as an acceleration: its velocity is not "
            "known; got 'ground'"
        )


def checked_reference(given: str | None, base_unit: str) -> str:
    """What the damper acts on; "base" for accelerations of a base, else "ground", unless it is given."""
    if given is None:
        return "base" if order_of(base_unit) == 2 else "ground"
    return checks.choice(given, "damping_reference", ("ground", "base"))


def checked_held(
    known: Mapping[str, float], free: Sequence[str] | None, units: tuple[str, str]
) -> tuple[np.ndarray, list[str], bool]:
    """Values of held parameters, NaN of fitted ones; the names of those shown; whether there is a spring."""
    values = {}
    for name, value in known.items():
        checks.choice(name, "known", FITTABLE)
        valid = {"above": 0.0} if name == "stiffness" else PARAMETERS[name].valid
        values[name] = checks.number(value, f"known.{name}", **valid)
    is_force, shows_place = order_of(units[0]) == FORCE, order_of(units[1]) == 0
    absent = [*(() if is_force else ("stiffness",)), *(() if shows_place else ("offset_x",))]
    fitted = checked_free(free, values, FITTABLE, optional=absent)
    usual = [name for name in _USUAL if name not in values and name not in absent]
    chosen = usual if fitted is None else list(fitted)
    elastic = is_elastic(chosen, values)
    if elastic:
        refuse_mu(chosen, values)
    for name in absent:
        if name in chosen:
            why = "x does not show where the mass rests" if name == "offset_x" else "it is for forces"
            raise InputError(f"cannot fit {name}: {why}; remove it from free")
    _check_channels(chosen, is_force, order_of(units[1]))
    for name in ("f_n", "zeta", "x_F"):
        if name not in chosen and name not in values:
            raise InputError(f"cannot hold {name}: its value is missing; add {name} to free or to known")
    held = [np.nan if name in chosen else values.get(name, _HELD.get(name, 0.0)) for name in FITTABLE]
    shown = [name for name in FITTABLE if name in chosen or name in values]
    if not is_force and "stiffness" in shown:
        shown.remove("stiffness")  # a scale of the friction force only
    return np.array([*held, np.nan, np.nan, np.nan if elastic else 0.0]), shown, elastic


def _check_channels(chosen: Sequence[str], is_force: bool, order: int) -> None:
    if "delay" in chosen and order == 2:
        raise InputError("cannot fit delay: accelerations jump; remove delay from free")
    if "gain" in chosen and "stiffness" in chosen and is_force:
        raise InputError(
            "cannot fit gain together with stiffness: the motion depends on their product only; hold one "
            "of them, known.gain or known.stiffness"
        )


def check_slips(given: Measured, held: np.ndarray, sigma_x: float | None) -> None:
    """Refuse a record in which nothing moves: there is a lower bound of the friction only."""
    if given.elastic:
        return
    drive, x = given.drive, given.x
    if drive.joined:
        if given.order != drive.order:
            return
        x = x - drive.values
    noise = float(np.std(np.diff(x)) / np.sqrt(2.0)) if sigma_x is None else sigma_x
    if float(np.var(x)) > noise**2 * (1.0 + _MOVES * np.sqrt(2.0 / x.size)):
        return
    half = 0.5 * float(np.ptp(drive.values))
    if drive.is_force:
        bound = f"mu F is at least {half:.4g} N, half the range of the force"
    elif drive.joined and drive.order < 2:
        raise InputError(
            "cannot fit x_F: nothing slips, x less the base is constant within its noise; move the base more"
        )
    elif drive.joined:
        bound = f"mu F over the mass is at least {1e-3 * half:.4g} m/s^2, half the range of the base"
    else:
        bound = f"mu x_F is at least {half:.4g} mm, half the range of the base"
    raise InputError(
        f"cannot fit x_F: nothing slips, x is constant within its noise; {bound}; "
        "increase the motion, or reduce the normal force"
    )


def checked_sigma(value: float | None, name: str, unit: str, least: bool) -> float | None:
    """A standard deviation in the units of the model; 0 if `least` allows it."""
    if value is None:
        return None
    valid: dict[str, float] = {"least": 0.0} if least else {"above": 0.0}
    return checks.number(value, name, **valid) * size_of(unit)


def check_unit(unit: str, name: str, *kinds: str) -> None:
    """Refuse a unit that is of none of the kinds."""
    valid = tuple(one for kind in kinds for one in units_of(kind))
    checks.choice(unit, name, valid)
