"""The continuous (non-sticking) steady state in closed form, theory.md 2.

Its friction force is a square wave locked to the maxima of z.  The answer of a mode to that wave, less its
harmonic part, is ``h`` of theory.md 2; all else is harmonic.  Modes that the contact does not see have the
harmonic part only: their u may be infinite, and is not asked for.
"""

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import SupportsFloat

import numpy as np

from .. import checks
from .._kernels.closed_form import damping_functions
from ..errors import InputError, NoSteadyState
from ..model.modes import ModalModel
from ..model.system import System
from .boundaries import find_curves

#: First intervals of half a period in the search of an amplitude, and parts that an open one is cut into.
_INTERVALS = 16
_PARTS = 32

#: The search ends when nothing can lie higher by this share of what was found, or after so many rounds: by
#: then an interval is shorter than the rounding of a time within it.
_TOLERANCE = 4e-16

#: Intervals that are cut up at a time; a motion of many masses with many equal maxima leaves some hundred.
_MOST_OPEN = 20000
_ROUNDS = 8

#: Below this (1 + 2 zeta) theta, 1 - d is summed as a series; terms beyond the last are less than rounding.
_SMALL = 0.3
_TERMS = 14


def _answers(zeta: float, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """1 - d, q and e = R q' of T(B.8), (B.9) at theta = tau/R >= 0, to a few units of rounding each.

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
    else:  # the two exponentials of d apart: the slow one is still near 1 where the fast one is gone
        rise = (slow * np.expm1(-theta / slow) - np.expm1(-slow * theta) / slow) / (2.0 * s)
    # y = 1 - d is the answer to a unit step, y'' + 2 zeta y' + y = 1 from rest: of order theta^2
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


@dataclass(frozen=True, eq=False)
class ContinuousMotion:
    """A continuous steady state; see `continuous_motion`.

    Times tau are those of the load, as in `frictionmap.response`, one number or a list of any length, and any
    size: the motion repeats.  Displacements are over P/k1 (Y).

    Attributes
    ----------
    r, beta : float
        Frequency and friction ratio.
    contact_amplitude : float
        Z, the amplitude of z, T(2.34), (7.20).
    contact_phase : float
        phi_z: z is largest at tau = phi_z, (2.35), (7.21) of T.
    """

    r: float
    beta: float
    contact_amplitude: float
    contact_phase: float
    # seen modes only, shape (n_seen,); `compliance` is phi_ki chi_i/w_i^2, (n, n_seen), `contact_compliance`
    # is chi_i^2/w_i^2, `dynamic` is phi_ki chi_i/(w_i^2 - r^2 + 2 i zeta_i w_i r) summed over them, (n,)
    _w: np.ndarray = field(repr=False)
    _zeta: np.ndarray = field(repr=False)
    _u: np.ndarray = field(repr=False)
    _g: np.ndarray = field(repr=False)
    _compliance: np.ndarray = field(repr=False)
    _contact_compliance: np.ndarray = field(repr=False)
    _dynamic: np.ndarray = field(repr=False)
    # phasors of the harmonic part from a maximum of z on: V_k e^{i phi_z}, (n,), and V e^{i phi_z}
    _harmonic: np.ndarray = field(repr=False)
    _contact_harmonic: complex = field(repr=False)

    def displacement(self, tau: object) -> np.ndarray:
        """x_k, T(7.28) with d(tau) of (B.8a); shape (n, tau.size)."""
        return self._at(tau, self._harmonic, self._compliance, velocity=False)

    def velocity(self, tau: object) -> np.ndarray:
        """dx_k/dtau; shape (n, tau.size)."""
        return self._at(tau, self._harmonic, self._compliance, velocity=True)

    def contact(self, tau: object) -> np.ndarray:
        """z = c.x - s cos(tau), T(5.41), (7.23); shape (tau.size,)."""
        return self._at(tau, np.array([self._contact_harmonic]), self._contact_compliance, velocity=False)[0]

    def contact_velocity(self, tau: object) -> np.ndarray:
        """dz/dtau; shape (tau.size,)."""
        return self._at(tau, np.array([self._contact_harmonic]), self._contact_compliance, velocity=True)[0]

    @cached_property
    def amplitude(self) -> np.ndarray:
        """max |x_k(tau)| of every mass, exact; shape (n,)."""
        return _largest_moduli(self, self._harmonic, self._compliance)

    @property
    def monoharmonic_amplitude(self) -> np.ndarray:
        """Approximate amplitude of every mass from x and x' at a maximum of z, T(5.50), (7.33); shape (n,).

        As from T(7.31), (7.32): the sign of U_dk sin(..) in T(7.33) is a slip.
        """
        if self.beta == 0.0:
            return np.abs(self._harmonic)  # u may be infinite
        g, u = self._compliance @ self._g, self._compliance @ self._u  # T(7.17), (7.16)
        return np.abs(self._harmonic - self.beta * (g - 1j * u))

    @property
    def first_harmonic(self) -> np.ndarray:
        """Phasors X of the part Re(X e^{i tau}) of x_k at the frequency of the load, exact; complex (n,).

        What T 4.3.3 calls frequency-based: abs(X) is the transmissibility of T(4.4), angle(X) the phase of
        T(4.5).  The square wave's own first harmonic is 4/pi of it.
        """
        friction = -4j / math.pi * self.beta * self._dynamic
        return (self._harmonic + friction) * np.exp(-1j * self.contact_phase)

    def _at(self, tau: object, harmonic: np.ndarray, compliance: np.ndarray, *, velocity: bool) -> np.ndarray:
        """Samples at times of the load, continued from half a period: x(tau + pi) = -x(tau)."""
        try:
            tau = np.atleast_1d(np.asarray(tau, dtype=float))
        except (TypeError, ValueError):
            raise InputError(f"tau must be numbers; got {tau!r}") from None
        if tau.ndim != 1 or not np.isfinite(tau).all():
            raise InputError("tau must be one-dimensional and finite")
        since = np.mod(tau - self.contact_phase, 2.0 * math.pi)
        second = since >= math.pi
        values = self._half(np.where(second, since - math.pi, since), harmonic, compliance, velocity)
        return np.where(second, -values, values)

    def _half(
        self, t: np.ndarray, harmonic: np.ndarray, compliance: np.ndarray, velocity: bool
    ) -> np.ndarray:
        """x_k or x_k' at times 0 <= t <= pi after a maximum of z; shape (n, t.size)."""
        turn = np.exp(1j * t)
        values = (harmonic[:, np.newaxis] * (1j * turn if velocity else turn)).real
        if self.beta == 0.0:
            return values  # u may be infinite
        answer = self._friction_velocity(t) if velocity else self._friction_displacement(t)
        return values + self.beta * (compliance @ answer)

    def _friction_displacement(self, t: np.ndarray) -> np.ndarray:
        """h_i of theory.md 2; shape (n_seen, t.size)."""
        h = np.empty((self._w.size, t.size))
        for i, (w, zeta, u, g) in enumerate(zip(self._w, self._zeta, self._u, self._g, strict=True)):
            rise, q, _ = _answers(zeta, w / self.r * t)
            h[i] = (1.0 + g) * rise - g - u * (self.r / w) * q
        return h

    def _friction_velocity(self, t: np.ndarray) -> np.ndarray:
        """h_i' of theory.md 2; shape (n_seen, t.size)."""
        h = np.empty((self._w.size, t.size))
        for i, (w, zeta, u, g) in enumerate(zip(self._w, self._zeta, self._u, self._g, strict=True)):
            _, q, e = _answers(zeta, w / self.r * t)
            h[i] = (1.0 + g) * (w / self.r) * q - u * e
        return h

    def _largest_accelerations(self) -> np.ndarray:
        """Bounds of |h_i''| over all times; shape (n_seen,).

        h'' = a e + b q, and q^2 + e^2 <= 1: it is the energy of free motion, 1 at the start.
        """
        a = self._w / self.r
        return np.hypot((1.0 + self._g) * a * a + 2.0 * self._zeta * a * self._u, a * self._u)


def _largest_moduli(motion: ContinuousMotion, harmonic: np.ndarray, compliance: np.ndarray) -> np.ndarray:
    """max |x_k| over half a period, shape (n,); no larger value exists by more than `_TOLERANCE`.

    An interval of length l holds nothing above the larger of its ends plus l^2/8 max |x''|.  Those that
    could hold more than the best so far are cut up until it is too little to matter.
    """
    if motion.beta == 0.0:
        return np.abs(harmonic)
    bend = np.abs(harmonic) + motion.beta * (np.abs(compliance) @ motion._largest_accelerations())
    # next to a pole of u the parts cancel: below the rounding of the largest there is nothing to look for
    parts = 1.0 + np.abs(1.0 + motion._g) + np.abs(motion._u) * motion.r / motion._w
    size = np.abs(harmonic) + motion.beta * (np.abs(compliance) @ parts)
    length = math.pi / _INTERVALS
    t = np.linspace(0.0, math.pi, _INTERVALS + 1)
    x = np.abs(motion._half(t, harmonic, compliance, False))
    best = x.max(axis=1)
    n = harmonic.size
    # open intervals of all masses in one list: mass, start, larger end
    mass = np.repeat(np.arange(n), _INTERVALS)
    start = np.tile(t[:-1], n)
    top = np.maximum(x[:, :-1], x[:, 1:]).ravel()
    for _ in range(_ROUNDS):
        slack = length * length / 8.0 * bend
        wanted = (top + slack[mass] > best[mass]) & (slack > _TOLERANCE * np.maximum(best, size))[mass]
        # so many are left only where the parts cancel down to rounding, all along: samples say as much
        if not 0 < np.count_nonzero(wanted) <= _MOST_OPEN:
            break
        mass, start = mass[wanted], start[wanted]
        length /= _PARTS
        nodes = np.minimum(start[:, np.newaxis] + length * np.arange(_PARTS + 1), math.pi)
        answer = motion._friction_displacement(nodes.ravel())
        friction = np.einsum("ji,ij->j", np.repeat(compliance[mass], _PARTS + 1, axis=0), answer)
        linear = (harmonic[mass, np.newaxis] * np.exp(1j * nodes)).real
        x = np.abs(linear + motion.beta * friction.reshape(nodes.shape))
        np.maximum.at(best, mass, x.max(axis=1))
        mass = np.repeat(mass, _PARTS)
        start = nodes[:, :-1].ravel()
        top = np.maximum(x[:, :-1], x[:, 1:]).ravel()
    return best


def _dynamic_compliance(modes: ModalModel, r: float, seen: np.ndarray) -> np.ndarray:
    """sum over seen modes of phi_ki chi_i/(w_i^2 - r^2 + 2 i zeta_i w_i r), complex (n,)."""
    stiffness = modes.dynamic_stiffness(np.array([r]))[0, seen]
    # zero at an undamped resonance, which only a motion without friction survives
    return (modes.phi[:, seen] * modes.chi[seen]) @ np.divide(
        1.0, stiffness, out=np.zeros_like(stiffness), where=stiffness != 0.0
    )


def continuous_motion(system: System, r: SupportsFloat, beta: SupportsFloat) -> ContinuousMotion:
    """The continuous steady state, in closed form.

    Parameters
    ----------
    system : System
    r, beta : float
        Frequency ratio (> 0) and friction ratio (>= 0) [-].  The ratio mu of static to kinetic friction does
        not enter the motion, but only below `beta_lim` of `frictionmap.boundaries` at mu is it one that the
        structure can make.  Above beta_lim at mu = 1, the largest, it is none for any mu and is refused.

    Returns
    -------
    ContinuousMotion

    Raises
    ------
    InputError
        An argument is out of range.
    NoSteadyState
        No motion is continuous there, or the motion grows without bound at an undamped resonance.

    Notes
    -----
    theory.md 2; T(7.20), (7.21), (7.28) for all three contacts, any number of modes, any damping.

    Examples
    --------
    >>> import frictionmap as fm
    >>> motion = fm.continuous_motion(fm.System(contact="joined-base-wall"), r=1.6, beta=0.5)
    >>> round(float(motion.amplitude[0]), 4)
    0.665
    """
    checks.instance(system, "system", System)
    r = checks.number(r, "r", above=0.0, most=checks.LARGEST_RATIO)
    beta = checks.number(beta, "beta", least=0.0)
    modes = system.modes
    at = np.array([r])
    found = find_curves(system, at, np.ones(1))
    v, beta_lim = found.v[0], found.beta_lim[0, 0]
    responses = np.array([modes.response(at, row)[0] for row in modes.phi])
    if np.isinf(v) or np.isinf(responses).any():
        raise NoSteadyState(f"r = {r:g}: an undamped resonance; the motion grows without bound")
    if beta > beta_lim:
        raise NoSteadyState(
            f"r = {r:g}, beta = {beta:g}: no motion is continuous above beta_lim = {beta_lim:.6g}"
        )
    seen = modes.chi != 0.0
    w, zeta, chi = modes.w[seen], modes.zeta[seen], modes.chi[seen]
    u, g = np.array([damping_functions(*mode, r) for mode in zip(w, zeta, strict=True)]).T
    # beta U, and beta G: U and u may be infinite where beta is 0
    swing, lift = (beta * found.u[0], beta * found.g[0]) if beta > 0.0 else (0.0, 0.0)
    # not above beta_lim, |V| is below beta |U| by rounding only
    root = math.sqrt(max(abs(v) - abs(swing), 0.0) * (abs(v) + abs(swing)))
    phase = math.atan2(-swing, root) - math.atan2(v.imag, v.real)  # T(7.21)
    return ContinuousMotion(
        r=r,
        beta=beta,
        contact_amplitude=root - lift,
        contact_phase=phase,
        _w=w,
        _zeta=zeta,
        _u=u,
        _g=g,
        _compliance=modes.phi[:, seen] * (chi / w**2),
        _contact_compliance=(chi / w)[np.newaxis] ** 2,
        _dynamic=_dynamic_compliance(modes, r, seen),
        _harmonic=responses * np.exp(1j * phase),
        _contact_harmonic=complex(root, -swing),
    )


def inversion_points(
    system: System, mass: int, beta: float, low: float, high: float, samples: int = 200
) -> np.ndarray:
    """Frequency ratios in (low, high) where friction leaves the exact amplitude of a mass as it is without.

    On one side of such a point friction lowers the amplitude, on the other it raises it.  For beta -> 0 they
    are `features.mass_invariant_points`.  Looked for at so many samples, equally spaced, where the motion is
    continuous: points closer together, or to the end of a stretch with continuous motion, are missed.
    """
    from scipy.optimize import brentq

    mass = checks.whole(mass, "mass", least=1, most=system.n)
    beta = checks.number(beta, "beta", above=0.0)
    low = checks.number(low, "low", above=0.0)
    high = checks.number(high, "high", above=low, most=checks.LARGEST_RATIO)
    samples = checks.whole(samples, "samples", least=2)
    modes = system.modes

    def gain(r: float) -> float:
        frictionless = abs(modes.response(np.array([r]), modes.phi[mass - 1])[0])
        return float(continuous_motion(system, r, beta).amplitude[mass - 1] - frictionless)

    def gain_or_none(r: float) -> float:
        try:
            return gain(r)
        except NoSteadyState:
            return math.nan

    r = np.linspace(low, high, samples)
    values = np.array([gain_or_none(x) for x in r])
    points = list(r[values == 0.0])
    for k in np.flatnonzero(np.sign(values[1:]) * np.sign(values[:-1]) < 0.0):
        try:
            points.append(brentq(gain, r[k], r[k + 1], xtol=1e-15))
        except NoSteadyState:  # a gap between the two: the sign changed across it
            continue
    return np.array(sorted(points))
