"""The engine of systems that change with r: belts of constant speed, shakers of constant acceleration.

At every frequency it is the general engine with the system of that frequency, `System.at_frequency`.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from .. import checks
from ..errors import InputError
from ..jobs import Job, Progress, Watch, run_jobs
from ..model.settings import CurveSettings, Solver
from ..model.sizes import Sizes, Wanted
from .general import GeneralEngine
from .interface import Limits, Motion

if TYPE_CHECKING:
    import xarray as xr

    from ..single.points import States

T = TypeVar("T")


def _joined(parts: Sequence["xr.Dataset"], r: np.ndarray) -> "xr.Dataset":
    """Datasets of single frequencies in one; NaN where a variable with r is not there at some."""
    import xarray as xr

    template = {str(name): one for part in reversed(parts) for name, one in part.variables.items()}
    found = {}
    for name, one in template.items():
        if name == "r" or "r" not in one.dims:
            continue
        along = one.dims.index("r")
        rows = [
            part.variables[name].values if name in part.variables else one.values * np.nan for part in parts
        ]
        found[name] = xr.Variable(one.dims, np.concatenate(rows, axis=along), one.attrs)
    rest = {name: one for name, one in template.items() if "r" not in one.dims}
    coords = {name: one for name, one in (rest | found).items() if any(name in part.coords for part in parts)}
    values = {name: one for name, one in (rest | found).items() if name not in coords}
    coords["r"] = xr.Variable(("r",), r, template["r"].attrs)
    return xr.Dataset(values, coords, parts[0].attrs)


class VaryingEngine(GeneralEngine):
    """Another system of the general engine at every frequency."""

    def _at(self, r: float) -> GeneralEngine:
        return GeneralEngine(self.system.at_frequency(self._checked(r)))

    def _checked(self, r: float) -> float:
        if r <= 0.0:
            raise InputError(
                "r",
                f"must be > 0 for a wall_speed or a constant acceleration of the base, which have no limit "
                f"at r = 0; got {r:g}",
            )
        return float(r)

    def _each(self, r: np.ndarray, ask: Callable[[GeneralEngine, np.ndarray], T]) -> list[T]:
        return [ask(self._at(one), np.array([one])) for one in r]

    def _on_threads(
        self, r: np.ndarray, ask: Callable[[GeneralEngine, np.ndarray], T], threads: int | None,
        progress: Progress | None, watch: Watch | None,
    ) -> list[T]:  # fmt: skip
        """Answers at all frequencies, each on one thread."""
        found: dict[int, T] = {}
        engines = [self._at(one) for one in r]

        def answer(k: int) -> None:
            found[k] = ask(engines[k], r[k : k + 1])

        def done(_: int) -> None:
            if progress is not None:
                progress(len(found), r.size)

        jobs: list[Job] = [(answer, (k,)) for k in range(r.size)]
        run_jobs(jobs, checks.threads(threads), done, watch)
        return [found[k] for k in range(r.size)]

    def needed_friction(self, r: np.ndarray) -> np.ndarray:
        return np.concatenate(self._each(r, lambda engine, one: engine.needed_friction(one)))

    def no_stop_limit(self, r: np.ndarray, mu: float, watch: Watch | None) -> np.ndarray:
        return np.concatenate(self._each(r, lambda engine, one: engine.no_stop_limit(one, mu, watch)))

    def limits(self, r: np.ndarray, mu: np.ndarray, watch: Watch | None = None) -> Limits:
        return _joined_limits(self._each(r, lambda engine, one: engine.limits(one, mu, watch)))

    def known_limits(self, r: np.ndarray, mu: np.ndarray) -> Limits:
        return _joined_limits(self._each(r, lambda engine, one: engine.known_limits(one, mu)))

    def boundaries(self, r: np.ndarray, mu: np.ndarray) -> "xr.Dataset":
        return _joined(self._each(r, lambda engine, one: engine.boundaries(one, mu)), r)

    def map(
        self, axes: Mapping[str, np.ndarray], solver: Solver, threads: int | None, progress: Progress | None,
        watch: Watch | None = None,
    ) -> "xr.Dataset":  # fmt: skip
        def ask(engine: GeneralEngine, one: np.ndarray) -> "xr.Dataset":
            return engine.map({**axes, "r": one}, solver, 1, None)

        return _joined(self._on_threads(axes["r"], ask, threads, progress, watch), axes["r"])

    def cells(
        self, axes: Mapping[str, np.ndarray], names: Sequence[str], solver: Solver, threads: int | None,
        progress: Progress | None, watch: Watch | None, searched: bool = True,
    ) -> tuple[dict[str, np.ndarray], Limits]:  # fmt: skip
        def ask(engine: GeneralEngine, one: np.ndarray) -> tuple[dict[str, np.ndarray], Limits]:
            return engine.cells({**axes, "r": one}, names, solver, 1, None, None, searched)

        parts = self._on_threads(axes["r"], ask, threads, progress, watch)
        cells = {name: np.concatenate([part[name] for part, _ in parts], axis=1) for name in parts[0][0]}
        return cells, _joined_limits([limits for _, limits in parts])

    def curves(
        self, axes: Mapping[str, np.ndarray], solver: Solver, asked: CurveSettings, threads: int | None,
        progress: Progress | None, watch: Watch | None = None,
    ) -> "xr.Dataset":  # fmt: skip
        def ask(engine: GeneralEngine, one: np.ndarray) -> "xr.Dataset":
            return engine.curves({**axes, "r": one}, solver, asked, 1, None)

        return _joined(self._on_threads(axes["r"], ask, threads, progress, watch), axes["r"])

    def motion(self, r: float, beta: float, mu: float, solver: Solver, points: int) -> "xr.Dataset":
        return self._at(r).motion(r, beta, mu, solver, points)

    def traced(self, r: float, beta: float, mu: float, solver: Solver, points: int) -> Motion:
        return self._at(r).traced(r, beta, mu, solver, points)

    def sizes_on_grid(
        self, wanted: Wanted, axes: dict[str, np.ndarray], solver: Solver, threads: int, watch: Watch | None
    ) -> Sizes:
        def ask(engine: GeneralEngine, one: np.ndarray) -> Sizes:
            return engine.sizes_on_grid(wanted, {**axes, "r": one}, solver, 1, None)

        return _joined_arrays(self._on_threads(axes["r"], ask, threads, None, watch))

    def sizes_at(
        self, wanted: Wanted, r: np.ndarray, beta: np.ndarray, mu: float, solver: Solver, threads: int,
        watch: Watch | None,
    ) -> Sizes:  # fmt: skip
        places, of_place = np.unique(r, return_inverse=True)

        def ask(engine: GeneralEngine, one: np.ndarray) -> Sizes:
            own = beta[r == one[0]]
            return engine.sizes_at(wanted, np.full(own.size, one[0]), own, mu, solver, 1, None)

        found = _joined_arrays(self._on_threads(places, ask, threads, None, watch))
        order = np.argsort(of_place, kind="stable")  # the points of one place follow each other in `found`
        back = np.empty_like(order)
        back[order] = np.arange(order.size)
        return Sizes(*(values[back] for values in found))

    def states(self, r: np.ndarray, beta: np.ndarray, mu: float) -> "list[States]":
        from ..single.points import States

        parts = [self._at(one).states(r[k : k + 1], beta[k : k + 1], mu)[0] for k, one in enumerate(r)]
        return [States(*(np.concatenate(values) for values in zip(*parts, strict=True)))]


def _joined_arrays(parts: Sequence[Sizes]) -> Sizes:
    return Sizes(*(np.concatenate(values) for values in zip(*parts, strict=True)))


def _joined_limits(parts: Sequence[Limits]) -> Limits:
    found: list[Any] = [np.concatenate(values, axis=1) for values in zip(*parts, strict=True)]
    return Limits(*found)
