"""Free decays as accelerometers, vibrometers and angle sensors show them, identified by `free_decay`.

Motion and filters are one linear system in every half cycle, and its matrix exponential gives the samples:
the package solves the two one after the other, in closed form.
"""

from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.linalg import expm

import frictionmap as fm

from .case import Case, Made
from .decays import Decay, half_cycles, light

#: Fits of a case: enough for a coverage to 3 %.
_SEEDS = 200

#: Standard deviation of the noise, over the largest signal of the motion.
_NOISE = (0.003, 0.006)

#: Corner frequencies of low-pass filters and of AC couplings, over f_n.
_LOW_PASS, _COUPLING = (8.0, 20.0), (0.05, 0.15)

#: Of 1 mm, mm/s and mm/s^2, in the units of the signals.
_SCALES = {"deg": 1.0, "mm/s": 1.0, "m/s^2": 1e-3}
_ORDERS = {"deg": 0, "mm/s": 1, "m/s^2": 2}


class Route(NamedTuple):
    """What is between the motion and the samples."""

    order: int  # how often the motion is differentiated
    low_pass: tuple[int, float] | None = None  # order 1, or 2 of Butterworth, and corner frequency [Hz]
    coupling: float | None = None  # corner frequency [Hz]


def _system(decay: Decay, route: Route, side: float) -> tuple[np.ndarray, np.ndarray]:
    """Matrix of the states x, v, 1, f, f', h, and the row of the signal; side 0: at rest."""
    w = 2.0 * np.pi * decay.f_n
    matrix, rows = np.zeros((6, 6)), np.eye(6)
    acceleration = -(w**2) * (rows[0] - side * decay.x_F * rows[2]) - 2.0 * decay.zeta * w * rows[1]
    if side != 0.0:
        matrix[0], matrix[1] = rows[1], acceleration
    signal = (rows[0], rows[1], matrix[1])[route.order]
    if route.low_pass is not None:
        order, corner = route.low_pass[0], 2.0 * np.pi * route.low_pass[1]
        matrix[3] = corner * (signal - rows[3]) if order == 1 else rows[4]
        if order == 2:
            matrix[4] = corner**2 * (signal - rows[3]) - np.sqrt(2.0) * corner * rows[4]
        signal = rows[3]
    if route.coupling is not None:
        matrix[5] = 2.0 * np.pi * route.coupling * (signal - rows[5])
        signal = signal - rows[5]
    return matrix, signal


def seen(decay: Decay, route: Route, time: np.ndarray) -> np.ndarray:
    """The signal at `time`, in mm and s, of a mass that was held at X0 for long before t0; no noise."""
    held = decay.X0 if route.order == 0 else 0.0
    state = np.array([decay.X0, 0.0, 1.0, held, 0.0, held])
    found = np.full(time.size, _system(decay, route, 0.0)[1] @ state)
    side, count = np.sign(decay.X0), half_cycles(decay)
    for j in range(count + 1):
        begin = decay.t0 + j * decay.half
        matrix, signal = _system(decay, route, 0.0 if j == count else side * (-1.0) ** j)
        inside = time >= begin
        waves = expm(matrix * (time[inside] - begin)[:, np.newaxis, np.newaxis])
        found[inside] = waves @ state @ signal
        state = expm(matrix * decay.half) @ state
        state[1] = 0.0  # it turns
    return found


def _made(rng: np.random.Generator, unit: str, order: int = 0, coupled: bool = False) -> Made:
    """A random decay as a sensor shows it, through a low-pass filter of an order, and an AC coupling."""
    decay = light(rng)
    low_pass = (order, decay.f_n * rng.uniform(*_LOW_PASS)) if order else None
    coupling = decay.f_n * rng.uniform(*_COUPLING) if coupled else None
    route = Route(_ORDERS[unit], low_pass, coupling)
    time = np.arange(int(decay.rate * decay.length)) / decay.rate
    largest = _SCALES[unit] * (2.0 * np.pi * decay.f_n) ** route.order * abs(decay.X0)
    offset = largest * rng.uniform(-0.05, 0.05)
    noise = rng.normal(0.0, largest * rng.uniform(*_NOISE), time.size)
    x = _SCALES[unit] * seen(decay, route, time) + offset + noise
    filters: dict[str, object] = {}
    if low_pass is not None:
        filters["filter"] = {"kind": "low-pass", "order": order, "frequency_Hz": low_pass[1]}
    if coupling is not None:
        filters["ac_coupling_Hz"] = coupling
    truth = {name: getattr(decay, name) for name in Decay._fields[:5]} | {"offset": offset}
    return Made(truth, lambda: fm.identify.free_decay(time, x, unit=unit, **filters))


CASES = (
    Case("acceleration", partial(_made, unit="m/s^2"), _SEEDS),
    Case("acceleration, low-pass of order 2", partial(_made, unit="m/s^2", order=2), _SEEDS),
    Case("acceleration, AC coupling", partial(_made, unit="m/s^2", coupled=True), _SEEDS),
    Case("velocity", partial(_made, unit="mm/s"), _SEEDS),
    Case(
        "velocity, low-pass of order 1, AC coupling",
        partial(_made, unit="mm/s", order=1, coupled=True),
        _SEEDS,
    ),
    Case("angle", partial(_made, unit="deg"), _SEEDS),
)
