"""What a sensor shows of a decay, in closed form with its derivatives.

With lambda = omega_n (-zeta + i d), d = sqrt(1 - zeta^2), a = 1 - i zeta/d and s_j the side of turning
point j, the motion of half cycle j, its velocity and its acceleration are (k = 0, 1, 2 times differentiated)

    s_j x_F [k = 0] + s_j (A_j - x_F) Re(a lambda^k e^{lambda tau}),   tau = t - t_j

A filter H(s) = H_0 + sum r/(s - p) answers with H(lambda) times the wave, H(0) times the constant, and with
sum r h_j e^{p tau}.  Its states do not jump at turning points.  With E = e^{p pi/(omega_n d)},

    gamma = (a lambda^k/(lambda - p) + conj(a lambda^k)/(conj(lambda) - p))/2 + [k = 0]/p
    h_j = -s_0 gamma ((A_0 - x_F) E^j + 2 x_F (E^j - (-1)^j)/(1 + E)),   j < n
    h_n = E h_{n-1} + s_n gamma (A_n + x_F)

for a mass that is held before t_0 and at rest from t_n on.  Whatever else was in the filter at the first
sample is a sum of e^{p t}, `Sensor.transients`.  lambda = p needs zeta = 0.7, at which a decay has no three
turning points that can be seen.
"""

import numpy as np

from .motion import PARAMETERS, Decay, half_period, turning_point_slopes
from .sensor import Sensor

#: A number and its derivatives by f_n, zeta, x_F and X0 are rows of one array.
_ROWS = 5


def measured_and_slopes(
    sensor: Sensor, decay: Decay, n: int, time: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """What a sensor shows, shape (samples,), and its derivatives by the parameters, shape (samples, 6).

    The mass is at rest from turning point `n` on.  The last parameter is the offset of the signal.  At jumps
    of the acceleration the derivatives are those beside the jump.
    """
    half = half_period(decay)
    j = np.clip(np.floor((time - decay.t0) / half), -1, n).astype(int)
    tau = time - decay.t0 - j * half
    value, by_tau = sensor.gain(0.0).real * _places(sensor, decay, n)[:, j + 1], np.zeros(time.size)
    for exponent, heights in _waves(sensor, decay, n):
        wave, slope = _wave(exponent, heights[:, j + 1], tau, np.multiply.outer(_half_slopes(decay), j))
        value, by_tau = value + wave, by_tau + slope
    slopes = np.empty((time.size, len(PARAMETERS)))
    slopes[:, :4] = sensor.scale * value[1:].T
    slopes[:, 4] = -sensor.scale * by_tau
    slopes[:, 5] = 1.0
    return decay.centre + sensor.scale * value[0], slopes


def _waves(sensor: Sensor, decay: Decay, n: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Exponents and the amplitudes before t_0 and in half cycles 0..n, shapes (5,) and (5, n + 2)."""
    waves = [(_exponent(decay), _swings(sensor, decay, n))]
    for pole, residue in zip(sensor.poles, sensor.residues, strict=True):
        constant = np.array([pole, 0.0, 0.0, 0.0, 0.0])
        waves.append((constant, residue * _states(sensor, decay, n, pole)))
    return waves


def _wave(
    exponent: np.ndarray, height: np.ndarray, tau: np.ndarray, shift: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Real part of height e^{exponent tau}, shape (5, samples), and its derivative by tau, (samples,).

    shift : shape (5, samples), derivatives of the turning points' times
    """
    shape = np.exp(exponent[0] * np.where(height[0] != 0.0, tau, 0.0))  # what has no height may grow
    turned = height[0] * shape
    value = (height * shape).real
    value[1:] += (turned * (exponent[1:, np.newaxis] * tau - exponent[0] * shift[1:])).real
    return value, (turned * exponent[0]).real


def _half_slopes(decay: Decay) -> np.ndarray:
    """Derivatives of half a period, in the rows of the parameters; the row of the number itself is 0."""
    half = half_period(decay)
    return np.array([0.0, -half / decay.f_n, half * decay.zeta / (1.0 - decay.zeta**2), 0.0, 0.0])


def _exponent(decay: Decay) -> np.ndarray:
    """The complex exponent lambda."""
    d = np.sqrt(1.0 - decay.zeta**2)
    w = 2.0 * np.pi * decay.f_n
    value = w * complex(-decay.zeta, d)
    return np.array([value, value / decay.f_n, w * complex(-1.0, -decay.zeta / d), 0.0, 0.0])


def _unit_swing(sensor: Sensor, decay: Decay) -> np.ndarray:
    """a lambda^k."""
    d = np.sqrt(1.0 - decay.zeta**2)
    result = np.array([complex(1.0, -decay.zeta / d), 0.0, -1j / d**3, 0.0, 0.0])
    for _ in range(sensor.order):
        result = _product(result, _exponent(decay))
    return result


def _swings(sensor: Sensor, decay: Decay, n: int) -> np.ndarray:
    """Amplitudes of e^{lambda tau} before t_0 and in half cycles 0..n, shape (5, n + 2)."""
    exponent = _exponent(decay)
    gain = sensor.gain_slope(exponent[0]) * exponent
    gain[0] = sensor.gain(exponent[0])
    heights = _heights(decay, n)
    heights[0] -= decay.x_F
    heights[3] -= 1.0
    sides = _sides(decay, n)
    swings = np.zeros((_ROWS, n + 2), dtype=complex)
    unit = _product(gain, _unit_swing(sensor, decay))
    swings[:, 1:-1] = _product(unit[:, np.newaxis], sides[:-1] * heights[:, :-1])
    return swings


def _places(sensor: Sensor, decay: Decay, n: int) -> np.ndarray:
    """Constant parts of the motion before t_0 and in half cycles 0..n, shape (5, n + 2)."""
    places = np.zeros((_ROWS, n + 2))
    if sensor.order:
        return places
    heights, sides = _heights(decay, n), _sides(decay, n)
    places[:, 0] = sides[0] * heights[:, 0]
    places[0, 1:-1], places[3, 1:-1] = sides[:-1] * decay.x_F, sides[:-1]
    places[:, -1] = sides[-1] * heights[:, -1]
    return places


def _states(sensor: Sensor, decay: Decay, n: int, pole: complex) -> np.ndarray:
    """h_j of a pole before t_0 and in half cycles 0..n, shape (5, n + 2)."""
    heights, sides, j = _heights(decay, n), _sides(decay, n), np.arange(n)
    friction = np.array([decay.x_F, 0.0, 0.0, 1.0, 0.0])
    gamma, once = _entry(sensor, decay, pole), _power(decay, pole, np.ones(1))[:, 0]
    power = _power(decay, pole, j)
    alternating, beyond = power.copy(), once.copy()
    alternating[0] -= (-1.0) ** j
    beyond[0] += 1.0
    released = _product((heights[:, 0] - friction)[:, np.newaxis], power)
    turned = _product(_product(2.0 * friction, _inverse(beyond))[:, np.newaxis], alternating)
    states = np.zeros((_ROWS, n + 2), dtype=complex)
    states[:, 1:-1] = -sides[0] * _product(gamma[:, np.newaxis], released + turned)
    stopped = sides[-1] * _product(heights[:, -1] + friction, gamma)
    states[:, -1] = _product(once, states[:, -2]) + stopped
    return states


def _power(decay: Decay, pole: complex, j: np.ndarray) -> np.ndarray:
    """E^j, shape (5, numbers)."""
    result = np.multiply.outer(pole * _half_slopes(decay), j * np.exp(pole * half_period(decay) * j))
    result[0] = np.exp(pole * half_period(decay) * j)
    return result


def _entry(sensor: Sensor, decay: Decay, pole: complex) -> np.ndarray:
    """gamma."""
    exponent, unit = _exponent(decay), _unit_swing(sensor, decay)
    result = np.zeros(_ROWS, dtype=complex)
    for rate, swing in ((exponent, unit), (exponent.conj(), unit.conj())):
        away = rate.copy()
        away[0] -= pole
        result += 0.5 * _product(swing, _inverse(away))
    if not sensor.order:
        result[0] += 1.0 / pole
    return result


def _heights(decay: Decay, n: int) -> np.ndarray:
    """A_0..A_n, shape (5, n + 1)."""
    height, by_zeta, by_friction, by_first = turning_point_slopes(decay, n)
    sign = 1.0 if decay.X0 >= 0.0 else -1.0
    return np.array([height, np.zeros(n + 1), by_zeta, by_friction, sign * by_first])


def _sides(decay: Decay, n: int) -> np.ndarray:
    """s_0..s_n."""
    return np.where(np.arange(n + 1) % 2 == 0, 1.0, -1.0) * (1.0 if decay.X0 >= 0.0 else -1.0)


def _product(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Product of numbers with their derivatives."""
    result = one * other[:1] + one[:1] * other
    result[0] = one[0] * other[0]
    return result


def _inverse(one: np.ndarray) -> np.ndarray:
    """1 over a number, with its derivatives."""
    result = -one / one[0] ** 2
    result[0] = 1.0 / one[0]
    return result
