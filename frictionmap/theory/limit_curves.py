"""Amplitude and phase of every mass at the boundary of continuous motion, beta_lim(r), theory.md 9.

At the boundary root(|V|^2 - beta^2 U^2) equals beta max(S, H + mu/(m_eff r^2)), so that z is known without a
difference of large numbers.  Where an undamped mode resonates, V and U are infinite but the motion is not.
Where beta_lim is 0, at r = 0 or a pole of U, the motion is the one without friction.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr

from ..datasets.variables import label_variable
from ..model.modes import ModalModel, wrapped
from ..model.system import System
from .boundary_curves import Curves, over_square, sliding_bracket
from .half_waves import (
    RESONANT_FIRST_HARMONIC,
    RESONANT_U,
    compliances,
    contact_compliances,
    dynamic_amplification,
    friction_responses,
    mass_peaks,
    peak_phases,
)


class LimitMotions(NamedTuple):
    """Continuous motions at beta_lim for one mu, over frequency.

    r, beta : (n_r,)
    contact_phase : (n_r,) phi_z; 0 where there is no friction
    harmonic : (n_r, n) complex, from a maximum of z, as in `HalfWaves`
    infinite : (n_r, n) bool, whether a mass resonates; its harmonic is then 0
    """

    r: np.ndarray
    beta: np.ndarray
    contact_phase: np.ndarray
    harmonic: np.ndarray
    infinite: np.ndarray


def _limit_motions(
    modes: ModalModel, r: np.ndarray, found: Curves, beta: np.ndarray, bracket: np.ndarray
) -> LimitMotions:
    """Find the motions at beta_lim for one mu."""
    resonant = (beta > 0.0) & np.isinf(found.v)
    regular = (beta > 0.0) & ~resonant
    u, size, v = (np.where(regular, part, 1.0) for part in (found.u, bracket, found.v))
    phase = np.where(regular, -np.arctan2(u, size) - np.angle(v), 0.0)
    responses = modes.mass_responses(r)
    infinite = np.isinf(responses) & ~resonant[:, np.newaxis]
    harmonic = np.where(np.isinf(responses), 0.0, responses) * np.exp(1j * phase)[:, np.newaxis]
    for j in np.flatnonzero(resonant):
        phase[j], harmonic[j] = _at_resonance(modes, r[j], beta[j], bracket[j])
    return LimitMotions(r, beta, phase, harmonic, infinite)


def _at_resonance(modes: ModalModel, r: float, beta: float, bracket: float) -> tuple[float, np.ndarray]:
    """phi_z and harmonic part of every mass where an undamped loaded mode i has w_i = r.

    Its u is taken without the part u sin(tau), with which the harmonic motion is finite.  z determines the
    motion of mode i; x_k - (phi_ki/chi_i) z does not depend on mode i.
    """
    at = np.array([r])
    load = modes.participation(at)
    i = int(np.flatnonzero((modes.dynamic_stiffness(at)[0] == 0.0) & (modes.chi != 0.0))[0])
    u = friction_responses(modes, at, np.array([beta])).at_maximum()[0][0]
    u = np.where(np.isinf(u), RESONANT_U, u)
    contact = beta * complex(bracket, -float(np.sum(contact_compliances(modes) * u)))
    turn = 1j * np.abs(load[0, i]) / load[0, i] * np.sign(modes.chi[i])  # e^{i phi_z}
    others = modes.modal_responses(at, load)[0]
    others[np.isinf(others)] = 0.0
    share = modes.phi[:, i] / modes.chi[i]
    remaining = modes.phi @ others - share * (modes.chi @ others - modes.base_motion)
    return float(np.angle(turn)), share * contact + turn * remaining


def _first_harmonics(modes: ModalModel, motions: LimitMotions) -> np.ndarray:
    """First harmonics X_k1, complex (n_r, n)."""
    shares = dynamic_amplification(modes, motions.r)
    responses = np.where(shares == 0.0, RESONANT_FIRST_HARMONIC, -4j / np.pi * shares)
    friction = motions.beta[:, np.newaxis] * (responses @ compliances(modes).T)
    return (motions.harmonic + friction) * np.exp(-1j * motions.contact_phase)[:, np.newaxis]


def _amplitudes_and_phases(
    modes: ModalModel, r: np.ndarray, found: Curves, beta: np.ndarray, bracket: np.ndarray
) -> dict[str, np.ndarray]:
    """The four variables for one mu, (n_r, n) each; `beta` (n_r,) is beta_lim, `bracket` that of S."""
    bracket = np.where(beta > 0.0, bracket, 0.0)
    motions = _limit_motions(modes, r, found, beta, bracket)
    responses = friction_responses(modes, np.where(beta > 0.0, r, 1.0), beta)
    z = beta * (bracket - np.where(beta > 0.0, found.g, 0.0))
    peaks = mass_peaks(modes, responses, beta, motions.harmonic, z)
    first = _first_harmonics(modes, motions)
    size = np.abs(first)
    values = {
        "limit_amplitude": peaks.modulus,
        "limit_phase": peak_phases(peaks, motions.contact_phase[:, np.newaxis]),
        "limit_first_harmonic_amplitude": size,
        "limit_first_harmonic_phase": np.where(size > 0.0, wrapped(-np.angle(first)), np.nan),
    }
    return {
        name: np.where(motions.infinite, np.nan if name.endswith("phase") else np.inf, value)
        for name, value in values.items()
    }


def limit_variables(system: System, r: np.ndarray, mu: np.ndarray, found: Curves) -> dict[str, xr.Variable]:
    """Amplitude and phase, also of the first harmonic, at beta_lim; dims (mu, r, dof).

    `r` and `mu` are checked axes, and `found` the curves there.  Phases are lags in radian.  A mass that
    resonates in a mode that does not participate has infinite amplitude.  Such a mass, and a mass at rest,
    has no phase: NaN.
    """
    modes = system.modes
    bracket = sliding_bracket(found.h, found.s, over_square(modes.inverse_mass, r), mu)
    rows = [
        _amplitudes_and_phases(modes, r, found, beta, row)
        for beta, row in zip(found.beta_lim, bracket, strict=True)
    ]
    return {name: label_variable(name, np.array([row[name] for row in rows])) for name in rows[0]}
