"""Places of contacts at rest: those to which the motion leads from its start, in any grid."""

import math

import numpy as np
import pytest

import frictionmap as fm
from frictionmap.regimes import PERMANENT_STICKING

OUTPUTS = (
    "regime", "stops_per_cycle", "amplitude", "peak_to_peak", "midpoint", "contact_amplitude",
    "contact_midpoint", "stuck_fraction", "sliding_distance", "multiplier", "status",
)  # fmt: skip


def two_masses(**further):
    """Two unit masses and springs; walls on both, the second with half the friction; both masses loaded."""
    return fm.System(
        mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0], damping_ratios=0.05,
        contacts=[fm.Contact("fixed-wall", 1), fm.Contact("fixed-wall", 2, ratio=0.5, **further)],
        load_harmonics={1: [1.0, 0.0], 2: [0.6, 0.0]},
    )  # fmt: skip


def chain_with_springs():
    """Three unit masses between fixed ends; a wall on the first and a joint to the second, behind springs."""
    stiffness = 2.0 * np.eye(3) - np.eye(3, k=1) - np.eye(3, k=-1)
    return fm.System(
        matrices={"M": np.eye(3), "K": stiffness, "C": 0.05 * stiffness}, load_mass=2, frequency_scale=1.0,
        contacts=[
            fm.Contact("fixed-wall", 1, stiffness=20.0),
            fm.Contact("between-masses", (1, 2), stiffness=20.0, ratio=0.7),
        ],
    )  # fmt: skip


class Marched:
    """Extremes of the masses in the last period of a motion from rest, by small steps.

    All terms have the mean of both ends of a step.  Friction makes the velocity in a rigid contact zero at
    the end of a step, or is at its limit; the force of a spring is at most its limit.  No event is looked
    for, so that errors fall with the step.
    """

    def __init__(self, stiffness, damping, limits, springs, r, load, steps, cycles):
        """The contacts are those of masses 1, 2, .. with walls; springs of 0 are rigid contacts."""
        n, h = len(stiffness), 2.0 * math.pi / steps
        inverse = np.linalg.inv(r * r * np.eye(n) + 0.5 * h * r * damping + 0.25 * h * h * stiffness)
        loads = [load(h * (k + 0.5)) for k in range(steps)]
        x, v, f = np.zeros(n), np.zeros(n), np.zeros(n)
        self.lowest, self.highest = np.full(n, np.inf), np.full(n, -np.inf)
        for k in range(steps * cycles):
            right = r * r * v + h * (
                loads[k % steps] - 0.5 * r * damping @ v - stiffness @ (x + 0.25 * h * v)
            )
            last, before = f.copy(), v
            for _ in range(100):  # Gauss-Seidel over the contacts
                change = 0.0
                for j in range(n):
                    v = inverse @ (right - h * np.where(springs, 0.5 * (last + f), f))
                    step = v[j] / (h * inverse[j, j])
                    if springs[j]:
                        stretch = springs[j] * h * 0.5 * (before[j] + v[j])
                        step = (last[j] + stretch - f[j]) / (1.0 + 0.25 * springs[j] * h * h * inverse[j, j])
                    new = min(max(f[j] + step, -limits[j]), limits[j])
                    change, f[j] = max(change, abs(new - f[j])), new
                if change <= 1e-13:
                    break
            v = inverse @ (right - h * np.where(springs, 0.5 * (last + f), f))
            x = x + 0.5 * h * (before + v)
            if k >= steps * (cycles - 1):
                self.lowest, self.highest = np.minimum(self.lowest, x), np.maximum(self.highest, x)


def marched_two_masses(r, beta, spring, steps=200, cycles=40):
    """`two_masses` from rest."""
    stiffness = np.array([[2.0, -1.0], [-1.0, 1.0]])
    squares, phi = np.linalg.eigh(stiffness)
    damping = phi @ np.diag(0.1 * np.sqrt(squares)) @ phi.T
    return Marched(
        stiffness, damping, [beta, 0.5 * beta], np.array([0.0, spring]), r,
        lambda tau: np.array([math.cos(tau) + 0.6 * math.cos(2.0 * tau), 0.0]), steps, cycles,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("r", "beta", "spring"), [(1.0, 1.1, 0.0), (1.0, 1.1, 5.0), (1.1, 0.95, 5.0), (1.3, 0.95, 5.0)]
)
def test_masses_are_where_the_motion_from_rest_ends(r, beta, spring):
    system = two_masses(**({"stiffness": spring} if spring else {}))
    found = fm.sweep(system, [r], [0.5 * beta, beta], outputs=OUTPUTS).sel(beta=beta).squeeze()
    march = marched_two_masses(r, beta, spring)
    assert (found.contact_regime == PERMANENT_STICKING).any()  # what rests, rests somewhere
    midpoint = 0.5 * (march.lowest + march.highest)
    assert abs(found.midpoint.values - midpoint).max() <= 2e-3  # errors of 400 steps are 1e-4
    assert abs(found.amplitude.values - np.maximum(march.highest, -march.lowest)).max() <= 2e-3


@pytest.mark.parametrize("system", [two_masses(), two_masses(stiffness=5.0), chain_with_springs()])
def test_a_cell_does_not_depend_on_the_rest_of_the_grid(system):
    r, beta = [0.6, 1.0, 1.6], np.linspace(0.1, 1.6, 16)
    whole = fm.sweep(system, r, beta, outputs=OUTPUTS, threads=2)
    cuts = [
        fm.sweep(system, r[1:], beta[7:], outputs=OUTPUTS),
        fm.sweep(system, r, beta[::3], outputs=OUTPUTS),
    ]
    cuts += [fm.sweep(system, [r[0]], [one], outputs=OUTPUTS) for one in beta[[4, 8, 11]]]
    for cut in cuts:
        same = whole.sel(r=cut.r, beta=cut.beta)
        for name in (name for name in cut.data_vars if "beta" in cut[name].dims):
            np.testing.assert_array_equal(cut[name].values, same[name].values, err_msg=name)


@pytest.mark.parametrize("system", [two_masses(), two_masses(stiffness=5.0)])
def test_outputs_do_not_depend_on_each_other(system):
    """A contact that moves does so about the place that one at rest leaves to it."""
    axes = [0.6, 1.6], np.linspace(0.1, 1.6, 16)
    whole = fm.sweep(system, *axes, outputs=OUTPUTS)
    rests = whole.contact_regime == PERMANENT_STICKING
    assert (rests.any("contact") & ~rests.all("contact")).sum() > 3
    for names in (("regime", "contact_amplitude"), ("regime", "stuck_fraction", "peak_to_peak")):
        found = fm.sweep(system, *axes, outputs=names)
        for name in (*names, "contact_regime", "status"):
            np.testing.assert_allclose(found[name], whole[name], rtol=1e-13, atol=1e-13, err_msg=name)


@pytest.mark.parametrize("beta", [1.21, 1.264375, 1.5, 1.7])
def test_a_contact_that_sticks_is_where_its_friction_can_hold_it(beta):
    """One mass under two harmonics: from rest it slides until the load stays within the friction.

    The load between -0.808 and 1.6 is held by more than 1.204; the mass ends where 1.6 - x is the friction.
    """
    system = fm.System(damping_ratios=0.05, load_harmonics={1: [1.0], 2: [0.6]})
    motion = fm.response(system, r=2.5, beta=beta)
    assert motion.regime == PERMANENT_STICKING
    assert abs(motion.friction).max() <= beta * (1.0 + 1e-12)
    wanted = max(1.6 - beta, 0.0)
    np.testing.assert_allclose(motion.x.values, wanted, atol=1e-9)
    found = fm.sweep(system, [2.5], [0.3, beta], outputs=["regime", "amplitude"])
    assert abs(found.amplitude.values[0, 0, 1, 0] - wanted) <= 1e-9


@pytest.mark.parametrize("stiffness", [None, 3.0])
def test_friction_never_exceeds_its_limit(stiffness):
    further = {} if stiffness is None else {"stiffness": stiffness}
    for r in (0.4, 0.7, 1.1, 1.7):
        for beta in (0.6, 0.9, 1.2, 1.5):
            motion = fm.response(two_masses(**further), r=r, beta=beta)
            limit = np.array([beta, 0.5 * beta])
            assert (abs(motion.friction).max("tau").values <= limit * (1.0 + 1e-11)).all(), (r, beta)


@pytest.mark.parametrize("ratio", [0.5, 1e3])
def test_a_mass_that_a_contact_holds_does_not_move(ratio):
    system = fm.System(
        mass_ratios=[1.0, 1.3, 0.7], stiffness_ratios=[1.0, 0.8, 1.1], damping_ratios=0.02,
        contacts=[fm.Contact("fixed-wall", 1), fm.Contact("fixed-wall", 3, ratio=ratio)], load_mass=2,
    )  # fmt: skip
    found = fm.sweep(system, [0.4, 0.9, 1.7], np.linspace(0.1, 2.0, 9), outputs=OUTPUTS)
    rests = found.contact_regime.values == PERMANENT_STICKING
    assert rests.any(axis=(0, 1, 2)).all()
    for contact, mass in ((0, 0), (1, 2)):
        assert (found.peak_to_peak.values[rests[..., contact], mass] == 0.0).all()
    motion = fm.response(system, r=0.9, beta=1.0 + 1.0 / ratio)
    held = np.array([0, 2])[motion.contact_regime.values == PERMANENT_STICKING]
    assert held.size > 0
    assert (np.ptp(motion.x.values[held], axis=1) == 0.0).all()
    assert (motion.v.values[held] == 0.0).all()
