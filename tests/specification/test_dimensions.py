"""Keys with a dimension: every one takes a text with its unit, and no other number has one."""

import math
import re

import numpy as np
import pint
import pytest

import frictionmap as fm
from frictionmap import InputError, load_config
from frictionmap.design.configuration import load_design
from frictionmap.files.keys import KEYS
from frictionmap.units.axes import KINDS
from frictionmap.units.dimensions import DIMENSIONS, OF_DESIGN, OF_MATRICES
from frictionmap.units.quantities import NUMBER
from frictionmap.units.scales import UNIT_KINDS
from frictionmap.units.structures import STRUCTURES

#: k1 = 500 N/mm, m1 = 40 kg, P = 100 N.
UNITS = '[units]\nstiffness = "500 N/mm"\nmass = "40 kg"\nload = "100 N"\n'
OMEGA = math.sqrt(500e3 / 40.0)
MODEL = '[units]\nnatural_frequency = "model"\nstiffness = "model"\nload = "100 N"\n'
MATRICES = "matrices = { M = [[40.0]], K = [[500e3]] }\n"
TWO = 'masses = ["40 kg", "10 kg"]\nsprings = ["5e5 N/m", "1 kN/mm"]\n'
ONE = "[grid]\nr = 1.0\nbeta = 1.0\n"

#: Text of a configuration with the key in units, what reads the number from it, and its value by hand.
CASES = {
    "masses": (TWO + ONE, "mass_ratios", (1, 0.25)),
    "springs": (TWO + ONE, "stiffness_ratios", (1, 2)),
    "dampers": ('dampers = ["300 N s/m"]\n' + UNITS + ONE, "dampers", (300 / math.sqrt(500e3 * 40),)),
    "load": ('load = ["50 N"]\n' + UNITS + ONE, "load", (0.5,)),
    "load_offset": ('load_offset = ["-0.05 kN"]\n' + UNITS + ONE, "load_offset", [-0.5]),
    "wall_velocity": ('wall_velocity = "0.2 m/s"\n' + UNITS + ONE, "wall_speed", 0.2 * 500e3 / (100 * OMEGA)),
    "wall_speed": ('wall_speed = "0.2 m/s"\n' + UNITS + ONE, "wall_speed", 0.2 * 500e3 / (100 * OMEGA)),
    "contact_stiffness": ('contact_stiffness = "800 N/mm"\n' + UNITS + ONE, "contact_stiffness", 1.6),
    "frequency_scale": (MATRICES + 'frequency_scale = "3 Hz"\n' + MODEL + ONE, "omega_1", 6 * math.pi),
    "stiffness_scale": (MATRICES + 'stiffness_scale = "1 N/mm"\n' + MODEL + ONE, "stiffness_scale", 1000.0),
    "rayleigh[1]": (MATRICES + 'rayleigh = ["0.1 1/s", "2 us"]\n' + MODEL + ONE, "rayleigh", (0.1, 2e-6)),
    "rayleigh[2]": (MATRICES + 'rayleigh = ["0.1 1/s", "2 ms"]\n' + MODEL + ONE, "rayleigh", (0.1, 2e-3)),
}  # fmt: skip


def first_harmonic(system):
    return system.contact_system.forces[1][0]


#: The same for numbers in tables of [system].
IN_TABLES = {
    "load_harmonics[].amplitude": (
        'load_harmonics = [{ n = 1, mass = 1, amplitude = "80 N" }]\n' + UNITS, first_harmonic, 0.8),
    "load_harmonics[].re": (
        'load_harmonics = [{ n = 1, mass = 1, re = "80 N" }]\n' + UNITS, first_harmonic, 0.8),
    "load_harmonics[].im": (
        'load_harmonics = [{ n = 1, mass = 1, im = "80 N" }]\n' + UNITS, first_harmonic, 0.8j),
    "contacts[].force": (
        'contacts = [{ force = "50 N" }]\n' + UNITS, lambda s: s.contacts[0].force, 0.5),
    "contacts[].law.speed": (
        'contacts = [{ law = { speed = ["0 m/s", "0.2 m/s"], factor = [1, 0.8] } }]\n' + UNITS,
        lambda s: list(s.contacts[0].law.speed), [0.0, 0.2 * 500e3 / (100 * OMEGA)]),
    "contacts[].wall_velocity": (
        'contacts = [{ wall_velocity = "200 mm/s" }]\n' + UNITS, lambda s: s.contacts[0].wall_speed,
        0.2 * 500e3 / (100 * OMEGA)),
    "contacts[].wall_speed": (
        'contacts = [{ wall_speed = "200 mm/s" }]\n' + UNITS, lambda s: s.contacts[0].wall_speed,
        0.2 * 500e3 / (100 * OMEGA)),
    "contacts[].normal.stiffness": (
        'contacts = [{ normal = { mass = 1, stiffness = "1 kN/mm", friction = 0.3 } }]\n' + UNITS,
        lambda s: s.contacts[0].normal.stiffness, 2.0),
    "contacts[].normal.preload": (
        'contacts = [{ normal = { mass = 1, stiffness = 2, friction = 0.3, preload = "-50 N" } }]\n' + UNITS,
        lambda s: s.contact_system.groups[0].normal.preload, -0.5),
    "springs[].gap": (
        'springs = [{ gap = "0.1 mm", stiffness = 2.0 }]\n' + UNITS,
        lambda s: s.spring_elements[0].displacement[0], 0.5),
    "springs[].backlash": (
        'springs = [{ backlash = "0.1 mm", stiffness = 2.0 }]\n' + UNITS,
        lambda s: list(s.spring_elements[0].displacement), [-0.5, 0.5]),
    "springs[].stiffness": (
        'springs = [{ gap = 0.5, stiffness = "1 kN/mm" }]\n' + UNITS,
        lambda s: s.spring_elements[0].stiffness_above, 2.0),
    "springs[].displacement": (
        'springs = [{ displacement = ["-0.1 mm", "0 mm"], force = [0.0, 1.0], stiffness_below = 1.0, '
        'stiffness_above = 2.0 }]\n' + UNITS,
        lambda s: list(s.spring_elements[0].displacement), [-0.5, 0.0]),
    "springs[].force": (
        'springs = [{ displacement = [-0.5, 0.0], force = ["-0.1 kN", "0 N"], stiffness_below = 1.0, '
        'stiffness_above = 2.0 }]\n' + UNITS,
        lambda s: list(s.spring_elements[0].force), [-1.0, 0.0]),
    "springs[].stiffness_below": (
        'springs = [{ displacement = [0.0], force = [0.0], stiffness_below = "1 kN/mm", '
        'stiffness_above = 2.0 }]\n' + UNITS,
        lambda s: s.spring_elements[0].stiffness_below, 2.0),
    "springs[].stiffness_above": (
        'springs = [{ displacement = [0.0], force = [0.0], stiffness_below = 1.0, '
        'stiffness_above = "250 N/mm" }]\n' + UNITS,
        lambda s: s.spring_elements[0].stiffness_above, 0.5),
    "contacts[].stiffness": (
        'contacts = [{ stiffness = "1 kN/mm" }]\n' + UNITS, lambda s: s.contacts[0].stiffness, 2.0),
}  # fmt: skip


@pytest.fixture
def configured(tmp_path):
    def read(text, *overrides):
        path = tmp_path / "rig.toml"
        path.write_text(text if "[system]" in text else f"[system]\n{text}", encoding="utf-8")
        return load_config(path, list(overrides))

    return read


def test_every_key_of_the_table_has_a_case():
    assert {*CASES, *IN_TABLES} == {*DIMENSIONS, *OF_MATRICES}


@pytest.mark.parametrize("key", CASES)
def test_a_key_in_its_unit(configured, key):
    text, name, expected = CASES[key]
    np.testing.assert_allclose(getattr(configured(text).system, name), expected, rtol=1e-15)


@pytest.mark.parametrize("key", IN_TABLES)
def test_a_key_of_a_table_in_its_unit(configured, key):
    text, found, expected = IN_TABLES[key]
    assert found(configured(text + ONE).system) == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize("key", DIMENSIONS)
def test_a_unit_of_another_kind_is_refused(configured, key):
    """Kelvins are no unit here, and hertz measure none of these."""
    text = CASES[key][0] if key in CASES else IN_TABLES[key][0] + ONE
    start = text.index('"', text.index(re.split(r"[\[.]", key)[-1] if key in IN_TABLES else key))
    wrong = re.sub(r'"[^"]*"', '"3 Hz"', text[start:], count=1)
    with pytest.raises(InputError, match=r"^system\..*; got '3 Hz': Hz is a unit of frequency$"):
        configured(text[:start] + wrong)


# Nothing is left out


#: Numbers of a configuration without a dimension.
DIMENSIONLESS = {
    "system.beam.modes", "system.plate.modes", "system.plate.nu", "system.modes.damping_ratios",
    "system.modes.damping_ratios[]",
    "system.mass_ratios[]", "system.stiffness_ratios[]", "system.damping_ratios", "system.damping_ratios[]",
    "system.contact_masses[]", "system.load_mass", "system.decouple", "system.harmonics",
    "system.reduce.keep[]", "system.reduce.modes", "system.reduce.allow",
    "system.load_harmonics[].n", "system.load_harmonics[].mass", "system.load_harmonics[].phase_deg",
    *(f"system.{place}normal_load[].{name}" for place in ("", "contacts[].")
      for name in ("n", "amplitude", "phase_deg", "re", "im")),
    *(f"system.contacts[].{name}" for name in ("masses[]", "ratio", "ratio[]", "mu")),
    *(f"system.contacts[].law.{name}" for name in ("factor[]", "slope", "kinetic", "viscous", "error")),
    *(f"system.sectors.{name}" for name in (
        "count", "coupling[].masses[]", "engine_order", "spread.standard_deviation", "spread.seed",
        "mass_factors[]", "stiffness_factors[]",
    )),
    *(f"system.contacts[].normal.{name}" for name in ("mass", "masses[]", "vector[]", "friction")),
    "system.springs[].masses", "system.springs[].masses[]",
    "grid.mu", "grid.friction_coefficient",
    "solver.cycles", "solver.tolerance", "solver.steps", "curves.harmonics",
    "design.mu", "design.second", "design.ratio[]", "design.spread", "design.quantile",
    "design.response.mass", "design.response.contact",
    "record.pulse.rise", "record.mass", "record.vector[]", "record.scale", "record.scale[]",
    *(f"record.generate.{name}" for name in ("seed", "count", "damping", "filter_damping")),
    "history.mu", "history.mu[]", "history.samples", "history.statistics.batches",
    "spectrum.mu", "spectrum.mu[]", "spectrum.damping",
    "spectrum.contact_stiffness",
}  # fmt: skip

#: Numbers of records and motions that may have units, which the tests of records compare.
OF_MOTIONS = {
    *(f"record.pulse.{name}" for name in ("amplitude", "duration")),
    *(f"record.sweep.{name}" for name in ("from", "to", "duration", "amplitude")),
    *(f"record.generate.{name}" for name in (
        "duration", "dt", "rms", "peak", "frequency", "filter_frequency", "wind_speed")),
    "record.peak", "history.beta", "history.friction", "history.statistics.start",
    "history.statistics.window", "spectrum.period", "spectrum.friction",
    "spectrum.beta",
}  # fmt: skip

#: Numbers in the unit that the record has.
OF_RECORD = {
    "record.dt", "record.after", "record.generate.level", "record.generate.density",
    "history.start.x", "history.start.v",
}  # fmt: skip

#: Entries of matrices: their units are those of `natural_frequency` and `stiffness` = "model".
ENTRIES = {
    "system.matrices.M", "system.matrices.K", "system.matrices.C", "system.matrices.dofs",
    *(f"system.sectors.{name}" for name in ("mass", "stiffness", "coupling", "coupling[].stiffness")),
    *(f"system.modes.{key}" for key in ("shapes", "residual", "compliance", "modal_masses")),
    *(f"system.modes.{key}" for key in ("participation", "influence", "base_residual")),
    *(f"history.start.{key}" for key in ("q", "q_rate")),
}  # fmt: skip

#: Numbers of beams, plates and modes, see `structures`.
OF_STRUCTURES = {
    *(f"system.{table}.{key}" for table, (_, kinds) in STRUCTURES.items() for key in kinds),
    "system.modes.frequencies",
}


def leaves(schema, name):
    """Names of all numbers in a schema, and whether each may be a text with a unit."""
    if "anyOf" in schema:
        found = [one for part in schema["anyOf"] for one in leaves(part, name)]
        return [(key, any(unit for other, unit in found if other == key)) for key, _ in found]
    if schema.get("type") == "object":
        return [
            one for key, part in schema.get("properties", {}).items() for one in leaves(part, f"{name}.{key}")
        ]
    if schema.get("type") == "array":
        items = [one for part in schema.get("prefixItems", ()) for one in leaves(part, f"{name}[]")]
        return items or leaves(schema["items"], f"{name}[]")
    if schema.get("type") in ("number", "integer"):
        return [(name, False)]
    return [(name, True)] if schema.get("pattern", "").startswith(f"^{NUMBER}") else []


def all_leaves():
    for section, keys in KEYS.items():
        for key in keys:
            yield from leaves(key.valid, f"{section}.{key.name}")


def test_every_number_is_in_the_table_or_has_no_dimension():
    of_system = {re.sub(r"\[[12]\]$", "", key) for key in (*DIMENSIONS, *OF_MATRICES)}
    dimensional = {
        *(f"system.{key}" for key in of_system), *(f"grid.{key}" for key in (*KINDS, "wall_speed")),
        *(f"design.{key}" for key in OF_DESIGN), *(f"units.{key}" for key in UNIT_KINDS),
        *OF_MOTIONS, *OF_STRUCTURES,
    }  # fmt: skip
    for name, unit in all_leaves():
        own = re.sub(r"(\[\]|\.(start|stop|step|num|values))+$", "", name)
        if own in ENTRIES | OF_RECORD or name.endswith(".num") or "dofs" in name:
            continue
        own = name if name in DIMENSIONLESS | OF_MOTIONS else own  # a time to start at is no end of a range
        assert (own in dimensional) != (own in DIMENSIONLESS), name
        assert unit == (own in dimensional), name


# Chains, axes, messages


CHAIN = """\
[system]
contact_masses = [2]
masses = ["40 kg", "25 kg"]
springs = ["500 N/mm", "300 N/mm"]
dampers = ["30 N s/m", "3 kN s/m"]
[units]
load = "100 N"
[grid]
r = ["5 Hz", "20 Hz"]
beta = ["1 N", "50 N"]
"""


def test_a_chain_defines_what_r_is(configured):
    config = configured(CHAIN)
    frequency = OMEGA / (2.0 * math.pi)
    np.testing.assert_allclose(config.r, [5.0 / frequency, 20.0 / frequency], rtol=1e-15)
    np.testing.assert_allclose(config.beta, [0.01, 0.5], rtol=1e-15)


def test_a_chain_with_dashpots_without_friction_is_the_linear_one(configured):
    """x = (K + i omega C - omega^2 M)^-1 F in kilograms, newtons and metres."""
    config = configured(CHAIN)
    ds = fm.curves(config, beta=[0.0], quantities=["first_harmonic"])
    k1, k2, c1, c2 = 5e5, 3e5, 30.0, 3000.0
    for hertz, found in zip((5.0, 20.0), ds.first_harmonic_amplitude_m.values[0, :, 0], strict=True):
        omega = 2.0 * math.pi * hertz
        dynamic = (
            np.array([[k1 + k2, -k2], [-k2, k2]], dtype=complex)
            + 1j * omega * np.array([[c1 + c2, -c2], [-c2, c2]])
            - omega**2 * np.diag([40.0, 25.0])
        )
        np.testing.assert_allclose(found, np.abs(np.linalg.solve(dynamic, [100.0, 0.0])), rtol=1e-12)


def test_dashpots_to_a_moving_base(configured):
    """Relative to the base the first dashpot loads the first mass, too: p = k1 y + c1 y'."""
    text = CHAIN.replace("dampers", 'excitation = "base"\ndamping_reference = "base"\ndampers')
    ds = fm.curves(configured(text), beta=[0.0], quantities=["first_harmonic"])
    k1, k2, c1, c2, y = 5e5, 3e5, 30.0, 3000.0, 100.0 / 5e5
    omega = 2.0 * math.pi * 20.0
    dynamic = (
        np.array([[k1 + k2, -k2], [-k2, k2]], dtype=complex)
        + 1j * omega * np.array([[c1 + c2, -c2], [-c2, c2]])
        - omega**2 * np.diag([40.0, 25.0])
    )
    expected = np.abs(np.linalg.solve(dynamic, [(k1 + 1j * omega * c1) * y, 0.0]))
    np.testing.assert_allclose(ds.first_harmonic_amplitude_m.values[0, 1, 0], expected, rtol=1e-12)


def test_further_axes_in_units(configured):
    text = (
        CHAIN
        + """\
[axes]
"masses[2]" = ["10 kg", "20 kg"]
contact_stiffness = { start = "100 N/mm", stop = "300 N/mm", step = "100 N/mm" }
"""
    )
    described = configured(text).variations.described
    np.testing.assert_allclose(described["mass_ratios[2]"], [0.25, 0.5], rtol=1e-15)
    np.testing.assert_allclose(described["contact_stiffness"], [0.2, 0.4, 0.6], rtol=1e-15)


def test_axes_that_vary_together_in_units(configured):
    sample = '"springs[2]" = ["250 N/mm", "1 kN/mm"], "dampers[1]" = ["0 N s/m", "4 N s/m"]'
    text = f"{CHAIN}[axes]\nsample = {{ {sample} }}\n"
    described = configured(text).variations.described["sample"]
    np.testing.assert_allclose(described["stiffness_ratios[2]"], [0.5, 2.0], rtol=1e-15)
    np.testing.assert_allclose(described["dampers[1]"], [0.0, 4.0 / math.sqrt(500e3 * 40.0)], rtol=1e-15)


def test_an_axis_of_the_first_mass_would_move_the_scale(configured):
    with pytest.raises(InputError, match=r"^cannot use axis masses\[1\]: the others are over the first one"):
        configured(CHAIN + '[axes]\n"masses[1]" = ["10 kg", "20 kg"]\n')


def test_a_value_of_the_command_line_in_its_unit(configured):
    config = configured(CHAIN, "system.contact_stiffness=800 N/mm", "units.load=50 N")
    assert config.system.contact_stiffness == 1.6
    np.testing.assert_allclose(config.beta, [0.02, 1.0], rtol=1e-15)


def test_all_that_is_missing_is_asked_for_at_once(configured):
    text = """\
[system]
contact_stiffness = "800 N/mm"
load_offset = ["3 N"]
[grid]
r = "5 Hz"
beta = "10 N"
"""
    with pytest.raises(InputError) as caught:
        configured(text)
    message = str(caught.value)
    for name in ("grid.r", "grid.beta", "system.contact_stiffness", "system.load_offset"):
        assert name in message
    given = message.partition("; give ")[2]
    for name in ("units.natural_frequency", "units.load", "units.stiffness"):
        assert name in given
    done = ["units.natural_frequency=4.2 Hz", "units.load=12.5 N", "units.stiffness=3 N/mm"]
    assert configured(text, *done).system.contact_stiffness == pytest.approx(800.0 / 3.0, rel=1e-15)


def test_all_that_a_question_needs_is_asked_for_at_once(tmp_path):
    path = tmp_path / "question.toml"
    path.write_text('[system]\n[design]\nquestion = "at-most"\nband = ["1 Hz", "2 Hz"]\nlimit = "2 mm"\n')
    with pytest.raises(
        InputError, match=r"natural_frequency .* and units\.load .* and units\.stiffness, such as "
    ):
        load_design(path)


def test_missing_in_python():
    with pytest.raises(
        InputError, match=r"^cannot convert r = '1 Hz' and beta = '2 N' .*natural_frequency.*load"
    ):
        fm.response(fm.System(), "1 Hz", "2 N")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[units]\nmass = "3 kg"', "cannot use units.mass with system.masses: it follows; omit it"),
        ('[units]\nnatural_frequency = "3 Hz"', "cannot use units.natural_frequency with system.masses"),
        ("mass_ratios = [1.0, 1.0]", "cannot use system.mass_ratios with masses: both define the chain"),
    ],
)  # fmt: skip
def test_what_follows_from_a_chain_is_not_given(configured, text, message):
    section = "" if text.startswith("[") else text + "\n"
    units = text + "\n" if text.startswith("[") else ""
    chain = '[system]\nmasses = ["40 kg", "25 kg"]\nsprings = ["500 N/mm", "300 N/mm"]\n'
    with pytest.raises(InputError, match=f"^{re.escape(message)}"):
        configured(chain + section + units + ONE)


def test_as_many_springs_as_masses(configured):
    with pytest.raises(InputError, match=r"^system\.springs must have as many values as masses \(2\); got 1"):
        configured('masses = ["40 kg", "25 kg"]\nsprings = ["500 N/mm"]\n' + ONE)


def test_a_list_has_units_everywhere_or_nowhere(configured):
    text = 'contacts = [{ stiffness = ["800 N/mm", 3.0] }]\n' + UNITS + ONE
    with pytest.raises(
        InputError, match=r"^system\.contacts\[1\]\.stiffness\[1\] must .*; got 3\.0: it has no unit"
    ):
        configured(text)


@pytest.mark.parametrize("key", ["frequency_scale", "stiffness_scale"])
def test_numbers_of_matrices_need_matrices_in_si_units(configured, key):
    text = CASES[key][0].replace('"model"', '"3 Hz"', 1).replace('"model"', '"3 N/m"', 1)
    with pytest.raises(InputError, match=rf'^system\.{key} must be .* = "model" states'):
        configured(text)


# Friction coefficients


def test_friction_coefficients_over_a_normal_force(configured):
    """F = mu N."""
    text = '[units]\nload = "100 N"\nnormal_force = "500 N"\n[grid]\nr = 1.0\n'
    text += "friction_coefficient = [0.1, 0.3]\n"
    config = configured(text)
    np.testing.assert_allclose(config.beta, [0.5, 1.5], rtol=1e-15)
    ds = fm.sweep(config)
    np.testing.assert_array_equal(ds.friction_coefficient.values, [0.1, 0.3])
    np.testing.assert_array_equal(ds.friction_force.values, [50.0, 150.0])


def test_the_weight_as_normal_force(configured):
    chain = 'masses = ["40 kg"]\nsprings = ["500 N/mm"]\n'
    text = '[units]\nload = "100 N"\nnormal_force = "weight"\n[grid]\nr = 1.0\nfriction_coefficient = 0.05\n'
    assert configured(chain + text).beta[0] == pytest.approx(0.05 * 40.0 * 9.80665 / 100.0, rel=1e-15)
    with pytest.raises(
        InputError, match=r"^units\.normal_force must be a force, or 'weight' with units\.mass"
    ):
        configured(text)


def test_friction_coefficients_in_python():
    units = fm.Units(load="100 N", normal_force="500 N")
    ds = fm.sweep(fm.System(), [1.0], [units.friction(0.1), units.friction(0.3)], units=units)
    np.testing.assert_allclose(ds.beta.values, [0.5, 1.5], rtol=1e-15)
    with pytest.raises(InputError, match=r"^normal_force must be given"):
        fm.Units(load="100 N").friction(0.1)


def test_coefficients_and_beta_exclude_each_other(configured):
    text = '[units]\nload = "1 N"\nnormal_force = "5 N"\n' + ONE + "friction_coefficient = 0.1\n"
    with pytest.raises(InputError, match=r"^cannot use grid\.friction_coefficient with grid\.beta"):
        configured(text)


# Python


def test_a_system_of_texts_and_of_quantities_of_pint():
    ureg = pint.UnitRegistry()
    texts = {
        "masses": ["40 kg", "25 kg"], "springs": ["500 N/mm", "300 N/mm"], "dampers": ["3 N s/m", "4 N s/m"],
        "contacts": [{"masses": [2], "force": "50 N", "stiffness": "800 N/mm"}],
    }  # fmt: skip
    other = {
        "masses": [40, 25] * ureg.kg,
        "springs": [500e3, 300e3] * ureg("N/m"),
        "dampers": [3, 4] * ureg("N s/m"),
        "contacts": [{"masses": [2], "force": 50 * ureg.N, "stiffness": 800e3 * ureg("N/m")}],
    }  # fmt: skip
    first, units = fm.system_in_units(fm.Units(load="100 N"), **texts)
    second, same = fm.system_in_units(fm.Units(load="100 N"), **other)
    assert first == second
    assert fm.sweep(first, ["5 Hz"], ["1 N"], units=units).equals(
        fm.sweep(second, ["5 Hz"], ["1 N"], units=same)
    )


def test_axes_of_python_in_units():
    system, units = fm.system_in_units(
        fm.Units(load="100 N"), masses=["40 kg"], springs=["500 N/mm"], contacts=[{"stiffness": "1 kN/mm"}]
    )
    ds = fm.sweep(system, [0.5], [0.5], units=units, axes={"contacts[1].stiffness": ["250 N/mm", "500 N/mm"]})
    np.testing.assert_array_equal(ds.contacts_1_stiffness.values, [0.5, 1.0])


# A working point in a picture


def test_a_working_point_in_units_is_that_of_its_ratios():
    units = fm.Units(natural_frequency="4 Hz", load="10 N")
    ds = fm.sweep(fm.System(), ["2 Hz", "4 Hz", "6 Hz"], ["0 N", "8 N"], units=units)
    legends = []
    for point, box in ((("3 Hz", "5 N"), ("0.4 Hz", "1 N")), ((0.75, 0.5), (0.1, 0.1))):
        (ax,) = fm.plot_regimes(ds, point=point, box=box)
        legends.append([text.get_text() for text in ax.figure.legends[0].get_texts()])
    assert legends[0] == legends[1]
    assert "working point: r = 0.75, β = 0.5" in legends[0]


def test_a_working_point_in_units_needs_those_of_the_file():
    ds = fm.sweep(fm.System(), [0.5, 1.0], [0.0, 0.8])
    with pytest.raises(InputError, match=r"^cannot convert point = '3 Hz' .*natural_frequency.*units\.load"):
        fm.plot_regimes(ds, point=("3 Hz", "5 N"))
    with pytest.raises(InputError, match=r"^point must be a number"):
        fm.plot_regimes(ds, point=("much", 0.5))
