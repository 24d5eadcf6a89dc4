"""Names of parameters to fit, and of those to hold."""

from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple

from .. import checks
from ..errors import InputError

#: The stiffness of a spring in the contact, over k1: fitted on request only, by default the contact is rigid.
CONTACT_STIFFNESS = "contact_stiffness"

#: Compliances between which motions are computed: a stiffer spring counts as rigid, a softer one as none.
STIFFEST, SOFTEST = 1e-4, 1e3

#: How channels may differ, and what is held unless that is fitted: they are alike.
ALIKE = {"delay": 0.0, "gain": 1.0}
CHANNELS = tuple(ALIKE)

#: Where and when a decay starts, and the zero of its signal: fitted unless they are known, named or not.
OF_START = ("X0", "t0", "centre", "offset")


class Parameter(NamedTuple):
    """A number that may be known."""

    meaning: str  # in words, with the unit, as a key of [known]
    example: str
    unit: str = ""  # of the key; lengths elsewhere are in the unit of the data
    valid: Mapping[str, float] = {}  # range, as `checks.number` takes it


#: What may be known of one mass, or of a structure with friction.
PARAMETERS = {
    "f_n": Parameter("natural frequency, Hz", "3.12", "Hz", {"above": 0.0}),
    "zeta": Parameter(
        "viscous damping ratio", "0.01", valid={"least": 0.0, "most": checks.LARGEST_DAMPING}
    ),
    "beta": Parameter("friction ratio of all sets", "0.2", valid={"least": 0.0}),
    "mu": Parameter("static over kinetic friction force, >= 1", "1.0", valid={"least": 1.0}),
    CONTACT_STIFFNESS: Parameter(
        "stiffness of a spring in the contact over k1; default: rigid", "3.0",
        valid={"least": 1.0 / SOFTEST, "most": 1.0 / STIFFEST},
    ),
    "delay": Parameter(
        "time by which masses are measured later than the base or load; default: 0, s", "0.002", "s"
    ),
    "gain": Parameter(
        "gain of the channels of masses over that of the base or load; default: 1", "1.02",
        valid={"above": 0.0},
    ),
    "x_F": Parameter("kinetic friction force over stiffness, mm", "0.2", "mm", {"least": 0.0}),
    "X0": Parameter("amplitude at t0, mm", "9.5", "mm"),
    "t0": Parameter("time of the first turning point, s", "0.0", "s"),
    "centre": Parameter("position of the unloaded mass, mm", "0.0", "mm"),
    "drift": Parameter("drift of the place of the unloaded mass, mm/s", "0.0", "mm/s"),
    "offset": Parameter(
        "zero of a decay that was measured as anything but a displacement, in the unit of its column", "0.0"
    ),
    "offset_x": Parameter("position of the unloaded mass for zero base displacement, mm", "0.0", "mm"),
}  # fmt: skip


def unit_of(name: str, length: str, column: str = "") -> str:
    """Unit of a parameter in a dataset, "1" if it has none, with lengths in the unit of the data.

    column : unit of the data, if it is not that of lengths
    """
    of_column = {"offset": column, "drift": f"{column}/s" if column else ""}
    return of_column.get(name) or PARAMETERS[name].unit.replace("mm", length) or "1"


def checked_known(known: Mapping[str, float], valid: Sequence[str]) -> dict[str, float]:
    """Parameters to be held, if they are known by name and in range; the compliance of a spring."""
    found = {}
    for name, value in known.items():
        checks.choice(name, "known", tuple(valid))
        number = checks.number(value, f"known.{name}", **PARAMETERS[name].valid)
        found[name] = 1.0 / number if name == CONTACT_STIFFNESS else number
    return found


def checked_free(
    free: object,
    known: Collection[str],
    parameters: Sequence[str],
    file: bool = False,
    optional: Collection[str] = (),
) -> tuple[str, ...] | None:
    """Check a list of the parameters to fit: exactly those that are not known.

    Of a contact with a spring mu is 1; of one without a spring there is no contact stiffness: neither must be
    listed then.

    parameters : that can be fitted
    file : whether they are keys of a configuration, fit.free and [known]
    optional : parameters that may be in neither list, beside those of contacts and channels

    Raises
    ------
    InputError
        It is no list of them, or a parameter is in both lists or in neither.
    """
    if free is None:
        return None
    option, table = ("fit.free", "[known]") if file else ("free", "known")
    if not isinstance(free, Sequence) or isinstance(free, str) or not free:
        raise InputError(f"{option} must be a list of parameters; got {checks.one_line(free)}")
    for index, name in enumerate(free):
        checks.choice(name, f"{option}[{index}]", tuple(parameters))
    for name in parameters:
        if name in free and name in known:
            raise InputError(f"cannot fit {name}: {table} holds it; remove it from {option} or from {table}")
        if name not in (*free, *known, *optional, *_optional((*free, *known))):
            key = f"known.{name} to [known]" if file else "to known"
            raise InputError(f"cannot hold {name}: its value is missing; add {name} to {option} or {key}")
    return tuple(free)


def is_elastic(free: Collection[str] | None, known: Collection[str]) -> bool:
    """Whether the contact has a spring, whose stiffness is fitted or known."""
    return CONTACT_STIFFNESS in (free or ()) or CONTACT_STIFFNESS in known


def refuse_mu(free: Collection[str] | None, known: dict[str, float]) -> None:
    """Refuse static friction above the kinetic one for a contact with a spring."""
    if "mu" in (free or ()):
        raise InputError(
            "cannot fit mu together with contact_stiffness: a contact with a spring is defined for mu = 1 "
            "only; remove mu from free"
        )
    if known.get("mu", 1.0) != 1.0:
        raise InputError(
            f"mu must be 1 for a contact with a spring, which would jump at break-away; got {known['mu']:g}"
        )


def _optional(named: Collection[str]) -> tuple[str, ...]:
    """Parameters that need not be named: of the other kind of contact, of unlike channels, of the start."""
    return (*CHANNELS, *OF_START, CONTACT_STIFFNESS, *(("mu",) if CONTACT_STIFFNESS in named else ()))
