"""Continuous (non-sticking) steady state in closed form, theory.md 2.

Its friction force is a square wave locked to the maxima of z.  The response of a mode to this wave, without
its harmonic part, is ``h`` of theory.md 2; everything else is harmonic.  Modes that do not participate have
the harmonic part only; their u, which may be infinite, is not used.  Where the damping couples modes,
theory.md 8 applies.
"""

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import SupportsFloat

import numpy as np

from .. import checks
from ..errors import InputError, NoSteadyState
from ..model.general import refuse_general
from ..model.modes import ModalModel, wrapped
from ..model.system import System
from .boundary_curves import find_curves
from .energy import damping_participation, transmitted_first_harmonic, work_input
from .half_waves import (
    FrictionResponses,
    Peaks,
    compliances,
    contact_compliances,
    dynamic_amplification,
    friction_responses,
    mass_peaks,
    peak_phases,
)


@dataclass(frozen=True, eq=False)
class ContinuousMotion:
    """A continuous steady state; see `continuous_motion`.

    Times tau are those of the load, as in `frictionmap.response`: one number or a list, of any size, since
    the motion is periodic.  Displacements are in P/k1 (Y), phases are lags behind the load in radian, and
    work is in P^2/k1 per cycle.

    Attributes
    ----------
    r, beta : float
        Frequency ratio and friction ratio.
    contact_amplitude : float
        Z, the amplitude of z, T(2.34), (7.20).
    contact_phase : float
        phi_z in (-pi, pi]: z is largest at tau = phi_z, (2.35), (7.21) of T.
    """

    r: float
    beta: float
    contact_amplitude: float
    contact_phase: float
    _modes: ModalModel = field(repr=False)
    _responses: FrictionResponses = field(repr=False)  # of this one motion
    # phasors of the harmonic part from a maximum of z on: V_k e^{i phi_z}, (n,), and V e^{i phi_z}
    _harmonic: np.ndarray = field(repr=False)
    _contact_harmonic: complex = field(repr=False)

    @cached_property
    def _compliance(self) -> np.ndarray:
        """Responses of every mass to friction, (n, responses)."""
        return compliances(self._modes)

    @cached_property
    def _contact_compliance(self) -> np.ndarray:
        """Responses of z to friction, (1, responses)."""
        return contact_compliances(self._modes)[np.newaxis]

    def displacement(self, tau: object) -> np.ndarray:
        """Displacements x_k, T(7.28) with d(tau) of (B.8a); shape (n, tau.size)."""
        return self._at(tau, self._harmonic, self._compliance, velocity=False)

    def velocity(self, tau: object) -> np.ndarray:
        """Velocities dx_k/dtau; shape (n, tau.size)."""
        return self._at(tau, self._harmonic, self._compliance, velocity=True)

    def contact(self, tau: object) -> np.ndarray:
        """Contact displacement z = c.x - s cos(tau), T(5.41), (7.23); shape (tau.size,)."""
        return self._at(tau, np.array([self._contact_harmonic]), self._contact_compliance, velocity=False)[0]

    def contact_velocity(self, tau: object) -> np.ndarray:
        """Contact velocity dz/dtau; shape (tau.size,)."""
        return self._at(tau, np.array([self._contact_harmonic]), self._contact_compliance, velocity=True)[0]

    @cached_property
    def _peaks(self) -> Peaks:
        one = np.array([self.beta]), self._harmonic[np.newaxis], np.array([self.contact_amplitude])
        return Peaks(*(part[0] for part in mass_peaks(self._modes, self._responses, *one)))

    @property
    def amplitude(self) -> np.ndarray:
        """Exact amplitude max |x_k(tau)| of every mass; shape (n,)."""
        return self._peaks.modulus

    @property
    def phase(self) -> np.ndarray:
        """Load phase tau in (-pi, pi] at which x_k is largest, its lag behind the load, (3.27), (7.29) of T;
        (n,).

        NaN for a mass at rest.
        """
        return peak_phases(self._peaks, self.contact_phase)

    @property
    def monoharmonic_amplitude(self) -> np.ndarray:
        """Approximate amplitude of every mass from x and x' at a maximum of z, T(5.50), (7.33); shape (n,).

        It follows from T(7.31), (7.32); the sign of U_dk sin(..) in T(7.33) is a misprint.
        """
        u, g = (self._compliance @ part[0] for part in self._responses.at_maximum())  # T(7.16), (7.17)
        return np.abs(self._harmonic - self.beta * (g - 1j * u))

    @property
    def first_harmonic(self) -> np.ndarray:
        """Exact first-harmonic phasors X, with Re(X e^{i tau}) the part of x_k at the load frequency; complex
        (n,).

        These are the frequency-based results of T 4.3.3: abs(X) is the transmissibility of T(4.4), -angle(X)
        the phase lag of T(4.5).
        """
        return self.harmonics(1)[:, 1]

    def harmonics(self, n: int) -> np.ndarray:
        """Harmonics X_km of x_k = X_k0 + Re sum_m X_km e^{i m tau}, m = 0..n; complex (n_masses, n + 1).

        Exact, theory.md 9 (1), (2); even harmonics are zero.
        """
        return self._harmonics(n, self._harmonic, self._compliance)

    def contact_harmonics(self, n: int) -> np.ndarray:
        """Harmonics Z_m of z, m = 0..n, as in `harmonics`; complex (n + 1,)."""
        return self._harmonics(n, np.array([self._contact_harmonic]), self._contact_compliance)[0]

    def friction_harmonics(self, n: int) -> np.ndarray:
        """Harmonics F_m of the friction force against z', over P, m = 0..n, as in `harmonics`; complex (n +
        1,).
        """
        order = np.arange(checks.whole(n, "n", least=0) + 1)
        odd = order % 2 == 1
        # harmonics of the wave that is -beta while z falls, counted from its maximum
        waves = np.where(odd, 4j / math.pi * self.beta / np.where(odd, order, 1), 0.0)
        return waves * np.exp(-1j * self.contact_phase * order)

    def _harmonics(self, n: int, harmonic: np.ndarray, compliance: np.ndarray) -> np.ndarray:
        force = self.friction_harmonics(n)
        # at an undamped m r = w_i the force has no harmonic m: even ones vanish, and for odd m no motion with
        # friction is continuous
        shares = dynamic_amplification(self._modes, self.r * np.arange(force.size))
        found = np.zeros((harmonic.size, force.size), dtype=complex)
        found[:, 1:2] = (harmonic * np.exp(-1j * self.contact_phase))[:, np.newaxis]
        return found - force * (compliance @ shares.T)

    @property
    def sliding_distance(self) -> float:
        """Distance that the contact slides per cycle, 4 Z."""
        return 4.0 * self.contact_amplitude

    @property
    def work_friction(self) -> float:
        """Work dissipated by friction per cycle."""
        return self.beta * self.sliding_distance

    @property
    def work_input(self) -> float:
        """Work per cycle of the load, or of everything that moves base and wall."""
        return work_input(self._modes, self.r, self.first_harmonic, self.friction_harmonics(1)[1])

    @property
    def work_damping(self) -> float:
        """Work dissipated by the dashpots per cycle, sum_i 2 zeta_i w_i r int q_i'^2, theory.md 9 (6)."""
        modes, r, beta = self._modes, self.r, self.beta
        if modes.coupled_modes.any():
            return self._coupled_work_damping
        part = damping_participation(modes, r) * np.exp(1j * self.contact_phase)
        rate = 2.0 * math.pi * modes.zeta * modes.w * r
        work = float(np.sum(rate * np.abs(part) ** 2))
        participating = modes.chi != 0.0
        # cross terms of the harmonic part with the modal responses to friction, then these responses alone
        share = modes.chi[participating] / modes.w[participating] ** 2
        turned = (1j * part[participating] * np.conj(dynamic_amplification(modes, np.array([r]))[0])).real
        alone = 4.0 * (modes.w[participating] * share) ** 2 * self._responses.g[0]
        work += beta * float(np.sum(8.0 / math.pi * rate[participating] * share * turned))
        return work + beta * beta * float(np.sum(alone))

    @property
    def _coupled_work_damping(self) -> float:
        """Work dissipated by the dashpots where the damping couples modes, theory.md 8."""
        modes, at = self._modes, np.array([self.r])
        friction = np.zeros((1, modes.w.size), dtype=complex)
        responses = (
            modes.free.compliances(np.eye(modes.free.omega.size)) @ dynamic_amplification(modes, at)[0]
        )
        friction[0, modes.participating] = -self.friction_harmonics(1)[1] * responses
        whole = damping_participation(modes, self.r) + friction
        first = math.pi * self.r * float((modes.damping_form(whole) - modes.damping_form(friction))[0])
        lift = float(self._contact_compliance[0] @ self._responses.at_maximum()[1][0])  # G
        return first + 4.0 * self.beta**2 * lift

    @property
    def equivalent_damping(self) -> float:
        """c_eq omega/k1 of the dashpot that dissipates the work of friction for harmonic z of amplitude Z."""
        if self.beta == 0.0:
            return 0.0
        z = self.contact_amplitude
        return 4.0 * self.beta / (math.pi * z) if z > 0.0 else math.inf

    @property
    def transmitted_first_harmonic(self) -> complex:
        """First harmonic of the force transmitted to the ground, the loads less the inertia, over P."""
        return transmitted_first_harmonic(self._modes, self.r, self.first_harmonic)

    def _at(self, tau: object, harmonic: np.ndarray, compliance: np.ndarray, *, velocity: bool) -> np.ndarray:
        """Evaluate at times of the load, continuing the half period by x(tau + pi) = -x(tau)."""
        try:
            tau = np.atleast_1d(np.asarray(tau, dtype=float))
        except (TypeError, ValueError):
            raise InputError("tau", f"must be numbers; got {tau!r}") from None
        if tau.ndim != 1 or not np.isfinite(tau).all():
            raise InputError("tau", f"must be one-dimensional and finite; got {tau!r}")
        since = np.mod(tau - self.contact_phase, 2.0 * math.pi)
        second = since >= math.pi
        values = self._half(np.where(second, since - math.pi, since), harmonic, compliance, velocity)
        return np.where(second, -values, values)

    def _half(
        self, t: np.ndarray, harmonic: np.ndarray, compliance: np.ndarray, velocity: bool
    ) -> np.ndarray:
        """Evaluate x_k or x_k' at times 0 <= t <= pi after a maximum of z; shape (n, t.size)."""
        turn = np.exp(1j * t)
        values = (harmonic[:, np.newaxis] * (1j * turn if velocity else turn)).real
        which = range(compliance.shape[1])
        if velocity:
            responses = [self._responses.rates(i, 0, t)[0] for i in which]
        else:
            responses = [self._responses.displacement(i, 0, t) for i in which]
        return values + self.beta * (compliance @ responses)


def continuous_motion(system: System, r: SupportsFloat, beta: SupportsFloat) -> ContinuousMotion:
    """Compute the continuous steady state in closed form.

    Parameters
    ----------
    system : System
    r, beta : float
        Frequency ratio (> 0) and friction ratio (>= 0) [-].  The motion does not depend on mu, but the
        structure can follow it only below `beta_lim` of `frictionmap.boundaries` at that mu.  Above beta_lim
        at mu = 1, the largest value, no such motion exists for any mu, and an error is raised.

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
    refuse_general(system, "compute the continuous motion")
    r = checks.number(r, "r", above=0.0, most=checks.LARGEST_RATIO)
    beta = checks.number(beta, "beta", least=0.0)
    modes = system.modes
    at = np.array([r])
    found = find_curves(system, at, np.ones(1))
    v, beta_lim = found.v[0], found.beta_lim[0, 0]
    responses = modes.mass_responses(at)[0]
    if np.isinf(v) or np.isinf(responses).any():
        raise NoSteadyState(f"r = {r:g}: an undamped resonance; the motion grows without bound")
    if beta > beta_lim:
        raise NoSteadyState(
            f"r = {r:g}, beta = {beta:g}: no motion is continuous above beta_lim = {beta_lim:.6g}"
        )
    # beta U, and beta G: U may be infinite where beta is 0
    swing, lift = (beta * found.u[0], beta * found.g[0]) if beta > 0.0 else (0.0, 0.0)
    # up to beta_lim, |V| can be below beta |U| by rounding only
    root = math.sqrt(max(abs(v) - abs(swing), 0.0) * (abs(v) + abs(swing)))
    phase = float(wrapped(math.atan2(-swing, root) - math.atan2(v.imag, v.real)))  # T(7.21)
    return ContinuousMotion(
        r=r,
        beta=beta,
        contact_amplitude=root - lift,
        contact_phase=phase,
        _modes=modes,
        _responses=friction_responses(modes, at, np.array([beta])),
        _harmonic=responses * np.exp(1j * phase),
        _contact_harmonic=complex(root, -swing),
    )


def inversion_points(
    system: System, mass: int, beta: float, low: float, high: float, samples: int = 200
) -> np.ndarray:
    """Find frequency ratios in (low, high) where friction does not change the exact amplitude of a mass.

    On one side of such a point friction lowers the amplitude, on the other side it raises it.  For beta -> 0
    the points are `features.mass_invariant_points`.  The search uses equally spaced samples where the motion
    is continuous: points closer together than two samples, or closer than one to the end of a range of
    continuous motion, are missed.
    """
    from scipy.optimize import brentq

    row = system.dofs.row(system.dofs.number(mass, "mass"))
    beta = checks.number(beta, "beta", above=0.0)
    low = checks.number(low, "low", above=0.0)
    high = checks.number(high, "high", above=low, most=checks.LARGEST_RATIO)
    samples = checks.whole(samples, "samples", least=2)
    modes = system.modes

    def gain(r: float) -> float:
        frictionless = abs(modes.response(np.array([r]), modes.phi[row])[0])
        return float(continuous_motion(system, r, beta).amplitude[row] - frictionless)

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
        except NoSteadyState:  # no continuous motion in between: the sign changed across this gap
            continue
    return np.array(sorted(points))
