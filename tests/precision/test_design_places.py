"""Answers of designs do not depend on where contacts come to rest."""

import numpy as np
import pytest

import frictionmap as fm

#: A frame with a damper in each storey, on a base that moves by 1.
FRAME = fm.System(
    excitation="base", damping_reference="base", mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0],
    damping_ratios=0.02,
    contacts=[fm.Contact("joined-base-wall", (1,)), fm.Contact("between-masses", (1, 2), ratio=0.5)],
)  # fmt: skip
BAND = [0.4, 2.0]


def test_a_frame_that_is_stuck_moves_with_its_base():
    """Mass 1 starts with the base, mass 2 at 0: the upper contact rests strained, x_2 = cos tau - 1."""
    assert fm.response(FRAME, r=2.0, beta=12.0).amplitude.values == pytest.approx([1.0, 2.0], abs=1e-12)
    answer = fm.design.least_peak(FRAME, BAND, mass=2, beta=[0.025, 10.0])
    assert answer.kind == "plateau"
    np.testing.assert_allclose(answer.peak_of_beta[answer.beta_search >= answer.beta], 1.0, atol=1e-9)


def test_constant_loads_count():
    """A mass on its spring and that of its contact: where the constant load moves it, and half the range."""
    system = fm.System(
        contacts=[fm.Contact("fixed-wall", (1,), stiffness=2.0)], damping_ratios=0.1, load_offset=[0.4]
    )
    beta = 10.0  # never slips: the mass on k1 and the contact's spring
    held = 1.0 / abs(1.0 + 2.0 - 0.25 + 2j * 0.1 * 0.5)
    answer = fm.design.least_peak(system, [0.5, 0.5001], beta=[beta, 2.0 * beta])
    assert answer.peak_of_beta.values == pytest.approx(held + 0.4, rel=1e-3)
