"""Normal forces that move with the structure and piecewise linear springs: keys, units, refusals, files."""

import tomllib

import numpy as np
import pytest

import frictionmap as fm
from frictionmap.command_line.cli import main
from frictionmap.datasets.provenance import system_text
from frictionmap.files.config import system_in

NORMAL = {"mass": 2, "stiffness": 1.0, "friction": 0.4}
GAP = {"gap": 0.5, "stiffness": 4.0}
KNOTS = {"displacement": [-1.0, 2.0], "force": [-1.0, 0.5], "stiffness_below": 3.0, "stiffness_above": 0.0}

#: Two masses, the first of which slides, and the second presses it.
B1 = """\
[system]
mass_ratios = [1.0, 1.0]
stiffness_ratios = [1.0, 0.2]
[[system.contacts]]
kind = "fixed-wall"
masses = [1]
stiffness = 3.0
normal = { mass = 2, stiffness = 1.0, friction = 0.4, preload = 0.5 }
[grid]
r = 1.5
beta = 0.2
"""


def two(**keys):
    return fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1], **keys)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"mass": None}, "normal.mass must be given, or masses or vector"),
        (
            {"masses": [1, 2]},
            "cannot use contacts[1].normal.masses with mass: both define the direction; omit one",
        ),
        ({"stiffness": 0.0}, "normal.stiffness must be > 0; got 0"),
        ({"stiffness": None}, "normal.stiffness must be given"),
        ({"friction": -0.1}, "normal.friction must be >= 0; got -0.1"),
        ({"friction": 0.0}, "normal.preload must be given with friction = 0"),
        ({"side": 0.5}, "normal.side must be 1 or -1; got 0.5"),
        ({"preload": "2 N"}, "normal.preload must be a number"),
        ({"mass": None, "masses": [2]}, "normal.masses must be two masses [A, B]; got [2]"),
        ({"mass": None, "masses": [2, 1]}, "normal.masses must be [A, B] with A < B; got [2, 1]"),
        ({"mass": None, "vector": [1.0]}, "normal.vector must have one number per mass (2); got 1"),
        ({"mass": 3}, "normal.mass must be <= 2; got 3"),
        ({"prelod": 1.0}, "unknown key 'normal.prelod' (did you mean preload?)"),
    ],
)
def test_a_wrong_normal_force_is_refused_by_its_key(changed, message):
    keys = {key: value for key, value in (NORMAL | changed).items() if value is not None}
    with pytest.raises(fm.InputError) as error:
        two(contacts=[{"normal": keys}])
    assert message in str(error.value)
    assert "contacts[1]" in str(error.value)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"law": {"speed": [0.0, 0.5], "factor": [1.0, 0.7]}}, "cannot use normal with law:"),
        ({"normal_load": {1: 0.2}}, "cannot use normal with normal_load:"),
        ({"normal": NORMAL | {"preload": 1.0}, "ratio": 2.0}, "cannot use normal.preload with ratio:"),
        ({"normal": NORMAL | {"preload": 1.0}, "force": 2.0}, "cannot use normal.preload with force:"),
        ({"stiffness": [1.0, 2.0]}, "stiffness must be one number with normal"),
        ({"stiffness": 1.0, "mu": 1.2}, "mu must be 1 for a contact with stiffness"),
        ({"normal": 0.4}, "normal must be { mass, masses, vector,"),
    ],
)
def test_keys_that_exclude_a_normal_force(keys, message):
    with pytest.raises(fm.InputError) as error:
        fm.Contact(**{"normal": NORMAL, **keys})
    assert message in str(error.value)


@pytest.mark.parametrize(
    ("spring", "message"),
    [
        ({"stiffness": 4.0}, "springs[1].gap must be given, or backlash or displacement"),
        ({"gap": 0.5}, "springs[1].stiffness must be given with gap"),
        ({**GAP, "backlash": 0.5}, "cannot use springs[1].backlash with gap: both define the spring"),
        ({**GAP, "force": [1.0]}, "cannot use springs[1].force with gap"),
        ({**GAP, "gap": -0.5}, "springs[1].gap must be >= 0; got -0.5"),
        ({**GAP, "stiffness": 0.0}, "springs[1].stiffness must be > 0; got 0"),
        ({**GAP, "side": 2}, "springs[1].side must be 1 or -1; got 2"),
        ({"backlash": 0.0, "stiffness": 1.0}, "springs[1].backlash must be > 0; got 0"),
        ({"backlash": 1.0, "stiffness": 1.0, "side": 1}, "cannot use springs[1].side with backlash"),
        ({**KNOTS, "force": [1.0]}, "springs[1].force must have as many values as displacement (2); got 1"),
        ({**KNOTS, "displacement": [0.0, 0.0]}, "springs[1].displacement must increase"),
        ({**KNOTS, "force": [1.0, 0.0]}, "springs[1].force must not fall"),
        ({**KNOTS, "stiffness_below": -1.0}, "springs[1].stiffness_below must be >= 0; got -1"),
        ({**KNOTS, "displacement": [*range(25)], "force": [0] * 25}, "at most 24 knots; got 25"),
        ({**GAP, "masses": [1, 3]}, "springs[1].masses[1] must be <= 2; got 3"),
        ({**GAP, "masses": [2, 1]}, "springs[1].masses must be [A, B] with A < B; got [2, 1]"),
        ({**GAP, "masses": [1, 2, 3]}, "springs[1].masses must be one mass, or two [A, B]"),
        ({**GAP, "kap": 1.0}, "unknown key 'springs[1].kap' (did you mean gap?)"),
        (4.0, "springs[1] must be a table of a spring; got 4.0"),
    ],
)
def test_a_wrong_spring_is_refused_by_its_key(spring, message):
    with pytest.raises(fm.InputError) as error:
        two(springs=[spring])
    assert message in str(error.value)


def test_forms_of_springs_are_one():
    """Displacements and forces that a gap and a backlash stand for."""
    u = np.linspace(-2.0, 2.0, 41)
    gap, mirrored, play, knots = two(
        springs=[GAP, {**GAP, "side": -1}, {"backlash": 0.5, "stiffness": 4.0, "masses": [1, 2]}, KNOTS]
    ).spring_elements
    np.testing.assert_allclose(gap(u), 4.0 * np.maximum(u - 0.5, 0.0))
    np.testing.assert_allclose(mirrored(u), 4.0 * np.minimum(u + 0.5, 0.0))
    np.testing.assert_allclose(play(u), np.sign(u) * 4.0 * np.maximum(abs(u) - 0.5, 0.0))
    np.testing.assert_allclose(knots(np.array([-2.0, 0.5, 5.0])), [-4.0, -0.25, 0.5])
    assert knots.slopes == (3.0, 0.5, 0.0)
    np.testing.assert_array_equal(play.direction, [-1.0, 1.0])


def test_directions_of_normal_forces():
    for keys, expected in (
        ({"mass": 2}, [0, 1]), ({"masses": [1, 2]}, [-1, 1]), ({"vector": [0.2, -3]}, [0.2, -3]),
    ):  # fmt: skip
        for side in (1, -1):
            normal = {"stiffness": 2.0, "friction": 0.3, "side": side, **keys}
            found = two(contacts=[{"normal": normal}]).contact_system.groups[0].normal
            np.testing.assert_array_equal(found.direction, side * np.array(expected))


def test_friction_at_preload_is_that_of_beta_or_of_the_preload():
    by_beta, given, open_ = two(
        contacts=[
            {"normal": NORMAL, "ratio": 2.0},
            {"normal": NORMAL | {"preload": 0.5}, "masses": [2]},
            {"normal": NORMAL | {"preload": -0.5}, "kind": "between-masses", "masses": [1, 2]},
        ]
    ).contact_system.groups
    assert by_beta.friction(0.6, 1.5) == (1.2, 1.2 * 1.5)
    assert by_beta.normal.preload_at(1.2) == 1.2 / 0.4
    assert given.friction(0.6, 1.0) == (0.2, 0.2)
    assert open_.friction(0.6, 1.0) == (0.0, 0.0)


def test_parallel_contacts_with_normal_forces_are_not_merged():
    """Their normal forces vanish at different times."""
    system = two(contacts=[{"normal": NORMAL, "stiffness": 1.0}, {"normal": NORMAL, "stiffness": 1.0}, {}])
    assert system.contact_system.count == 3


def test_springs_of_a_chain_and_piecewise_linear_ones_are_distinguished(tmp_path):
    path = tmp_path / "drive.toml"
    path.write_text(
        '[system]\nmasses = ["40 kg", "20 kg"]\nstiffness_ratios = [1.0, 0.5]\n'
        'springs = [{ masses = [1, 2], backlash = "0.1 mm", stiffness = "1 kN/mm" }]\n'
        '[units]\nstiffness = "500 N/mm"\nload = "100 N"\n[grid]\nr = 1.0\nbeta = 1.0\n'
    )
    system = fm.load_config(path).system
    assert system.mass_ratios == (1.0, 0.5)
    assert system.spring_elements[0].displacement == (-0.5, 0.5)
    assert system.spring_elements[0].stiffness_below == 2.0
    path.write_text(path.read_text().replace("springs = [", 'springs = ["500 N/mm", '))
    with pytest.raises(fm.InputError, match=r"^system\.springs must be stiffnesses of a chain or tables"):
        fm.load_config(path)


def test_a_file_holds_the_system():
    system = two(
        contacts=[
            {
                "stiffness": 3.0,
                "normal": {"masses": [1, 2], "stiffness": 1.0, "friction": 0.0, "preload": -1.0},
            },
            {"masses": [2], "normal": {"vector": [1.0, 0.5], "stiffness": 2.0, "friction": 0.3, "side": -1}},
        ],
        springs=[GAP, {"backlash": 0.5, "stiffness": 1.0, "masses": [1, 2], "name": "joint"}, KNOTS],
    )
    text = system_text(system)
    tomllib.loads(text)
    assert system_in(text) == system
    assert "normal force of stiffness 1, friction 0" in system.describe()
    assert "spring with backlash 0.5 between masses 1 and 2 (stiffness 1)" in system.describe()


@pytest.fixture
def command(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "b1.toml").write_text(B1)

    def run(text):
        status = main(text.split())
        return status, capsys.readouterr().err

    return run


def test_functions_that_do_not_take_them_name_the_key():
    system = two(contacts=[{"normal": NORMAL}])
    for call in (
        lambda: fm.borders(system, r=[0.5, 1.0], beta=[0.1, 1.0]),
        lambda: fm.continuous_motion(system, 0.5, 0.1),
        lambda: fm.design.no_stop(system, (0.5, 1.5)),
        lambda: fm.features.peak_thresholds(system),
    ):
        with pytest.raises(fm.InputError, match=r"with contacts(\[1\]\.normal)?: "):
            call()


def test_a_reduced_structure_keeps_what_presses_and_what_is_stretched():
    """With all modes it is the whole structure."""
    n = 6
    stiffness = 2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    keys = {
        "matrices": {"M": np.eye(n), "K": stiffness, "C": 0.05 * stiffness}, "frequency_scale": 0.5,
        "load_mass": 6, "contacts": [{"masses": [2], "stiffness": 3.0, "normal": {**NORMAL, "mass": 5}}],
        "springs": [{"masses": [4], "gap": 0.05, "stiffness": 2.0}],
    }  # fmt: skip
    whole, small = (
        fm.sweep(
            fm.System(**keys, **more), [0.9, 1.7], [0.05, 0.2], outputs=["open_fraction", "spring_force_max"]
        )
        for more in ({}, {"reduce": {"modes": 2, "allow": 1.0}})
    )
    assert small.open_fraction.max() > 0.0
    for name in ("open_fraction", "spring_force_max"):
        np.testing.assert_allclose(small[name], whole[name], atol=1e-9)


def test_a_free_structure_with_them_is_refused():
    system = fm.System(
        mass_ratios=[1, 1], stiffness_ratios=[0, 1], springs=[{**GAP, "masses": [1, 2]}],
        contact="between-masses", contact_masses=[1, 2],
    )  # fmt: skip
    with pytest.raises(
        fm.InputError, match="cannot compute steady states of a free structure with springs: "
    ):
        fm.sweep(system, [0.5], [1.0])


MAP = """\
title = "Damper and gap"
[system]
mass_ratios = [1.0, 1.0]
stiffness_ratios = [1.0, 0.5]
damping_ratios = 0.03
load = [1.0, [0.5, 0.6]]
[[system.contacts]]
masses = [1]
stiffness = 3.0
normal = { mass = 2, stiffness = 1.0, friction = 0.4 }
[[system.contacts]]
kind = "between-masses"
masses = [1, 2]
ratio = 0.2
[[system.springs]]
masses = [2]
gap = 0.5
stiffness = 1.0
[grid]
r = [0.6, 1.2]
beta = [0.1, 0.3]
[solver]
outputs = ["regime", "stops_per_cycle", "open_fraction", "normal_force_max", "spring_force_max", "unique"]
[units]
stiffness = "2 N/mm"
natural_frequency = "10 Hz"
load = "4 N"
"""


@pytest.mark.filterwarnings("ignore:The data type")  # texts in stores have no standard yet
def test_files_of_all_kinds(command, tmp_path):
    """Maps, curves, boundaries and motions are written, read, described, drawn; a store has the same bits."""
    (tmp_path / "two.toml").write_text(MAP)
    for call in (
        "map two.toml -o map.nc", "map two.toml -o map.zarr", "curves two.toml -o curves.nc",
        "boundaries b1.toml -o limits.nc", "response two.toml --r 1.2 --beta 0.1 -o motion.nc",
    ):  # fmt: skip
        status, error = command(call)
        assert status == 0, error
    for name in ("map.nc", "map.zarr", "curves.nc", "limits.nc", "motion.nc"):
        status, error = command(f"info {name}")
        assert (status, error) == (0, "")
    for name in ("map.nc", "curves.nc", "motion.nc"):
        status, error = command(f"plot {name} -o {name}.png")
        assert status == 0, error
    status, error = command("plot map.nc --quantity open_fraction --at contact=1 -o open.png")
    assert status == 0, error
    whole, stored = fm.open("map.nc"), fm.open("map.zarr")
    assert all(str(name).endswith("_N") for name in set(whole.variables) - set(stored.variables))
    for name in set(whole.variables) & set(stored.variables):
        np.testing.assert_array_equal(stored[name].values, whole[name].values)
    assert whole["spring_name"].values.tolist() == ["spring 2"]
    np.testing.assert_allclose(whole["spring_force_max_N"], 4.0 * whole["spring_force_max"])
    motion = fm.open("motion.nc")
    assert motion["normal_force"].dims == ("contact", "tau")
    assert np.isnan(motion["normal_force"].values[1]).all()
    np.testing.assert_array_equal(motion["open"].values[0] == 1, motion["normal_force"].values[0] == 0.0)
    assert motion["spring_force"].dims == ("spring", "tau")
    assert "beta_noslip" in fm.open("limits.nc")


def test_structures_given_by_modes_are_refused():
    own = {"length": 1.0, "bending_stiffness": 1.0, "mass_per_length": 1.0}
    beam = fm.Beam(ends="clamped-free", points={"tip": 1.0}, modes=3, **own)
    springs = [{"masses": "tip", **GAP}]
    with pytest.raises(fm.InputError, match=r"cannot use springs or contacts.*with modes"):
        fm.System(modes=beam, contact_masses=["tip"], load_mass="tip", springs=springs)
