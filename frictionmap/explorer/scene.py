"""Subject of a page: system, initial view, parameters that can be changed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from .. import checks
from ..errors import InputError
from ..model.settings import Solver, Start
from ..model.system import System
from ..model.variations import named_number
from ..units.axes import KINDS, ratios, require
from ..units.scales import Units, scales_of
from .contacts import contacts_of, is_placed, put_contact
from .law_numbers import is_of_law, put_law_number
from .scene_parts import BELT_SPEED, FREQUENCY, Contact, Slider
from .sliders import is_of_belt, sliders_of

if TYPE_CHECKING:
    from ..files.config import Config

#: Systems that are kept: a slider that is moved to and fro comes back to them.
_KEPT = 32


@dataclass(frozen=True)
class Scene:
    """Subject of a page: system, initial view, settings."""

    title: str
    system: System
    r: tuple[float, float]
    beta: tuple[float, float]
    mu: float
    solver: Solver
    config: "Config | None" = None
    units: Units | None = None
    unloaded: bool = False  # on a belt, without a load: `r` is the range of belt speeds

    def __post_init__(self) -> None:
        if not self.system.contact_system.count:
            raise InputError(
                "cannot show a page of a system without contacts: its maps are over the friction in them; "
                "use frictionmap curves"
            )
        if self.unloaded:
            from ..no_load.sweep import checked  # xarray takes long to import, and other pages need none

            checked(self.system, self.r[1], self.beta, self.mu, self.units)
        object.__setattr__(self, "changed", lru_cache(_KEPT)(self._changed))

    @property
    def files(self) -> Sequence[Path]:
        """Files from which it was read."""
        return () if self.config is None else self.config.files

    @property
    def sliders(self) -> tuple[Slider, ...]:
        """Numbers that can be changed by sliders."""
        found = sliders_of(self.system, self.mu)
        return found if not self.unloaded else tuple(one for one in found if not is_of_belt(one.key))

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """Contacts to choose from, that of the system first."""
        found = contacts_of(self.system)
        return found[:1] if self.unloaded and is_placed(self.system) else found

    def _changed(self, contact: str, numbers: tuple[tuple[str, float], ...]) -> System:
        """Change the contact and numbers of the system; contact "": unchanged.

        Raises
        ------
        InputError
            A key is unknown, or there is no such system.
        """
        system = put_contact(self.system, contact) if contact else self.system
        changed: dict[str, Any] = {}
        for text, value in numbers:
            if is_of_law(text):
                changed["contacts"] = put_law_number(changed.get("contacts", system.contacts), text, value)
                continue
            number = named_number(text, "slider")
            before = changed.get(number.key, getattr(system, number.key))
            changed[number.key] = number.put_into(before, value)
        return replace(system, **changed)  # at once: one alone may make no sense

    changed: Any = None  # `_changed`, with what it found kept


def _ends(values: Any) -> tuple[float, float]:
    """Range of an axis; around the value if there is only one."""
    first, last = float(values[0]), float(values[-1])
    return (first, last) if last > first else (0.5 * first, 1.5 * first or 1.0)


def scene_of(config: "Config") -> Scene:
    """Make the scene of a configuration, with the first point of further axes and the first mu."""
    system, mu = config.system, float(config.mu[0])
    if config.wall_speed is not None:
        ends = (_ends(config.wall_speed), _ends(config.beta))
        return Scene(config.title, system, *ends, mu, config.solver, config, config.units, unloaded=True)
    if config.variations is not None:
        system = config.variations.at([0] * len(config.variations.axes))
    ends = (_ends(config.r), _ends(config.beta))
    return Scene(config.title, system, *ends, mu, config.solver, config, config.units)


def checked_range(values: object, name: str) -> tuple[float, float]:
    """The two ends of a range of r or beta."""
    most = checks.LARGEST_RATIO if name == "r" else float("inf")
    ends = checks.axis(values, name, least=0.0, most=most)
    if ends.size < 2:
        raise InputError(f"{name} must be a range of two numbers, or more; got {ends.size}")
    return float(ends[0]), float(ends[-1])


def scene_of_system(
    system: System, r: object, beta: object, mu: object, start: object, title: object, units: Units | None,
    *, unloaded: bool = False,
) -> Scene:  # fmt: skip
    """Make the scene of a system, from checked arguments."""
    checks.instance(system, "system", System)
    if not isinstance(title, str):
        raise InputError("title", f"must be text; got {checks.one_line(title)}")
    checks.choice(start, "start", get_args(Start))
    mu = checks.number(mu, "mu", least=1.0)
    scales = scales_of(units, system)  # they may not go with it
    settings: Mapping[str, Any] = {"start": start}
    across = BELT_SPEED if unloaded else FREQUENCY
    kinds = {across.key: (across.measure, r), "beta": (KINDS["beta"], beta)}
    require(scales, **kinds)
    ends = [checked_range(ratios(one, name, kind, scales), name) for name, (kind, one) in kinds.items()]
    if not unloaded:
        system.costs(np.array(ends[0]))
    return Scene(title, system, ends[0], ends[1], mu, Solver(**settings), units=units, unloaded=unloaded)
