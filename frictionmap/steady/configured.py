"""A configuration in the place of a system and its axes: `fm.sweep(fm.load_config("map.toml"))`."""

from typing import Any, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from .. import checks
from ..errors import InputError
from ..model.settings import CurveSettings, Solver
from ..model.system import System
from ..model.variations import Variations
from ..units.scales import Units


@runtime_checkable
class Configured(Protocol):
    """What `load_config` returns: a system with its axes and settings."""

    @property
    def system(self) -> System: ...
    @property
    def r(self) -> np.ndarray: ...
    @property
    def beta(self) -> np.ndarray: ...
    @property
    def mu(self) -> np.ndarray: ...
    @property
    def solver(self) -> Solver: ...
    @property
    def curves(self) -> CurveSettings: ...
    @property
    def variations(self) -> Variations | None: ...
    @property
    def units(self) -> Units | None: ...
    @property
    def wall_speed(self) -> np.ndarray | None: ...
    def refuse_belt(self, what: str) -> None: ...


class Asked(NamedTuple):
    """A system with its axes; what is given to a function replaces what stands in a configuration."""

    system: System
    r: ArrayLike
    beta: ArrayLike
    mu: ArrayLike
    units: Units | None
    config: Configured | None


def system_and_axes(
    system: System | Configured, r: ArrayLike | None, beta: ArrayLike | None, mu: ArrayLike | None,
    units: Units | None, needs: tuple[str, ...] = ("r", "beta"),
) -> Asked:  # fmt: skip
    """A system with its axes, from arguments or a configuration.

    Raises
    ------
    InputError
        Neither a system nor a configuration is given, or a system without its axes.
    """
    if not isinstance(system, System) and isinstance(system, Configured):
        config = system
        if "r" in needs:
            config.refuse_belt("compute this")
        return Asked(
            config.system,
            config.r if r is None else r,
            config.beta if beta is None else beta,
            config.mu if mu is None else mu,
            config.units if units is None else units,
            config,
        )
    checks.instance(system, "system", System)
    for name, value in (("r", r), ("beta", beta)):
        if value is None and name in needs:
            raise InputError(name, "must be given with a system, such as [0.5, 1.0]; got nothing")
    return Asked(system, r, beta, 1.0 if mu is None else mu, units, None)  # type: ignore[arg-type]


def belt_speeds(system: object, wall_speed: Any, r: object) -> Any:
    """Belt speeds in the place of r, from an argument or a configuration; None under a load.

    Raises
    ------
    InputError
        Both are given.
    """
    own = getattr(system, "wall_speed", None) if not isinstance(system, System) else None
    found = own if wall_speed is None else wall_speed
    if found is not None and r is not None:
        raise InputError("cannot use", "r", "with wall_speed: there is no load; omit one of them")
    return found
