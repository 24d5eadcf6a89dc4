"""Boundaries of contacts whose normal force moves, as `boundaries` and files give them."""

import math

import numpy as np
import pytest

import frictionmap as fm


def system_of(row, contact):
    """The system of a row of an independent program; C may couple modes."""
    c, own = row["c"] if "c" in row else row["contact"]["c"], {**row, **row.get("contact", {})}
    rows = np.flatnonzero(c)
    assert set(np.abs(c)[rows]) == {1.0}
    kind = "fixed-wall" if rows.size == 1 else "between-masses"
    # between masses z = x_B - x_A, and a wall has z = x: the sign of c is that of c f, which no limit sees
    # unless it meets d and the direction of the belt
    sign = float(np.sign(c[rows[-1]]))
    normal = {"vector": own["d"], "stiffness": own["kn"], **contact["normal"]}
    keys = {**contact, "kind": kind, "masses": (rows + 1).tolist(), "normal": normal}
    loads = {int(n): np.array([complex(*z) for z in load]) for n, load in row.get("loads", {}).items()}
    damping = {} if not np.any(row["C"]) else {"C": np.array(row["C"])}
    matrices = {"M": np.array(row["M"]), "K": np.array(row["K"]), **damping}
    more = {"load_harmonics": loads} if loads else {}
    return sign, fm.System(matrices=matrices, frequency_scale=1.0, contacts=[keys], **more)


def test_friction_without_slip_of_an_independent_program(reference_table):
    """2e-9: the program brackets the slip of its motions; the formula of both is the same."""
    for row in reference_table("laws.json")["no_slip"]:
        own = row["contact"]
        contact = {"stiffness": own["kt"], "normal": {"friction": own["phi"]}}
        _, system = system_of(row, contact)
        found = fm.boundaries(system, r=[row["r"]])
        assert found["beta_noslip"].item() == pytest.approx(own["phi"] * row["preload_no_slip"], rel=1e-11)
        assert found["self_locking"].item() == int(abs(own["phi"] * row["eta"]) >= 1.0)


def test_flutter_of_an_independent_program(reference_table):
    for row in reference_table("laws.json")["flutter"]:
        sign = float(np.sign([one for one in row["c"] if one][-1]))
        contact = {"wall_speed": sign * row["belt_sign"] * 0.2, "normal": {"friction": 0.3}}
        _, system = system_of(row, contact)
        found = fm.boundaries(system, r=[1.0])
        kind = fm.regimes.DIVERGENCE if row["kind"] == "divergence" else fm.regimes.FLUTTER
        assert found["friction_lim_kind"].item() == kind
        assert found["friction_lim"].item() == pytest.approx(row["phi_flutter"], rel=1e-10)


def test_mode_coupling_of_two_directions_of_a_mass():
    """phi = [(k11 - k22 - kn)^2 + 4 k12^2]/(4 |k12| kn) without damping, if sigma k12 < 0."""
    k = np.array([[2.0, 0.35], [0.35, 1.2]])
    expected = ((k[0, 0] - k[1, 1] - 1.0) ** 2 + 4.0 * 0.35**2) / (4.0 * 0.35)
    for speed, flutters in ((0.3, True), (-0.3, False)):
        contact = {"wall_speed": speed, "normal": {"mass": 2, "stiffness": 1.0, "friction": 0.6}}
        system = fm.System(matrices={"M": np.eye(2), "K": k}, frequency_scale=1.0, contacts=[contact])
        found = fm.boundaries(system, r=[1.0])
        assert "beta_noslip" not in found
        assert "beta_stick" not in found
        if flutters:
            assert found["friction_lim"].item() == pytest.approx(expected, rel=1e-12)
            assert found["friction_lim_kind"].item() == fm.regimes.FLUTTER
        else:
            assert found["friction_lim_kind"].item() != fm.regimes.FLUTTER


def test_a_normal_force_that_does_not_change_is_ordinary_friction():
    """d on a mass of its own that nothing moves: the boundary to permanent sticking is that without it."""
    k = np.array([[1.0, -0.5, 0.0], [-0.5, 1.5, 0.0], [0.0, 0.0, 1.0]])
    matrices = {"M": np.eye(3), "K": k, "C": 0.05 * k}
    r, mu = np.linspace(0.1, 2.0, 7), [1.0, 1.3]
    normal = {"mass": 3, "stiffness": 2.0, "friction": 0.4}
    for stiffness, name in ((None, "beta_stick"), (3.0, "beta_noslip")):
        one, other = (
            fm.boundaries(
                fm.System(
                    matrices=matrices, frequency_scale=1.0, contacts=[{"stiffness": stiffness, **more}]
                ),
                r=r, mu=mu if stiffness is None else [1.0],
            )[name]
            for more in ({}, {"normal": normal})
        )  # fmt: skip
        np.testing.assert_allclose(one.values, other.values, rtol=1e-12)


def test_base_motion_loads_the_contact_like_forces():
    """K ones cos(tau) as loads, and as the motion of the base."""
    k = np.array([[1.5, -0.5], [-0.5, 0.5]])
    matrices = {"M": np.eye(2), "K": k, "C": 0.05 * k}
    contact = {"normal": {"vector": [0.2, 0.5], "stiffness": 1.0, "friction": 0.3}, "stiffness": 2.0}
    base, forced = (
        fm.boundaries(
            fm.System(matrices=matrices, frequency_scale=1.0, contacts=[contact], **more), r=[0.4, 0.9]
        )["beta_noslip"].values
        for more in ({"excitation": "base"}, {"load": k.sum(axis=1).tolist()})
    )
    np.testing.assert_allclose(base, forced, rtol=1e-13)


def test_several_contacts_or_springs_have_no_such_closed_form():
    one = {"normal": {"mass": 1, "stiffness": 1.0, "friction": 0.3}}
    springs = fm.System(contacts=[one], springs=[{"gap": 0.5, "stiffness": 1.0}])
    with pytest.raises(
        fm.InputError, match="closed forms are for contacts with friction and without such springs"
    ):
        fm.boundaries(springs, r=[0.5])
    assert math.isfinite(fm.boundaries(fm.System(contacts=[one]), r=[0.5])["beta_stick"].item())
