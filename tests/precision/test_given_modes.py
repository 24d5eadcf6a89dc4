"""Structures given by modes: against their matrices, exact receptances, the equations, reference values."""

import math

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

import frictionmap as fm
from frictionmap.errors import InputError

MASS = np.diag([1.0, 0.7, 1.3])
STIFFNESS = np.array([[2.2, -1.0, 0.0], [-1.0, 2.4, -1.4], [0.0, -1.4, 1.9]])
ZETA = (0.02, 0.03, 0.05)

CONTACTS = {
    "one rigid": {"contact_masses": [2]},
    "one elastic": {"contact_masses": [2], "contact_stiffness": 3.0},
    "two rigid": {"contacts": [fm.Contact(masses=[1]), fm.Contact("between-masses", masses=[2, 3])]},
    "rigid and elastic": {"contacts": [fm.Contact(masses=[1], stiffness=2.0), fm.Contact(masses=[3])]},
    "all held": {"contacts": [fm.Contact(masses=[k]) for k in (1, 2, 3)]},
}
LOADS = {
    "one": {"load_mass": 3},
    "all": {"load": [1.0, 0.5j, -0.2]},
    "two orders": {
        "load_harmonics": {1: [0.0, 0.0, 1.0], 2: [0.3, 0.0, 0.1j]}, "load_offset": [0.2, 0.0, 0.1],
    },
}  # fmt: skip

TIP = {"contact_masses": ["tip"], "load_mass": "tip"}
UNIT = {"length": 1.0, "bending_stiffness": 1.0, "mass_per_length": 1.0}


def named(keys):
    """The same keys with names of points in the place of numbers."""
    names = {1: "a", 2: "b", 3: "c"}
    found = dict(keys)
    for key in ("contact_masses",):
        if key in found:
            found[key] = [names[k] for k in found[key]]
    if "load_mass" in found:
        found["load_mass"] = names[found["load_mass"]]
    return found


def pair(keys):
    """A structure by its matrices, and by its modes."""
    squares, phi = eigh(STIFFNESS, MASS)
    modes = fm.Modes(np.sqrt(squares), ZETA, phi, ["a", "b", "c"])
    whole = fm.System(matrices={"M": MASS, "K": STIFFNESS}, damping_ratios=ZETA, **keys)
    return whole, fm.System(modes=modes, **named(keys))


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("contacts", CONTACTS)
def test_modes_are_matrices(contacts, load):
    whole, modal = pair({**CONTACTS[contacts], **LOADS[load]})
    outputs = ("regime", "contact_amplitude", "amplitude", "peak_to_peak", "midpoint", "sliding_distance",
               "work_friction", "contact_peak_to_peak", "contact_midpoint")  # fmt: skip
    solver = fm.Solver(outputs=outputs)
    if whole.general is None:  # the other engine has fewer outputs
        whole = fm.System(matrices={"M": MASS, "K": STIFFNESS}, damping_ratios=ZETA,
                          contacts=[fm.Contact(masses=[2])], **LOADS[load])  # fmt: skip
    grid = {"r": [0.4, 1.0, 1.7], "beta": [0.05, 0.3, 0.9, 4.0]}
    expected, found = (fm.sweep(system, **grid, solver=solver) for system in (whole, modal))
    assert (found.regime == expected.regime).all()
    for name in outputs[1:]:
        size = float(np.nanmax(np.abs(expected[name])))
        np.testing.assert_allclose(found[name], expected[name], rtol=0.0, atol=1e-10 * max(size, 1e-3))
    for name in ("beta_stick", "beta_lim", "beta_noslip"):
        if name in expected:
            np.testing.assert_allclose(found[name], expected[name], rtol=1e-9)
    assert found.point_name.values.tolist() == ["a", "b", "c"]


def test_response_and_curves_are_those_of_matrices():
    whole, modal = pair({**CONTACTS["one elastic"], **LOADS["two orders"]})
    expected, found = (fm.response(system, r=0.8, beta=0.3) for system in (whole, modal))
    for name in ("x", "v", "z", "y", "friction", "displacement_harmonic", "work_input", "work_damping"):
        np.testing.assert_allclose(found[name], expected[name], rtol=0.0, atol=1e-9)
    expected, found = (fm.curves(system, r=[0.8, 1.1], beta=[0.3, 9.0]) for system in (whole, modal))
    for name in ("amplitude", "first_harmonic_amplitude", "phase"):
        np.testing.assert_allclose(found[name], expected[name], rtol=0.0, atol=1e-8)


def test_points_are_in_any_order_and_number():
    squares, phi = eigh(STIFFNESS, MASS)
    grid = {"r": [0.7, 1.2], "beta": [0.1, 0.4]}
    solver = fm.Solver(outputs=("amplitude", "contact_amplitude"))
    found = [
        fm.sweep(
            fm.System(modes=fm.Modes(np.sqrt(squares), ZETA, phi[rows], names), contact_masses=["b"],
                      contact_stiffness=2.0, load_mass="c"),
            **grid, solver=solver,
        )
        for rows, names in (([0, 1, 2], ["a", "b", "c"]), ([2, 1], ["c", "b"]))
    ]  # fmt: skip
    np.testing.assert_allclose(found[0].contact_amplitude, found[1].contact_amplitude, rtol=1e-12)
    np.testing.assert_allclose(found[0].amplitude[..., [2, 1]], found[1].amplitude, rtol=1e-12)


def receptance(b):
    """Displacement of the free end of a cantilever by a unit force there, w = b^2, without damping."""
    top = math.cosh(b) * math.sin(b) - math.sinh(b) * math.cos(b)
    return top / (b**3 * (1.0 + math.cosh(b) * math.cos(b)))


@pytest.mark.parametrize("r", [0.5, 2.0, 5.0])
def test_a_held_spring_at_the_tip_of_a_beam(r):
    # modes beyond the 12th are static: the receptance misses w^2 sum 4/w_i^4 = 5e-10 of 0.01 at r = 5
    beam = fm.Beam(
        "clamped-free", length=1.0, bending_stiffness=1.0, mass_per_length=1.0, points={"tip": 1.0}
    )
    system = fm.System(modes=beam, contact_masses=["tip"], contact_stiffness=0.8, load_mass="tip",
                       stiffness_scale=1.0)  # fmt: skip
    alpha = receptance(math.sqrt(r * beam.frequencies[0]))
    found = fm.sweep(system, r=[r], beta=[100.0], solver=fm.Solver(outputs=("peak_to_peak", "amplitude")))
    span = found.peak_to_peak.item()
    assert span == pytest.approx(2.0 * abs(alpha / (1.0 + 0.8 * alpha)), rel=1e-7)
    needed = abs(0.8 * alpha / (1.0 + 0.8 * alpha))
    assert found.beta_noslip.item() == pytest.approx(needed, rel=1e-7)


def test_a_held_spring_on_a_free_beam():
    # pushed and held at its middle: either half is guided there, and takes half of the force
    beam = fm.Beam("free-free", **{**UNIT, "length": 2.0}, points={"middle": 1.0}, modes=20)
    half = fm.Beam("guided-free", **UNIT, points={"left": 0.0}, modes=20)
    found = []
    for one, scale in ((beam, 1.0), (half, 0.5)):
        system = fm.System(modes=one, contact_masses=[1], contact_stiffness=1.5, load_mass=1,
                           frequency_scale=2.0, stiffness_scale=scale)  # fmt: skip
        ds = fm.sweep(system, r=[0.7, 1.9], beta=[100.0], solver=fm.Solver(outputs=("peak_to_peak",)))
        found.append(ds.peak_to_peak.values)
    np.testing.assert_allclose(found[0], found[1], rtol=1e-8)  # the halves have more modes


def test_residual_of_the_contact_alone_softens_its_spring():
    # R acts at the contact only: the same forces and the same slides as with a spring 1/(1/kt + R)
    squares, phi = eigh(STIFFNESS, MASS)
    flexible = 0.15
    residual = np.zeros((3, 3))
    residual[1, 1] = flexible
    keys = {"contact_masses": ["b"], "load_mass": "c"}
    names = ["a", "b", "c"]
    with_it = fm.System(
        modes=fm.Modes(np.sqrt(squares), ZETA, phi, names, residual), contact_stiffness=4.0, **keys
    )
    without = fm.System(
        modes=fm.Modes(np.sqrt(squares), ZETA, phi, names), contact_stiffness=1 / (0.25 + flexible), **keys
    )
    for beta in (0.1, 0.4, 50.0):
        found, expected = (fm.response(system, r=0.9, beta=beta) for system in (with_it, without))
        for name in ("friction", "y", "sliding_distance", "work_friction", "work_input"):
            np.testing.assert_allclose(found[name], expected[name], rtol=0.0, atol=1e-10)
        np.testing.assert_allclose(found.x[[0, 2]], expected.x[[0, 2]], rtol=0.0, atol=1e-10)
        place = expected.x[1] - flexible * expected.friction
        np.testing.assert_allclose(found.x[1], place, rtol=0.0, atol=1e-10)
        np.testing.assert_allclose(found.z, place, rtol=0.0, atol=1e-10)
        span = float(place.max() - place.min())
        assert float(found.contact_peak_to_peak) == pytest.approx(span, rel=1e-5)  # place is sampled
        assert float(found.peak_to_peak[1]) == pytest.approx(float(found.contact_peak_to_peak), rel=1e-12)


def test_a_node_without_mass():
    """A mass on a spring and a dashpot; a spring from it to a node without mass, which is pushed and rubs
    through a contact stiffness: integrated in time.
    """
    r, beta, kt, k2, zeta = 0.7, 0.35, 2.5, 3.0, 0.04
    modes = fm.Modes([1.0], [zeta], [[1.0], [1.0]], ["mass", "node"], [[0.0, 0.0], [0.0, 1.0 / k2]])
    system = fm.System(modes=modes, contact_masses=["node"], contact_stiffness=kt, load_mass="node")
    found = fm.response(system, r=r, beta=beta, solver=fm.Solver(outputs=("peak_to_peak",)))
    kappa = 1.0 / (1.0 / kt + 1.0 / k2)  # force by the place that the node would have without the contact

    def rates(sense):
        def f(tau, state):
            x, v, force = state
            push = math.cos(tau)
            rate = v - math.sin(tau) / k2
            return [v, (push - force - x - 2.0 * zeta * r * v) / r**2, 0.0 if sense else kappa * rate]

        return f

    state, tau, sense, end = np.array([0.0, 0.0, 0.0]), 0.0, 0, 60 * 2.0 * math.pi
    times, values = [], []
    while tau < end:

        def watched(t, s, sense=sense):
            if sense:
                return sense * (s[1] - math.sin(t) / k2)
            return beta - abs(s[2])

        watched.terminal, watched.direction = True, -1.0
        run = solve_ivp(rates(sense), (tau, end), state, "DOP853", events=watched, rtol=1e-11, atol=1e-12,
                        dense_output=True, max_step=0.05)  # fmt: skip
        inside = np.linspace(tau, run.t[-1], 400)
        times.append(inside)
        values.append(run.sol(inside))
        tau, state = run.t[-1], run.y[:, -1].copy()
        if run.status == 1:
            if sense:
                sense = 0
            else:
                sense = int(np.sign(state[2]))
                state[2] = sense * beta
    t, (x, _, force) = np.concatenate(times), np.concatenate(values, axis=1)
    last = t > end - 2.0 * math.pi
    node = (x + (np.cos(t) - force) / k2)[last]
    assert float(found.peak_to_peak[0]) == pytest.approx(np.ptp(x[last]), rel=1e-4)  # samples
    assert float(found.peak_to_peak[1]) == pytest.approx(np.ptp(node), rel=1e-4)
    assert float(found.contact_peak_to_peak) == pytest.approx(np.ptp(node), rel=1e-4)
    assert float(found.friction.max()) == pytest.approx(beta, rel=1e-12)
    energy = found.work_input - found.work_damping - found.work_friction
    assert abs(float(energy)) <= 1e-11


def test_reference_cantilevers(reference_table):
    rows = [row for row in reference_table("continuous.json")["rows"] if row["kind"] == "cantilever-residual"]
    for row in rows:
        given, expected, within = row["given"], row["expect"], row["tolerance"]
        same = given["contact_x"] == given["load_x"]
        places = {"tip": given["contact_x"]} | ({} if same else {"load": given["load_x"]})
        beam = fm.Beam("clamped-free", length=1.0, bending_stiffness=1.0, mass_per_length=1.0, points=places,
                       modes=given["modes"])  # fmt: skip
        system = fm.System(
            modes=beam, damping_ratios=given["zeta"], contact_masses=["tip"], contact_stiffness=given["kt"],
            load_mass="tip" if same else "load",
            load_harmonics={int(n): complex(*value) for n, value in given["harmonics"].items()},
        )  # fmt: skip
        found = fm.response(system, r=given["r"], beta=given["beta"])
        size = expected["contact_peak_to_peak"][0]
        values = {
            "output_peak_to_peak": found.peak_to_peak[-1], "contact_peak_to_peak": found.contact_peak_to_peak,
            "sliding_distance": found.sliding_distance,
        }  # fmt: skip
        for name, value in values.items():
            assert abs(float(value) - expected[name][0]) <= within["ranges"] * size
        assert float(found.slips_per_cycle) == expected["slips_per_cycle"][0]
        share = expected["elastic_fraction"][0]
        assert (
            float(found.elastic_fraction) == np.float32(share) or abs(found.elastic_fraction - share) < 1e-8
        )
        for name in ("work_input", "work_damping"):
            assert float(found[name]) == pytest.approx(expected[name], rel=1e-10)


BEAM = """
[system]
contact_masses = ["tip"]
contact_stiffness = "5 N/mm"
load_mass = "shaker"
damping_ratios = 0.01
[system.beam]
ends = "clamped-free"
length = "300 mm"
bending_stiffness = "21 N m^2"
mass_per_length = "0.78 kg/m"
points = { tip = "300 mm", shaker = "180 mm" }
modes = 6
[units]
load = "10 N"
[grid]
r = ["20 Hz", "35 Hz"]
beta = ["1 N", "3 N"]
"""

PLATE = """
[system]
contact_masses = ["corner"]
contact_stiffness = 0.4
load_mass = "corner"
[system.plate]
edges = ["pinned", "pinned", "pinned", "free"]
size = ["300 mm", "200 mm"]
thickness = "2 mm"
E = "210 GPa"
density = "7850 kg/m^3"
nu = 0.3
points = { corner = ["100 mm", "200 mm"] }
modes = 4
[grid]
r = 0.8
beta = 0.1
"""

MODES = """
[system]
modes = { frequencies = ["31.2 Hz", "190 Hz"], damping_ratios = [0.004, 0.01], points = ["tip", "load"],
          shapes = [[1.9, -1.8], [0.8, 1.1]], residual = [[2e-6, 1e-7], [1e-7, 1e-6]], normalised = "mass" }
contact_masses = ["tip"]
contact_stiffness = 20000.0
load_mass = "load"
[grid]
r = 0.8
beta = 0.1
"""


@pytest.mark.parametrize("text", [BEAM, PLATE, MODES])
def test_configurations(text, tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text(
        text.replace("modes = { frequencies", "modes = { frequencies").replace(",\n          ", ", ")
    )
    config = fm.load_config(path)
    ds = fm.sweep(
        config.system, config.r, config.beta, solver=fm.Solver(outputs=("amplitude",)), units=config.units
    )
    again = tmp_path / "again.toml"
    again.write_text(ds.attrs["config"])
    assert fm.load_config(again).system == config.system
    file = tmp_path / "map.nc"
    ds.to_netcdf(file)
    with xr.open_dataset(file) as stored:
        assert stored.point_name.values.tolist() == config.system.dofs.written_labels
    assert fm.open(file).point_name.values.tolist() == config.system.dofs.written_labels


def test_a_beam_in_units(tmp_path):
    path = tmp_path / "beam.toml"
    path.write_text(BEAM)
    config = fm.load_config(path)
    first = 1.8751040687119611**2 * math.sqrt(21.0 / 0.78) / 0.3**2
    assert config.system.omega_1 == pytest.approx(first, rel=1e-14)
    assert config.r[0] == pytest.approx(20.0 * 2.0 * math.pi / first, rel=1e-14)
    scale = 0.78 * 0.3 * first**2
    assert config.system.contact_stiffness == pytest.approx(5000.0 / scale, rel=1e-14)
    assert "32.262" in config.system.costs(config.r)["modes"]


@pytest.mark.parametrize(("make", "message"), [
    (lambda: fm.System(modes=fm.Modes([1.0], 0, [[1.0]], ["tip"]), mass_ratios=[1.0]),
     "cannot use mass_ratios with modes: both define the structure; omit one"),
    (lambda: fm.System(modes=fm.Modes([1.0], 0, [[1.0]], ["tip"]), rayleigh=[0.1, 0.1]),
     "cannot use rayleigh with modes: modes have damping_ratios"),
    (lambda: fm.System(modes=fm.Modes([1.0], 0.1, [[1.0]], ["tip"]), damping_ratios=0.1),
     "cannot use damping_ratios with modes: they have their own"),
    (lambda: fm.System(modes=fm.Modes([1.0], 0, [[1.0]], ["tip"], [[0.1]]), **TIP),
     "cannot use residual with the rigid contact fixed-wall 1"),
    (lambda: fm.System(modes=fm.Modes([1.0], 0, [[1.0]], ["tip"]), contact_masses=["top"]),
     "must be one of the points tip; got 'top'"),
    (lambda: fm.System(modes=fm.Modes([1.0], 0, [[1.0]], ["tip"]), excitation="base"),
     "excitation must be force for modes"),
    (lambda: fm.System(modes=fm.System().modes), "modes must be those of a structure"),
    (lambda: fm.Modes([1.0], 0, [[1.0, 2.0]]), "shapes must be points x 1 modes; got 1 x 2"),
    (lambda: fm.Modes(np.arange(1.0, 202.0), 0, np.ones((1, 201))), "modes must be at most 200; got 201"),
    (lambda: fm.Modes([2.0, 1.0], 0, [[1.0, 2.0]]), "w must be >= 0 and increasing"),
    (lambda: fm.Modes([1.0], 0, [[1.0], [2.0]], ["a", "a"]), "points must be 2 different names"),
    (lambda: fm.Modes([1.0, 2.0], 0, [[1.0, 1.0j], [1.0, 1.0]], ["a", "b"]), "shapes must be real to 0.1"),
    (lambda: fm.Modes([1.0], 0, [[1.0]], ["a"], [[0.1]], [[1.0]]), "cannot use compliance with residual"),
    (lambda: fm.System(modes={"frequencies": [1.0], "shapes": [[1.0]]}),
     "must state how shapes are normalised"),
])  # fmt: skip
def test_refusals(make, message):
    with pytest.raises(InputError, match=message.replace("(", r"\(")):
        make()


@pytest.mark.parametrize("ask", [
    lambda system: fm.continuous_motion(system, r=0.5, beta=0.1),
    lambda system: fm.sweep(system, r=[0.5], beta=[0.1], solver=fm.Solver(outputs=("drift",))),
    lambda system: fm.sweep(system, r=[0.5], beta=[0.1], solver=fm.Solver(outputs=("base_force",))),
])  # fmt: skip
def test_what_modes_do_not_offer(ask):
    system = fm.System(modes=fm.Modes([1.0], 0.1, [[1.0]], ["tip"]), contact_masses=["tip"])
    with pytest.raises(InputError, match="of a structure given by modes"):
        ask(system)


def test_a_rigid_contact_on_a_beam_is_described():
    beam = fm.Beam(**UNIT, points={"tip": 1.0})
    system = fm.System(modes=beam, **TIP)
    assert system.contact_system.points.residual is None
    assert "the number of stops depends on the number of modes" in system.costs(np.array([1.0]))["modes"]
    elastic = fm.System(modes=beam, **TIP, contact_stiffness=2.0)
    assert elastic.contact_system.points.residual is not None


def test_complex_shapes_are_turned():
    shapes = np.array([[1.0, -0.4], [0.3, 0.9]])
    turned = shapes * np.exp(1j * np.array([0.7, -2.0])) * (1.0 + 0.0j)
    found = fm.Modes([1.0, 2.0], 0.0, turned, ["a", "b"])
    signs = np.sign(found.shapes[0] * shapes[0])
    np.testing.assert_allclose(found.shapes, shapes * signs, atol=1e-15)
    small = fm.Modes([1.0, 2.0], 0.0, shapes * (1.0 + np.array([[0.02j, 0.0], [-0.02j, 0.0]])), ["a", "b"])
    assert 0.0 < small.imaginary < 0.1


def test_files_with_a_participation(tmp_path):
    path = tmp_path / "rig.csv"
    head = "frequency_Hz,damping_ratio,participation,modal_mass,tip"
    path.write_text(f"{head}\n9,0.01,0.4,4,2\n5,0.02,-1.5,1,3\n")
    found = fm.System(modes=path, contact_masses=["tip"]).matrices
    assert found.participation.tolist() == [-1.5, 0.4]
    assert found.shapes.tolist() == [[3.0, 1.0]]
    arrays = {"w": [1.0, 2.0], "shapes": [[1.0, 0.5], [0.2, 0.3]], "points": ["a", "b"]}
    more = {"participation": [0.3, 0.1], "influence": [1.0, 0.0], "base_residual": [0.01, 0.0]}
    np.savez(tmp_path / "rig.npz", **arrays, **more)
    one = fm.System(modes={"file": tmp_path / "rig.npz", "points": ["b"]}, contact_masses=["b"]).matrices
    assert (one.influence.tolist(), one.base_residual.tolist()) == ([0.0], [0.0])
    np.savez(tmp_path / "short.npz", **arrays, participation=[0.3])
    with pytest.raises(InputError, match="must be a number per mode"):
        fm.System(modes=tmp_path / "short.npz", contact_masses=["b"])


def test_compliance_in_the_place_of_the_residual():
    beam = fm.Beam(**UNIT, points={"tip": 1.0, "mid": 0.5}, modes=3)
    whole = beam.residual + (beam.shapes / beam.frequencies**2) @ beam.shapes.T
    found = fm.Modes(beam.frequencies, 0.0, beam.shapes, list(beam.points), compliance=whole)
    np.testing.assert_allclose(found.residual, beam.residual, atol=1e-16)


def two_masses_and_nodes(tiny):
    """M and K of two masses and two nodes of tiny masses, joined by springs."""
    stiffness = np.zeros((4, 4))
    for i, j, k in ((None, 0, 1.0), (0, 1, 1.3), (0, 2, 2.0), (1, 3, 3.0), (2, 3, 0.7)):
        ends = np.zeros(4)
        ends[j] = 1.0
        if i is not None:
            ends[i] = -1.0
        stiffness += k * np.outer(ends, ends)
    return np.diag([1.0, 0.8, tiny, tiny]), stiffness


@pytest.mark.parametrize("keys", [
    {"contact_stiffness": 2.5, "wall_velocity": 0.3},
    {"contact_stiffness": 2.5, "normal_load": {1: 0.4j}},
    {"contact": "between-masses", "contact_masses": [3, 4], "contact_stiffness": 1.2},
], ids=["belt", "normal load", "between"])  # fmt: skip
def test_nodes_without_mass_are_light_nodes(keys):
    # a contact and a load at nodes without mass, which only a residual flexibility describes, beside nodes
    # of a mass of 1e-6; their vibrations are damped with ratios of 0.2 and change the motion by 2 0.2/1000
    mass, stiffness = two_masses_and_nodes(0.0)
    node = stiffness[2:, 2:]
    follow = -np.linalg.solve(node, stiffness[2:, :2])
    squares, phi = eigh(stiffness[:2, :2] + stiffness[:2, 2:] @ follow, mass[:2, :2])
    residual = np.zeros((4, 4))
    residual[2:, 2:] = np.linalg.inv(node)
    modes = fm.Modes(np.sqrt(squares), 0.03, np.vstack((phi, follow @ phi)), list("abcd"), residual)
    mass, stiffness = two_masses_and_nodes(1e-6)
    keys = {"contact_masses": [3], "load_mass": 4, "frequency_scale": math.sqrt(squares[0]), **keys}
    light = fm.System(matrices={"M": mass, "K": stiffness}, damping_ratios=(0.03, 0.03, 0.2, 0.2), **keys)
    found, expected = (fm.response(one, r=0.8, beta=0.15) for one in (fm.System(modes=modes, **keys), light))
    for name in ("peak_to_peak", "contact_peak_to_peak", "sliding_distance", "work_friction", "midpoint"):
        np.testing.assert_allclose(found[name], expected[name], rtol=4e-4, atol=1e-4)
    assert float(found.slips_per_cycle) == float(expected.slips_per_cycle)
    wall = float(found.work_wall) if "work_wall" in found else 0.0
    assert (
        abs(found.work_input.item() + wall - found.work_damping.item() - found.work_friction.item()) < 1e-12
    )
