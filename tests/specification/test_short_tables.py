"""`export` of motions and response curves: few columns, units in the header, and everything on request."""

import csv
import io

import numpy as np
import pytest
import xarray as xr

import frictionmap as fm
from frictionmap.command_line.cli import main
from frictionmap.files.export import csv_of

UNITS = fm.Units(natural_frequency="4 Hz", load="10 N", stiffness="2 N/mm")
TWO = fm.System(
    contacts=[fm.Contact("fixed-wall", 1), fm.Contact("between-masses", (1, 2), ratio=0.5)],
    mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.05,
)  # fmt: skip
CHAIN = fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.05)


def rows_of(text):
    """Names of columns, and their texts by name."""
    head, *rows = csv.reader(io.StringIO(text))
    return head, {name: [row[k] for row in rows] for k, name in enumerate(head)}


def numbers(texts):
    return np.array(texts, dtype=float)


def test_a_motion_has_a_row_per_instant():
    ds = fm.response(fm.System(damping_ratios=0.05), 0.8, 0.2)
    head, columns = rows_of(csv_of(ds))
    assert head == ["tau", "x_1", "z", "friction"]
    np.testing.assert_array_equal(numbers(columns["x_1"]), ds.x[0])
    np.testing.assert_array_equal(numbers(columns["tau"]), ds.tau)


def test_a_motion_in_units_has_them_in_its_header(tmp_path):
    """Of two contacts, with a column for each; measured files name their columns in the same way."""
    ds = fm.response(TWO, "3.2 Hz", "2 N", units=UNITS)
    ds.to_netcdf(tmp_path / "motion.nc")
    assert main(["export", str(tmp_path / "motion.nc"), "-o", str(tmp_path / "motion.csv"), "--quiet"]) == 0
    head, columns = rows_of((tmp_path / "motion.csv").read_text())
    assert head == ["time_s", "x_1_m", "x_2_m", "z_1_m", "z_2_m", "friction_1_N", "friction_2_N"]
    np.testing.assert_allclose(numbers(columns["time_s"])[-1], 1.0 / 3.2, rtol=1e-12)
    np.testing.assert_allclose(numbers(columns["z_2_m"]), 5e-3 * ds.z[1], rtol=1e-12)
    assert np.abs(numbers(columns["friction_2_N"])).max() == pytest.approx(1.0, rel=1e-12)


def test_curves_have_a_row_per_frequency():
    """Several friction ratios stand side by side."""
    r = np.linspace(0.4, 1.6, 7)
    ds = fm.curves(fm.System(damping_ratios=0.05), r, [0.1, 0.3], harmonics=3)
    head, columns = rows_of(csv_of(ds))
    assert len(columns["r"]) == r.size
    for k, beta in enumerate(("beta = 0.1", "beta = 0.3")):
        found = numbers(columns[f"amplitude_1 ({beta})"])
        np.testing.assert_array_equal(found, ds.amplitude[0, :, k, 0])
        assert set(columns[f"regime ({beta})"]) <= {"continuous", "stick_slip", "permanent_sticking"}
    assert not [name for name in head if "harmonic" in name]
    one = rows_of(csv_of(fm.curves(fm.System(damping_ratios=0.05), r, [0.1], units=UNITS)))[0]
    assert one[:2] == ["frequency_Hz", "r"]
    assert {"amplitude_1_m", "phase_1_rad", "contact_amplitude_m"} <= set(one)


def test_everything_is_there_on_request(tmp_path):
    ds = fm.response(fm.System(damping_ratios=0.05), 0.8, 0.2)
    ds.to_netcdf(tmp_path / "motion.nc")
    out = str(tmp_path / "all.csv")
    assert main(["export", str(tmp_path / "motion.nc"), "--all", "-o", out, "--quiet"]) == 0
    head, _ = rows_of((tmp_path / "all.csv").read_text())
    assert {"v", "phase", "displacement_harmonic", "work_friction", "beta_lim"} <= set(head)


def test_one_motion_in_time_and_several(tmp_path):
    record = fm.Record([0.0, 1.0, 0.0, 0.0], dt=1.0, quantity="force")
    one = fm.history(fm.System(damping_ratios=0.1), record, beta=[0.2])
    head, columns = rows_of(csv_of(one))
    assert head[:2] == ["time", "x_1"]
    assert {"z", "friction"} <= set(head)
    assert "x_1_m" not in head
    assert len(columns["time"]) == one.sizes["time"]


def test_several_motions_in_time_have_a_row_each(tmp_path, capsys):
    """Masses and contacts are columns, friction is also in newtons, and one of them can be had over time.

    The first record moves nothing, and the share of the time in which it sticks is 1, not a little more.
    """
    pulses = {"kind": "half-sine", "duration": "0.2 s", "quantity": "force", "unit": "N"}
    records = [fm.Record.pulse(amplitude=peak, **pulses) for peak in ("1 N", "30 N")]
    ds = fm.history(TWO, records, beta=[0.2, 0.3], units=UNITS, after=4.0)
    path = str(tmp_path / "suite.nc")
    ds.to_netcdf(path)
    assert main(["export", path, "-o", str(tmp_path / "suite.csv")]) == 0
    said = "suite.csv, a row per motion; --at record=1 --at beta=0.2 writes one of them over time\n"
    assert capsys.readouterr().out.endswith(said)
    assert (ds.stuck_fraction.sel(record=1) == 1.0).all()
    assert (ds.amplitude.sel(record=2) > 0.1).all()
    head, columns = rows_of((tmp_path / "suite.csv").read_text())
    assert len(columns["record"]) == 4
    assert columns["friction_force_N"] == ["2.0", "3.0", "2.0", "3.0"]
    for k in (1, 2):
        wanted = ds.amplitude_m.sel(dof=k).transpose("record", "scale", "mu", "beta").values.ravel()
        np.testing.assert_array_equal(numbers(columns[f"amplitude_{k}_m"]), wanted)
        wanted = ds.stops.sel(contact=k).transpose("record", "scale", "mu", "beta").values.ravel()
        np.testing.assert_array_equal(numbers(columns[f"stops_{k}"]), wanted)
    assert not {"amplitude_1", "amplitude", "x_1", "z_max_1_m"} & set(head)
    assert {"amplitude_1", "amplitude_1_m", "z_max_1_m"} <= set(rows_of(csv_of(ds, everything=True))[0])
    at = ["--at", "record=2", "--at", "beta=0.3", "--quiet"]
    assert main(["export", path, *at, "-o", str(tmp_path / "one.csv")]) == 0
    _, columns = rows_of((tmp_path / "one.csv").read_text())
    one = ds.x_m.sel(record=2, beta=0.3, dof=2).values.ravel()
    np.testing.assert_array_equal(numbers(columns["x_2_m"]), one[: len(columns["x_2_m"])])


def test_a_value_is_chosen_as_it_is_printed(tmp_path):
    """With six digits, where only one value has them."""
    record = fm.Record([0.0, 1.0, 0.0, 0.0], dt=1.0, quantity="force")
    ds = fm.history(fm.System(damping_ratios=0.1), record, beta=[1 / 7, 2 / 7, 2 / 7 + 1e-9])
    ds.to_netcdf(tmp_path / "motions.nc")
    out = ["-o", str(tmp_path / "one.csv"), "--quiet", "--overwrite"]
    assert main(["export", str(tmp_path / "motions.nc"), "--at", "beta=0.142857", *out]) == 0
    _, columns = rows_of((tmp_path / "one.csv").read_text())
    wanted = ds.x[0, 0, 0, 0, 0].values
    np.testing.assert_array_equal(numbers(columns["x_1"]), wanted[: len(columns["x_1"])])
    assert main(["export", str(tmp_path / "motions.nc"), "--at", "beta=0.285714", *out]) == 2


def test_the_masses_of_a_map_are_columns():
    solver = fm.Solver(outputs=["regime", "amplitude", "also_reachable"])
    ds = fm.sweep(CHAIN, [0.5, 0.9], [0.1, 0.4], units=UNITS, solver=solver)
    head, columns = rows_of(csv_of(ds))
    assert head[:5] == ["mu", "r", "beta", "frequency_Hz", "friction_force_N"]
    assert len(columns["r"]) == 4
    for k in (1, 2):
        wanted = ds.amplitude_m.sel(dof=k).transpose("mu", "r", "beta").values.ravel()
        np.testing.assert_array_equal(numbers(columns[f"amplitude_{k}_m"]), wanted)
    codes = {"permanent_sticking": 1, "stick_slip": 2, "continuous": 4}
    masks = [sum(codes[name] for name in text.split(" | ") if name) for text in columns["also_reachable"]]
    assert masks == ds.also_reachable.transpose("mu", "r", "beta").values.ravel().tolist()


def test_shares_and_boundaries_have_a_row_per_cell_and_per_frequency():
    ds = fm.sweep(fm.System(), [0.5, 0.9], [0.1, 0.4], axes={"damping_ratios": [0.01, 0.05]}, units=UNITS)
    head, columns = rows_of(csv_of(fm.shares(ds, "damping_ratios")))
    assert len(columns["r"]) == 4
    assert {"frequency_Hz", "friction_force_N", "regime_share_continuous"} <= set(head)
    middle = ds.beta_lim_N.mean("damping_ratios").values.repeat(2)  # between two values
    np.testing.assert_allclose(numbers(columns["beta_lim_quantile_0.5_N"]), middle, rtol=1e-12)
    head, columns = rows_of(csv_of(ds))  # with its further axis
    assert head[:4] == ["damping_ratios", "mu", "r", "beta"]
    assert len(columns["r"]) == 8
    head, columns = rows_of(csv_of(fm.boundaries(fm.System(), [0.5, 0.9], units=UNITS)))
    assert len(columns["r"]) == 2
    assert {"frequency_Hz", "beta_lim_N", "beta_stick_N"} <= set(head)


def test_a_map_of_two_contacts_has_a_column_for_each(tmp_path):
    ds = fm.sweep(TWO, [0.5, 0.9], [0.1, 0.4])
    ds.to_netcdf(tmp_path / "map.nc")
    assert main(["export", str(tmp_path / "map.nc"), "-o", str(tmp_path / "map.csv"), "--quiet"]) == 0
    _, columns = rows_of((tmp_path / "map.csv").read_text())
    with xr.open_dataset(tmp_path / "map.nc") as stored:
        for k in (1, 2):
            wanted = stored.contact_amplitude.sel(contact=k).transpose("mu", "r", "beta").values.ravel()
            np.testing.assert_array_equal(numbers(columns[f"contact_amplitude_{k}"]), wanted)
