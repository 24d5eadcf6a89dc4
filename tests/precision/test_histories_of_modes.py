"""Motions in time of structures given by modes: against matrices, light nodes, closed forms of beams."""

import math

import numpy as np
import pytest
from lcg_records import lcg
from scipy.linalg import eigh

import frictionmap as fm
from frictionmap.errors import InputError
from frictionmap.steady.points import steady_states

MASS = np.diag([1.0, 0.7, 1.3])
STIFFNESS = np.array([[2.2, -1.0, 0.0], [-1.0, 2.4, -1.4], [0.0, -1.4, 1.9]])
ZETA = (0.02, 0.03, 0.05)
NAMES = ["a", "b", "c"]
UNIT = {"length": 1.0, "bending_stiffness": 1.0, "mass_per_length": 1.0}

CONTACTS = {
    "one rigid": [fm.Contact(masses=[2])],
    "one elastic": [fm.Contact(masses=[2], stiffness=3.0)],
    "two": [fm.Contact(masses=[1], stiffness=2.0), fm.Contact("between-masses", masses=[2, 3], mu=1.3)],
    "all held": [fm.Contact(masses=[k]) for k in (1, 2, 3)],
    "belt": [fm.Contact(masses=[2], wall_velocity=0.2)],
}
SAMPLES = lcg(77, 160, [1.31, -0.76], [20, 110])
RECORDS = {
    "force": fm.Record(SAMPLES, 0.17, quantity="force", mass=3),
    "forces": fm.Record(SAMPLES, 0.17, quantity="force", vector=[0.5, -1.0, 0.2], interpolation="hold"),
    "base": fm.Record(np.diff(SAMPLES) / 0.17, 0.17, quantity="acceleration"),
    "velocity": fm.Record(SAMPLES, 0.17, quantity="velocity", interpolation="cubic"),
}


def pair(contacts, **keys):
    """A structure by its matrices, and by all its modes."""
    squares, phi = eigh(STIFFNESS, MASS)
    phi = phi * [1.0, -1.0, 1.0]
    iota = phi.T @ MASS @ np.ones(3)
    modes = fm.Modes(np.sqrt(squares), ZETA, phi, NAMES, participation=iota)
    whole = fm.System(matrices={"M": MASS, "K": STIFFNESS}, damping_ratios=ZETA, contacts=contacts, **keys)
    return whole, fm.System(modes=modes, contacts=contacts, **keys)


def compare(found, expected, within=1e-10, without=()):
    """Every variable that both have, to a share of the largest value of its kind."""
    # the largest force is the friction, at any slide, and the largest place that of any rest
    without = (*without, "friction_amplitude_time", "contact_amplitude_time")
    names = [name for name in expected.data_vars if name in found and name not in without]
    assert {"x", "amplitude", "residual", "events", "status", "work_friction", "beta_hold"} <= set(names)
    for name in names:
        one, other = found[name].values, expected[name].values
        assert one.shape == other.shape, name
        if other.dtype.kind in "iu":
            assert (one == other).all(), name
        elif np.isfinite(other).any():
            assert (np.isnan(one) == np.isnan(other)).all(), name
            size = float(np.abs(other[np.isfinite(other)]).max())
            np.testing.assert_allclose(one, other, rtol=0.0, atol=within * max(size, 1e-2), err_msg=name)


@pytest.mark.parametrize("record", RECORDS)
@pytest.mark.parametrize("contacts", CONTACTS)
def test_all_modes_are_matrices(contacts, record):
    whole, modal = pair(CONTACTS[contacts])
    ends = {"after": 20.0} if contacts == "belt" else {}
    expected, found = (
        fm.history(system, RECORDS[record], beta=[0.15], scale=[1.5], **ends) for system in (whole, modal)
    )
    compare(found, expected, without=("base_force", "base_force_max", "base_force_min"))
    assert found.point_name.values.tolist() == NAMES
    assert "base_force" not in found
    assert expected.events.item() > 3


@pytest.mark.parametrize("reference", ["base", "ground"])
def test_walls_on_a_moving_base(reference):
    contacts = [fm.Contact("joined-base-wall", [3]), fm.Contact(masses=[1], stiffness=2.0)]
    keys = {"excitation": "base", "damping_reference": reference}
    whole, modal = pair(contacts, **keys)
    for record in ("base", "velocity"):
        expected, found = (fm.history(one, RECORDS[record], beta=[0.2]) for one in (whole, modal))
        compare(found, expected)


def test_states_in_modes_and_at_points():
    whole, modal = pair(CONTACTS["two"])
    x, v = [0.3, -0.2, 0.4], [0.1, 0.5, 0.0]
    squares, phi = eigh(STIFFNESS, MASS)
    phi = phi * [1.0, -1.0, 1.0]
    record = RECORDS["force"]
    expected = fm.history(whole, record, beta=0.2, start={"x": x, "v": v})
    compare(fm.history(modal, record, beta=0.2, start={"x": x, "v": v}), expected)
    q, rate = phi.T @ MASS @ x, phi.T @ MASS @ v
    compare(fm.history(modal, record, beta=0.2, start={"q": q, "q_rate": rate}), expected)
    few = fm.Modes(np.sqrt(squares), ZETA, phi[:2], NAMES[:2])
    system = fm.System(modes=few, contact_masses=["b"])
    with pytest.raises(InputError, match="must determine the 3 modes"):
        fm.history(system, fm.Record(SAMPLES, 0.17, quantity="force"), beta=0.2, start={"x": x[:2]})
    found = fm.history(system, fm.Record(SAMPLES, 0.17, quantity="force", mass="a"), beta=0.2, start={"q": q})
    one = fm.System(matrices={"M": MASS, "K": STIFFNESS}, damping_ratios=ZETA, contact_masses=[2])
    expected = fm.history(one, fm.Record(SAMPLES, 0.17, quantity="force", mass=1), beta=0.2, start={"x": x})
    np.testing.assert_allclose(found.x, expected.x[..., :2, :], rtol=0.0, atol=1e-10)


def nodes():
    """Two masses and two nodes without mass, joined by springs: K, and the modes with their residual."""
    stiffness = np.zeros((4, 4))
    for i, j, k in ((None, 0, 1.0), (0, 1, 1.3), (0, 2, 2.0), (1, 3, 3.0), (2, 3, 0.7)):
        ends = np.zeros(4)
        ends[j] = 1.0
        if i is not None:
            ends[i] = -1.0
        stiffness += k * np.outer(ends, ends)
    node = stiffness[2:, 2:]
    follow = -np.linalg.solve(node, stiffness[2:, :2])
    squares, phi = eigh(stiffness[:2, :2] + stiffness[:2, 2:] @ follow, np.diag([1.0, 0.8]))
    residual = np.zeros((4, 4))
    residual[2:, 2:] = np.linalg.inv(node)
    return stiffness, np.sqrt(squares), np.vstack((phi, follow @ phi)), residual


#: Lines with kinks, jumps at the beginning, at samples and at the end, and a smooth curve.
LOADS = {
    "lines": {"values": [0.0, 1.0, -1.2, 0.8, 0.3, -0.9, 0.0], "dt": 1.3},
    "jumps": {"values": [0.9, -1.0, 0.4, 1.2, -0.7], "dt": 1.7, "interpolation": "hold"},
    "ends": {"values": [0.8, 1.1, -1.2, -0.6], "dt": 2.1},
    "spline": {"values": [0.0, 1.0, -1.2, 0.8, 0.3, -0.9, 0.0], "dt": 1.3, "interpolation": "cubic"},
}


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("pushed", [3, 4])
def test_nodes_without_mass_are_light_nodes(load, pushed):
    # a node of a mass of 1e-6, damped beyond overshoots, follows within some 1e-3 units of time
    stiffness, w, shapes, residual = nodes()
    keys = {"contact_masses": [3], "contact_stiffness": 2.5, "frequency_scale": w[0]}
    modal = fm.System(modes=fm.Modes(w, 0.03, shapes, list("abcd"), residual), **keys)
    light = fm.System(
        matrices={"M": np.diag([1.0, 0.8, 1e-6, 1e-6]), "K": stiffness},
        damping_ratios=(0.03, 0.03, 1.2, 1.2), **keys,
    )  # fmt: skip
    record = fm.Record(quantity="force", mass=pushed, **LOADS[load])
    found, expected = (fm.history(one, record, beta=0.3, after=9.0) for one in (modal, light))
    for name in ("z_max", "z_min", "friction_max", "friction_min", "sliding_distance", "x_max", "x_min"):
        np.testing.assert_allclose(found[name], expected[name], rtol=2e-3, atol=6e-3, err_msg=name)
    assert float(found.slips.item()) >= 3.0
    ends = [one.x.values[..., -1].ravel() for one in (found, expected)]
    np.testing.assert_allclose(*ends, rtol=0.0, atol=3e-3)
    assert "v" not in found
    assert "acceleration" not in found


@pytest.mark.parametrize("load", LOADS)
def test_without_damping_nothing_is_lost_in_it(load):
    _, w, shapes, residual = nodes()
    system = fm.System(
        modes=fm.Modes(w, 0.0, shapes, list("abcd"), residual), contact_masses=[4], contact_stiffness=2.5
    )
    ds = fm.history(system, fm.Record(quantity="force", mass=4, **LOADS[load]), beta=0.2, after=7.3)
    assert float(ds.work_friction.item()) > 0.1
    # work_damping is what the other works leave of the energy
    assert abs(ds.work_damping.item()) <= 1e-12


def test_a_residual_of_the_contact_alone_softens_its_spring():
    squares, phi = eigh(STIFFNESS, MASS)
    flexible = 0.15
    residual = np.zeros((3, 3))
    residual[1, 1] = flexible
    w = np.sqrt(squares)
    with_it = fm.System(
        modes=fm.Modes(w, ZETA, phi, NAMES, residual), contact_masses=["b"], contact_stiffness=4.0
    )
    without = fm.System(
        modes=fm.Modes(w, ZETA, phi, NAMES), contact_masses=["b"],
        contact_stiffness=1.0 / (0.25 + flexible),
    )  # fmt: skip
    found, expected = (fm.history(one, RECORDS["force"], beta=0.15) for one in (with_it, without))
    for name in ("friction", "y", "sliding_distance", "work_friction", "event_time", "energy", "beta_hold"):
        np.testing.assert_allclose(found[name], expected[name], rtol=0.0, atol=1e-11, err_msg=name)
    np.testing.assert_allclose(found.z, expected.z - flexible * expected.friction, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(found.x[..., 1, :], found.z, rtol=0.0, atol=1e-11)
    # at rest without a load the spring carries what the structure pulls: f = -k x of the contact alone
    held = np.linalg.inv(STIFFNESS)[1, 1]
    force = -(expected.contact_residual / held)
    rest = expected.contact_residual - flexible * force
    np.testing.assert_allclose(found.contact_residual, rest, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("residual", [False, True])
def test_a_record_in_two_parts(residual):
    beam = fm.Beam(**UNIT, points={"tip": 1.0, "mid": 0.6}, modes=4, with_residual=residual)
    system = fm.System(
        modes=beam, damping_ratios=0.01, contact_masses=["tip"], contact_stiffness=0.8, load_mass="mid"
    )
    values = np.concatenate(([0.0], np.asarray(SAMPLES[:80]), [0.0]))
    whole = fm.history(system, fm.Record(values, 0.13, quantity="force"), beta=0.1, after=2.0)
    first = fm.history(system, fm.Record(values[:41], 0.13, quantity="force"), beta=0.1, after=0.0)
    second = fm.history(
        system, fm.Record(values[40:], 0.13, quantity="force"), beta=0.1, after=2.0, start=first
    )
    assert first.slips.item() + second.slips.item() == whole.slips.item()
    assert whole.slips.item() > 3
    np.testing.assert_allclose(second.x[..., -1], whole.x[..., -1], rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(second.modal_place, whole.modal_place, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize(("ends", "first"), [
    ("clamped-free", 0.7829918), ("clamped-clamped", 0.8308615), ("pinned-pinned", math.sqrt(8.0) / math.pi),
])  # fmt: skip
def test_participation_of_beams(ends, first):
    # Blevins, Formulas for natural frequency and mode shape: 0.7830, 0.8309 of unit modes
    beam = fm.Beam(ends, **UNIT, points={"x": 0.5}, modes=150)
    found = beam.participation
    assert abs(found[0]) == pytest.approx(first, rel=2e-7)
    # all of the mass moves with the base: the rest falls as the number of modes
    assert 1.0 - 0.02 < float((found**2).sum()) < 1.0


def test_participation_of_a_beam_with_tips_and_of_one_that_turns():
    beam = fm.Beam("pinned-free", **UNIT, points={"x": 0.5}, modes=150)
    found = beam.participation
    assert abs(found[0]) == pytest.approx(math.sqrt(3.0) / 2.0, rel=1e-14)  # of the turn about the pin
    assert float((found**2).sum()) == pytest.approx(1.0, abs=0.02)
    heavy = fm.Beam("clamped-free", **UNIT, points={"tip": 1.0}, modes=60, end_masses=[0.0, 2.5])
    assert float((heavy.participation**2).sum()) == pytest.approx(3.5, abs=0.02)
    assert fm.Beam("free-free", **UNIT, points={"x": 0.5}).participation is None
    held = fm.Beam("free-free", **UNIT, points={"x": 0.5}, end_springs=[3.0, 2.0], modes=60)
    assert float((held.participation**2).sum()) == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize(("ends", "more", "sag"), [
    ("clamped-free", {}, {1.0: 1.0 / 8.0, 0.5: 17.0 / 384.0}),
    ("pinned-pinned", {}, {0.5: 5.0 / 384.0}),
    ("clamped-clamped", {}, {0.5: 1.0 / 384.0}),
    ("clamped-free", {"end_masses": [0.0, 2.0]}, {1.0: 1.0 / 8.0 + 2.0 / 3.0}),
    ("free-free", {"end_springs": [4.0, 4.0]}, {0.5: 5.0 / 384.0 + 1.0 / 8.0}),
])  # fmt: skip
def test_sag_of_beams(ends, more, sag):
    beam = fm.Beam(ends, **UNIT, points={str(k): x for k, x in enumerate(sag)}, modes=3, **more)
    by_modes = (beam.shapes / beam.frequencies**2) @ beam.participation
    np.testing.assert_allclose(by_modes + beam.base_residual, list(sag.values()), rtol=1e-12)
    assert (np.abs(beam.base_residual) > 1e-8).all()
    longer = fm.Beam(ends, length=2.0, bending_stiffness=3.0, mass_per_length=0.7, modes=3,
                     points={"x": 2.0 * next(iter(sag))}, **{
                         "end_masses": [m * 1.4 for m in more.get("end_masses", (0.0, 0.0))],
                         "end_springs": [k * 3.0 / 8.0 for k in more.get("end_springs", (0.0, 0.0))],
                     })  # fmt: skip
    by_modes = (longer.shapes / longer.frequencies**2) @ longer.participation
    unit = 0.7 * 2.0**4 / 3.0
    expected = unit * next(iter(sag.values()))
    assert float((by_modes + longer.base_residual)[0]) == pytest.approx(expected, rel=1e-12)


def test_participation_and_sag_of_plates():
    plate = fm.Plate(
        edges=["supported"] * 4, size=[2.0, 2.0], bending_stiffness=3.0, mass_per_area=0.7,
        points={"centre": [1.0, 1.0]}, modes=4,
    )  # fmt: skip
    # modes (1, 1), (1, 2), (2, 1), (2, 2): 2/side/sqrt(rho h) sin sin
    expected = 2.0 / 2.0 / math.sqrt(0.7) * 0.7 * (2.0 * 2.0 / math.pi) ** 2
    np.testing.assert_allclose(np.abs(plate.participation), [expected, 0.0, 0.0, 0.0], atol=1e-9)
    by_modes = (plate.shapes / plate.frequencies**2) @ plate.participation
    # Timoshenko and Woinowsky-Krieger: 0.00406235 q a^4/D
    sag = float((by_modes + plate.base_residual)[0])
    assert sag == pytest.approx(0.00406235 * 0.7 * 2.0**4 / 3.0, rel=2e-6)
    free = fm.Plate(size=[1.0, 1.0], bending_stiffness=1.0, mass_per_area=1.0, edges=["free"] * 4,
                    points={"c": [0.3, 0.2]}, modes=3)  # fmt: skip
    assert free.participation is None


def test_a_beam_on_a_base_that_is_slow():
    # a held spring kt at the tip: x (1 + kt/3) = -a/8, once the vibration by the kink of the record is over
    beam = fm.Beam(**UNIT, points={"tip": 1.0}, modes=3)
    system = fm.System(
        modes=beam, damping_ratios=0.05, contact="joined-base-wall", contact_masses=["tip"],
        contact_stiffness=2.0, damping_reference="base", stiffness_scale=1.0, frequency_scale=1.0,
    )  # fmt: skip
    ds = fm.history(system, fm.Record([0.0, 1.0, 1.0], dt=200.0), beta=100.0, after=0.0)
    expected = -(1.0 / 8.0) / (1.0 + 2.0 / 3.0)
    assert float(ds.x[..., 0, -1].item()) == pytest.approx(expected, rel=1e-9)
    assert float(ds.friction[..., -1].item()) == pytest.approx(2.0 * expected, rel=1e-9)


def shaken(modes, **keys):
    beam = fm.Beam(**UNIT, points={"tip": 1.0}, modes=modes, **keys)
    return fm.System(
        modes=beam, damping_ratios=0.02, contact="joined-base-wall", contact_masses=["tip"],
        contact_stiffness=1.5, damping_reference="base",
    )  # fmt: skip


def test_residuals_converge_on_a_moving_base():
    record = fm.Record.pulse("half-sine", 1.0, 2.5)
    exact = fm.history(shaken(60), record, beta=0.1, after=6.0)
    assert exact.slips.item() >= 3
    errors = {}
    for residual in (False, True):
        one = fm.history(shaken(5, with_residual=residual), record, beta=0.1, after=6.0)
        errors[residual] = abs(float((one.z_max - exact.z_max).item())) / float(exact.z_max.item())
    assert errors[True] < 2e-6
    assert errors[True] < 0.05 * errors[False]


def test_first_harmonics_are_those_of_points():
    _, modal = pair(CONTACTS["one elastic"], load_mass=3)
    whole, _ = pair(CONTACTS["one elastic"], load_mass=3)
    r, beta = np.array([0.7, 1.1, 1.1]), np.array([0.2, 0.2, 30.0])
    found, expected = (steady_states(one, r, beta, 1.0)[0] for one in (modal, whole))
    np.testing.assert_allclose(found.phasors, expected.phasors, rtol=0.0, atol=1e-10)
    assert (found.regime == expected.regime).all()
    _, w, shapes, residual = nodes()
    system = fm.System(
        modes=fm.Modes(w, 0.05, shapes, list("abcd"), residual), contact_masses=[3], contact_stiffness=2.5,
        load_mass=4,
    )  # fmt: skip
    states = steady_states(system, r, np.array([0.2, 0.2, 0.1]), 1.0)[0]
    curves = fm.curves(system, r=[0.7, 1.1], beta=[0.1, 0.2], quantities=["first_harmonic"])
    sizes = curves.first_harmonic_amplitude.sel(beta=0.2).values.reshape(2, 4)
    np.testing.assert_allclose(np.abs(states.phasors[:2]), sizes, rtol=1e-8)


@pytest.mark.parametrize(("system", "record", "message"), [
    (lambda: fm.System(modes=fm.Modes([1.0], 0.1, [[1.0]], ["tip"]), contact_masses=["tip"]),
     fm.Record([0.0, 1.0, 0.0], dt=0.1), "without participation"),
    (lambda: fm.System(modes=fm.Beam("free-free", **UNIT, points={"tip": 1.0}), contact_masses=["tip"]),
     fm.Record([0.0, 1.0, 0.0], dt=0.1), "a beam or plate with a support"),
    (lambda: fm.System(modes=fm.Modes([1.0], 0.1, [[1.0]], ["tip"], [[0.1]], participation=[1.0]),
                       contact_masses=["tip"], contact_stiffness=1.0),
     fm.Record([0.0, 1.0, 0.0], dt=0.1), "cannot use residual .* without base_residual"),
    (lambda: fm.System(modes=fm.Beam(**UNIT, points={"tip": 1.0}), contact_masses=["tip"]),
     fm.Record([0.0, 1.0, 0.0], dt=0.1, quantity="force", mass="top"), "must be one of the points tip"),
])  # fmt: skip
def test_refusals(system, record, message):
    with pytest.raises(InputError, match=message):
        fm.history(system(), record, beta=[0.1])


@pytest.mark.parametrize(("keys", "message"), [
    ({"participation": [1.0, 2.0]}, r"participation must be one finite number per mode \(1\)"),
    ({"participation": [1.0], "influence": [math.nan]}, "influence must be one finite number per point"),
    ({"influence": [1.0]}, "cannot use influence without participation"),
    ({"shapes": [[1.0 + 0.01j]], "participation": [1.0]}, "cannot use participation with complex shapes"),
])  # fmt: skip
def test_refusals_of_modes(keys, message):
    with pytest.raises(InputError, match=message):
        fm.Modes([1.0], 0.1, keys.pop("shapes", [[1.0]]), ["tip"], **keys)


def test_points_across_the_base_are_not_carried():
    # a mass on two springs, at right angles: the base moves along the first one
    modes = fm.Modes([1.0, 1.5], 0.05, [[1.0, 0.0], [0.0, 1.0]], ["along", "across"],
                     participation=[1.0, 0.0], influence=[1.0, 0.0])  # fmt: skip
    record = fm.Record(SAMPLES, 0.17)
    found = fm.history(fm.System(modes=modes, contact_masses=["along"]), record, beta=0.2)
    expected = fm.history(fm.System(damping_ratios=0.05), record, beta=0.2)
    np.testing.assert_allclose(found.x[..., 0, :], expected.x[..., 0, :], rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(
        found.acceleration[..., 0, :], expected.acceleration[..., 0, :], rtol=0.0, atol=1e-12
    )
    assert not found.acceleration[..., 1, :].any()


SHOCK = """
[system]
contact_masses = ["tip"]
contact_stiffness = "5 N/mm"
damping_ratios = 0.01
[system.beam]
ends = "clamped-free"
length = "300 mm"
bending_stiffness = "21 N m^2"
mass_per_length = "0.78 kg/m"
points = { tip = "300 mm", shaker = "180 mm" }
modes = 6
[units]
natural_frequency = "model"
[record]
quantity = "force"
unit = "N"
mass = "shaker"
pulse = { kind = "half-sine", amplitude = "40 N", duration = "20 ms" }
[history]
friction = ["2 N", "8 N"]
"""


def test_a_configuration_in_units(tmp_path):
    from frictionmap.motions.configuration import load_history

    path = tmp_path / "shock.toml"
    path.write_text(SHOCK)
    ds = load_history(path).ask()
    assert ds.point_name.values.tolist() == ["tip", "shaker"]
    beam = fm.Beam(length=0.3, bending_stiffness=21.0, mass_per_length=0.78, modes=6,
                   points={"tip": 0.3, "shaker": 0.18})  # fmt: skip
    scale = beam.mass * beam.frequencies[0] ** 2
    system = fm.System(
        modes=beam, damping_ratios=0.01, contact_masses=["tip"], contact_stiffness=5000.0 / scale
    )
    # k_1 = m omega_1^2, and P/m is 1 m/s^2
    push = fm.Record.pulse(
        "half-sine", 40.0 / beam.mass, 0.02 * beam.frequencies[0], quantity="force", mass="shaker"
    )
    plain = fm.history(system, push, beta=np.array([2.0, 8.0]) / beam.mass)
    length = beam.mass / scale
    np.testing.assert_allclose(ds.amplitude_m, plain.amplitude * length, rtol=1e-9)
    np.testing.assert_allclose(ds.end_time, plain.end_time / beam.frequencies[0], rtol=1e-9)
    ds.to_netcdf(tmp_path / "shock.nc")
    again = fm.open(tmp_path / "shock.nc")
    assert again.point_name.values.tolist() == ["tip", "shaker"]
    np.testing.assert_array_equal(again.modal_place, ds.modal_place)


def test_spectra_are_of_one_mass(tmp_path):
    from frictionmap.motions.configuration import load_spectrum

    path = tmp_path / "spectrum.toml"
    modes = '[system.modes]\nfrequencies = [1.0, 3.0]\nshapes = [[1.0, 2.0]]\nnormalised = "mass"\n'
    record = '[record]\npulse = { kind = "half-sine", amplitude = 1.0, duration = 1.0 }\n'
    path.write_text(f"{modes}{record}[spectrum]\nperiod = [1.0]\nfriction = [0.1]\n")
    with pytest.raises(InputError, match="cannot compute spectra of a structure given by modes"):
        load_spectrum(path)
