"""Force of a damper over a given motion, against the spring's force added up in small steps."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import frictionmap
from frictionmap.errors import InputError
from frictionmap.identify import loop
from frictionmap.identify.loop.branches import Layout
from frictionmap.identify.loop.problem import DamperTest, modelled_force, places_of
from frictionmap.identify.rigs.configuration import identify, load_rig

FRICTION, STIFFNESS, BACKLASH = 60.0, 150.0, 0.3


def added_up(u: np.ndarray, backlash: float, asymmetry: float, w: float = 0.0) -> np.ndarray:
    """The spring follows every small step of the displacement, and its force is limited by friction."""
    force = np.empty(u.size)
    for k, step in enumerate(np.diff(u, prepend=u[0])):
        w = min(w + step, FRICTION * (1.0 + asymmetry) / STIFFNESS + backlash / 2.0)
        w = max(w, -FRICTION * (1.0 - asymmetry) / STIFFNESS - backlash / 2.0)
        force[k] = STIFFNESS * np.sign(w) * max(abs(w) - backlash / 2.0, 0.0)
    return force


def straight(mu: float = 1.0) -> tuple[DamperTest, Layout, np.ndarray]:
    """A displacement of straight branches, one of which is too short to slip."""
    test = DamperTest(np.linspace(0.0, 5.0, 501), np.zeros(501), np.zeros(501), 0, np.zeros(1))
    layout = Layout(0.0, 5.0, (-1,) * 5)
    named = [FRICTION, STIFFNESS, mu, BACKLASH, 0.08, 2.0, 0.5, 0.0, 0.002, 1.5, 0.1]
    places = [0.4, -1.7, 1.3, 1.0, 1.55, -2.0]
    return test, layout, np.array([*named, 0.2, *places, 1.013, 2.021, 2.307, 2.783])


def test_the_force_is_that_of_small_steps() -> None:
    test, layout, values = straight()
    values[[5, 6, 8, 9, 10]] = 0.0
    nodes, places = layout.nodes(values[12:]), values[12:18]
    fine = np.unique(np.concatenate((test.time, nodes)))  # turning points are among the steps
    u = np.interp(fine, nodes, places)
    expected = added_up(u, BACKLASH, 0.08, 0.2)[np.isin(fine, test.time)]
    found = modelled_force(test, layout, values)
    # sums of some hundred steps, each rounded to the digits of forces of 100 N
    assert np.abs(found.force - expected).max() < 1e-10
    # from where it slipped at 1.3 it goes back by 0.3, which the spring follows, and then on by 0.55
    assert found.broke.tolist() == [True, True, False, True, True]


def test_slopes_are_those_of_differences() -> None:
    test, layout, values = straight()
    slopes = modelled_force(test, layout, values).slopes
    for k in range(values.size):
        if k in (2, 7):  # mu has no derivative; straight branches have no accelerations
            continue
        step = 1e-7
        ends = []
        for sign in (1.0, -1.0):
            moved = values.copy()
            moved[k] += sign * step
            ends.append(modelled_force(test, layout, moved).force)
        differences = (ends[0] - ends[1]) / (2.0 * step)
        # rounding of forces near 100 N over the step, times slopes; samples at a kink see both sides
        close = np.abs(slopes[:, k] - differences) < 1e-5 * np.maximum(np.abs(slopes[:, k]), 1.0)
        assert close.mean() > 0.97, k


def measured(seed: int, amplitude: float = 1.6) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    fine = np.arange(0, 30001) / 10000.0
    u = amplitude * np.cos(2.0 * np.pi * fine)
    force = added_up(u, 0.0, 0.0)[::50] + 2.0
    return fine[::50], u[::50] + rng.normal(0.0, 0.003, 601), force + rng.normal(0.0, 0.5, 601)


@pytest.mark.parametrize("seed", range(3))
def test_estimates_are_near_the_truth(seed: int) -> None:
    time, u, force = measured(seed)
    ds = loop(time, force, displacement=u)
    for name, true in (("friction", FRICTION), ("contact_stiffness", STIFFNESS), ("offset", 2.0)):
        one = ds.sel(parameter=name)
        assert abs(float(one["estimate"]) - true) < 4.0 * float(one["standard_error"])
    # noise of the displacement in a sampled model would raise the friction by more than this
    assert float(ds.sel(parameter="friction")["standard_error"]) < 0.1


def test_friction_that_never_slips_is_not_estimated() -> None:
    time, u, force = measured(1, 0.15)
    ds = loop(time, force, displacement=u)
    assert str(ds["verdict"].attrs["flag_meanings"]).split()[int(ds["verdict"])] == "no_slip"
    friction = ds.sel(parameter="friction")
    assert np.isnan(float(friction["estimate"]))
    assert 0.0 < float(friction["lower"]) < FRICTION
    total, error = float(ds["stiffness_sum"]), float(ds["stiffness_sum_standard_error"])
    assert abs(total - STIFFNESS) < 4.0 * error


def test_reversed_forces_are_refused() -> None:
    time, u, force = measured(1)
    with pytest.raises(InputError, match="polarity is reversed"):
        loop(time, -force, displacement=u)


def test_asymmetry_needs_a_known_zero_of_the_force() -> None:
    time, u, force = measured(1)
    free = ["friction", "contact_stiffness", "asymmetry", "offset"]
    with pytest.raises(InputError, match="cannot fit asymmetry together with offset"):
        loop(time, force, displacement=u, free=free)


def test_a_motion_that_does_not_turn_back_is_refused() -> None:
    time, _, force = measured(1)
    with pytest.raises(InputError, match="turns back 0 times"):
        loop(time, force, displacement=time)


def test_places_are_those_of_the_unknowns() -> None:
    test, _, values = straight()
    assert values[places_of(test).state] == 0.2


SETS = (
    "plain", "peak", "backlash", "spring", "viscous", "falling", "inertia", "coarse", "velocity", "rigid",
    "held",
)  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", SETS)
def test_reference_loops(name: str, reference_path: Callable[[str], Path]) -> None:
    folder = reference_path("identification-2")
    truth = json.loads((folder / "truth.json").read_text())[f"loop-{name}"]
    ds = identify(load_rig(folder / f"loop-{name}.toml"))
    for parameter, row in truth["parameters"].items():
        one = {
            key: float(ds.sel(parameter=parameter)[key])
            for key in ("estimate", "lower", "upper", "standard_error")
        }
        if row["fitted"] is None:  # an interval or a bound only
            assert np.isnan(one["standard_error"]), parameter
            assert one["lower"] <= row["truth"] <= one["upper"], parameter
        else:
            assert abs(one["estimate"] - row["truth"]) < 4.0 * one["standard_error"], parameter
            assert 0.8 < one["standard_error"] / row["standard_error"] < 1.25, parameter
    if name == "held":
        assert abs(float(ds["stiffness_sum"]) - 420.0) < 4.0 * float(ds["stiffness_sum_standard_error"])


def test_velocities_and_speed_laws_of_a_configuration(tmp_path: Path) -> None:
    """The columns, units and knots of a file are those of the arrays."""
    time, _, force = measured(1)
    velocity = -3.2 * np.pi * np.sin(2.0 * np.pi * time) + np.random.default_rng(1).normal(0.0, 0.02, 601)
    table = np.column_stack((time, velocity / 1000.0, force))
    np.savetxt(tmp_path / "a.csv", table, "%.12g", ",", header="time_s,velocity_m_s,force_N", comments="")
    (tmp_path / "a.toml").write_text(
        '[data]\nkind = "loop"\nfile = "a.csv"\n[known]\nlaw_speeds_mm_s = [0.0, 5.0]\noffset = "2 N"\n'
    )
    found = identify(load_rig(tmp_path / "a.toml"))
    wanted = loop(time, force, velocity=velocity, law_speeds=[0.0, 5.0], known={"offset": 2.0})
    assert found["parameter"].values.tolist() == ["friction", "contact_stiffness", "offset", "factor_1"]
    # numbers of twelve digits in the file
    np.testing.assert_allclose(found["estimate"], wanted["estimate"], rtol=1e-6)
    law = found.sel(parameter="factor_1")
    assert abs(float(law["estimate"]) - 1.0) < 4.0 * float(law["standard_error"])


def test_picture_of_force_over_motion() -> None:
    time, u, force = measured(1)
    axes = frictionmap.plot_fit(loop(time, force, displacement=u))
    assert len(axes) == 3
    assert np.array_equal(axes[2].lines[0].get_xdata(), u)
    assert np.array_equal(axes[2].lines[0].get_ydata(), force)
