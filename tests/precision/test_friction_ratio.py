"""Friction ratios from single lags: the closed form, roots of the exact lag, and where there is none."""

import numpy as np
import pytest
from responses import continuous
from scipy.optimize import minimize_scalar

import frictionmap as fm
from frictionmap.steady.points import steady_states

#: r, beta and the exact lag [deg] of one mass on a fixed wall, by integration in 40 digits.
EXACT = [
    (0.42, 0.1, 7.072484048645867),
    (0.65, 0.5741, 44.23664122251264),
    (0.8, 0.4, 30.50086066977087),
    (0.95, 0.2, 14.752336914253982),
    (1.1, 0.6, 130.28607213981977),
    (1.25, 0.392, 150.10364134894303),
    (1.85, 0.5741, 134.6611096446578),
    (2.4, 0.3, 157.62688056861677),
]
BASE_WALL = fm.System("joined-base-wall", damping_reference="base")


def lag_of(r, beta, zeta=0.0):
    return -np.degrees(np.angle(continuous(r, beta, zeta)))


def off(found, beta):
    """How far the nearest friction ratio is."""
    return min((abs(one - beta) for one in found.beta), default=np.inf)


def test_exact_lags():
    r, beta, lag = np.transpose(EXACT)
    for one, truth in zip(fm.identify.friction_ratio(r, lag), beta, strict=True):
        assert one.beta == pytest.approx([truth], abs=1e-12)


def test_random_continuous_motions():
    """Both roots count: near beta_lim, next to resonance, it is the larger one."""
    rng = np.random.default_rng(1)
    r = np.sort(rng.uniform(0.36, 3.0, 150))
    r[:50] = np.sort(rng.uniform(0.85, 1.15, 50))
    r.sort()
    beta = fm.boundaries(fm.System(), r).beta_lim.values[0] * rng.uniform(0.01, 0.9999, r.size)
    lag = np.array([lag_of(*pair) for pair in zip(r, beta, strict=True)])
    found = fm.identify.friction_ratio(r, lag)
    # sin(lag) near its extreme halves the digits
    assert max(map(off, found, beta)) < 1e-9


def test_slopes():
    r, beta = 0.8, 0.4
    slope = (lag_of(r, beta + 1e-5) - lag_of(r, beta - 1e-5)) / 2e-5
    assert fm.identify.friction_ratio(r, lag_of(r, beta))[0].slope == pytest.approx([slope], rel=1e-6)


def test_resonance():
    """sin(lag) = 4 beta/pi, and next to it the same."""
    at, beside = fm.identify.friction_ratio([1.0, 1.0 - 1e-9], [30.0, 30.0])
    assert at.beta == pytest.approx([np.pi / 8.0], abs=1e-14)
    assert beside.beta[0] == pytest.approx(np.pi / 8.0, abs=1e-8)
    assert at.slope == pytest.approx([np.degrees(4.0 / np.pi / np.cos(np.pi / 6.0))], rel=1e-9)


def test_two_friction_ratios_beyond_90_degrees():
    """Lags at r = 0.7 rise to 108 deg and come back as the mass sticks; values by integration."""
    for lag, beta in ((107.5, 0.9), (104.1, 0.95), (99.1, 0.98), (94.6, 0.995)):
        found = fm.identify.friction_ratio(0.7, lag)[0]
        assert len(found.beta) == 2
        assert off(found, beta) < 5e-4  # the lags are known to 0.05 deg
        assert found.slope[0] > 0.0 > found.slope[1]


def test_damping():
    """A root of the exact lag where there is no closed form."""
    system = fm.System(excitation="base", damping_reference="base", damping_ratios=0.02)
    for r, beta in ((0.85, 0.3), (1.4, 0.5)):
        found = fm.identify.friction_ratio(r, lag_of(r, beta, 0.02), system=system)[0]
        assert found.beta == pytest.approx([beta], abs=1e-9)


@pytest.mark.parametrize(
    ("r", "lag", "system", "reason"),
    [
        (6.0 / 3.086, 60.0, fm.System(), "no friction ratio gives a lag of 60 deg at r = 1.944: above "
         "resonance it is 90 to 180 deg"),
        (0.7, 120.0, fm.System(), "a lag of 120 deg at r = 0.7: below resonance it is 0 to 108 deg"),
        (0.8, 20.0, BASE_WALL, "the lag at r = 0.8 rises and falls with friction"),
    ],
)  # fmt: skip
def test_no_friction_ratio(r, lag, system, reason):
    found = fm.identify.friction_ratio(r, lag, system=system)[0]
    assert found.beta == found.slope == ()
    assert reason in found.reason


def test_base_wall_above_resonance():
    """One friction ratio, of a motion that has that lag."""
    found = fm.identify.friction_ratio(1.6, 140.0, system=BASE_WALL)[0]
    motion = fm.continuous_motion(BASE_WALL, 1.6, found.beta[0])
    assert -np.degrees(np.angle(motion.first_harmonic[0])) == pytest.approx(140.0, abs=1e-8)
    assert len(found.beta) == 1


@pytest.mark.parametrize(
    ("r", "lag", "message"),
    [
        (0.0, 20.0, "r must be > 0; got 0"),
        ([0.5, 0.6], 20.0, "phase_lag must be 2 numbers, one per frequency; got 1"),
        (0.5, np.nan, "phase_lag must be finite numbers"),
        ("a", 20.0, "r must be finite numbers; got"),
    ],
)
def test_bad_arguments(r, lag, message):
    with pytest.raises(fm.InputError, match=message):
        fm.identify.friction_ratio(r, lag)


@pytest.mark.parametrize(
    ("r", "lag", "beta"),
    [
        (1.065919144067727, 116.87754740448655, (0.65250, 0.78303, 0.78379)),
        (0.8769076947157068, 111.88985605556766, (0.84524, 0.85654)),
    ],
)
def test_two_friction_ratios_next_to_an_extreme(r, lag, beta):
    """Both sides of an extreme that lies between two of the friction ratios that are looked at."""
    found = fm.identify.friction_ratio(r, lag, system=fm.System(damping_ratios=0.01))[0]
    assert found.beta == pytest.approx(beta, abs=1e-5)


@pytest.mark.parametrize("r", [1.066, 1.2])
def test_extremes_of_continuous_motions(r):
    """The least lag above resonance, by another formula: friction ratios on both sides, ever nearer."""
    system = fm.System(excitation="base", damping_reference="base", damping_ratios=0.01)
    high = 0.9995 * float(fm.boundaries(system, [r]).beta_lim[0, 0])
    least = minimize_scalar(lambda beta: lag_of(r, beta, 0.01), bounds=(0.8 * high, high), method="bounded",
                            options={"xatol": 1e-9})  # fmt: skip
    assert least.x < 0.9999 * high  # not an end
    for distance in (1e-2, 1e-3, 1e-4):
        for beta in (least.x - distance, least.x + min(distance, 0.5 * (high - least.x))):
            found = fm.identify.friction_ratio(r, lag_of(r, beta, 0.01), system=system)[0]
            # rounding of a lag moves beta by some 1e-14 over its slope, here above distance/10
            assert off(found, beta) < 1e-12 / distance
            assert len(found.beta) >= 2
    at = fm.identify.friction_ratio(r, least.fun, system=system)[0]
    assert off(at, least.x) < 1e-5
    beyond = fm.identify.friction_ratio(r, least.fun - 1e-6, system=system)[0]
    assert off(beyond, least.x) > 1e-2


def exact_points(seed, count, zeta):
    """Random r, beta and the exact lag [deg], of one mass on a fixed wall."""
    rng = np.random.default_rng(seed)
    system = fm.System(damping_ratios=zeta)
    r = rng.uniform(0.05, 3.0, count)
    beta = rng.uniform(0.001, 0.9999, count) * np.abs(system.contact_load(r))
    lag = -np.degrees(np.angle(steady_states(system, r, beta, 1.0)[0].phasors[:, 0]))
    return system, r, beta, lag


def check_inverse(seed, count):
    for zeta in (0.0, 0.005, 0.01, 0.05):
        system, r, beta, lag = exact_points(seed, count, zeta)
        found = fm.identify.friction_ratio(r, lag, system=system)
        assert max(map(off, found, beta)) < 1e-7, zeta


def test_inverse_of_exact_lags():
    """Every friction ratio is among those of its lag, continuous or stick-slip."""
    check_inverse(3, 60)


@pytest.mark.slow
def test_inverse_of_many_exact_lags():
    check_inverse(4, 300)


def test_motion_that_just_slides():
    """At beta_lim motion is continuous: its lag is that just below."""
    r = np.array([2.38883556722757, 0.365, 1.7])
    lim = fm.boundaries(fm.System(), np.sort(r)).beta_lim.values[0][np.argsort(np.argsort(r))]
    at, below = (steady_states(fm.System(), r, beta, 1.0)[0].phasors for beta in (lim, lim * (1.0 - 1e-12)))
    np.testing.assert_allclose(at, below, rtol=1e-9)
    lag = 134.89039285029645  # between beta_lim and the next friction ratio that is looked at
    assert len(fm.identify.friction_ratio(r[0], lag)[0].beta) == 1


def test_a_lag_just_outside_the_range_is_named_with_enough_digits():
    reason = fm.identify.friction_ratio(0.8769076947157068, 111.3, system=fm.System(damping_ratios=0.05))[
        0
    ].reason
    assert "a lag of 111.3 deg at r = 0.8769: below resonance it is 20.7 to 111.2 deg" in reason
