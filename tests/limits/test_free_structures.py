"""Structures that no spring holds at a place: a block, a sliding base, the limit of soft springs."""

import math

import numpy as np
import pytest

import frictionmap as fm
from frictionmap.features import peak_thresholds
from frictionmap.model.general import in_general_form

BLOCK = fm.System(stiffness_ratios=[0])

#: Continuous motion of a block under cos tau: between turns r^2 x'' = cos tau - beta, the speed is zero at
#: both, and sin(tau_0) = pi beta/2; the force at a turn is cos(tau_0) >= beta.
NO_STOP = 1.0 / math.sqrt(1.0 + math.pi**2 / 4.0)


def outputs(*names):
    return fm.Solver(outputs=("regime", *names))


def free_chain(ground, **further):
    """Three masses, held at a place by a spring to the ground only if `ground` > 0."""
    stiffness = np.array([[1.0 + ground, -1.0, 0.0], [-1.0, 1.7, -0.7], [0.0, -0.7, 0.7]])
    damping = 0.03 * stiffness * (ground == 0.0)
    damping = damping if ground == 0.0 else 0.03 * (stiffness - np.diag([ground, 0.0, 0.0]))
    return in_general_form(
        fm.System(
            matrices={"M": np.diag([1.0, 0.8, 0.5]), "K": stiffness, "C": damping},
            frequency_scale=1.0,
            **further,
        )
    )


def test_boundaries_of_a_block_do_not_depend_on_the_frequency():
    found = fm.boundaries(BLOCK, [0.3, 1.0, 2.0])
    np.testing.assert_allclose(found.beta_stick, 1.0, rtol=1e-14)
    np.testing.assert_allclose(found.no_stop_end[0, :, 0], NO_STOP, rtol=1e-12)


def test_static_friction_of_a_block():
    """The force at a turn, cos(tau_0), must exceed mu beta; and no other motion goes on stopping below."""
    mu = np.array([1.0, 1.3, 2.0])
    found = fm.boundaries(BLOCK, [0.7], mu)
    limit = 1.0 / np.sqrt(mu**2 + 0.25 * math.pi**2)
    np.testing.assert_allclose(found.beta_lim[:, 0], limit, rtol=1e-12)
    np.testing.assert_allclose(found.beta_stick[:, 0], 1.0 / mu, rtol=1e-14)
    answer = fm.design.no_stop(BLOCK, [0.7, 1.6], mu=1.3)
    assert answer.beta.item() == pytest.approx(limit[1], rel=1e-6)


def test_continuous_motion_of_a_block():
    """Over half a period from the turn at t0: x = (cos t0 - cos t - beta t^2/2 + ...)/r^2."""
    r, beta = 0.8, 0.9 * NO_STOP
    found = fm.sweep(BLOCK, [r], [beta], solver=outputs("contact_amplitude", "sliding_distance"))
    # from the turn at t0 the speed is (sin t - sin t0 - beta (t - t0))/r^2, and zero after pi
    t0 = -math.asin(0.5 * math.pi * beta)
    way = (2.0 * math.cos(t0) - math.pi * math.sin(t0) - 0.5 * beta * math.pi**2) / r**2
    assert found.regime.item() == 2
    assert found.contact_amplitude.item() == pytest.approx(0.5 * way, rel=1e-12)
    assert found.sliding_distance.item() == pytest.approx(2.0 * way, rel=1e-12)


def test_sticking_block_on_a_table():
    """A block on a table that moves by cos tau: at rest on it where friction exceeds its inertia r^2."""
    table = fm.System("joined-base-wall", stiffness_ratios=[0])
    r = np.array([0.5, 1.0, 1.5])
    found = fm.boundaries(table, r)
    np.testing.assert_allclose(found.beta_stick[0], r**2, rtol=1e-13)
    np.testing.assert_allclose(found.no_stop_end[0, :, 0], NO_STOP * r**2, rtol=1e-12)
    rides = fm.response(table, 1.0, 1.2)
    assert rides.amplitude.item() == pytest.approx(1.0, rel=1e-12)
    assert rides.contact_amplitude.item() == 0.0


def test_building_on_a_sliding_base():
    """Slide amplitudes by event-driven integration of a storey on a base that slides (10 digits)."""
    stiffness = np.array([[1.0, -1.0], [-1.0, 1.0]])
    system = fm.System(
        matrices={"M": np.diag([1 / 3, 1.0]), "K": stiffness, "C": 0.1 * stiffness},
        contact_masses=[1], load=[1 / 3, 1.0], frequency_scale=1.0,
    )  # fmt: skip
    found = fm.sweep(system, [0.5, 1.0, 1.5], [0.3, 0.6, 1.0])
    expected = [
        [3.688744, 3.323768, 2.663172], [0.8908325, 0.8196387, 0.7612803], [0.2385230, 0.0, 0.0],
    ]  # fmt: skip
    np.testing.assert_allclose(found.contact_amplitude[0], expected, rtol=3e-7)
    assert found.regime.values[0].tolist() == [[1, 1, 1], [1, 1, 1], [1, 0, 0]]
    assert np.nanmax(found.stops_per_cycle) == 2.0 == np.nanmin(found.stops_per_cycle)


CONTACTS = {
    "wall": {"contact_masses": [1]},
    "between masses": {"contact": "between-masses", "contact_masses": [1, 2]},
    "two walls": {"contacts": [fm.Contact("fixed-wall", 1), fm.Contact("fixed-wall", 3, ratio=0.3)]},
    "wall and joint": {
        "contacts": [fm.Contact("fixed-wall", 1), fm.Contact("between-masses", (2, 3), ratio=0.3)]
    },
    "spring in the contact": {"contact_masses": [2], "contact_stiffness": 3.0},
}


@pytest.mark.parametrize("name", CONTACTS)
def test_the_limit_of_soft_springs_to_the_ground(name):
    """Ground springs of 1e-6 and 1e-9 come as near as they are soft, in every regime."""
    keys = {**CONTACTS[name], "load": [1.0, 0.0, 0.3]}
    r, beta = [0.5, 0.9, 1.3], np.linspace(0.05, 1.1, 5)
    solver = outputs("contact_peak_to_peak", "peak_to_peak")
    free = fm.sweep(free_chain(0.0, **keys), r, beta, solver=solver)
    assert (free.status.values == 0).all()
    for ground in (1e-6, 1e-9):
        held = fm.sweep(free_chain(ground, **keys), r, beta, solver=solver)
        np.testing.assert_array_equal(free.regime, held.regime)
        for output in ("contact_peak_to_peak", "peak_to_peak"):
            size = float(np.abs(held[output]).max())
            np.testing.assert_allclose(free[output], held[output], atol=30.0 * ground * size)


def marched(load, r, beta, damping=0.0, count=40_000, cycles=60):
    """Mean velocity and sliding distance of a block, by implicit steps of first order."""
    step = 2.0 * math.pi / count
    force = load(step * (np.arange(count) + 0.5))
    velocity = place = 0.0
    for _ in range(cycles):
        begin, way = place, 0.0
        for push in force:
            pulled = velocity + step / r**2 * (push - r * damping * velocity)
            velocity = math.copysign(max(abs(pulled) - step * beta / r**2, 0.0), pulled)
            place += step * velocity
            way += step * abs(velocity)
    return (place - begin) / (2.0 * math.pi), way


@pytest.mark.parametrize(("beta", "damping"), [(0.2, 0.3), (0.9, 0.3), (0.9, 0.0), (1.3, 0.0)])
def test_a_block_drifts_under_a_load_that_pushes_harder_one_way(beta, damping):
    def load(tau):
        return np.cos(tau) + 0.5 * np.cos(2.0 * tau)

    system = fm.System(
        matrices={"M": [[1.0]], "K": [[0.0]], "C": [[damping]]}, frequency_scale=1.0,
        load_harmonics={1: 1.0, 2: 0.5},
    )  # fmt: skip
    solver = outputs("stops_per_cycle", "contact_amplitude", "midpoint", "mean_velocity", "sliding_distance")
    found = fm.sweep(system, [0.8], [beta], solver=solver)
    velocity, way = marched(load, 0.8, beta, damping)
    assert found.mean_velocity.item() == pytest.approx(velocity, rel=1e-3)
    assert found.sliding_distance.item() == pytest.approx(way, rel=1e-3)
    assert math.isnan(found.contact_amplitude.item())
    assert math.isnan(found.midpoint.item())
    one = fm.response(system, 0.8, beta)  # velocities repeat, and so do the works
    np.testing.assert_allclose(one.v[:, 0], one.v[:, -1], atol=1e-12)
    assert one.work_input.item() == pytest.approx(
        one.work_friction.item() + one.work_damping.item(), rel=1e-12
    )
    # without springs the constant part of the force that holds the block is zero: the largest force counts
    assert found.beta_stick.item() == pytest.approx(1.5, rel=1e-12)


def test_a_mode_that_no_contact_restrains_moves_with_its_load():
    """Two masses in friction with each other: their centre moves as the load alone moves it, about 0."""
    system = fm.System(
        "between-masses", (1, 2), mass_ratios=[1, 0.5], stiffness_ratios=[0, 1], damping_ratios=0.02,
        load_harmonics={1: 1.0, 2: 0.5},
    )  # fmt: skip
    for start in ("rest", "moving"):
        one = fm.response(system, 0.8, 0.2, mu=1.0, solver=fm.Solver(start=start))
        centre = (one.x[0] + 0.5 * one.x[1]) / 1.5
        expected = -(np.cos(one.tau) + 0.5 / 4.0 * np.cos(2.0 * one.tau)) / 0.8**2 / 1.5
        np.testing.assert_allclose(centre, expected, atol=1e-11)


def test_balance_of_work_of_a_building_on_a_table():
    stiffness = np.array([[1.0, -1.0], [-1.0, 1.0]])
    system = fm.System(
        "joined-base-wall", (1,), matrices={"M": np.diag([1 / 3, 1.0]), "K": stiffness, "C": 0.1 * stiffness},
        frequency_scale=1.0,
    )  # fmt: skip
    one = fm.response(system, 0.8, 0.2)
    assert one.mean_velocity.item() == 0.0
    x, velocity = one.x[:, :-1].values, one.v[:, :-1].values
    assert np.abs(x.mean(axis=1)).max() < 1e-12
    drift = velocity[1] - velocity[0]  # the power of the dashpot, over all samples of a period
    assert one.work_damping.item() == pytest.approx(0.8 * 2.0 * math.pi * 0.1 * (drift**2).mean(), rel=1e-4)


def test_digits_left_out_of_a_file_leave_rigid_body_modes():
    system = fm.System(matrices={"M": np.eye(2), "K": [[1.0, -1.0], [-1.0, 1.0 - 3e-9]]}, load=[1.0, 0.5])
    assert system.modes.w.tolist() == [0.0, 1.0]
    found = fm.boundaries(system, [0.9])
    exact = fm.boundaries(
        fm.System(mass_ratios=[1, 1], stiffness_ratios=[0, 1], load=[1.0, 0.5]), [0.9 * math.sqrt(2)]
    )
    np.testing.assert_allclose(found.beta_stick, exact.beta_stick, rtol=3e-8)  # ten times the digits


def test_contacts_of_matrices_know_that_the_structure_is_free():
    """What holds a place, a spring, is looked for in the checked matrices, from arrays or from a file."""
    free, held = [[1.0, -1.0], [-1.0, 1.0]], [[1.1, -1.0], [-1.0, 1.0]]
    for stiffness, expected in ((free, True), (held, False)):
        system = fm.System(matrices={"M": np.eye(2), "K": stiffness}, load_mass=2)
        assert system.contact_system.free is expected


def test_matrices_and_chain_agree():
    chain = fm.System(mass_ratios=[1, 0.5], stiffness_ratios=[0, 1], damping_ratios=0.05, load_mass=2)
    given = fm.System(
        matrices={"M": np.diag([1.0, 0.5]), "K": [[1.0, -1.0], [-1.0, 1.0]]}, frequency_scale=1.0,
        damping_ratios=0.05, load_mass=2,
    )  # fmt: skip
    for one, other in zip(
        *(fm.sweep(s, [0.7], [0.1, 0.3]).contact_amplitude.values.ravel() for s in (chain, given)),
        strict=True,
    ):
        assert one == pytest.approx(other, rel=1e-11)


REFUSED = {
    "a constant force": ({"load_offset": [0.1]}, "load_offset must cancel along rigid-body modes"),
    "a belt": (
        {"wall_velocity": 0.2},
        "wall_velocity must be 0 at a contact that takes the structure along, .* got 0.2",
    ),
    "nothing at the base": ({"excitation": "base"}, "excitation must be force where neither spring"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_has_no_steady_state_is_refused(what):
    keys, words = REFUSED[what]
    with pytest.raises(fm.InputError, match=words):
        fm.System(stiffness_ratios=[0], **keys)


def test_refusals_with_what_to_do():
    with pytest.raises(fm.InputError, match="frequency_scale must be given for K = 0"):
        fm.System(matrices={"M": [[1.0]], "K": [[0.0]]})
    with pytest.raises(fm.InputError, match="r must be > 0 for a free structure"):
        fm.sweep(BLOCK, [0.0, 0.5], [0.1])
    with pytest.raises(fm.InputError, match="of a free structure: this is offered where springs hold it"):
        peak_thresholds(BLOCK)
    with pytest.raises(
        fm.InputError, match=r"stiffness_ratios\[1\] must be 1, the unit of the others; got 2"
    ):
        fm.System(mass_ratios=[1, 1], stiffness_ratios=[0, 2])
    two = [fm.Contact("fixed-wall", 1), fm.Contact("fixed-wall", 2)]
    shared = fm.System(
        mass_ratios=[1, 1], stiffness_ratios=[0, 1], contacts=two, load_harmonics={1: 1.0, 2: 0.5}
    )
    with pytest.raises(fm.InputError, match="constant forces in them depend on each other"):
        fm.boundaries(shared, [0.5])


def test_every_question_is_answered():
    """Curves and design agree with the map; the picture is drawn."""
    curve = fm.curves(BLOCK, [0.5, 0.8], [0.1, 0.4])
    cells = fm.sweep(BLOCK, [0.5, 0.8], [0.1, 0.4], solver=outputs("amplitude"))
    np.testing.assert_allclose(curve.amplitude, cells.amplitude, rtol=1e-12)
    assert fm.design.no_stop(BLOCK, [0.5, 1.5]).beta.item() == pytest.approx(NO_STOP, rel=1e-9)
    assert fm.design.stuck(BLOCK, [0.5, 1.5]).beta.item() == pytest.approx(1.0, rel=1e-9)
