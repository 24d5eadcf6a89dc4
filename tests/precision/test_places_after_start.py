"""Contacts that come to rest: the places where motions leave them, against fixed steps and closed forms."""

import numpy as np
import pytest

import frictionmap as fm
from frictionmap.general.problem import problem_of
from frictionmap.general.starts import initial_states

#: Friction that falls at a speed that no motion reaches: as no law, but not known to have one steady state.
FAR = {"speed": [0.0, 90.0, 90.1], "factor": [1.0, 1.0, 0.0], "slope": 0.0}

LOAD = 0.434


def one_mass(zeta, law=None):
    return fm.System(
        matrices={"M": np.eye(1), "K": np.eye(1), "C": 2.0 * zeta * np.eye(1)},
        contacts=[fm.Contact(law=law)], load_harmonics={1: [LOAD * 1j]}, frequency_scale=1.0,
        stiffness_scale=1.0,
    )  # fmt: skip


def two_masses(law=None):
    return fm.System(
        matrices={"M": np.diag([1.0, 1.3]), "K": np.array([[2.0, -1.0], [-1.0, 1.2]]),
                  "C": 0.03 * np.array([[2.0, -1.0], [-1.0, 1.2]])},
        contacts=[fm.Contact("between-masses", [1, 2], law=law)], load_harmonics={1: [0.7, -0.5 - 0.1j]},
        frequency_scale=1.0, stiffness_scale=1.0,
    )  # fmt: skip


def moving(system, r, beta):
    return fm.response(system, r, beta, solver=fm.Solver(start="moving"))


def naive(zeta, r, beta, periods=20, steps=2**12):
    """Place of the mass after some periods, by fixed steps with a clipped impulse of friction."""
    system = one_mass(zeta)
    problem, modal = problem_of(system, np.array([r]), beta)
    state = initial_states(system, problem, modal, "moving")[0]
    h, x, v, tau = 2.0 * np.pi / steps, float(state[0, 0]), float(state[1, 0]), float(state[2, 0])
    limit = h * beta / r**2
    for _ in range(periods * steps):
        load = -LOAD * np.sin(tau + 0.5 * h)
        free = v + h * (load - x - 0.5 * h * v - 2.0 * zeta * r * v) / r**2
        new = free - min(max(free, -limit), limit)
        x += 0.5 * h * (v + new)
        v, tau = new, tau + h
    return x


@pytest.mark.parametrize("law", [None, FAR])
@pytest.mark.parametrize(
    ("zeta", "r", "beta"),
    [
        (0.03, 0.2, 0.5),
        (0.03, 0.22, 0.5),
        (0.05, 0.2, 0.48),
        (0.05, 0.21, 0.5),
        (0.03, 0.21, 0.48),
        (0.098, 1.77, 0.85),
        (0.134, 1.72, 0.86),
    ],
)
def test_a_fast_mass_is_followed_until_its_load_no_longer_moves_it(zeta, r, beta, law):
    """It first comes to rest far from the middle, where its load exceeds the friction later: it slides back
    beyond the place at which it no longer does.  Or it still slides
    where states are compared.  The twin's error is about half an angle of a step, 8e-4.
    """
    cell = moving(one_mass(zeta, law), r, beta)
    assert float(cell.stuck_fraction) == 1.0
    assert float(cell.midpoint[0]) == pytest.approx(naive(zeta, r, beta), abs=4e-4)


@pytest.mark.parametrize("law", [None, FAR])
@pytest.mark.parametrize(("zeta", "r"), [(0.03, 0.22), (0.05, 0.23)])
def test_a_contact_that_creeps_ends_where_its_force_reaches_its_friction(zeta, r, law):
    """The force that holds the mass at z is load - z; it slides ever less, up to z = load - beta."""
    beta = 0.48
    cell = moving(one_mass(zeta, law), r, beta)
    assert float(cell.status) == fm.regimes.RESOLVED
    assert float(cell.stuck_fraction) == 1.0
    assert float(cell.midpoint[0]) == pytest.approx(LOAD - beta, abs=1e-10)


@pytest.mark.parametrize("start", ["rest", "moving"])
@pytest.mark.parametrize("r", [0.5, 1.16, 1.3])
def test_places_do_not_depend_on_whether_uniqueness_is_known(r, start):
    """The motion is the same: what is proved of it decides only how its steady state is found."""
    beta = np.array([0.9, 1.0, 1.1]) * fm.boundaries(two_masses(), [r]).beta_stick.item()
    found, wanted = (
        fm.sweep(
            two_masses(law), [r], beta, start=start,
            outputs=["contact_midpoint", "midpoint", "stuck_fraction", "status"],
        )
        for law in (FAR, None)
    )  # fmt: skip
    assert (found.status == fm.regimes.RESOLVED).all()
    for name in ("contact_midpoint", "midpoint", "stuck_fraction"):
        assert found[name].values == pytest.approx(wanted[name].values, abs=1e-7)
