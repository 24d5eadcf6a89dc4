"""Motions over half a period from a maximum of z, theory.md 2, and their largest moduli.

Such a half is harmonic except for the responses h_i of the modes to the square wave of friction; the next
half is its mirror image.  Modes that do not participate have the harmonic part only.  Where the damping
couples modes, the h_i are those of oscillators, whose velocities contribute as well: R_i h_i' is a further
response of each.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .._kernels.closed_form import damping_functions
from ..model.balance import dynamic_stiffness
from ..model.modes import ModalModel, wrapped

#: Initial intervals per half period in the search for an amplitude, and number of parts into which an open
#: one is divided.
_INTERVALS = 16
_PARTS = 32

#: The search ends when no value can exceed the one found by more than this share, or after `_ROUNDS` rounds,
#: when an interval is shorter than the rounding error of a time within it.
_TOLERANCE = 4e-16

#: Displacements searched at a time, and largest number of open intervals divided at a time; a motion of many
#: masses with many equal maxima leaves some hundred.
_AT_ONCE = 512
_MOST_OPEN = 20000
_ROUNDS = 8

#: Newton steps from the end of that search to the turning point: they square an error of about 1e-8, so one
#: of them suffices.
_STEPS = 6

#: Below this value of (1 + 2 zeta) theta, 1 - d is computed by a series of `_TERMS` terms; further terms are
#: below rounding.
_SMALL = 0.3
_TERMS = 14

#: Finite part of u at an undamped resonance; the infinite part is included in the harmonic motion.
RESONANT_U = -2.0 / math.pi

#: First harmonic of h, -(4 i/pi) w^2/(w^2 - r^2) for an undamped mode, at resonance without the infinite
#: part.
RESONANT_FIRST_HARMONIC = -3j / math.pi


def free_response(zeta: float, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """1 - d, q and e = R q' of T(B.8), (B.9) at theta = tau/R >= 0, accurate to a few units of rounding each.

    zeta >= 1 is the analytic continuation (sin -> sinh, and the double root at zeta = 1).
    """
    if zeta < 1.0:
        s = math.sqrt((1.0 - zeta) * (1.0 + zeta))
        envelope = np.exp(-zeta * theta)
        q = envelope * np.sin(s * theta) / s
        e = envelope * np.cos(s * theta) - zeta * q
    elif zeta == 1.0:
        envelope = np.exp(-theta)
        q = envelope * theta
        e = envelope - q
    else:
        s = math.sqrt((zeta - 1.0) * (zeta + 1.0))
        slow = 1.0 / (zeta + s)
        q = np.exp(-slow * theta) * -np.expm1(-2.0 * s * theta) / (2.0 * s)
        e = np.exp(-(zeta + s) * theta) - slow * q
    if zeta < 2.0:
        rise = 1.0 - e - 2.0 * zeta * q
    else:  # the two exponentials of d separately: the slow one is near 1 where the fast one has decayed
        rise = (slow * np.expm1(-theta / slow) - np.expm1(-slow * theta) / slow) / (2.0 * s)
    # y = 1 - d is the response to a unit step, y'' + 2 zeta y' + y = 1 from rest: of order theta^2
    small = (1.0 + 2.0 * zeta) * theta < _SMALL
    if small.any():
        x = theta[small]
        before, term = np.zeros_like(x), 0.5 * x * x
        total = term.copy()
        for k in range(3, _TERMS):
            before, term = term, -x * (2.0 * zeta * term + x / (k - 1.0) * before) / k
            total += term
        rise[small] = total
    return rise, q, e


class ModeMotion(NamedTuple):
    """One mode in several motions: a = w/r, u (0 where it is infinite), g, and whether u is infinite."""

    a: np.ndarray
    u: np.ndarray
    g: np.ndarray
    resonant: np.ndarray


@dataclass(frozen=True, eq=False)
class FrictionResponses:
    """Responses h_i of theory.md 2 of p participating modes or oscillators, in several motions.

    zeta : (p,) damping ratios
    coupled_indices : (j,) oscillators for which R_i h_i' are responses too, numbered p.. of p + j; see
    `FreeStructure`
    pace : (n_motions, p) w_i/r
    u, g : (n_motions, p) damping functions T(7.11), (7.12).  At an undamped resonance u is infinite: its part
    u sin(tau) is included in the harmonic motion there, and (2/pi) tau cos(tau) remains, theory.md 9 (5)

    Times t, 0 <= t <= pi, are counted from the maximum of z.  A motion is an index, or one index for every
    time.
    """

    zeta: np.ndarray
    coupled_indices: np.ndarray
    pace: np.ndarray
    u: np.ndarray
    g: np.ndarray

    def displacement(self, index: int, motion: np.ndarray | int, t: np.ndarray) -> np.ndarray:
        """Evaluate h_i, or R_i h_i', at times t."""
        if index >= self.zeta.size:
            i = int(self.coupled_indices[index - self.zeta.size])
            return self._rates(i, motion, t)[0] / self.pace[motion, i]
        a, u, g, resonant = self._mode_motion(index, motion)
        rise, q, _ = free_response(self.zeta[index], a * t)
        return (1.0 + g) * rise - g - np.where(resonant, RESONANT_U * t * np.cos(t), u / a * q)

    def rates(self, index: int, motion: np.ndarray | int, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Velocity and acceleration of `displacement` at times t."""
        if index < self.zeta.size:
            return self._rates(index, motion, t)
        i = int(self.coupled_indices[index - self.zeta.size])
        a = self.pace[motion, i]
        swing, bend = self._rates(i, motion, t)
        return bend / a, -2.0 * self.zeta[i] * bend - a * swing

    def at_maximum(self) -> tuple[np.ndarray, np.ndarray]:
        """Velocities and displacements at t = 0 with reversed sign; (n_motions, p + j) both.

        For the h_i they are u and g.  The term a in h_i''(0)/a is omitted: a force does not change a velocity
        instantly, so these terms add up to zero.
        """
        which = self.coupled_indices
        a, u, g = self.pace[:, which], self.u[:, which], self.g[:, which]
        velocity = -(a * g + 2.0 * self.zeta[which] * u)
        return np.hstack((self.u, velocity)), np.hstack((self.g, u / a))

    def _rates(self, mode: int, motion: np.ndarray | int, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Evaluate h_i' and h_i'' at times t."""
        a, u, g, resonant = self._mode_motion(mode, motion)
        zeta = self.zeta[mode]
        _, q, e = free_response(zeta, a * t)
        swing, bend = u * e, -a * u * (2.0 * zeta * e + q)
        if np.any(resonant):
            sine, cosine = np.sin(t), np.cos(t)
            swing = np.where(resonant, RESONANT_U * (cosine - t * sine), swing)
            bend = np.where(resonant, -RESONANT_U * (2.0 * sine + t * cosine), bend)
        return (1.0 + g) * a * q - swing, (1.0 + g) * a * a * e - bend

    def _mode_motion(self, mode: int, motion: np.ndarray | int) -> ModeMotion:
        u = self.u[motion, mode]
        resonant = np.isinf(u)
        return ModeMotion(self.pace[motion, mode], np.where(resonant, 0.0, u), self.g[motion, mode], resonant)

    def largest_displacements(self) -> np.ndarray:
        """Moduli of the terms of h_i, which set the rounding error of the sum; (n_motions, p + j)."""
        swing = np.where(np.isinf(self.u), 2.0, np.abs(self.u) / self.pace)
        size = np.abs(1.0 + self.g) + swing
        return np.hstack((1.0 + size, size[:, self.coupled_indices]))

    def largest_accelerations(self) -> np.ndarray:
        """Upper bounds on their accelerations over all times; (n_motions, p + j).

        h'' = a e + b q, and q^2 + e^2 <= 1 is the energy of free motion, 1 at the start.
        The acceleration of R h' is (b - 2 zeta a) e - a q.
        """
        a, zeta = self.pace, self.zeta
        resonant = np.isinf(self.u)
        u = np.where(resonant, 0.0, self.u)
        along, across = (1.0 + self.g) * a * a + 2.0 * zeta * a * u, a * u
        bound = np.where(resonant, 1.0 - RESONANT_U * (2.0 + math.pi), np.hypot(along, across))
        further = np.hypot(across - 2.0 * zeta * along, along)
        return np.hstack((bound, further[:, self.coupled_indices]))


def friction_responses(modes: ModalModel, r: np.ndarray, beta: np.ndarray) -> FrictionResponses:
    """Responses to friction of motions at r > 0 with friction ratio beta, (n_motions,) both.

    u and g are set to 0 where there is no friction: u may be infinite without a resonance.
    """
    free = modes.free
    w, zeta = free.omega, free.zeta
    pairs = np.array([[damping_functions(*mode, x) for mode in zip(w, zeta, strict=True)] for x in r])
    u, g = np.where(beta[:, np.newaxis, np.newaxis] > 0.0, pairs, 0.0).transpose(2, 0, 1)
    return FrictionResponses(zeta, free.coupled_indices, w / r[:, np.newaxis], u, g)


def dynamic_amplification(modes: ModalModel, s: np.ndarray) -> np.ndarray:
    """Responses to a harmonic force in place of the square wave of friction, complex (n_s, p + j).

    w_i^2/(w_i^2 - s^2 + 2 i zeta_i w_i s), and i s/w_i times it.  0 where it is infinite, at an undamped s =
    w_i.
    """
    free = modes.free
    stiffness, squares = dynamic_stiffness(free.omega, free.zeta, s).complex(), free.omega[:, np.newaxis] ** 2
    shares = np.divide(squares, stiffness, out=np.zeros_like(stiffness), where=stiffness != 0.0)
    turning = 1j * s / free.omega[free.coupled_indices, np.newaxis]
    return np.vstack((shares, turning * shares[free.coupled_indices])).T


def compliances(modes: ModalModel) -> np.ndarray:
    """Responses of displacements in terms of `FrictionResponses`, (n, p + j); phi_ki chi_i/w_i^2 of modes."""
    return modes.free.compliances(modes.phi[:, modes.participating])


def contact_compliances(modes: ModalModel) -> np.ndarray:
    """Responses of z to friction by `FrictionResponses`, (p + j,); chi_i^2/w_i^2 of modes."""
    free = modes.free
    static, rates = free.weights(modes.chi[modes.participating])
    return np.append(static, (free.omega * rates)[free.coupled_indices])


class HalfWaves(NamedTuple):
    """Displacements Re(harmonic e^{it}) + sum_i weights_i h_i(t), 0 <= t <= pi, from a maximum of z.

    responses : the h_i of the motions
    motion : (m,) index of the motion of each displacement
    harmonic : (m,) complex
    weights : (m, p + j)
    """

    responses: FrictionResponses
    motion: np.ndarray
    harmonic: np.ndarray
    weights: np.ndarray

    def displacement(self, which: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Evaluate the displacements with indices `which` at times t; the arrays must be broadcastable."""
        x = (self.harmonic[which] * np.exp(1j * t)).real
        for i, weight in enumerate(self.weights.T):
            x = x + weight[which] * self.responses.displacement(i, self.motion[which], t)
        return x

    def turning(self, which: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Velocity and acceleration at times t of any size, for the half wave continued antiperiodically."""
        halves = np.floor(t / math.pi)
        t = np.clip(t - math.pi * halves, 0.0, math.pi)
        motion, turn = self.motion[which], self.harmonic[which] * np.exp(1j * t)
        velocity, acceleration = -turn.imag, -turn.real
        for i, weight in enumerate(self.weights.T):
            swing, bend = self.responses.rates(i, motion, t)
            velocity = velocity + weight[which] * swing
            acceleration = acceleration + weight[which] * bend
        sign = np.where(halves % 2.0 == 0.0, 1.0, -1.0)
        return sign * velocity, sign * acceleration


class Peaks(NamedTuple):
    """Largest moduli of displacements; (m,) each."""

    modulus: np.ndarray
    t: np.ndarray  # since the maximum of z
    value: np.ndarray  # the displacement there, negative at a minimum


def largest_moduli(waves: HalfWaves) -> Peaks:
    """Find max |x| of every displacement to within `_TOLERANCE`; no larger value is missed."""
    size = np.abs(waves.harmonic)
    found = Peaks(size, -np.angle(waves.harmonic), size.copy())  # of a harmonic motion
    with_friction = np.flatnonzero((waves.weights != 0.0).any(axis=1))
    found.modulus[with_friction] = -1.0  # below every sample
    for first in range(0, with_friction.size, _AT_ONCE):
        _search(waves, with_friction[first : first + _AT_ONCE], found)
    found.t[with_friction] = _refine_times(waves, with_friction, found.t[with_friction])
    return found


def _search(waves: HalfWaves, which: np.ndarray, found: Peaks) -> None:
    """Fill in the peaks of the displacements `which`, except for the last digits of their times.

    An interval of length l holds nothing above the larger of its ends plus l^2/8 max |x''|.  Intervals that
    may exceed the largest value so far are divided until the excess is negligible.
    """
    responses, weights, motion = waves.responses, np.abs(waves.weights), waves.motion
    bend = np.abs(waves.harmonic) + (weights * responses.largest_accelerations()[motion]).sum(axis=1)
    # close to a pole of u the terms cancel; differences below the rounding error of the largest are ignored
    size = np.abs(waves.harmonic) + (weights * responses.largest_displacements()[motion]).sum(axis=1)
    length = math.pi / _INTERVALS
    nodes = np.tile(np.linspace(0.0, math.pi, _INTERVALS + 1), (which.size, 1))
    for _ in range(_ROUNDS):
        x = waves.displacement(which[:, np.newaxis], nodes)
        _keep_largest(which, nodes, x, found)
        top = np.maximum(np.abs(x[:, :-1]), np.abs(x[:, 1:])).ravel()
        which, start = np.repeat(which, nodes.shape[1] - 1), nodes[:, :-1].ravel()
        slack = length * length / 8.0 * bend
        matters = slack > _TOLERANCE * np.maximum(found.modulus, size)
        wanted = (top + slack[which] > found.modulus[which]) & matters[which]
        # more remain only where the terms cancel to rounding everywhere; the samples are then sufficient
        if not 0 < np.count_nonzero(wanted) <= _MOST_OPEN:
            return
        which, start = which[wanted], start[wanted]
        length /= _PARTS
        nodes = np.minimum(start[:, np.newaxis] + length * np.arange(_PARTS + 1), math.pi)


def _keep_largest(which: np.ndarray, t: np.ndarray, x: np.ndarray, found: Peaks) -> None:
    """Update the peaks of the displacements `which` (k,) from samples x (k, n_nodes)."""
    rows = np.arange(which.size)
    node = np.argmax(np.abs(x), axis=1)
    value = x[rows, node]
    before = found.modulus[which]
    np.maximum.at(found.modulus, which, np.abs(value))
    new = (np.abs(value) == found.modulus[which]) & (np.abs(value) > before)
    found.t[which[new]], found.value[which[new]] = t[rows, node][new], value[new]


def _refine_times(waves: HalfWaves, which: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Refine times to the zeros of the velocity next to `start`, by Newton steps as long as it decreases."""
    found = start.copy()
    at = np.arange(start.size)
    velocity, acceleration = waves.turning(which, start)
    for _ in range(_STEPS):
        moving = (velocity != 0.0) & (acceleration != 0.0)
        at, velocity, acceleration = at[moving], velocity[moving], acceleration[moving]
        new = found[at] - velocity / acceleration
        speed, bend = waves.turning(which[at], new)
        smaller = np.abs(speed) < np.abs(velocity)
        at, velocity, acceleration = at[smaller], speed[smaller], bend[smaller]
        found[at] = new[smaller]
    return found


def mass_peaks(
    modes: ModalModel, responses: FrictionResponses, beta: np.ndarray, harmonic: np.ndarray, z: np.ndarray
) -> Peaks:
    """Find the peaks of all masses in several motions, (n_motions, n) each.

    beta, z : (n_motions,) friction ratio, and amplitude of the contact
    harmonic : (n_motions, n) complex, see `HalfWaves`
    """
    shape = harmonic.shape
    weights = beta[:, np.newaxis, np.newaxis] * compliances(modes)
    motion = np.repeat(np.arange(shape[0]), shape[1])
    wall_mass = int(np.argmax(modes.contact))
    is_contact = not modes.base_motion and np.count_nonzero(modes.contact) == 1
    if is_contact:
        weights[:, wall_mass] = 0.0  # not searched
    waves = HalfWaves(responses, motion, harmonic.ravel(), weights.reshape(harmonic.size, -1))
    found = Peaks(*(part.reshape(shape) for part in largest_moduli(waves)))
    if is_contact:
        # this mass is the contact: at beta_lim it turns so slowly that a search would lose half of the digits
        rows = np.flatnonzero(beta > 0.0)
        found.modulus[rows, wall_mass] = found.value[rows, wall_mass] = z[rows]
        found.t[rows, wall_mass] = 0.0
    return found


def peak_phases(peaks: Peaks, contact_phase: np.ndarray | float) -> np.ndarray:
    """Load phases tau in (-pi, pi] of the maxima of displacements, T(3.27), (7.29), from that of z.

    A minimum is half a period from its maximum.  NaN for a mass at rest.
    """
    tau = wrapped(contact_phase + peaks.t + np.where(peaks.value < 0.0, math.pi, 0.0))
    return np.where(peaks.modulus > 0.0, tau, np.nan)
