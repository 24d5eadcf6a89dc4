"""Records of steady motion through the command `identify` and in Python: what comes out, what is refused."""

import re

import numpy as np
import pytest
import xarray as xr
from records import Truth, base_at, filtered, rates, steady, synthetic
from refusals import refusal

import frictionmap as fm
from frictionmap.command_line.cli import main

TRUTH = Truth(3.13, 0.01, 0.8, 1.0, -0.1, 1.001, (0.1, 1.8j, 0.02), rate=100.0, length=7.3)


@pytest.fixture(scope="module")
def measured_record():
    """Times, base and mass, with two stops per cycle."""
    return synthetic(TRUTH, steady(TRUTH), 4)


@pytest.fixture
def rig(tmp_path, monkeypatch):
    """Writes a data file and its configuration; the path of the latter."""
    monkeypatch.chdir(tmp_path)

    def write(columns, more="", head="time_s,base_mm,x_mm"):
        rows = [head, *(",".join(f"{value:.8g}" for value in row) for row in zip(*columns, strict=True))]
        (tmp_path / "record.csv").write_text("\n".join(rows) + "\n")
        path = tmp_path / "rig.toml"
        system = '[system]\ncontact = "fixed-wall"\nexcitation = "base"\ndamping_reference = "base"\n'
        path.write_text(f'[data]\nkind = "record"\nfile = "record.csv"\n{system}[known]\nmu = 1.0\n{more}\n')
        return path

    return write


def test_from_a_file_to_a_friction_force(rig, capsys, measured_record):
    path = rig(measured_record, "stiffness = 1191.0")
    assert main(["identify", str(path)]) == 0
    out = capsys.readouterr().out
    row = next(line.split() for line in out.splitlines() if line.split()[:1] == ["x_F"])
    assert float(row[1]) == pytest.approx(TRUTH.x_F, abs=0.005)
    assert row[-1] == "mm"
    assert "friction found, and the mass sticks and slips" in out
    assert len(re.findall("^ *stops_per_cycle", out, re.MULTILINE)) == 1
    with xr.open_dataset("rig-identify.nc") as ds:
        names = ["f_n", "zeta", "x_F", "mu", "offset_x"]
        names += ["beta", "lag_deg", "amplitude_ratio", "stops_per_cycle"]
        assert ds.parameter.values.tolist() == names
        assert ds.unit.values.tolist() == ["Hz", "1", "mm", "1", "mm", "1", "deg", "1", "1"]
        assert ds.known.values.tolist() == [0, 0, 0, 1, 0, 0, 0, 0, 0]
        for name in names[5:]:
            assert float(ds[name]) == float(ds.estimate.sel(parameter=name))
        assert float(ds.friction_force) == pytest.approx(1.191 * float(ds.estimate.sel(parameter="x_F")))
        np.testing.assert_allclose(ds.data, measured_record[2], rtol=1e-6)
        np.testing.assert_allclose(ds.model - ds.data, ds.residual, atol=1e-12)
        assert not any(np.isnan(ds[name]).any() for name in ds.data_vars if ds[name].dtype.kind == "f")
        first = complex(*ds.phasor.sel(channel="base").isel(harmonic=1).values)
        assert abs(first) == pytest.approx(float(ds.base_amplitude)) == pytest.approx(1.8, abs=0.001)
    assert main(["info", "rig-identify.nc"]) == 0
    assert "stops_per_cycle" in capsys.readouterr().out


def test_a_late_channel_is_named_in_the_report_and_can_be_held(rig, capsys, measured_record):
    """The mass comes 2 samples, 20 ms, late: 7 degrees of the cycle."""
    time, base, x = measured_record
    late = time[2:], base[2:], x[:-2]
    path = rig(late, "f_n = 3.13\nzeta = 0.01")
    assert main(["identify", str(path)]) == 0
    out = capsys.readouterr().out
    assert "the model explains the data with a delay between the channels (delay 0.0" in out
    assert "but not without it" in out
    row = next(line.split() for line in out.splitlines() if line.split()[:1] == ["delay"])
    assert float(row[1]) == pytest.approx(0.02, abs=0.001)
    assert row[-1] == "s"
    assert main(["identify", str(path), "--overwrite", "--set", 'known.delay="20 ms"']) == 0
    assert "explains" not in capsys.readouterr().out
    with xr.open_dataset("rig-identify.nc") as ds:
        assert float(ds.estimate.sel(parameter="delay")) == 0.02
        friction = ds.sel(parameter="x_F")
        assert abs(float(friction.estimate) - TRUTH.x_F) < 4.0 * float(friction.standard_error)


def test_units_of_the_columns(rig, measured_record):
    """Lengths come in the unit of the mass, known values are given in mm."""
    time, base, x = measured_record
    path = rig((1e3 * time, 1e3 * base, 1e-3 * x), "x_F = 0.8", "time_ms,base_um,x_m")
    assert main(["identify", str(path), "--quiet"]) == 0
    with xr.open_dataset("rig-identify.nc") as ds:
        found = dict(zip(ds.parameter.values, ds.estimate.values, strict=True))
        assert found["x_F"] == pytest.approx(0.8e-3)
        assert found["beta"] == pytest.approx(0.8 / 1.8, rel=1e-3)
        assert found["f_n"] == pytest.approx(TRUTH.f_n, abs=0.02)


@pytest.mark.parametrize(("unit", "order", "size"), [("m_s2", 2, 1e3), ("g", 2, 9806.65), ("mm_s", 1, 1.0)])
def test_accelerations_and_velocities(rig, capsys, unit, order, size):
    """Of base and mass, with 1 % noise: friction as a length in mm, of the integrated harmonics."""
    motion = steady(TRUTH)
    time = np.arange(int(TRUTH.rate * TRUTH.length) + 1) / TRUTH.rate
    mass = filtered(TRUTH, lambda t: rates(TRUTH, motion, t)[order - 1], time)
    rng = np.random.default_rng(3)
    channels = [
        (one + rng.normal(0.0, 0.01 * np.std(one), time.size)) / size
        for one in (base_at(TRUTH, time, order), mass)
    ]
    path = rig((time, *channels), "stiffness = 1191.0", f"time_s,base_{unit},x_{unit}")
    assert main(["identify", str(path)]) == 0
    out = capsys.readouterr().out
    assert "warning: offset_x has no meaning: velocities and accelerations do not show" in out
    assert "integration amplifies" not in out
    with xr.open_dataset("rig-identify.nc") as ds:
        found = dict(zip(ds.parameter.values, ds.estimate.values, strict=True))
        assert ds.unit.values[2] == "mm"
    assert found["x_F"] == pytest.approx(TRUTH.x_F, abs=0.008)
    assert found["f_n"] == pytest.approx(TRUTH.f_n, abs=0.02)
    assert found["zeta"] == pytest.approx(TRUTH.zeta, abs=0.003)
    assert found["beta"] == pytest.approx(TRUTH.x_F / 1.8, abs=0.005)


def test_noise_that_integration_amplifies_is_reported(rig, capsys, measured_record):
    """A noisy accelerometer on the mass, a displacement of the base, in a window."""
    motion = steady(TRUTH)
    time, base, _ = measured_record
    mass = filtered(TRUTH, lambda t: rates(TRUTH, motion, t)[1], time)
    mass = mass + np.random.default_rng(3).normal(0.0, 0.4 * np.std(mass), time.size)
    path = rig((time, base, mass), head="time_s,base_mm,x_mm_s2")
    assert main(["identify", str(path), "--set", "data.window=[0.5, 7.0]"]) == 0
    assert re.search(
        r"warning: x_mm_s2 as a displacement has noise of \d+% of its motion: integration amplifies",
        capsys.readouterr().out,
    )


def warnings(measured_record, change, **arguments):
    columns = change(*(column.copy() for column in measured_record))
    return fm.identify.record(*columns, damping_reference="base", known={"mu": 1.0}, **arguments).warnings


def without_some(time, base, x):
    kept = np.delete(np.arange(time.size), slice(200, 250))
    return time[kept], base[kept], x[kept]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (without_some, "a gap of 0.51 s in the times"),
        (lambda time, base, x: (time, base, np.minimum(x, 1.5)), "clipped: "),
        (lambda time, base, x: (time, base, x * (1.0 + 0.01 * time)), "not steady"),
        (lambda time, base, x: (time, base, x + 0.01 * time), "x drifts by 0.01"),
    ],
)
def test_what_is_to_be_minded(measured_record, change, words):
    assert words in warnings(measured_record, change)


def test_clipped_samples_are_left_out(measured_record):
    time, base, x = measured_record
    ds = fm.identify.record(time, base, np.minimum(x, 1.5), damping_reference="base", known={"mu": 1.0})
    assert (ds.data < 1.5).all()
    for name, exact in (("x_F", TRUTH.x_F), ("f_n", TRUTH.f_n), ("zeta", TRUTH.zeta)):
        one = ds.sel(parameter=name)
        assert abs(float(one.estimate) - exact) < 4.0 * float(one.standard_error), name
    whole = fm.identify.record(time, base, x, damping_reference="base", known={"mu": 1.0})
    for name in ("lag_deg", "amplitude_ratio"):
        one = whole.sel(parameter=name)
        assert float(ds[name]) == pytest.approx(float(one.estimate), abs=4.0 * float(one.standard_error))


def test_a_distorted_base(measured_record):
    truth = TRUTH._replace(base=(0.0, 1.8j, 0.15, 0.05))
    ds = fm.identify.record(*synthetic(truth, steady(truth), 1), damping_reference="base", known={"mu": 1.0})
    assert "the base is distorted: its higher harmonics are 8.8%" in ds.warnings
    assert float(ds.estimate.sel(parameter="x_F")) == pytest.approx(truth.x_F, abs=0.005)
    assert "distorted" not in warnings(measured_record, lambda *columns: columns)


def test_rows_without_a_number_are_dropped_on_request_only(rig, capsys, measured_record):
    time, base, x = (column.copy() for column in measured_record)
    x[77] = np.nan
    path = rig((time, base, x))
    assert "column x_mm, line 79 must be a finite number; got 'nan' (data.missing = \"drop\"" in refusal(
        capsys, "identify", path
    )
    assert main(["identify", str(path), "--set", "data.missing=drop"]) == 0
    assert "warning: 1 of 731 rows of record.csv have no number" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda t, y, x: (t, y, np.random.default_rng(1).normal(0.0, 0.01, t.size)),
            "cannot fit x: its first harmonic at 1.001 Hz, the frequency of the base, is",
        ),
        (lambda t, y, x: (t, np.minimum(y, 1.3), x), "a part of the cycle has no samples"),
        (lambda t, y, x: (t[::17], y[::17], x[::17]), "5.8 samples per cycle, 8 needed"),
        (lambda t, y, x: (t[::-1], y, x), "line 3 must be > 7.3, the time of the previous row; got 7.29"),
    ],
)  # fmt: skip
def test_bad_records(rig, capsys, measured_record, change, message):
    found = refusal(capsys, "identify", rig(change(*measured_record)))
    assert message in found
    assert "record.csv" in found


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"base": [1.0, 2.0]}, "base must be 731 numbers, one per time"),
        ({"x": np.full(731, np.nan)}, "x must be finite; got nan at index 0"),
        ({"unit": "inch"}, "unit must be one of mm, m, um, in, cm, ft; got 'inch'"),
        ({"damping_reference": "wall"}, "damping_reference must be one of ground, base; got 'wall'"),
        ({"stiffness": -1.0}, "stiffness must be > 0; got -1"),
        (
            {"known": dict(f_n=3.0, zeta=0.0, x_F=0.5, mu=1.0, offset_x=0.0)},
            "known must leave at least one parameter free",
        ),
    ],
)
def test_bad_arguments(measured_record, arguments, message):
    time, base, x = measured_record
    with pytest.raises(fm.InputError, match=re.escape(message)):
        fm.identify.record(**{"time": time, "base": base, "x": x} | arguments)


def test_motion_without_friction():
    """One harmonic motion: no friction is found, and mu has no part in it."""
    f, r, zeta = 2.0, 0.6, 0.05
    time = np.arange(800) / 100.0
    truth = TRUTH._replace(f=f, base=(0.0, 1.5))
    gain = (1.0 + 2j * zeta * r) / (1.0 - r**2 + 2j * zeta * r)
    rng = np.random.default_rng(2)
    x = (1.5 * gain * np.exp(2j * np.pi * f * time)).real + rng.normal(0.0, 0.01, time.size)
    base = base_at(truth, time) + rng.normal(0.0, 0.003, time.size)
    ds = fm.identify.record(time, base, x, damping_reference="base")
    assert ds.verdict.flag_meanings.split()[int(ds.verdict)] == "no_friction_found"
    friction, damping = ds.sel(parameter="x_F"), ds.sel(parameter="zeta")
    assert float(friction.lower) == 0.0
    assert float(friction.upper) < 0.1
    assert float(damping.lower) - 1e-3 < zeta < float(damping.upper) + 1e-3
    assert np.isfinite(ds.estimate).all()
