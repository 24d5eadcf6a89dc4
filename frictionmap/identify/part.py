"""A measurement as a part of a joint fit: a problem of its own, some of whose parameters are shared.

All parts have f_n, zeta and mu in common.  Residuals of a part are divided by the standard deviation of its
noise.  A kind of measurement becomes a part by a function that returns a `Part`, or an instance of a class
derived from it where more than its defaults is known: see `decay.part` and `time_series.part`.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import xarray as xr

from .statistics.least_squares import Problem, Residuals

#: What all parts share, in this order; (mu - 1)^2 stands for mu in the fit.
SHARED = ("f_n", "zeta", "mu")


class Settings(NamedTuple):
    """What holds for all parts of a fit."""

    unit: str  # of lengths
    contact: str
    damping_reference: str
    known: Mapping[str, float]  # parameters that are held
    loss: str


@dataclass(frozen=True)
class Part:
    """A measurement that does not depend on mu, and whose noise is known."""

    label: str
    names: tuple[str, ...]  # of its parameters; further ones belong to drift and wander
    problem: Problem  # in its own parameters
    start: np.ndarray
    sigma: float  # standard deviation of the noise by which its residuals are divided
    freedom: int  # degrees of freedom by which that is known
    time: np.ndarray  # s, of the samples
    data: np.ndarray
    plain: Residuals  # fitted less measured, each sample with its full weight
    cautions: tuple[str, ...] = ()  # about the data

    #: Residuals at the harmonics of a base, over the noise beside them; 1 if due to chance.
    model_error: float = 1.0

    @property
    def leads(self) -> bool:
        """Whether f_n and zeta of this part alone are good starting values for all."""
        return True

    @property
    def own(self) -> list[int]:
        """Places of the parameters that are not shared."""
        return [k for k in range(self.start.size) if k >= len(self.names) or self.names[k] not in SHARED]

    def measured_again(self, values: np.ndarray) -> "Part":
        """The part with the noise that its residuals show at some values of its parameters."""
        return self

    def with_shared(self, shared: Mapping[str, float], known: Mapping[str, float]) -> "Part":
        """The part, fitted alone again with other values of f_n and zeta if that changes its start."""
        return self

    def residual(self, values: np.ndarray) -> np.ndarray:
        """Fitted less measured at some values of its parameters, in the unit of the data."""
        return self.plain(values)[0]

    def stops(self, values: np.ndarray) -> int | None:
        """Stops per cycle of the motion that is fitted; None if that does not depend on mu."""
        return None

    def data_warnings(self, unit: str) -> list[str]:
        """Warnings about the data, whose lengths are in `unit`."""
        return list(self.cautions)

    def variables(self, values: np.ndarray) -> dict[str, xr.Variable]:
        """Further results at some values of its parameters, to be named by the label."""
        return {}
