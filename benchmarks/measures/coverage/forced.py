"""Forced responses with known true values: exact first harmonics, identified by `forced`."""

from collections.abc import Callable
from functools import lru_cache, partial
from typing import NamedTuple

import numpy as np

import frictionmap as fm

from ...references.chains import chain, continuous
from ...references.shaken import Rig, steady
from .case import Case, Made, cramer_rao, robust
from .disturbances import outliers


class Truth(NamedTuple):
    """Tests of one structure; every set of `beta` is measured at every r."""

    beta: tuple[float, ...]
    f_n: float
    zeta: float
    mu: float
    r: tuple[float, ...]
    wall_moves: bool = False
    sigma_phase: float = 0.7  # deg
    sigma_amplitude: float = 0.01
    spring: float = 0.0  # stiffness in the contact over k1; 0: rigid


#: Frequency ratios of random tests.
RATIOS = (0.65, 0.8, 0.93, 1.06, 1.2, 1.5, 2.0)

#: Tests of the specification.
WALL = Truth((0.2, 0.4, 0.6), 3.086, 0.004, 1.0, (0.5, 0.7, 0.85, 0.93, 1.06, 1.2, 1.5, 2.0))
BASE_WALL = Truth((0.5, 0.75, 1.0), 3.086, 0.004, 1.0, (1.1, 1.3, 1.45, 1.6, 1.8, 2.1), True)
STICK_SLIP = Truth(
    (0.25, 0.45, 0.65), 3.086, 0.006, 1.15, (0.15, 0.22, 0.28, 0.36, 0.44, 0.55, 0.7), False, 0.3, 0.005
)

#: A spring in the contact: near sticking in the last set, and far from it in all.
SPRING = Truth((0.3, 0.6, 0.9), 3.086, 0.01, 1.0, RATIOS, spring=3.0)
FAR = Truth((0.02, 0.05), 3.086, 0.01, 1.0, RATIOS, spring=3.0)

#: Two storeys, contact on the second one: beta, zeta, f_k1m1 [Hz], ratios, frequency ratios, errors.
TWO_BETA, TWO_ZETA, TWO_F = 0.2, 0.003, 2.9248318221702254
TWO_MASSES, TWO_SPRINGS = (1.0, 0.9772), (1.0, 1.1119)
TWO_RATIOS = (0.55, 0.68, 0.75, 0.85, 1.25, 1.35, 1.45, 1.55, 1.75)
TWO_SIGMAS = 1.0, 0.015


def _phasor(truth: Truth, r: float, beta: float) -> complex:
    """X/Y of one mass with its damper between base and mass: closed form, or marched if it stops."""
    if not truth.spring:
        moving = continuous(chain([1.0], [1.0], [truth.zeta], True), 0, truth.wall_moves, r, beta)
        if moving is not None:
            return complex(moving[0])
    rig = Rig(1.0, truth.zeta, beta, truth.mu, 0.0, r, (0.0, 1.0), truth.wall_moves, spring=truth.spring)
    return steady(rig).first_harmonic()


@lru_cache(maxsize=64)
def _phasors(truth: Truth) -> np.ndarray:
    """X/Y of every set at every r, one set after another."""
    return np.array([_phasor(truth, r, beta) for beta in truth.beta for r in truth.r])


def _quantities(phasors: np.ndarray) -> np.ndarray:
    """Phase lags [rad], then logarithms of amplitudes."""
    return np.concatenate((-np.angle(phasors), np.log(np.abs(phasors))))


def _bound(truth: Truth, names: dict[str, float]) -> dict[str, float]:
    """Cramer-Rao bound of beta of every set, f_n, zeta and optionally mu or the spring."""
    sets, frequency = len(truth.beta), truth.f_n * np.array(truth.r)

    def model(values: np.ndarray) -> np.ndarray:
        law = float(values[sets + 2]) if values.size > sets + 2 else truth.mu
        one = truth._replace(
            beta=tuple(values[:sets].tolist()), f_n=1.0, zeta=float(values[sets + 1]),
            r=tuple((frequency / values[sets]).tolist()),
        )  # fmt: skip
        return _quantities(_phasors(one._replace(spring=law) if truth.spring else one._replace(mu=law)))

    count = sets * len(truth.r)
    return cramer_rao(model, names, np.repeat([np.radians(truth.sigma_phase), truth.sigma_amplitude], count))


def _made(
    rng: np.random.Generator,
    draw: Callable[[np.random.Generator], Truth],
    far: bool = False,
    given: bool = False,
    mu_known: bool = True,
    **arguments: object,
) -> Made:
    """Add noise to the first harmonics; `far`: also outliers; `given`: pass the errors of the data to the
    fit.
    """
    truth = draw(rng)
    names = {f"beta_{k}": beta for k, beta in enumerate(truth.beta, start=1)}
    names |= {"f_n": truth.f_n, "zeta": truth.zeta} | ({} if mu_known else {"mu": truth.mu})
    if truth.spring:
        names["contact_stiffness"] = truth.spring
        arguments = {"free": ["beta", "f_n", "zeta", "contact_stiffness"], **arguments}
    phasors = _phasors(truth)
    errors = [rng.normal(0.0, one, phasors.size) for one in (truth.sigma_phase, truth.sigma_amplitude)]
    if far:
        errors[0] += outliers(rng, phasors.size, truth.sigma_phase)
        errors[1] += outliers(rng, phasors.size, truth.sigma_amplitude)
    words: dict[str, object] = {
        "sets": np.repeat(np.arange(1, len(truth.beta) + 1), len(truth.r)),
        "system": fm.System(
            contact="joined-base-wall" if truth.wall_moves else "fixed-wall",
            excitation="base", damping_reference="base",
        ),
        "known": {"mu": 1.0} if mu_known else {},
    }  # fmt: skip
    if given:
        words |= {"sigma_phase": truth.sigma_phase, "sigma_amplitude": truth.sigma_amplitude}
    frequency = np.tile(truth.f_n * np.array(truth.r), len(truth.beta))
    bound = None if draw is _with_spring else _bound(truth, names)  # it takes much longer than the fit
    lag, ratio = -np.degrees(np.angle(phasors)) + errors[0], np.abs(phasors) * np.exp(errors[1])
    return Made(names, lambda: fm.identify.forced(frequency, lag, ratio, **words, **arguments), bound)


def _random(rng: np.random.Generator, heavy: bool = False) -> Truth:
    """One storey tested with two friction forces."""
    zeta = rng.uniform(0.08, 0.12) if heavy else 10.0 ** rng.uniform(-2.5, -1.5)
    beta = rng.uniform(0.1, 0.25), rng.uniform(0.3, 0.5)
    return Truth(beta, rng.uniform(2.0, 6.0), zeta, 1.0, RATIOS)


def _with_spring(rng: np.random.Generator) -> Truth:
    """One storey with a spring in its contact, which sticks for a part of the cycle."""
    zeta, spring = 10.0 ** rng.uniform(-2.2, -1.5), 10.0 ** rng.uniform(-0.3, 1.3)
    beta = rng.uniform(0.3, 0.5), rng.uniform(0.6, 0.9)
    return Truth(beta, rng.uniform(2.0, 6.0), zeta, 1.0, RATIOS, spring=spring)


def _fixed(truth: Truth) -> Callable[[np.random.Generator], Truth]:
    return lambda rng: truth


@lru_cache(maxsize=32)
def _storeys(beta: float, zeta: float) -> np.ndarray:
    """X/Y of both storeys, shape (2, frequencies)."""
    structure = chain(TWO_MASSES, TWO_SPRINGS, [zeta] * 2, False)
    found = [continuous(structure, 1, False, r, beta) for r in TWO_RATIOS]
    return np.array(found).T


def _two_storeys(rng: np.random.Generator) -> Made:
    """Phase lags and amplitudes of both storeys, errors given; beta and zeta are fitted."""
    phasors = _storeys(TWO_BETA, TWO_ZETA)
    lags = -np.degrees(np.angle(phasors)) + rng.normal(0.0, TWO_SIGMAS[0], phasors.shape)
    ratios = np.abs(phasors) * np.exp(rng.normal(0.0, TWO_SIGMAS[1], phasors.shape))
    system = fm.System(
        contact_masses=[2], excitation="base", mass_ratios=TWO_MASSES, stiffness_ratios=TWO_SPRINGS
    )
    truth = {"beta": TWO_BETA, "zeta": TWO_ZETA}
    bound = cramer_rao(
        lambda values: _quantities(_storeys(*values.tolist()).ravel()), truth,
        np.repeat([np.radians(TWO_SIGMAS[0]), TWO_SIGMAS[1]], phasors.size),
    )  # fmt: skip
    return Made(
        truth,
        lambda: fm.identify.forced(
            TWO_F * np.array(TWO_RATIOS), dict(enumerate(lags, start=1)), dict(enumerate(ratios, start=1)),
            system=system, known={"f_n": TWO_F, "mu": 1.0},
            sigma_phase=TWO_SIGMAS[0], sigma_amplitude=TWO_SIGMAS[1],
        ),
        bound,
    )  # fmt: skip


CASES = (
    Case("two sets, noise only", partial(_made, draw=_random)),
    Case("zeta 0.08 to 0.12", partial(_made, draw=partial(_random, heavy=True))),
    Case("outliers", partial(_made, draw=_random, far=True, **robust(fm.identify.forced))),
    Case("two storeys", _two_storeys),
    Case("curves-wall, three sets", partial(_made, draw=_fixed(WALL), given=True), 100),
    Case("wall on the base, three sets", partial(_made, draw=_fixed(BASE_WALL), given=True), 100),
    Case(
        "curves-stick-slip, mu fitted",
        partial(_made, draw=_fixed(STICK_SLIP), given=True, mu_known=False),
        100,
    ),
    Case("spring in the contact, two sets", partial(_made, draw=_with_spring), 100),
    Case("spring in the contact, three sets", partial(_made, draw=_fixed(SPRING), given=True), 100),
    Case("spring in the contact, far from sticking", partial(_made, draw=_fixed(FAR), given=True), 40),
)
