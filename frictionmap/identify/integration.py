"""Displacements from velocities and accelerations, harmonic by harmonic: X = V/(i omega) = -A/omega^2."""

import numpy as np

from ..units.table import COLUMN_UNITS, derivative_order


def amplitude_factors(unit: str, into: str, frequency: np.ndarray) -> np.ndarray:
    """What amplitudes of one harmonic are multiplied by to be those of its displacement, (k,).

    unit : of a displacement, velocity or acceleration, as names of columns end
    into : a unit of length
    frequency : (k,) of the harmonic [Hz]
    """
    size = float(COLUMN_UNITS[unit].size / COLUMN_UNITS[into].size)
    return size / (2.0 * np.pi * np.asarray(frequency, dtype=float)) ** derivative_order(unit)
