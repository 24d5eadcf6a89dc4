"""Further axes: maps over numbers of the system, alone and together."""

from pathlib import Path

import numpy as np
import pytest

import frictionmap as fm
from frictionmap import InputError
from frictionmap.command_line.cli import main
from frictionmap.files.reading import read
from frictionmap.files.stored import stored_system

GRID = {"r": [0.3, 0.9, 1.4], "beta": [0.1, 0.5, 1.0], "mu": [1.0, 1.5]}


@pytest.fixture(scope="module")
def two_masses():
    return fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1])


def is_point(ds, point, system):
    """Whether a point of a study is the map of its system, to the bit."""
    one = fm.sweep(system, **GRID, outputs=(*fm.Solver().outputs, "status"))
    part = ds.isel(point)
    for name in one.data_vars:
        if name in part:
            assert part[name].dims == one[name].dims
            np.testing.assert_array_equal(part[name].values, one[name].values)


def test_every_point_is_the_map_of_its_system(two_masses):
    axes = {"damping_ratios": [0.0, 0.02], "stiffness_ratios[2]": [0.5, 1.0, 2.0]}
    ds = fm.sweep(two_masses, **GRID, axes=axes)
    assert ds["regime"].dims == ("damping_ratios", "stiffness_ratios_2", "mu", "r", "beta")
    assert ds["beta_lim"].dims == ("damping_ratios", "stiffness_ratios_2", "mu", "r")
    np.testing.assert_array_equal(ds["stiffness_ratios_2"], [0.5, 1.0, 2.0])
    assert ds["stiffness_ratios_2"].attrs["long_name"] == "stiffness ratio k_2/k_1"
    for i, zeta in enumerate(axes["damping_ratios"]):
        for k, kappa in enumerate(axes["stiffness_ratios[2]"]):
            system = fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, kappa], damping_ratios=zeta)
            is_point(ds, {"damping_ratios": i, "stiffness_ratios_2": k}, system)


def test_numbers_that_change_together(two_masses):
    sample = {"mass_ratios[2]": [1.0, 1.1, 0.9], "stiffness_ratios[2]": [2.0, 1.0, 3.0]}
    ds = fm.sweep(two_masses, **GRID, axes={"sample": sample})
    assert ds["regime"].dims == ("sample", "mu", "r", "beta")
    np.testing.assert_array_equal(ds["mass_ratios_2"], sample["mass_ratios[2]"])
    assert ds["mass_ratios_2"].dims == ("sample",)
    for k, (gamma, kappa) in enumerate(zip(*sample.values(), strict=True)):
        is_point(ds, {"sample": k}, fm.System(mass_ratios=[1, gamma], stiffness_ratios=[1, kappa]))


def test_numbers_that_make_sense_only_together():
    """One contact mass alone would pass the other."""
    chain = {"mass_ratios": [1] * 4, "stiffness_ratios": [1] * 4, "contact": "between-masses"}
    pairs = {"contact_masses[1]": [1, 3], "contact_masses[2]": [2, 4]}
    ds = fm.sweep(fm.System(contact_masses=[1, 2], **chain), **GRID, axes={"pair": pairs})
    is_point(ds, {"pair": 1}, fm.System(contact_masses=[3, 4], **chain))


@pytest.mark.parametrize(
    ("axes", "words"),
    [
        ({}, "axes must be a mapping such as"),
        ([1], "axes must be a mapping such as"),
        ({"load[1]": [1.0]}, r"cannot use axis load\[1\]: the system has no load; give load first"),
        ({"damping_ratios": ["x"]}, "axes.damping_ratios must be numbers"),
        ({"damping_ratios": [0], "damping_ratios[1]": [0]}, "must change damping_ratios in one way only"),
        ({"load_mass": [1.5]}, "at load_mass = 1.5: load_mass must be a whole number"),
        ({"Case 1": {"load_mass": [1]}}, "a name of its own in lower-case letters"),
        ({"mass_ratios_2": {"load_mass": [1]}}, "a name of its own in lower-case letters"),
        ({"sample": {}}, "as many values of every key; got none"),
        ({"sample": {"load_mass": [1], "damping_ratios": [0, 1]}}, "load_mass 1, damping_ratios 2"),
        ({"sample": {"damping_ratios": [0, np.nan]}}, r"axes.sample.damping_ratios\[1\] must be finite"),
    ],
)
def test_what_is_refused(two_masses, axes, words):
    with pytest.raises(InputError, match=words) as refused:
        fm.sweep(two_masses, **GRID, axes=axes)
    assert "\n" not in str(refused.value)


CONFIG = """
[system]
mass_ratios = [1.0, 1.0]
stiffness_ratios = [1.0, 1.0]
[grid]
r = [0.3, 0.9]
beta = { start = 0.1, stop = 1.0, num = 4 }
"""


def loaded(tmp_path, text):
    path = tmp_path / "study.toml"
    path.write_text(CONFIG + text)
    return fm.load_config(path)


def test_axes_of_a_configuration(tmp_path):
    text = (
        '[axes]\ndamping_ratios = [0.0, 0.1]\n"mass_ratios[2]" = { start = 0.5, stop = 1.5, step = 0.25 }\n'
    )
    variations = loaded(tmp_path, text).variations
    assert variations.shape == (2, 5)
    assert variations.at((1, 3)) == fm.System(
        mass_ratios=[1, 1.25], stiffness_ratios=[1, 1], damping_ratios=0.1
    )


def test_a_file_of_variants(tmp_path):
    (tmp_path / "variants.csv").write_text("mass_ratios[2],damping_ratios\n1.5,0.01\n0.5,0\n")
    variations = loaded(tmp_path, '[axes]\nsample = { file = "variants.csv" }\n').variations
    assert variations.shape == (2,)
    assert variations.at((1,)) == fm.System(mass_ratios=[1, 0.5], stiffness_ratios=[1, 1])
    same = {"mass_ratios[2]": [1.5, 0.5], "damping_ratios": [0.01, 0.0]}
    assert variations.described == {"sample": same}


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("load_mass,damping_ratios\n1,0\n1\n", "row 3 must have 2 numbers; got 1"),
        (
            "load_mass,damping_ratios\n\n1,0,0,1\n",
            "row 3 must have 2 numbers; got 4 .separate numbers by commas",
        ),
        ("load_mass,load_mass\n1,1\n", "must name every number once in its first row; got load_mass,load_m"),
        ("load_mass,damping_ratios\n1,nan\n", "row 2, damping_ratios must be a number; got 'nan'"),
        ("load_mass,damping_ratios\n1,1_0\n", "row 2, damping_ratios must be a number; got '1_0'"),
        ("load_mass\none\n", "row 2, load_mass must be a number; got 'one'"),
        ("mass\n1\n", "axes.sample must name a number of the system"),
        ("load_mass\n", "axes.sample.load_mass must be a list of numbers"),
    ],
)
def test_bad_files_of_variants(tmp_path, content, words):
    if content is not None:
        (tmp_path / "variants.csv").write_text(content)
    with pytest.raises(InputError, match=words):
        loaded(tmp_path, '[axes]\nsample = { file = "variants.csv" }\n')


def test_the_configuration_in_the_file_makes_it_again(tmp_path, two_masses):
    axes = {"damping_ratios": [0.0, 0.02], "sample": {"mass_ratios[2]": [2.0, 1.0]}}
    ds = fm.sweep(two_masses, **GRID, axes=axes)
    path = tmp_path / "again.toml"
    path.write_text(ds.attrs["config"])
    config = fm.load_config(path)
    assert config.variations.described == {name: _lists(values) for name, values in axes.items()}
    assert config.system == two_masses


def test_a_file_of_variants_is_part_of_the_configuration(tmp_path, monkeypatch):
    """Another file of that name, where the map is looked at, is not used."""
    (tmp_path / "v.csv").write_text("\ufeffmass_ratios[2], damping_ratios\r\n1.5, 0.01\r\n , \r\n0.5,0\r\n")
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "v.csv").write_text("mass_ratios[2],damping_ratios\n7,0.07\n7,0.07\n")
    config = loaded(tmp_path, '[axes]\nsample = { file = "v.csv" }\n')
    assert config.files == (tmp_path / "study.toml", tmp_path / "v.csv")
    before = (tmp_path / "v.csv").read_bytes()
    command = ["map", str(tmp_path / "study.toml"), "--quiet", "--overwrite", "-o"]
    assert main([*command, str(tmp_path / "v.csv")]) == 2
    assert (tmp_path / "v.csv").read_bytes() == before
    assert main([*command, str(tmp_path / "study.nc")]) == 0
    monkeypatch.chdir(tmp_path / "elsewhere")
    system = stored_system(read(tmp_path / "study.nc", at={"sample": 0}))
    assert system == fm.System(mass_ratios=[1, 1.5], stiffness_ratios=[1, 1], damping_ratios=0.01)
    (tmp_path / "again.toml").write_text(config.text)
    assert fm.load_config(tmp_path / "again.toml").variations.described == config.variations.described


@pytest.mark.parametrize(
    ("override", "expected"),
    [
        ("axes.damping_ratios.num=3", [0.0, 0.05, 0.1]),
        ("axes.damping_ratios.values=[0.0, 0.3]", [0.0, 0.3]),
        ('axes."damping_ratios"=[0.2]', [0.2]),
    ],
)
def test_axes_are_overridden_as_grids_are(tmp_path, override, expected):
    path = tmp_path / "study.toml"
    path.write_text(CONFIG + "[axes]\ndamping_ratios = { start = 0.0, stop = 0.1, step = 0.1 }\n")
    ((values,),) = (axis.values for axis in fm.load_config(path, [override]).variations.axes)
    assert values.tolist() == expected


def _lists(values):
    return {key: list(map(float, v)) for key, v in values.items()} if isinstance(values, dict) else values


def test_too_many_cells_are_refused(two_masses):
    axes = {"damping_ratios": np.linspace(0, 1, 1000)}
    grid = {"r": np.linspace(0.1, 2, 2000), "beta": np.linspace(0, 1, 1000)}
    with pytest.raises(InputError, match=r"at most 1e\+09 cells in memory; got 2e\+09 .* x 1000 points"):
        fm.sweep(two_masses, **grid, axes=axes)


@pytest.mark.parametrize("name", ["five-masses", "two-masses"])
def test_studies_among_the_configurations(name):
    config = fm.load_config(Path(__file__).parents[2] / "configs" / "studies" / f"{name}.toml")
    assert config.variations.count == {"five-masses": 1000, "two-masses": 24}[name]
    last = config.variations.at([size - 1 for size in config.variations.shape])
    ds = fm.sweep(last, config.r[::20], config.beta[::20], config.mu, solver=config.solver)
    assert (ds["regime"] >= 0).any()


#: One mass on a belt, with a spring in its contact: r = 1 is 4.2 Hz, P = 12.5 N, k_1 = 3 N/mm.
IN_UNITS = """\
[system]
damping_ratios = 0.02
contact_stiffness = 1.0
wall_speed = 0.5
[units]
natural_frequency = "4.2 Hz"
load = "12.5 N"
stiffness = "3 N/mm"
[grid]
r = [0.5]
beta = [0.2]
"""


def load_varied(folder, table, content):
    (folder / "varied.csv").write_text(content)
    (folder / "varied.toml").write_text(IN_UNITS + table)
    (axis,) = fm.load_config(folder / "varied.toml").variations.axes
    return {number.text: values for number, values in zip(axis.numbers, axis.values, strict=True)}


def test_columns_of_a_file_have_units(tmp_path):
    content = "contact_stiffness [N/mm], wall_velocity [mm/s],damping_ratios\n3,20,0.01\n4.5,50,0.02\n"
    found = load_varied(tmp_path, '[axes]\ndesign = { file = "varied.csv" }\n', content)
    speed = 2 * np.pi * 4.2 * 12.5 / 3000  # omega_1 P/k_1
    assert set(found) == {"contact_stiffness", "wall_speed", "damping_ratios"}
    np.testing.assert_array_equal(found["contact_stiffness"], [1.0, 1.5])
    np.testing.assert_allclose(found["wall_speed"], np.array([0.02, 0.05]) / speed, rtol=4e-16)
    np.testing.assert_array_equal(found["damping_ratios"], [0.01, 0.02])


def test_wall_velocities_with_units_that_vary_with_others_are_speeds(tmp_path):
    """Over omega_1 P/k_1: the ratio over omega P/k_1 would be another one at r = 0.5."""
    table = '[axes.design]\nwall_velocity = ["20 mm/s", "50 mm/s"]\ndamping_ratios = [0.01, 0.02]\n'
    found = load_varied(tmp_path, table, "")
    assert set(found) == {"wall_speed", "damping_ratios"}


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (
            "contact_stiffness [N]\n3\n",
            "axes.design.contact_stiffness.* such as '3 N/mm'; got '3 N': N is a unit",
        ),
        (
            "contact_stiffness\n3 N/mm\n",
            r"whose unit belongs to the first row, as in force \[N\]; got '3 N/mm'",
        ),
        ("damping_ratios [mm]\n0.1\n", "axes.design.damping_ratios.* must be a number; got '0.1 mm'"),
        (
            "wall_speed,wall_velocity [m/s]\n1,1\n",
            "cannot use axes.design.wall_velocity beside another wall_sp",
        ),
        ("contact_stiffness,contact_stiffness [N/mm]\n1,3\n", "must name every number once"),
    ],
)
def test_wrong_units_of_columns_are_refused(tmp_path, content, said):
    with pytest.raises(InputError, match=said):
        load_varied(tmp_path, '[axes]\ndesign = { file = "varied.csv" }\n', content)


@pytest.mark.parametrize("key", ["load_file", "waveform"])
def test_loads_of_files_are_ratios(tmp_path, key):
    (tmp_path / "load.csv").write_text("time [s],force [N]\n0,1\n1,2\n")
    (tmp_path / "one.toml").write_text(f'[system]\n{key} = "load.csv"\n[grid]\nr = [0.5]\nbeta = [0.2]\n')
    with pytest.raises(InputError, match=r"without units, forces over P; got time \[s\], force \[N\] in"):
        fm.load_config(tmp_path / "one.toml")
