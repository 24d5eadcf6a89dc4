"""Short texts of settings: what they differ in from their defaults."""

from collections.abc import Mapping
from dataclasses import MISSING, fields
from typing import Any


class Shown:
    """A dataclass whose text holds its class and the fields that are not as by default."""

    def __repr__(self) -> str:
        filled = self._filled()
        shown = []
        for one in fields(self):  # type: ignore[arg-type]  # it is mixed into dataclasses
            value = getattr(self, one.name)
            if one.repr and not any(_equal(value, other) for other in (_default(one), filled.get(one.name))):
                shown.append(f"{one.name}={_short(value)}")
        return f"{type(self).__name__}({', '.join(shown)})"

    def _filled(self) -> Mapping[str, object]:
        """What stands in fields for which nothing was given, where it is not their default."""
        return {}


def _equal(value: object, other: object) -> bool:
    return value is other or (type(value) is type(other) and bool(value == other))


def _default(one: Any) -> object:
    return one.default if one.default_factory is MISSING else one.default_factory()


def _short(value: object) -> str:
    """One line, at most a hundred characters."""
    text = " ".join(repr(value).split())
    return text if len(text) <= 100 else f"{text[:96]} ..."
