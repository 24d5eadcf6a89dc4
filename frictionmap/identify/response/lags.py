"""Friction ratios from single lags of a table, and lags that no friction gives."""

import numpy as np
import xarray as xr

from ...errors import InputError
from ...model.system import System
from ..statistics.estimates import flags
from .data import ForcedTable, most_beyond
from .fit import TableFit
from .model import DELAY, F_N, GAIN, ZETA, Samples, corrected
from .phase_inversion import MEANINGS, distance_from_range, invert

#: Code of samples that are no lags, after those of `MEANINGS`.
_NO_LAG = len(MEANINGS)


def impossible(table: ForcedTable, system: System, f_n: float) -> np.ndarray:
    """Samples, by index, that are lags of one mass further off all that friction gives than their errors."""
    if system.n > 1:
        return np.empty(0, dtype=int)
    samples = table.samples
    which = np.flatnonzero(samples.is_phase)
    off = distance_from_range(system, table.rows.frequency[samples.row[which]] / f_n, samples.value[which])
    return which[off > most_beyond(table)[which]]


def refuse_impossible(table: ForcedTable, system: System, f_n: float, sample: int) -> None:
    """Name a lag that no friction gives."""
    row = table.samples.row[sample : sample + 1]
    lag = table.samples.value[sample : sample + 1]
    inverted = invert(system, table.rows.frequency[row] / f_n, lag, np.zeros(1, dtype=int))[0]
    raise InputError(
        f"cannot fit the lag in row {int(row[0]) + 1}: {inverted.reason}; "
        'use unreachable = "drop" to ignore such lags'
    )


def without(table: ForcedTable, samples: np.ndarray) -> ForcedTable:
    """The table without some samples."""
    kept = np.delete(np.arange(table.samples.row.size), samples)
    return table._replace(samples=Samples(*(part[kept] for part in table.samples)))


def friction_ratios(fit: TableFit) -> dict[str, xr.Variable]:
    """Friction ratios from single lags, at the frequency and damping that were fitted, mu = 1."""
    values = fit.solution.values
    samples = corrected(fit.model, float(values[DELAY]), float(values[GAIN])).samples
    lags = np.flatnonzero(samples.is_phase)
    r = fit.model.rows.frequency[samples.row[lags]] / values[F_N]
    inversions = invert(fit.model.with_zeta(float(values[ZETA])), r, samples.value[lags], samples.mass[lags])
    status = np.full(samples.row.size, _NO_LAG, dtype=np.int8)
    status[lags] = [one.code for one in inversions]
    attributes = {"long_name": "friction ratios that follow from the lag", **flags((*MEANINGS, "no_lag"))}
    found = {"lag_status": xr.Variable("sample", status, attributes)}
    counts = [len(one.beta) for one in inversions]
    if sum(counts):
        beta, slope = (
            np.concatenate([getattr(one, name) for one in inversions]) for name in ("beta", "slope")
        )
        sample = np.repeat(lags, counts)
        error = np.degrees(samples.sigma[sample]) / np.abs(slope)
        found |= {
            "lag_sample": xr.Variable("answer", sample, {"long_name": "sample of the lag", "units": "1"}),
            "lag_friction_ratio": xr.Variable(
                "answer", beta, {"long_name": "friction ratio of this row that gives the lag", "units": "1"}
            ),
            "lag_friction_ratio_error": xr.Variable(
                "answer", error, {"long_name": "its standard error, to first order", "units": "1"}
            ),
        }
    return found
