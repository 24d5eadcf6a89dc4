"""The table [record] of a configuration."""

import tomllib

import numpy as np
import pytest

from frictionmap import InputError
from frictionmap.motions.record import Record
from frictionmap.motions.table import records_of


def records(text, folder):
    return records_of(tomllib.loads(text), folder)


@pytest.fixture
def suite(tmp_path):
    (tmp_path / "suite").mkdir()
    for k in (2, 1, 3):
        rows = [f"{0.1 * j},{k * (-1) ** j}" for j in range(4)]
        (tmp_path / "suite" / f"r{k}.csv").write_text("\n".join(["time_s,acceleration_g", *rows]) + "\n")
    return tmp_path


def test_one_file(suite):
    found, files = records('file = "suite/r2.csv"\nbaseline = "mean"\ninterpolation = "cubic"', suite)
    assert files == (suite / "suite" / "r2.csv",)
    (record,) = found
    np.testing.assert_array_equal(record.values, [2, -2, 2, -2])
    assert (record.interpolation, record.unit, record.name) == ("cubic", "g", "r2")
    assert record.note == "the mean, 0 g, is taken off"


def test_files_of_a_pattern_are_sorted_and_scaled(suite):
    found, files = records('files = "suite/*.csv"\npeak = "0.4 g"', suite)
    assert [record.name for record in found] == ["r1", "r2", "r3"]
    assert [file.name for file in files] == ["r1.csv", "r2.csv", "r3.csv"]
    for record in found:
        assert np.abs(record.values * record.scale).max() == pytest.approx(0.4, rel=1e-15)


def test_files_in_a_list(suite):
    found, _ = records('files = ["suite/r3.csv", "suite/r1.csv"]', suite)
    assert [record.name for record in found] == ["r3", "r1"]


def test_pulse(tmp_path):
    text = 'pulse = { kind = "triangle", amplitude = "2 kN", duration = "0.2 s", rise = 0.0 }\n'
    (record,), files = records(text + 'unit = "N"\nquantity = "force"\nmass = 2', tmp_path)
    assert files == ()
    np.testing.assert_array_equal(record.values, [2000, 0])
    assert (record.quantity, record.mass, record.duration) == ("force", 2, 0.2)


def test_sweep(tmp_path):
    (found,), _ = records(
        'sweep = { from = "1 Hz", to = 4, duration = 3, law = "log" }\nunit = "g"', tmp_path
    )
    expected = Record.sweep(1.0, 4.0, 3.0, law="log", unit="g")
    np.testing.assert_array_equal(found.values, expected.values)


def test_generate(tmp_path):
    text = """
unit = "g"
[generate]
kind = "kanai-tajimi"
frequency = "2.5 Hz"
damping = 0.6
peak = "0.4 g"
duration = "20 s"
dt = "0.01 s"
seed = 1
count = 4
"""
    found, _ = records(text, tmp_path)
    expected = Record.generate(
        "kanai-tajimi", 20.0, 0.01, seed=1, count=4, peak=0.4, unit="g", frequency=2.5, damping=0.6
    )
    assert len(found) == 4
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_array_equal(one.values * one.scale, other.values * other.scale)


def test_generated_forces_act_on_a_mass(tmp_path):
    text = 'generate = { kind = "white", rms = 1.0, duration = 20, dt = 0.1 }\n'
    text += 'quantity = "force"\nvector = [1, 2]'
    (record,), _ = records(text, tmp_path)
    assert (record.quantity, record.vector) == ("force", (1.0, 2.0))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "file must be given, or one of files, pulse, sweep, generate"),
        ('file = "a"\nfiles = "b"', "cannot use files with file: both give records"),
        ('fil = "a"', r"unknown key 'record.fil' \(did you mean file\?\)"),
        ("file = 3", "file must be the path of a file; got 3"),
        ('file = "none.csv"', "cannot read .*none.csv: No such file"),
        ('files = "none*.csv"', "files must be a pattern that matches files"),
        ("files = []", "files must be a pattern or a list of paths"),
        ('file = "suite/r1.csv"\nunit = "m/s^2"', "unit must be that of column acceleration_g, g"),
        ('file = "suite/r1.csv"\npeak = "4 mm"', "peak must be .*mm is a unit of length"),
        ('pulse = "ricker"', "pulse must be a table of kind, amplitude, duration, rise"),
        ('pulse = { kind = "ricker" }', "pulse.duration must be given"),
        ('pulse = { kind = "ricker", duration = 0 }', "pulse.duration must be > 0"),
        ('pulse = { kind = "ricker", length = 2 }', "unknown key 'record.pulse.length'"),
        ('pulse = { kind = "ricker", duration = 2 }\nbaseline = "mean"', "cannot use baseline with pulse"),
        ("sweep = { from = -1, to = 1, duration = 1 }", "sweep.from must be > 0"),
        ("sweep = { start = 1, to = 1, duration = 1 }", "unknown key 'record.sweep.start'"),
        ('generate = { kind = "white", duration = 1, dt = 0 }', "generate.dt must be > 0"),
        ('generate = { kind = "white", duration = 1, dt = 0.1, colour = 1 }', "unknown key 'record.gen"),
        ('generate = { kind = "white", duration = 1, dt = 0.1 }', "level must be given, or rms, or peak"),
    ],
)
def test_refused(suite, text, message):
    with pytest.raises(InputError, match=message) as error:
        records(text, suite)
    assert "\n" not in str(error.value)
