"""Names of parameters to fit, and of those to hold."""

from collections.abc import Collection, Sequence

from .. import checks
from ..errors import InputError

#: The stiffness of a spring in the contact, over k1: fitted on request only, by default the contact is rigid.
CONTACT_STIFFNESS = "contact_stiffness"


#: How channels may differ, and what is held unless that is fitted: they are alike.
ALIKE = {"delay": 0.0, "gain": 1.0}
CHANNELS = tuple(ALIKE)


def checked_free(
    free: object, known: Collection[str], parameters: Sequence[str], file: bool = False
) -> tuple[str, ...] | None:
    """Check a list of the parameters to fit: exactly those that are not known.

    Of a contact with a spring mu is 1; of one without a spring there is no contact stiffness: neither must be
    listed then.

    parameters : that can be fitted
    file : whether they are keys of a configuration, fit.free and [known]

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
        if name not in free and name not in known and name not in _optional((*free, *known)):
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
    """Parameters that are neither fitted nor held: of the other kind of contact, or of unlike channels."""
    return (*CHANNELS, CONTACT_STIFFNESS, *(("mu",) if CONTACT_STIFFNESS in named else ()))
