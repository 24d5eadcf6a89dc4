"""Numbers of friction over speed that a slider changes: how far it falls, and how it rises beyond."""

import re
from collections.abc import Sequence
from dataclasses import replace

from ..errors import InputError
from ..model.contact import Contact
from ..model.friction_law import FrictionLaw, formula_law

#: Numbers of a law: of a formula, and of break points.
OF_FORMULA, OF_POINTS = ("kinetic", "speed", "viscous"), ("last", "slope")

_KEY = re.compile(rf"contacts\[([1-9][0-9]*)\]\.law\.({'|'.join((*OF_FORMULA, *OF_POINTS))})")


def is_of_law(key: str) -> bool:
    """Whether a key names a number of a law."""
    return _KEY.fullmatch(key) is not None


def numbers_of_law(law: FrictionLaw) -> dict[str, float]:
    """The numbers that can be changed: those of the formula; else the friction at the last break point over
    that at speed 0, where it differs from it, and the slope beyond.
    """
    if law.curve is not None:
        return {name: getattr(law.curve, name) for name in OF_FORMULA}
    last = {"last": law.factor[-1]} if law.factor[-1] != 1.0 else {}
    return {**last, "slope": law.slope}


def put_law_number(contacts: Sequence[Contact] | None, key: str, value: float) -> list[Contact]:
    """The contacts with this number of a law changed.

    Raises
    ------
    InputError
        The number is out of range.
    """
    matched = _KEY.fullmatch(key)
    assert matched is not None
    found, k = list(contacts or ()), int(matched[1]) - 1
    law = found[k].law
    try:
        changed = _changed(law, matched[2], value)
    except InputError as error:
        raise error.renamed(key) from None
    if changed.is_flat:
        raise InputError(f"{key} must leave friction that depends on the speed; got {value:g}")
    found[k] = replace(found[k], law=changed)
    return found


def _changed(law: FrictionLaw, name: str, value: float) -> FrictionLaw:
    if law.curve is not None:
        return formula_law(**{**law.curve._asdict(), name: value})
    if name == "slope":
        return replace(law, slope=value)
    share = (value - 1.0) / (law.factor[-1] - 1.0)  # all break points keep their shares of the fall
    factor = [1.0 + share * (one - 1.0) for one in law.factor[:-1]]
    return replace(law, factor=(*factor, value))
