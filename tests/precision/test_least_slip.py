"""The shortest slip of an elastic contact against an integration of one mass from event to event."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import frictionmap as fm

ZETA = 0.05


def slips_of(r, beta, kt, belt, cycles):
    """Distances and ends of the single slips of the motion from rest in physical coordinates (DOP853).

    An event ends a phase: z' - v = 0 in a slip, where y begins to rest; |f| = beta while y rests.
    """
    tau, state, y, slips, sense = 0.0, np.zeros(2), 0.0, [], 0
    exact = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13}
    while tau < 2.0 * np.pi * cycles:

        def force(t, z, sense=sense, y=y):
            return sense * beta if sense else kt * (z - belt * t - y)

        def slope(t, s, force=force):
            return [s[1], (np.cos(t) - force(t, s[0]) - s[0]) / r**2 - 2.0 * ZETA * s[1] / r]

        def ends(t, s, sense=sense, force=force):
            return sense * (s[1] - belt) if sense else beta - abs(force(t, s[0]))

        ends.terminal, ends.direction = True, -1
        found = solve_ivp(slope, (tau, 2.0 * np.pi * cycles), state, events=ends, max_step=0.05, **exact)
        begin, z = tau, state[0]
        tau, state = found.t[-1], found.y[:, -1]
        if sense:
            slips.append((tau, abs(state[0] - z - belt * (tau - begin))))
            sense, y = 0, state[0] - belt * tau - sense * beta / kt
        else:
            sense = int(np.sign(kt * (state[0] - belt * tau - y)))
    return np.array(slips)


@pytest.mark.parametrize(
    ("r", "beta", "kt", "belt"),
    [(0.4, 0.42, 100.0, 0.0), (0.4, 0.42, 1000.0, 0.0), (0.8, 0.5, 3.0, 0.0), (0.3, 0.2, 10.0, 0.1)],
)
def test_least_slip(r, beta, kt, belt):
    system = fm.System(damping_ratios=ZETA, contact_stiffness=kt, wall_velocity=belt)
    cycles = 40
    slips = slips_of(r, beta, kt, belt, cycles)
    last = slips[
        (slips[:, 0] > 2.0 * np.pi * (cycles - 2) + 0.1) & (slips[:, 0] < 2.0 * np.pi * cycles - 0.1)
    ]
    cell = fm.sweep(
        system, [r], [beta], outputs=["least_slip", "slips_per_cycle", "sliding_distance"]
    ).squeeze()
    assert float(cell.least_slip) == pytest.approx(last[:, 1].min(), rel=1e-6)
    one = fm.response(system, r, beta)
    assert float(one.least_slip) == pytest.approx(float(cell.least_slip), rel=1e-12)
    if cell.slips_per_cycle == 2.0 and belt == 0.0:  # two equal slips
        assert float(cell.sliding_distance) == pytest.approx(2.0 * float(cell.least_slip), rel=1e-12)


def test_least_slip_without_a_slip_or_without_an_end():
    """0 if the contact does not slip, the distance per cycle if it slips throughout, NaN if rigid."""
    damper = fm.System(damping_ratios=ZETA, contact_stiffness=3.0)
    asked = ["least_slip", "slips_per_cycle"]
    limit = fm.boundaries(damper, [0.8]).beta_noslip.item()
    held = fm.sweep(damper, [0.8], [1.01 * limit], outputs=asked)
    assert held.least_slip.item() == held.slips_per_cycle.item() == 0.0
    belt = fm.System(damping_ratios=ZETA, contact_stiffness=3.0, wall_velocity=5.0)
    one_way = fm.sweep(belt, [0.5], [0.2], outputs=asked)
    assert one_way.least_slip.item() == pytest.approx(2.0 * np.pi * 5.0, rel=1e-12)
    assert one_way.slips_per_cycle.item() == 1.0
    both = fm.System(
        contacts=[fm.Contact(masses=1), fm.Contact(masses=1, stiffness=2.0)], damping_ratios=ZETA
    )
    values = fm.sweep(both, [0.5], [0.1], outputs=asked).least_slip.values.ravel()
    assert np.isnan(values[0])
    assert values[1] > 0.0


def test_least_slip_does_not_depend_on_the_section():
    """Turning the load moves the section of the period, and slips across it, but no slip."""
    found = []
    for angle in np.linspace(0.0, np.pi, 7):
        system = fm.System(
            damping_ratios=ZETA, contact_stiffness=30.0,
            load_harmonics={1: np.exp(1j * angle), 2: 0.4 * np.exp(1j * (2.0 * angle + 0.3))},
        )  # fmt: skip
        found.append(fm.sweep(system, [0.37], [0.45], outputs=["least_slip"]).least_slip.item())
    assert found[0] > 0.0
    np.testing.assert_allclose(found, found[0], rtol=1e-9)
