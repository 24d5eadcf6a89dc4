"""What drives a mass: samples of a base or force, the spline through them, and how it moves the mass."""

from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

#: Share of the sampling rate from which a record of a base or force is noise only.
_ABOVE_BAND = 0.4

#: Median of the squared modulus of a spectral line of noise, over its mean.
_MEDIAN = float(np.log(2.0))

#: Columns of the derivatives by samples of the drive that are made at a time: a few megabytes.
BLOCK = 128

FORCE = -1  # in place of the order of a derivative


class Drive(NamedTuple):
    """A measured base or force."""

    time: np.ndarray  # (n,)
    values: np.ndarray  # (n,) in mm, mm/s, mm/s^2 or N
    order: int  # of the derivative of the displacement of the base, or FORCE
    joined: bool  # the mass rubs on the base, and u is relative to it
    damping_by_base: bool  # the damper acts on the velocity relative to the base
    noisy: np.ndarray  # (n,) bool: samples with noise; others are known to be 0

    @property
    def is_force(self) -> bool:
        """Whether it is a force on the mass."""
        return self.order == FORCE

    def forms(self, w: float, zeta: float) -> np.ndarray:
        """What factors the drive, its first and its second derivative have in the load, (3, 3).

        Columns: values, derivatives by w and by zeta.
        """
        square, damping = np.array([w * w, 2.0 * w, 0.0]), np.array([2.0 * zeta * w, 2.0 * zeta, 2.0 * w])
        result = np.zeros((3, 3))
        if self.is_force or not self.joined:
            result[0] = square
            if self.damping_by_base and not self.is_force:
                result[1] = damping
            return result
        result[2 - self.order, 0] = -1.0
        if not self.damping_by_base and self.order < 2:
            result[1 - self.order] -= damping
        return result


class Pieces(NamedTuple):
    """Intervals between samples of the drive, divided where the mass was sampled."""

    lengths: np.ndarray  # (m,)
    interval: np.ndarray  # (m,) of the drive
    shift: np.ndarray  # (m, 4, 4) from coefficients of the interval to those of the piece
    places: np.ndarray  # of samples of the mass, among the m + 1 ends of pieces


def gated(force: np.ndarray, gate: float | None) -> tuple[np.ndarray, np.ndarray]:
    """A force that is 0 outside its pulses, and which samples are in a pulse.

    A pulse reaches from the last sample below the gate before it to the first one after it.
    """
    if gate is None:
        return force, np.ones(force.size, dtype=bool)
    inside = np.abs(force) >= gate
    return np.where(inside, force, 0.0), inside


def noise_above_band(values: np.ndarray) -> float:
    """Standard deviation of the noise of a record, from its spectrum above its band."""
    window = np.hanning(values.size)
    line = np.linspace(-1.0, 1.0, values.size)
    flat = values - np.polynomial.Polynomial.fit(line, values, 1)(line)
    power = np.abs(np.fft.rfft(window * flat)) ** 2 / float(window @ window)
    high = power[int(2.0 * _ABOVE_BAND * power.size) :]
    return float(np.sqrt(np.median(high) / _MEDIAN))


def coefficients(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Cubic pieces by powers of the share of the interval, shape (n - 1, 4, ...).

    The ends are those of a record, not of a motion: no slope or curvature is imposed there.
    """
    found = CubicSpline(time, values, axis=0).c[::-1]
    lengths = np.diff(time).reshape((-1,) + (1,) * (values.ndim - 1))
    powers = np.stack([lengths**k for k in range(4)])
    return np.moveaxis(found * powers, 0, 1)


def pieces(drive: np.ndarray, wanted: np.ndarray) -> Pieces:
    """Divide intervals between times `drive` at the times `wanted`, which lie within."""
    every = np.union1d(drive, wanted)
    interval = np.clip(np.searchsorted(drive, every[:-1], side="right") - 1, 0, drive.size - 2)
    whole = np.diff(drive)[interval]
    begin, share = (every[:-1] - drive[interval]) / whole, np.diff(every) / whole
    shift = np.zeros((interval.size, 4, 4))
    binomial = ((1, 1, 1, 1), (0, 1, 2, 3), (0, 0, 1, 3), (0, 0, 0, 1))
    for to in range(4):
        for of in range(to, 4):
            shift[:, to, of] = binomial[to][of] * begin ** (of - to) * share**to
    return Pieces(np.diff(every), interval, shift, np.searchsorted(every, wanted))


def shifted(of: Pieces, found: np.ndarray) -> np.ndarray:
    """Coefficients of pieces, (m, 4, ...), from those of intervals."""
    if of.lengths.size == found.shape[0]:
        return found
    return np.einsum("kij,kj...->ki...", of.shift, found[of.interval])


def derivative_at(found: np.ndarray, lengths: np.ndarray, order: int) -> np.ndarray:
    """A derivative of the drive at all ends of pieces, (m + 1, ...); `found` as of `shifted`."""
    scale = lengths.reshape((-1,) + (1,) * (found.ndim - 2)) ** order
    factors = np.array([[1, 1, 1, 1], [0, 1, 2, 3], [0, 0, 2, 6]], dtype=float)[order]
    at_begin = factors[order] * found[:, order] / scale
    at_end = np.tensordot(found[-1], factors, axes=(0, 0)) / scale[-1]
    return np.concatenate((at_begin, np.asarray(at_end)[None]))
