"""Configuration files: overrides, axes as they were typed, and text that gives the same problem again."""

import re
import tomllib
from decimal import Decimal

import numpy as np
import pytest
from conftest import ROOT
from hypothesis import given
from hypothesis import strategies as st

import frictionmap as fm
from frictionmap import InputError, Solver, System, load_config
from frictionmap.datasets.provenance import to_toml
from frictionmap.files.config import _decimal_steps

CONFIGS = sorted((ROOT / "configs").glob("*.toml"))

BASE = """\
# a comment
title = "Base"

[system]
contact = "joined-base-wall"
damping_ratios = 0.25

[grid]
r = { start = 0.0, stop = 2.5, step = 0.02 }
beta = [0.0, 0.5, 1.0]
mu = [1.0, 1.5]

[solver]
cycles = 300
"""


@pytest.fixture
def base(tmp_path):
    path = tmp_path / "base.toml"
    path.write_text(BASE)
    return path


def written(folder, text):
    path = folder / "again.toml"
    path.write_text(text, encoding="utf-8")
    return path


def assert_same(one, other):
    assert one.system == other.system
    assert one.solver == other.solver
    assert one.title == other.title
    for axis in ("r", "beta", "mu"):
        np.testing.assert_array_equal(getattr(one, axis), getattr(other, axis), strict=True)


def test_everything_in_the_file_arrives(base):
    config = load_config(base)
    assert config.title == "Base"
    assert config.name == "base"
    assert config.text == BASE  # with its comments
    assert config.system == System(contact="joined-base-wall", damping_ratios=0.25)
    assert config.solver == Solver(cycles=300)
    assert [axis.dtype for axis in (config.r, config.beta, config.mu)] == [np.float64] * 3
    np.testing.assert_array_equal(config.beta, [0.0, 0.5, 1.0])
    np.testing.assert_array_equal(config.mu, [1.0, 1.5])


def test_defaults(tmp_path):
    config = load_config(written(tmp_path, "[system]\n[grid]\nr = 0.5\nbeta = [0.25]\n"))
    assert config.title == config.name == "again"
    assert config.system == System()
    assert config.solver == Solver()
    assert (config.r, config.beta, config.mu) == ([0.5], [0.25], [1.0])


def test_a_byte_order_mark_and_windows_line_ends_are_accepted(base, tmp_path):
    path = tmp_path / "windows.toml"
    path.write_bytes(b"\xef\xbb\xbf" + BASE.replace("\n", "\r\n").encode())
    assert_same(load_config(path), load_config(base))


@pytest.mark.parametrize("path", CONFIGS, ids=lambda path: path.stem)
def test_the_configurations_that_come_with_the_program_are_valid(path):
    config = load_config(path)
    assert config.title != config.name
    motion = config.r.size == config.beta.size == config.mu.size == 1
    assert config.r.size > 1 or motion


@pytest.mark.parametrize("path", CONFIGS, ids=lambda path: path.stem)
def test_configurations_are_named_by_their_figures(path):
    """fig-4-7.toml says Fig. 4.7 in its title; motions and curves say that they are, and ask for no more."""
    config = load_config(path)
    figure = re.match(r"fig-(\d)-(\d+)", path.stem)
    if figure:
        assert re.search(rf"Fig\. {figure[1]}\.{figure[2]}\b", config.title)
    drawn = {
        "amplitude": {"amplitude"},
        "phase": {"phase"},
        "first harmonic": {"first_harmonic", "harmonics"},
    }
    if "[curves]" in config.text:
        wanted = set().union(*(names for word, names in drawn.items() if word in config.title))
        assert wanted == set(config.curves.quantities)
        assert config.r.size >= 250
    elif config.r.size == 1:
        assert "motion" in config.title
        assert config.beta.size <= 8


# Axes


def test_a_decimal_axis_has_the_doubles_next_to_the_decimals(base):
    r = load_config(base).r
    assert r.size == 126
    assert r[35] == 0.7  # 35*0.02 is 0.7000000000000001
    assert r[-1] == 2.5
    np.testing.assert_array_equal(r, [float(Decimal(2 * k) / 100) for k in range(126)])


@given(
    start=st.decimals(0, 100, places=4),
    step=st.decimals("0.0001", 10, places=5),
    count=st.integers(0, 50),
)
def test_decimal_steps_are_rounded_once(start, step, count):
    expected = [float(start + k * step) for k in range(count + 1)]
    assert _decimal_steps(start, step, count).tolist() == expected


@pytest.mark.parametrize(
    ("start", "step"), [("1e-30", "0.1"), ("12345678901234567", "0.1"), ("1e300", "1e299"), ("0", "5e-324")]
)
def test_decimal_steps_of_any_size_are_rounded_once(start, step):
    start, step = Decimal(start), Decimal(step)
    assert _decimal_steps(start, step, 3).tolist() == [float(start + k * step) for k in range(4)]


@pytest.mark.parametrize(
    ("axis", "expected"),
    [
        ("{ start = 0, stop = 1, num = 5 }", [0.0, 0.25, 0.5, 0.75, 1.0]),
        ("{ start = 0.5, stop = 0.5, num = 1 }", [0.5]),
        ("{ start = 0.5, stop = 0.5, step = 0.1 }", [0.5]),
        ("{ start = 0, stop = 1, step = 0.4 }", [0.0, 0.4, 0.8, 1.0]),  # ends included
        ("{ start = 1, stop = 3, step = 1 }", [1.0, 2.0, 3.0]),
        ("{ values = [0, 0.3] }", [0.0, 0.3]),
        ("[0.1, 2]", [0.1, 2.0]),
        ("2", [2.0]),
    ],
)
def test_ways_to_give_an_axis(base, axis, expected):
    assert load_config(base, [f"grid.r={axis}"]).r.tolist() == expected


def test_the_last_step_is_not_lost_to_rounding(base):
    # 0.3/0.1 is 2.9999999999999996 in doubles
    r = load_config(base, ["grid.r={ start = 0.0, stop = 0.3, step = 0.1 }"]).r
    assert r.tolist() == [0.0, 0.1, 0.2, 0.3]


# Overrides


def test_an_override_changes_one_key_and_no_other(base):
    config = load_config(base, ["grid.r.stop=1.0", "solver.tolerance=1e-9"])
    assert config.r[-1] == 1.0
    assert config.r.size == 51
    assert config.solver == Solver(cycles=300, tolerance=1e-9)
    assert config.system == load_config(base).system
    np.testing.assert_array_equal(config.beta, load_config(base).beta)


@pytest.mark.parametrize(
    ("overrides", "expected"),
    [
        (["grid.r.step=1.25"], [0.0, 1.25, 2.5]),
        (["grid.r.num=3"], [0.0, 1.25, 2.5]),
        (["grid.r.values=[0.5, 1]"], [0.5, 1.0]),
        (["grid.r = [ 0.5 ]"], [0.5]),
        (["grid.r=0.5"], [0.5]),
        (["grid.r={start=0, stop=1, num=2}"], [0.0, 1.0]),
        (["grid.r={start=0, stop=1, num=2}", "grid.r.num=3"], [0.0, 0.5, 1.0]),
    ],
)
def test_overrides_of_an_axis_take_the_place_of_their_rivals(base, overrides, expected):
    assert load_config(base, overrides).r.tolist() == expected


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("grid.r.num=3", "grid.r.step=2.5"),
        ("grid.r.step=2.5", "grid.r.num=3"),
        ("grid.r.num=3", "grid.r.values=[0.5, 1]"),
        ("grid.r.values=[1]", "grid.r.start=0"),
        ("grid.r.num=3", "grid.r.num=3"),
        ("grid.r.num=3", " grid . r .num=4"),
        ("grid.r.num=3", "grid.r=0.5"),
        ("solver.steps=9", "solver.steps=10"),
        ("title=One", "title=Two"),
    ],
)
def test_no_override_is_dropped_for_another(base, before, after):
    message = (
        f"^cannot apply --set {re.escape(after)}: it undoes --set {re.escape(before)}; give one of the two$"
    )
    with pytest.raises(InputError, match=message):
        load_config(base, [before, after])


@pytest.mark.parametrize("text", ["9 # of old", "9, cycles = 5", "9 }, b = { c = 1", "9 }\nb = { c = 1"])
def test_no_part_of_an_override_is_dropped(base, text):
    with pytest.raises(InputError, match=r"^solver\.steps must be a whole number|^--set must be one line"):
        load_config(base, [f"solver.steps={text}"])
    if "\n" not in text:
        assert load_config(base, [f"title={text}"]).title == text


def test_the_files_of_a_configuration(base, tmp_path):
    assert load_config(base).files == (base,)
    np.savez(tmp_path / "frame.npz", M=np.eye(1), K=np.eye(1))
    assert load_config(base, ["system.matrices=frame.npz"]).files == (base, tmp_path / "frame.npz")


def test_words_need_no_quotes(base):
    config = load_config(base, ["solver.start=moving", "system.contact=fixed-wall", "title=Two words"])
    assert config.solver.start == "moving"
    assert config.system.contact == "fixed-wall"
    assert config.title == "Two words"
    assert load_config(base, ['solver.start="moving"']).solver.start == "moving"


def test_lists(base):
    config = load_config(base, ['solver.outputs=["status", "regime", "status"]', "grid.mu=[1, 3]"])
    assert config.solver.outputs == ("status", "regime")
    assert config.mu.tolist() == [1.0, 3.0]


def test_an_override_may_add_a_table(tmp_path):
    path = written(tmp_path, "[grid]\nr = 1\nbeta = 1\n")
    config = load_config(path, ["system.damping_ratios=0.5", "solver.cycles=7"])
    assert config.system.zeta == 0.5
    assert config.solver.cycles == 7


def test_matrices_are_looked_for_next_to_the_configuration(base, tmp_path, monkeypatch):
    for name in ("elsewhere", "data"):
        (tmp_path / name).mkdir()
    np.savez(tmp_path / "data" / "frame.npz", M=np.eye(2), K=np.array([[2.0, -1.0], [-1.0, 1.0]]))
    monkeypatch.chdir(tmp_path / "elsewhere")
    overrides = ["system.matrices=data/frame.npz", "system.frequency_scale=0.5", "system.stiffness_scale=2"]
    config = load_config(base, overrides)
    assert config.system == System(
        contact="joined-base-wall", damping_ratios=0.25, matrices=tmp_path / "data" / "frame.npz",
        frequency_scale=0.5, stiffness_scale=2.0,
    )  # fmt: skip
    assert tomllib.loads(config.text)["system"]["matrices"] == "data/frame.npz"
    assert_same(load_config(written(tmp_path, config.text)), config)


def test_excitation_and_damping_reference(base):
    overrides = ["system.contact=fixed-wall", "system.excitation=base", "system.damping_reference=base"]
    system = load_config(base, overrides).system
    assert system == System(excitation="base", damping_reference="base", damping_ratios=0.25)
    assert system.contact_load(np.array([2.0])).tolist() == [1.0 + 1.0j]


def test_the_text_with_overrides_gives_the_same_problem(base, tmp_path):
    overrides = [
        "grid.r.step=0.05",
        "grid.beta={ start = 0, stop = 1, num = 7 }",
        "grid.mu=1.25",
        "solver.tolerance=1e-9",
        "solver.start=moving",
        'solver.outputs=["regime", "cycles"]',
        "system.mass_ratios=[1.0]",
    ]
    config = load_config(base, overrides)
    assert tomllib.loads(config.text)["grid"]["r"] == {"start": 0.0, "stop": 2.5, "step": 0.05}
    assert_same(load_config(written(tmp_path, config.text)), config)


@pytest.mark.parametrize(
    "title", ['quo"ted', "back\\slash", "new\nline", "tab\t", "re\rturn", "bell\a", "delete\x7f", "β ≥ 0", ""]
)
def test_any_title_survives(base, tmp_path, title):
    tree = tomllib.loads(BASE) | {"title": title}
    again = load_config(written(tmp_path, to_toml(tree)), ["grid.mu=2"])
    assert again.title == title
    assert tomllib.loads(again.text)["title"] == title


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("grid.r=" + "[" * 5000, r"^grid\.r must be a number, a list of numbers or a table; got '\[\[\["),
        ("grid.mu=1" + "0" * 400, r"^grid\.mu must be finite; got inf$"),
        ("grid.mu=-1" + "0" * 400, r"^grid\.mu must be finite; got -inf$"),
        ("grid.mu=1" + "0" * 5000, r"^grid\.mu must be a number, a list of numbers or a table; got '1000"),
        (
            "grid.r.values={ values = [1] }",
            r"^grid\.r\.values must be a list of numbers; got \{'values': \[1\]\}$",
        ),
        ("grid.r.values=1", r"^grid\.r\.values must be a list of numbers; got 1$"),
    ],
)
def test_bad_overrides(base, override, message):
    with pytest.raises(InputError, match=message):
        load_config(base, [override])


def test_the_value_is_shown_with_all_its_digits(base):
    with pytest.raises(InputError, match=r"^grid\.mu must be >= 1; got 0\.9999999999 at index 0$"):
        load_config(base, ["grid.mu=0.9999999999"])
    with pytest.raises(InputError, match=r"^system\.damping_ratios must be >= 0; got -1\.0000000001$"):
        load_config(base, ["system.damping_ratios=-1.0000000001"])
    with pytest.raises(InputError, match=r"^solver\.tolerance must be <= 0\.001; got 0\.0010000000001$"):
        load_config(base, ["solver.tolerance=0.0010000000001"])


# Axes of the Python interface


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ("0.5", r"^r must be numbers; got '0\.5'$"),
        (["0.5"], r"^r must be numbers; got \['0\.5'\]$"),
        (True, r"^r must be numbers; got True$"),
        (1j, r"^r must be numbers; got 1j$"),
        (None, r"^r must be given with a system, such as \[0\.5, 1\.0\]; got nothing$"),
        ([[1.0], [1.0, 2.0]], r"^r must be numbers; got \[\[1\.0\], \[1\.0, 2\.0\]\]$"),
        (np.array(["a"] * 40), r"^r must be numbers; got array\(\[.*\]"),
        ([10**400], r"^r must be numbers; got \[1000"),
        ([[1.0, 2.0]], r"^r must be one-dimensional; got 2 dimensions$"),
        ([], r"^r must have at least one value; got none$"),
        ([1.0, np.nan], r"^r must be finite; got nan at index 1$"),
        ([1.0, 1.0], r"^r must be increasing; got 1\.0 at index 1$"),
        ([-1.0], r"^r must be >= 0; got -1\.0 at index 0$"),
        ([1e9], r"^r must be <= 1e\+08; got 1000000000\.0 at index 0$"),
    ],
)
def test_axes_given_to_python_are_checked_alike(values, message):
    import frictionmap as fm

    with pytest.raises(InputError, match=message) as caught:
        fm.boundaries(System(), values)
    assert "\n" not in str(caught.value)


def test_one_value_cannot_hold_two_ends(base):
    with pytest.raises(InputError, match=r"grid.r.num must be >= 2 to hold both 0.1 and 1; got 1"):
        load_config(base, ["grid.r={ start = 0.1, stop = 1.0, num = 1 }"])
    assert load_config(base, ["grid.r={ start = 0.1, stop = 0.1, num = 1 }"]).r.tolist() == [0.1]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((1,), "configuration must be the path of a TOML file; got 1"),
        (("a\0b",), "cannot read configuration .*"),
        (("x.toml", "grid.r=1"), "overrides must be a list"),
        (("x.toml", [1]), "overrides must be text"),
    ],
)
def test_bad_arguments(base, arguments, message):
    path, *rest = arguments
    with pytest.raises(InputError, match=message):
        load_config(base if path == "x.toml" else path, *rest)


@pytest.mark.parametrize("path", sorted((ROOT / "configs").glob("*.toml")), ids=lambda path: path.stem)
def test_every_configuration_loads(path):
    """Each file of configs/ is valid, and its curves have no hole but those that are limits."""
    config = fm.load_config(path)
    ds = fm.boundaries(config.system, config.r, config.mu)
    assert not np.any(np.isnan(ds.beta_lim))
    assert not np.any(np.isnan(ds.beta_stick))
    assert np.all(ds.beta_lim >= 0.0)
