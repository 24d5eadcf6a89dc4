"""Shares, response curves and reduction where friction depends on the speed, against single cells."""

import numpy as np
import pytest

import frictionmap as fm

LAW = {"speed": [0.0, 0.4, 1.0], "factor": [1.0, 0.7, 0.6], "slope": 0.05}
R, BETA, ZETAS = [0.5, 0.8, 1.2], [0.2, 0.5, 0.9], [0.04, 0.06, 0.1]


def one_mass(zeta=0.08, **contact):
    return fm.System(damping_ratios=zeta, contacts=[fm.Contact("fixed-wall", [1], law=LAW, **contact)])


def test_shares_count_the_regimes_of_the_samples():
    ds = fm.sweep(
        one_mass(), R, BETA, axes={"damping_ratios": ZETAS}, outputs=["regime", "contact_amplitude"]
    )
    found = fm.shares(ds, "damping_ratios")
    alone = [fm.sweep(one_mass(zeta), R, BETA) for zeta in ZETAS]
    for code in fm.regimes.REGIMES:
        share = np.mean([one.regime.values == code.value for one in alone], axis=0)
        np.testing.assert_array_equal(found.regime_share.sel(outcome=code.name).values, share)
    middle = np.median([one.contact_amplitude.values for one in alone], axis=0)
    np.testing.assert_array_equal(found.contact_amplitude_quantile.sel(quantile=0.5).values, middle)


@pytest.mark.parametrize("speed", [0.0, 0.3])
def test_works_of_a_curve_balance(speed):
    """Load and belt put in what friction and damping take; the friction force is that of the law."""
    ds = fm.curves(one_mass(wall_speed=speed), R, BETA, quantities=["energy", "amplitude"])
    belt = ds.work_wall if speed else 0.0
    left = ds.work_input + belt - ds.work_damping - ds.work_friction
    assert float(abs(left).max()) < 1e-12
    moves = ds.sliding_distance > 0.0
    mean = (ds.work_friction / ds.sliding_distance / ds.beta).values[moves.values]
    assert (mean < 1.0).all()
    assert (mean > 0.6).all()


@pytest.mark.parametrize(("modes", "error"), [(6, 1e-2), (8, 1e-9)])
def test_a_reduced_structure_has_the_cells_of_the_whole_one(modes, error):
    """With all modes of the held structure it is the same structure in other coordinates."""
    n = 10
    stiffness = 2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    load = {1: [1.0, *[0.0] * (n - 1)]}

    def structure(**more):
        return fm.System(
            matrices={"M": np.eye(n), "K": stiffness, "C": 0.05 * stiffness}, load_harmonics=load,
            contacts=[fm.Contact("fixed-wall", [4], law=LAW)], **more,
        )  # fmt: skip

    whole = fm.sweep(structure(), [0.6, 1.1], [0.1, 0.4])
    small = fm.sweep(structure(reduce={"keep": [1, 4], "modes": modes}), [0.6, 1.1], [0.1, 0.4])
    np.testing.assert_array_equal(small.regime.values, whole.regime.values)
    np.testing.assert_allclose(small.contact_amplitude.values, whole.contact_amplitude.values, rtol=error)
