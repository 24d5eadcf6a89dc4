"""The two-storey rig of T 6.4 from its printed text: ratios, frequencies, and what r1 can mean."""

import numpy as np
import pytest

import frictionmap as fm

#: T line 2216: r1 = (0.3419 s) omega, gamma, kappa, to four or five digits.
SECONDS, GAMMA, KAPPA = 0.3419, 0.9772, 1.1119

#: T lines 2174, 1005: the lower plate, and one of four columns between two plates.
PLATE, LENGTH, WIDTH, THICKNESS = 3.270, 0.410, 0.0255, 0.0016

#: Mild steel [Pa], give or take 3 %.
YOUNG = 210e9


def amplitude(f, f_k1m1):
    """T(6.15) of masses 1 and gamma on springs 1 and kappa, from M and K."""
    K = np.array([[1.0 + KAPPA, -KAPPA], [-KAPPA, KAPPA]])
    M = np.diag([1.0, GAMMA])
    return np.array([abs(np.linalg.solve(K - (one / f_k1m1) ** 2 * M, [1.0, 0.0])[0]) for one in f])


def test_the_rig_from_its_text():
    """T Fig. 6.19: the grid of 0 to 8 Hz; the three frequencies lead back to what is printed."""
    f = np.linspace(0.4, 8.0, 39)
    ds = fm.identify.sweep(f, amplitude(f, 1.0 / SECONDS))
    found = dict(zip(ds.parameter.values.tolist(), ds.estimate.values.tolist(), strict=True))
    assert found["f1"] == pytest.approx(1.8479, abs=5e-5)
    assert found["f2"] == pytest.approx(4.9382, abs=5e-5)
    assert found["f0"] == pytest.approx(3.1199, abs=5e-5)
    assert found["f_k1m1"] == pytest.approx(1.0 / SECONDS, rel=1e-7)
    assert found["gamma"] == pytest.approx(GAMMA, rel=1e-7)
    assert found["kappa"] == pytest.approx(KAPPA, rel=1e-7)
    # T(6.18), (6.19) with the fourth frequency of T(6.20), which follows from the three
    f_z0_squared = found["f1"] ** 2 + found["f2"] ** 2 - (found["f1"] * found["f2"] / found["f0"]) ** 2
    assert f_z0_squared / found["f0"] ** 2 - 1.0 == pytest.approx(GAMMA, rel=1e-6)
    kappa = GAMMA * (found["f0"] ** 2 / (found["f1"] * found["f2"])) ** 2
    assert kappa == pytest.approx(KAPPA, rel=1e-6)


def test_r1_is_a_time_times_the_frequency_in_hertz():
    """Four clamped columns, 12 E I/L^3 each, say 3.14 Hz: f in Hz is 7 % off, omega a factor of 6.7.

    With omega both natural frequencies would lie below 0.8 Hz, and T Fig. 6.19 goes to 8 Hz.
    """
    stiffness = 4.0 * 12.0 * YOUNG * (WIDTH * THICKNESS**3 / 12.0) / LENGTH**3
    columns = np.sqrt(stiffness / PLATE) / (2.0 * np.pi)
    assert columns == pytest.approx(3.14, abs=0.005)
    in_hertz = 1.0 / SECONDS
    assert in_hertz == pytest.approx(columns, rel=0.08)
    with_omega = 1.0 / (2.0 * np.pi * SECONDS)
    assert with_omega == pytest.approx(0.4655, abs=1e-4)
    assert columns / with_omega > 6.5
    highest = with_omega * np.sqrt(np.linalg.eigvals([[1 + KAPPA, -KAPPA], [-KAPPA / GAMMA, KAPPA / GAMMA]]))
    assert highest.max() < 0.8
