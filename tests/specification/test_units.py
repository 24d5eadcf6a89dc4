"""Units: what a careful person expects of hertz and newtons, to the bit; other texts are refused."""

import math
import re
import tomllib
from fractions import Fraction

import mpmath
import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from refusals import refusal

import frictionmap as fm
from frictionmap import InputError, load_config
from frictionmap.command_line.cli import main
from frictionmap.files.reading import read
from frictionmap.identify.rigs.configuration import load_rig
from frictionmap.units.axes import Ladder, typed
from frictionmap.units.quantities import quantity
from frictionmap.units.scales import NO_SCALES, scales_of
from frictionmap.units.table import PI, UNITS, units_of

MIXED = fm.Units(natural_frequency="4.2 Hz", load="12.5 N", stiffness="3 N/mm")
BASE = fm.System(contact="joined-base-wall")

CONFIG = """\
[system]
contact = "joined-base-wall"
[units]
natural_frequency = "4.2 Hz"
load = "12.5 N"
stiffness = "3 N/mm"
[grid]
r = { start = "1 Hz", stop = "600 rpm", step = "0.5 Hz" }
beta = { values = ["1 N", "2.5 N"] }
"""


@pytest.fixture
def rig(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text(CONFIG, encoding="utf-8")
    return path


def hertz(text):
    return quantity(text, "f", "frequency").value


def assert_same_numbers(one, other):
    """The same variables with the same bits."""
    assert set(one.variables) == set(other.variables)
    for name in one.variables:
        np.testing.assert_array_equal(one[name].values, other[name].values, strict=True)


# The table


def test_sixty_turns_a_minute_are_one_hertz_are_two_pi_radian_a_second():
    assert hertz("60 rpm") == hertz("1 Hz") == hertz("0.001 kHz") == 1
    assert float(hertz("6.28318530717958647692528676655900576839 rad/s")) == 1.0
    assert float(hertz(f"{2 * math.pi!r} rad/s")) == math.nextafter(1.0, 0.0)  # 2 pi itself is rounded
    assert float(hertz("60 rpm") / hertz("1 rad/s")) == 2 * math.pi


def test_pi_has_fifty_digits():
    with mpmath.workdps(60):
        assert abs(mpmath.mpf(PI.numerator) / PI.denominator - mpmath.pi) < mpmath.mpf(10) ** -49


@pytest.mark.parametrize(
    ("text", "kind", "size"),
    [
        ("1 lbf", "force", "4.4482216152605"),  # 0.45359237 kg x 9.80665 m/s^2, NIST SP 811 B.8
        ("1 in", "length", "0.0254"),
        ("1 g", "acceleration", "9.80665"),
        ("1 lb", "mass", "0.45359237"),
        ("3 N/mm", "stiffness", "3000"),
        ("3 kN/m", "stiffness", "3000"),
        ("1 kN/mm", "stiffness", "1e6"),
        ("12.5 kN", "force", "12500"),
        ("12.5 mN", "force", "0.0125"),
        ("250 um", "length", "0.00025"),
        ("250 \u00b5m", "length", "0.00025"),
        ("250 \u03bcm", "length", "0.00025"),
        ("9.80665 m/s\u00b2", "acceleration", "9.80665"),
        ("1e-3 N", "force", "0.001"),
        ("+.5 N", "force", "0.5"),
        ("5. N", "force", "5"),
        ("12.5N", "force", "12.5"),
    ],
)
def test_sizes(text, kind, size):
    assert quantity(text, "it", kind).value == Fraction(size)


def test_a_pound_force_an_inch():
    assert float(quantity("1 lbf/in", "k", "stiffness").value) == pytest.approx(175.126835246476, rel=1e-14)


KINDS = ("frequency", "force", "length", "mass", "stiffness", "acceleration")


@pytest.mark.parametrize("unit", [unit for kind in KINDS for unit in units_of(kind)])
@given(number=st.floats(1e-300, 1e300))
def test_every_unit_there_and_back(unit, number):
    found = quantity(f"{number!r} {unit}", "it", UNITS[unit].measures)
    assert found.text == f"{number!r} {unit}"
    assert float(found.value / UNITS[unit].size) == number


@given(r=st.floats(1e-6, 1e6), one=st.decimals("0.001", 10000, places=3))
def test_a_ratio_is_typed_as_a_frequency_with_the_fewest_digits(r, one):
    one = Fraction(one)
    found = float(typed(np.array([r]), one)[0])
    assert abs(Fraction(found) / one - Fraction(r)) <= 2 * Fraction(math.ulp(r))


@given(number=st.decimals("0.001", 10000, places=6), one=st.decimals("0.001", 10000, places=3))
def test_typed_numbers_are_shown_as_typed(number, one):
    r = float(Fraction(number) / Fraction(one))
    assert typed(np.array([r]), Fraction(one))[0] == float(number)


# Text that is no quantity


WRONG = {
    "12,5 N": "use a decimal point, not a comma",
    "1.012,5 N": "use a decimal point, not a comma",
    "12.5": "it has no unit",
    "1e5": "it has no unit",
    "12.5 n": "unknown unit n (did you mean N?)",
    "12.5 kn": "unknown unit kn (did you mean kN?)",
    "12.5 Newton": "unknown unit Newton",
    "12.5 MN": "unknown unit MN (did you mean mN?)",
    "12.5 Hz": "Hz is a unit of frequency",
    "12.5 kg": "kg is a unit of mass",
    "nan N": "it is not finite",
    "inf N": "it is not finite",
    "-inf": "it is not finite",
    "1e400 N": "it exceeds the range of double precision",
    "1e-400 N": "it exceeds the range of double precision",
    "1e999999999999 N": "it exceeds the range of double precision",
    "N": "expected one number, one space and one unit",
    "": "expected one number, one space and one unit",
    "12.5  N": "expected one number, one space and one unit",
    " 12.5 N": "expected one number, one space and one unit",
    "12.5 N ": "expected one number, one space and one unit",
    "12.5 N\n": "expected one number, one space and one unit",
    "12.5 N m": "N m is a unit of plate stiffness",
    "12.5 N ms": "expected one number, one space and one unit",
    "1 000 N": "expected one number, one space and one unit",
    "1_000 N": "expected one number, one space and one unit",
    "1.2.3 N": "expected one number, one space and one unit",
    "0x10 N": "x10 N",
    "\uff11 N": "expected one number, one space and one unit",
}


@pytest.mark.parametrize("text", WRONG)
def test_text_that_is_no_force(text):
    with pytest.raises(InputError) as caught:
        fm.Units(load=text)
    message = str(caught.value)
    assert "\n" not in message
    assert message.startswith(
        "load must be a number with a unit of force (N, mN, kN, lbf), such as '12.5 N'; got "
    )
    assert repr(text) in message
    assert text == "0x10 N" or message.endswith(WRONG[text])


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"load": 12.5}, "such as '12.5 N'; got 12.5: it has no unit"),
        ({"load": True}, "such as '12.5 N'; got True"),
        ({"load": ["1 N"]}, "such as '12.5 N'; got ['1 N']"),
        ({"natural_frequency": "4.2 hz"}, "unknown unit hz (did you mean Hz?)"),
        ({"load": "1 N", "base_amplitude": "1 mm"}, "cannot use base_amplitude with load"),
        (
            {"stiffness": "1 N/m", "mass": "1 kg", "natural_frequency": "1 Hz"},
            "cannot use mass with natural_frequency and stiffness: each follows from the two others",
        ),
        ({"mass": "1 kg"}, "cannot use mass alone: it gives k1 = m1 omega_1^2 with natural_frequency"),
        ({"mass": "5 g", "natural_frequency": "1 Hz"}, "g is a unit of acceleration"),
        ({"base_acceleration": "0.5 g"}, "cannot use base_acceleration without acceleration_frequency"),
        ({"acceleration_frequency": "5 Hz"}, "cannot use acceleration_frequency without base_acceleration"),
    ],
)  # fmt: skip
def test_units_that_make_no_sense(given, message):
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        fm.Units(**given)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("units", "message"),
    [
        ({"load": "1e308 kN"}, "beta = 1 mean 1e-100 to 1e+100 N; got 1.00e+311 N from load 1e308 kN"),
        ({"natural_frequency": "1e307 kHz"}, "r = 1 mean 1e-100 to 1e+100 Hz; got 1.00e+310 Hz from"),
        (
            {"load": "1e90 N", "stiffness": "1e-90 N/m"},
            "an amplitude of 1 mean 1e-100 to 1e+100 m; got 1.00e+180 m from load 1e90 N, stiffness",
        ),
        (
            {"load": "1e-90 N", "stiffness": "1e90 N/m"},
            "an amplitude of 1 mean 1e-100 to 1e+100 m; got 1e-180 m",
        ),
        (
            {"load": "1e-80 N", "stiffness": "1 N/m"},
            "a work of 1 mean 1e-100 to 1e+100 J; got 1e-160 J from",
        ),
    ],
)
def test_units_that_make_too_much_or_too_little_of_1(units, message):
    """Each number by itself may be well; what follows from them would overflow or vanish."""
    with pytest.raises(InputError, match=f"^units must make {re.escape(message)}"):
        fm.boundaries(fm.System(), [1.0], units=fm.Units(**units))
    fm.boundaries(fm.System(), [1.0], units=fm.Units(load="1e50 N", stiffness="1 N/m"))


def test_units_do_not_go_with_an_axis_that_changes_them():
    system = fm.System(matrices={"M": [[2.0]], "K": [[8.0]]}, frequency_scale=2.0)
    with pytest.raises(InputError, match=r"cannot use units with axes.*: stiffness_scale changes"):
        fm.sweep(system, [1.0], [1.0], axes={"stiffness_scale": [1.0, 2.0]}, units=MIXED)


# What follows from what is given


@pytest.mark.parametrize(
    ("units", "system", "force", "length"),
    [
        ({"load": "12.5 N", "stiffness": "3 N/mm"}, {}, 12.5, 12.5 / 3000),
        ({"load": "12.5 N"}, {}, 12.5, None),
        ({"stiffness": "3 N/mm"}, {}, None, None),
        ({"base_amplitude": "0.5 mm"}, {"excitation": "base"}, None, 0.0005),
        ({"base_amplitude": "0.5 mm", "stiffness": "3 N/mm"}, {"excitation": "base"}, 1.5, 0.0005),
        ({"load": "1.5 N", "stiffness": "3 N/mm"}, {"contact": "joined-base-wall"}, 1.5, 0.0005),
        (
            {"base_acceleration": "0.5 g", "acceleration_frequency": "5 Hz", "stiffness": "3 N/mm"},
            {"excitation": "base"},
            3000 * 0.5 * 9.80665 / (10 * math.pi) ** 2,
            0.5 * 9.80665 / (10 * math.pi) ** 2,
        ),
        (
            {"load": "2 N", "mass": "2 kg", "natural_frequency": "3 Hz"},
            {"mass_ratios": [1.0, 2.0], "stiffness_ratios": [1.0, 1.0]},
            2.0,
            2.0 / (2.0 * (6.0 * math.pi) ** 2),
        ),
        (
            {"load": "2 N", "stiffness": "model"},
            {"matrices": {"M": [[2.0]], "K": [[8.0]]}, "stiffness_scale": 8.0},
            2.0,
            0.25,
        ),
    ],
)
def test_force_and_length_that_follow(units, system, force, length):
    scales = scales_of(fm.Units(**units), fm.System(**system))
    assert scales.of("force") == (None if force is None else pytest.approx(force, rel=1e-15))
    assert scales.of("length") == (None if length is None else pytest.approx(length, rel=1e-15))


def test_the_frequency_of_a_model_in_si_units():
    """k = 8 N/m, m = 2 kg: 2 rad/s; with a frequency_scale that is what r = 1 is."""
    matrices = {"M": [[2.0]], "K": [[8.0]]}
    units = fm.Units(natural_frequency="model")
    for scale, expected in ((None, 1.0 / math.pi), (5.0, 2.5 / math.pi)):
        system = fm.System(matrices=matrices, frequency_scale=scale)
        found = scales_of(units, system).of("frequency")
        assert found == pytest.approx(expected, rel=1e-15)
        ds = fm.boundaries(system, ["1 Hz"], units=units)
        assert ds.r.item() == pytest.approx(1.0 / expected, rel=1e-15)


def test_an_equation_of_motion_in_newtons():
    """One mass below resonance, no friction: k1 x_max = P/(1 - r^2) in SI units, and work in joules."""
    units = fm.Units(natural_frequency="4 Hz", load="12 N", stiffness="3 N/mm")
    ds = fm.curves(fm.System(), ["2 Hz"], ["0 N"], units=units, quantities=["amplitude", "energy"])
    assert ds.amplitude_m.item() == pytest.approx(12 / 3000 / 0.75, rel=1e-12)
    ds = fm.curves(fm.System(), ["2 Hz"], ["3 N"], units=units, quantities=["amplitude", "energy"])
    work = 4 * 3 * ds.contact_amplitude_m.item()  # Coulomb: 4 F X a cycle
    assert ds.work_friction_J.item() == pytest.approx(work, rel=1e-9)


# Axes


def test_ratios_are_exact(rig):
    config = load_config(rig)
    assert config.units == MIXED
    assert config.r.tolist() == [float(Fraction(k, 2) / Fraction("4.2")) for k in range(2, 21)]
    assert config.beta.tolist() == [0.08, 0.2]
    assert load_config(rig, ["grid.r=4.2 Hz"]).r.tolist() == [1.0]
    assert load_config(rig, ['grid.r=["2.1 Hz", "252 rpm"]']).r.tolist() == [0.5, 1.0]
    assert load_config(rig, ["grid.r.step=30 rpm"]).r.tolist() == config.r.tolist()


@pytest.mark.parametrize(
    ("axis", "expected"),
    [
        ('{ start = "0 Hz", stop = "4.2 Hz", num = 5 }', [0.0, 0.25, 0.5, 0.75, 1.0]),
        ('{ start = "2.1 Hz", stop = "2.1 Hz", num = 1 }', [0.5]),
        (
            '{ start = "2.1 Hz", stop = "4.2 Hz", step = "60 rpm" }',
            [0.5, float(Fraction(31, 42)), float(Fraction(41, 42)), 1.0],
        ),
        ('{ values = ["2.1 Hz"] }', [0.5]),
        ("[0.5, 1]", [0.5, 1.0]),
        ("{ start = 0.5, stop = 1, num = 2 }", [0.5, 1.0]),
    ],
)
def test_ways_to_give_an_axis(rig, axis, expected):
    assert load_config(rig, [f"grid.r={axis}"]).r.tolist() == expected


@given(
    start=st.fractions(0, 100, max_denominator=1000),
    step=st.fractions("0.001", 10, max_denominator=1000),
    count=st.integers(1, 40),
)
def test_a_range_is_rounded_once(start, step, count):
    last = start + (count - 1) * step
    values = Ladder(start, step, last, count).values()
    assert values.tolist() == [float(start + k * step) for k in range(count)]


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("grid.r.step=0.5", "grid.r.step must be a number with a unit of frequency"),
        ("grid.r.start=1", "grid.r.start must be a number with a unit of frequency"),
        ("grid.r.step=0.5 hz", "(did you mean Hz?)"),
        ("grid.r.step=0 Hz", "grid.r.step must be > 0; got '0 Hz'"),
        ("grid.r.stop=0.5 Hz", "grid.r.stop must be >= start (1 Hz); got '0.5 Hz'"),
        ("grid.r.step=1e-12 Hz", "grid.r.step must leave at most 1e+09 values; got '1e-12 Hz'"),
        ("grid.r.num=2.5", "grid.r.num must be a whole number; got 2.5"),
        ("grid.r.num=1", "grid.r.num must be >= 2 to hold both 1 Hz and 600 rpm; got 1"),
        ('grid.r=["1 Hz", 2]', "grid.r[1] must be a number with a unit of frequency"),
        ("grid.r=1e300 kHz", "grid.r must be <= 1e+08"),
        ("grid.r.stop=1e308 kHz", "grid.r must be finite"),
        ('units={ load = "12.5 N" }', "cannot convert grid.r ="),
        ("units.load=12.5", "got 12.5: it has no unit"),
        ("units=3", "units must be a table [units]; got 3"),
        ("units.load=1e308 kN", "units must make beta = 1 mean 1e-100 to 1e+100 N"),
    ],
)
def test_the_command_refuses_in_one_line(rig, capsys, override, message):
    assert message in refusal(capsys, "map", rig, "--set", override)


def test_a_grid_with_units_needs_them(rig, tmp_path):
    path = tmp_path / "without.toml"
    path.write_text(
        CONFIG.replace("[units]", "[solver]").split("[solver]")[0] + "[grid]" + CONFIG.split("[grid]")[1]
    )
    with pytest.raises(
        InputError,
        match=r"^cannot convert grid\.r = .* and grid\.beta = .*; give .*natural_frequency .* and .*load ",
    ):
        load_config(path)
    with pytest.raises(
        InputError, match=r"^cannot convert r = '4 Hz' to ratios: .*; give units\.natural_frequency \(or .*"
    ):
        fm.boundaries(fm.System(), "4 Hz")


# Datasets


@pytest.fixture(scope="module")
def mapped():
    return fm.sweep(BASE, ["1.05 Hz", "4.2 Hz"], ["1 N", "2.5 N"], [1.0, 1.5], units=MIXED)


def test_without_units_nothing_changes(mapped):
    """The same bits in the same variables, and none beside them."""
    plain = fm.sweep(BASE, [0.25, 1.0], [0.08, 0.2], [1.0, 1.5])
    assert not [name for name in plain.variables if "units" in plain[name].attrs and plain[name].units != "1"]
    assert not [name for name in plain.attrs if name.endswith(("_Hz", "_N", "_m"))]
    own = mapped[list(plain.data_vars)].drop_vars(["frequency", "friction_force"])
    assert_same_numbers(own, plain)


def test_coordinates_and_variables_of_a_map_in_units(mapped):
    assert mapped.frequency.values.tolist() == [1.05, 4.2]
    assert mapped.friction_force.values.tolist() == [1.0, 2.5]
    assert (mapped.frequency.dims, mapped.frequency.units) == (("r",), "Hz")
    assert (mapped.friction_force.dims, mapped.friction_force.units) == (("beta",), "N")
    assert set(mapped.coords) == {"mu", "r", "beta", "frequency", "friction_force"}
    length = 12.5 / 3000
    for name, unit, one in (
        ("contact_amplitude", "m", length), ("beta_lim", "N", 12.5), ("beta_stick", "N", 12.5)
    ):  # fmt: skip
        beside = mapped[f"{name}_{unit}"]
        assert beside.units == unit
        assert beside.dims == mapped[name].dims
        np.testing.assert_allclose(beside, mapped[name] * one, rtol=1e-15)
    assert mapped.attrs["frequency_scale_Hz"] == 4.2
    assert mapped.attrs["length_scale_m"] == length


def test_motion_in_time():
    ds = fm.response(BASE, "2.1 Hz", "2.5 N", units=MIXED)
    assert (ds.r.item(), ds.beta.item(), ds.frequency.item(), ds.friction_force.item()) == (
        0.5,
        0.2,
        2.1,
        2.5,
    )
    np.testing.assert_allclose(ds.time[-1] * 2.1, ds.period, rtol=1e-15)
    inside = slice(1, -1)  # where the acceleration jumps a slope of differences is off by its step
    slope = np.gradient(ds.x_m.values[0], ds.time.values)[inside]
    np.testing.assert_allclose(ds.v_m_s.values[0, inside], slope, atol=5e-4 * float(ds.v_m_s.max()))
    assert np.abs(ds.friction_N).max() == pytest.approx(2.5, rel=1e-15)
    assert ds.event_tau_s.units == "s"
    plain = fm.response(BASE, 0.5, 0.2)
    assert_same_numbers(ds[list(plain.data_vars)].drop_vars(["frequency", "friction_force", "time"]), plain)


def test_a_configuration_in_a_result_gives_it_again(mapped, tmp_path):
    path = tmp_path / "again.toml"
    path.write_text(mapped.attrs["config"], encoding="utf-8")
    config = load_config(path)
    assert config.units == MIXED
    again = fm.sweep(
        config.system, config.r, config.beta, config.mu, solver=config.solver, units=config.units
    )
    assert again.attrs["config"] == mapped.attrs["config"]
    xr.testing.assert_identical(again.assign_attrs(history=""), mapped.assign_attrs(history=""))


def test_the_command_writes_what_the_function_returns(rig, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["map", str(rig), "--quiet", "-o", "map.nc"]) == 0
    config = load_config(rig)
    ds = fm.sweep(BASE, config.r, config.beta, units=MIXED)
    stored = read(tmp_path / "map.nc")
    assert_same_numbers(stored, ds)
    assert tomllib.loads(stored.attrs["config"]) == tomllib.loads(CONFIG)
    with xr.open_dataset(tmp_path / "map.nc") as opened:
        assert {"frequency", "friction_force"} < set(opened.coords)
        assert opened.frequency.values.tolist() == [k / 2 for k in range(2, 21)]
    assert main(["info", "map.nc"]) == 0
    assert "r = 1 is 4.2 Hz, beta = 1 is 12.5 N, an amplitude of 1 is 4.16667 mm" in capsys.readouterr().out
    assert main(["export", "map.nc", "--quiet", "-o", "map.csv"]) == 0
    head = (tmp_path / "map.csv").read_text().splitlines()[0].split(",")
    assert {"frequency_Hz", "friction_force_N", "contact_amplitude_m", "beta_lim_N"} < set(head)
    assert not {"contact_amplitude", "beta_lim"} & set(head)


def test_a_response_is_asked_for_in_hertz(rig, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    asked = ["response", str(rig), "--r", "2.1 Hz", "--beta", "2.5 N"]
    assert main([*asked, "--quiet"]) == 0
    ds = read(tmp_path / "rig-response.nc")
    assert (ds.r.item(), ds.frequency.item(), ds.friction_force.item()) == (0.5, 2.1, 2.5)
    assert main(["info", "rig-response.nc"]) == 0
    assert f"amplitude {1e3 * ds.contact_amplitude_m.item():.6g} mm" in capsys.readouterr().out
    for r, message in (
        ("2,1 Hz", "not a comma"),
        ("2.1 N", "N is a unit of force"),
        ("4 x", "unknown unit x"),
    ):
        assert message in refusal(capsys, "response", rig, "--r", r, "--beta", "1", "-o", "no.nc")


def test_a_store_has_the_axes_and_is_read_with_lengths(rig, tmp_path, capsys):
    pytest.importorskip("zarr")
    path = tmp_path / "map.zarr"
    assert main(["map", str(rig), "--quiet", "-o", str(path)]) == 0
    with xr.open_zarr(path, consolidated=False) as ds:
        assert {"frequency", "friction_force"} < set(ds.coords)
    config = load_config(rig)
    whole = fm.sweep(BASE, config.r, config.beta, units=MIXED, outputs=(*config.solver.outputs, "status"))
    assert_same_numbers(read(path)[list(whole.data_vars)], whole)
    message = refusal(
        capsys, "map", rig, "-o", path, "--set", "units.load=13 N", "--set", "grid.beta=[0.08, 0.2]"
    )
    assert "its configuration differs, units.load: '12.5 N' there, '13 N' now" in message


def test_shares_keep_the_axes():
    axes = {"damping_ratios": [0.0, 0.1]}
    ds = fm.shares(fm.sweep(BASE, ["2.1 Hz"], ["1 N"], axes=axes, units=MIXED), "damping_ratios")
    assert (ds.frequency.values.tolist(), ds.friction_force.values.tolist()) == ([2.1], [1.0])


# Quantities of other packages


def test_quantities_of_pint():
    pint = pytest.importorskip("pint")
    ureg = pint.UnitRegistry()
    for frequency, text in (
        (60 * ureg.rpm, "60.0 rpm"),
        (1 * ureg.Hz, "1.0 Hz"),
        (2 * ureg.kHz, "2000.0 Hz"),
        (3 * ureg.rad / ureg.s, "3.0 rad/s"),
    ):
        assert fm.Units(natural_frequency=frequency).natural_frequency == text
    one = fm.Units(natural_frequency=1 * ureg.turn / ureg.s).value("natural_frequency")
    assert abs(float(one) - 1.0) <= math.ulp(1.0)
    units = fm.Units(natural_frequency=4.2 * ureg.Hz, load=12.5 * ureg.N, stiffness=3 * ureg.N / ureg.mm)
    ds = fm.boundaries(fm.System(), np.array([2.1, 4.2]) * ureg.Hz, units=units)
    assert ds.r.values.tolist() == [0.5, 1.0]
    assert fm.boundaries(fm.System(), [2.1 * ureg.Hz, "252 rpm"], units=units).r.values.tolist() == [0.5, 1.0]
    with pytest.raises(InputError, match="1/s is neither Hz nor rad/s"):
        fm.Units(natural_frequency=1 / ureg.s)
    with pytest.raises(InputError, match="newton is not one of them"):
        fm.Units(natural_frequency=1 * ureg.N)
    with pytest.raises(InputError, match=r"cannot convert r = .*; give units\.natural_frequency"):
        fm.boundaries(fm.System(), np.array([2.1]) * ureg.Hz)


def test_quantities_of_astropy():
    u = pytest.importorskip("astropy.units")
    assert fm.Units(natural_frequency=2 * u.kHz).natural_frequency == "2000.0 Hz"
    assert fm.Units(natural_frequency=3 * u.rad / u.s).natural_frequency == "3.0 rad/s"
    assert float(
        fm.Units(natural_frequency=60 * u.cycle / u.min).value("natural_frequency")
    ) == pytest.approx(1.0, rel=3e-16)
    assert fm.Units(load=1 * u.kN, stiffness=3 * u.N / u.mm).given == {
        "load": "1000.0 N", "stiffness": "3000.0 N/m"
    }  # fmt: skip
    units = fm.Units(natural_frequency=4.2 * u.Hz)
    assert fm.boundaries(fm.System(), [2.1, 4.2] * u.Hz, units=units).r.values.tolist() == [0.5, 1.0]
    with pytest.raises(InputError, match=r"cannot convert r = .*; give units\.natural_frequency"):
        fm.boundaries(fm.System(), [2.1, 4.2] * u.Hz)  # they would be taken for ratios
    with pytest.raises(InputError, match="1/s is neither Hz nor rad/s"):
        fm.Units(natural_frequency=1 / u.s)


def test_quantities_of_unyt():
    unyt = pytest.importorskip("unyt")
    assert fm.Units(natural_frequency=unyt.unyt_quantity(60, "rpm")).natural_frequency == "60.0 rpm"
    assert fm.Units(natural_frequency=unyt.unyt_quantity(2, "kHz")).natural_frequency == "2000.0 Hz"
    assert fm.Units(natural_frequency=unyt.unyt_quantity(3, "rad/s")).natural_frequency == "3.0 rad/s"
    assert fm.Units(base_amplitude=unyt.unyt_quantity(2, "inch")).value("base_amplitude") == Fraction(
        "0.0508"
    )


def test_an_axis_in_hertz_of_another_dataset(mapped):
    """Numbers that say what their unit is are not taken for ratios."""
    assert fm.boundaries(BASE, mapped.frequency, units=MIXED).r.values.tolist() == mapped.r.values.tolist()
    assert fm.boundaries(BASE, mapped.r, units=MIXED).r.values.tolist() == mapped.r.values.tolist()
    with pytest.raises(InputError, match=r"cannot convert r = .*; give units\.natural_frequency"):
        fm.boundaries(BASE, mapped.frequency)
    turning = xr.DataArray([2 * math.pi * 4.2], attrs={"units": "rad s-1"})  # as CF writes it
    assert fm.boundaries(BASE, turning, units=MIXED).r.item() == pytest.approx(1.0, rel=1e-15)
    assert fm.boundaries(BASE, mapped.r.assign_attrs(units="")).r.values.tolist() == mapped.r.values.tolist()


@pytest.mark.parametrize("units", [None, MIXED])
@pytest.mark.parametrize(
    ("said", "hint"),
    [
        ("s-1", "unknown unit s-1"),
        ("1/min", "unknown unit 1/min"),
        ("Rpm", "unknown unit Rpm (did you mean rpm?)"),
        ("rad s^-1", "(did you mean rad/s?)"),
        ("N", "N is a unit of force"),
    ],
)
def test_an_axis_in_another_unit_is_not_taken_for_ratios(said, hint, units):
    with pytest.raises(InputError, match=re.escape(hint)) as caught:
        fm.boundaries(BASE, xr.DataArray([1.0, 2.0], attrs={"units": said}), units=units)
    assert str(caught.value).startswith("r")
    assert "\n" not in str(caught.value)


def test_no_units_are_no_scales():
    assert scales_of(None, BASE) is NO_SCALES
    with pytest.raises(InputError, match=r"units must be a frictionmap\.Units; got '4 Hz'"):
        fm.boundaries(BASE, [1.0], units="4 Hz")


# Measured data


@pytest.mark.parametrize(
    ("f_n", "expected"), [("3.0", 3.0), ('"180 rpm"', 3.0), ('"3 Hz"', 3.0), ('"0.003 kHz"', 3.0)]
)
def test_known_numbers_of_a_rig_may_have_units(tmp_path, f_n, expected):
    path = tmp_path / "rig.toml"
    head = '[data]\nkind = "free-decay"\nfile = "decay.csv"\n[known]\n'
    path.write_text(head + f'f_n = {f_n}\nx_F = "0.1 in"\nstiffness = "1.2 N/mm"\n')
    assert load_rig(path).known == {"f_n": expected, "x_F": 2.54, "stiffness": 1200.0}
    for wrong, message in (('f_n = "3 mm"', "known.f_n must be a number with a unit of frequency"),
                           ('x_F = "1e308 m"', "known.x_F must be finite in mm; got '1e308 m'"),
                           ('zeta = "3 Hz"', "known.zeta must be a number; got '3 Hz'")):  # fmt: skip
        path.write_text(head + wrong)
        with pytest.raises(InputError, match=re.escape(message)):
            load_rig(path)


# Pictures


def second_axes(ax):
    """Names and limits of the second axes of a panel, drawn."""
    ax.figure.draw_without_rendering()
    found = {}
    for child in ax.child_axes:
        one = child.xaxis if child.get_xlabel() else child.yaxis
        found[one.get_label_text()] = one.get_view_interval()
    return found


def assert_beside(found, expected):
    assert set(found) == set(expected)
    for name, limits in expected.items():
        np.testing.assert_allclose(found[name], limits, rtol=1e-12)


def test_maps_have_axes_in_hertz_and_newtons(mapped):
    for draw in (fm.plot_regimes, fm.plot_boundaries):
        for ax in draw(mapped):
            (low, high), (bottom, top) = ax.get_xlim(), ax.get_ylim()
            assert_beside(
                second_axes(ax),
                {
                    "frequency [Hz]": (4.2 * low, 4.2 * high),
                    "friction force [N]": (12.5 * bottom, 12.5 * top),
                },
            )
    plain = fm.sweep(BASE, [0.25, 1.0], [0.08, 0.2])
    assert not [child for ax in fm.plot_regimes(plain) for child in ax.child_axes]


def test_logarithmic_axes_have_logarithmic_second_axes():
    r = np.geomspace(0.1, 10.0, 9)
    (ax,) = fm.plot_boundaries(fm.boundaries(BASE, r, units=MIXED))
    assert ax.get_xscale() == "log"
    assert_beside(
        {name: limits for name, limits in second_axes(ax).items() if "Hz" in name},
        {"frequency [Hz]": (0.42, 42.0)},
    )


def test_curves_and_motions_have_axes_in_millimetres_and_seconds():
    ds = fm.curves(BASE, ["1 Hz", "2 Hz"], ["1 N"], units=MIXED, quantities=["amplitude", "energy"])
    amplitude = fm.plot_curves(ds)[0]
    top = amplitude.get_ylim()[1]
    assert_beside(
        second_axes(amplitude), {"frequency [Hz]": (1.0, 2.0), "amplitude [mm]": (0.0, top * 12.5 / 3.0)}
    )
    works = {name for ax in fm.plot_curves(ds, "energy") for name in second_axes(ax)}
    assert works == {
        "frequency [Hz]",
        "work of the load [mJ]",
        "work of friction [mJ]",
        "sliding distance [mm]",
    }
    ds = fm.response(BASE, "2.1 Hz", "2.5 N", units=MIXED, points=50)
    load, contact, *_, friction = fm.plot_response(ds)
    assert_beside(second_axes(load), {"time [ms]": (0.0, 1000.0 / 2.1)})
    assert "r = 0.5 (2.1 Hz), β = 0.2 (2.5 N)" in load.figure.get_suptitle()
    assert list(second_axes(contact)) == ["$z$ [mm]"]
    assert_beside(second_axes(friction), {"friction [N]": 12.5 * np.array(friction.get_ylim())})
    portrait, loop, _ = fm.plot_orbit(ds)
    assert set(second_axes(portrait)) == {"displacement [mm]"}
    assert set(second_axes(loop)) == {"motion in the contact [mm]", "friction [N]"}


def test_mass_and_stiffness_give_the_natural_frequency():
    """1 kg on 5 N/m: sqrt(5) rad/s, which is irrational; 40 digits from its square."""
    units = fm.Units(mass="1 kg", stiffness="5 N/m", load="10 N")
    scales = scales_of(units, fm.System())
    omega = scales.frequency * 2 * PI
    assert abs(omega**2 / 5 - 1) < Fraction(1, 10**40)
    assert scales.length == 2
    ds = fm.sweep(fm.System(), r=["2.5 rad/s"], beta=["3.92 N"], units=units)
    assert ds.r.values[0] == 2.5 / 5**0.5
    # by own integration of x" + 5 x + 3.92 sgn(x') = 10 cos(2.5 t)
    assert float(ds.contact_amplitude_m[0, 0, 0]) == pytest.approx(6.815165, abs=1e-6)


def test_a_rational_frequency_is_exact():
    """4 kg on 9 N/m: 3/2 rad/s."""
    scales = scales_of(fm.Units(mass="4 kg", stiffness="9 N/m"), fm.System())
    assert scales.frequency * 2 * PI == Fraction(3, 2)
