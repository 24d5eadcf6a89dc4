"""A sensor of a decay: what it measures, in which unit, through which filter.

A low-pass filter of order 1 is omega_c/(s + omega_c), of order 2 that of Butterworth, with poles
omega_c (-1 +- i)/sqrt(2); coupling for alternating signals is s/(s + omega_h).  Their product is
H(s) = H_0 + sum r/(s - p), its states after the first sample are sums of e^{p t}.
"""

from typing import NamedTuple

import numpy as np

#: A state that has decayed to rounding within one sample has no transient: -ln of the rounding.  One that
#: changes less than half of all digits over a record is an offset.
_FORGOTTEN, _CONSTANT = -float(np.log(np.finfo(float).eps)), float(np.sqrt(np.finfo(float).eps))


class Filter(NamedTuple):
    """A low-pass filter."""

    order: int  # 1, or 2: Butterworth
    frequency: float  # at which the gain is 1/sqrt(2), Hz


class Sensor(NamedTuple):
    """A sensor and its electronics."""

    order: int  # what it measures: 0 a place, 1 a velocity, 2 an acceleration
    scale: float  # of 1 unit of the estimates (per s or s^2), in the unit of the signal
    poles: tuple[complex, ...] = ()  # of the filters, 1/s
    residues: tuple[complex, ...] = ()
    direct: float = 1.0  # the gain at high frequencies

    def gain(self, s: complex) -> complex:
        """H(s)."""
        return self.direct + sum(r / (s - p) for p, r in zip(self.poles, self.residues, strict=True))

    def gain_slope(self, s: complex) -> complex:
        """Derivative of H at s."""
        return -sum(r / (s - p) ** 2 for p, r in zip(self.poles, self.residues, strict=True))

    @property
    def jumps(self) -> bool:
        """Whether the signal jumps where friction changes its sign: an acceleration without a low-pass."""
        return self.order == 2 and self.direct != 0.0

    def transients(self, time: np.ndarray) -> np.ndarray:
        """What the state of the filters at the first sample can add, shape (samples, states)."""
        since, step = time - time[0], float(np.median(np.diff(time)))
        found = []
        for pole in self.poles:
            if pole.imag < 0.0 or -pole.real * step > _FORGOTTEN or abs(pole) * since[-1] < _CONSTANT:
                continue
            wave = np.exp(pole * since)
            found += [wave.real, wave.imag] if pole.imag > 0.0 else [wave.real]
        return np.column_stack(found) if found else np.zeros((time.size, 0))


def sensor_of(order: int, scale: float, low_pass: Filter | None, ac_coupling: float | None) -> Sensor:
    """A sensor with a low-pass filter, and with an AC coupling of a corner frequency [Hz], if any."""
    poles: list[complex] = []
    size = 1.0
    if low_pass is not None:
        corner = 2.0 * np.pi * low_pass.frequency
        turned = (
            [-1.0] if low_pass.order == 1 else [complex(-1, 1) / np.sqrt(2), complex(-1, -1) / np.sqrt(2)]
        )
        poles += [complex(corner * one) for one in turned]
        size = corner**low_pass.order
    if ac_coupling is not None:
        poles.append(complex(-2.0 * np.pi * ac_coupling))
    residues = tuple(
        complex(
            size * (pole if ac_coupling is not None else 1.0)
            / np.prod([pole - other for other in poles if other != pole])
        )
        for pole in poles
    )  # fmt: skip
    return Sensor(order, scale, tuple(poles), residues, 0.0 if low_pass is not None else 1.0)
