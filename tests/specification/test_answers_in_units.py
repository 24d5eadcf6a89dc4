"""Values in the units that suit them, remedies that work when pasted, and records described by `info`."""

import json
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from refusals import refusal

import frictionmap as fm
from frictionmap.command_line.cli import main
from frictionmap.datasets.amounts import Amounts
from frictionmap.files.summary import describe_file
from frictionmap.motions.table import records_of

UNITS = fm.Units(natural_frequency="4 Hz", load="10 kN", stiffness="2 kN/mm")

BEAM = """[system]
contact_masses = ["tip"]
contact_stiffness = "5 N/mm"
load_mass = "tip"
damping_ratios = 0.01
[system.beam]
ends = "clamped-free"
length = "300 mm"
bending_stiffness = "21 N m^2"
mass_per_length = "0.78 kg/m"
points = { tip = "300 mm" }
[grid]
r = ["30 Hz"]
beta = ["2 N"]
"""

AT2 = """PEER NGA STRONG MOTION DATABASE RECORD
Event, Station, 090
ACCELERATION TIME SERIES IN UNITS OF G
NPTS=  4, DT=   .0100 SEC
  0.0000000E+00 -0.2500000E+00  0.1000000E+00  0.0000000E+00
"""


def test_friction_of_several_motions_is_in_one_unit():
    pulse = fm.Record.pulse("half-sine", "8 kN", "0.1 s", quantity="force", unit="N")
    ds = fm.history(fm.System(), pulse, beta=["5 kN", "10 kN"], units=UNITS, samples="none")
    assert re.findall(r"half-sine, (\S+ \S+) ", describe_file(ds)) == ["5 kN", "10 kN"]


def test_no_motion_is_zero_millimetres():
    words = Amounts({"length": 100.0, "force": 1.0}, "amplitude of mass 1")
    assert words.response(0.0) == "0 mm"
    assert words.response(0.005) == "500 mm"


def test_lengths_of_spectra_are_in_millimetres():
    pulse = fm.Record.pulse("half-sine", "0.4 g", "0.2 s", unit="g")
    ds = fm.spectrum(pulse, period=["0.5 s", "1 s"], friction=["0.02 g", "0.1 g"], damping=0.05)
    np.testing.assert_array_equal(ds.period, [0.5, 1.0])
    peaks = np.quantile(1e3 * ds.amplitude.values, [0.0, 0.5, 1.0])
    text = " ... ".join(f"{peak:.4g}" for peak in peaks)
    assert re.search(rf"largest displacement +{re.escape(text)} mm", describe_file(ds))
    (ax,) = fm.plot_spectrum(ds)
    assert ax.get_ylabel() == "largest displacement [mm]"
    drawn = [line.get_ydata() for line in ax.lines]
    np.testing.assert_allclose(drawn, 1e3 * ds.amplitude.values[0, 0, 0].T.reshape(2, 2), rtol=1e-14)
    (ax,) = fm.plot_incremental(ds)
    assert ax.get_ylabel() == "largest displacement [mm]"


def test_periods_with_a_unit_need_records_with_one():
    pulse = fm.Record.pulse("half-sine", 1.0, 2.0)
    with pytest.raises(fm.InputError, match="period must be numbers without a unit, because the records"):
        fm.spectrum(pulse, period=["0.5 s"], friction=[0.1])


def test_energies_are_in_the_unit_of_their_sum():
    """Each energy is below 10 kJ, from which on kilojoules are handy, and their sum is above."""
    pulse = fm.Record.pulse("half-sine", "240 kN", "0.1 s", quantity="force", unit="N")
    ds = fm.history(fm.System(damping_ratios=0.3), pulse, beta=["64 kN"], units=UNITS)
    parts = [ds[name].squeeze(drop=True) for name in ("lost_friction_J", "lost_damping_J", "stored_energy_J")]
    assert max(float(part.max()) for part in parts) < 1e4
    (ax,) = fm.plot_energies(ds)
    assert ax.get_ylabel() == "energy [kJ]"
    assert ax.lines[0].get_ydata().max() == pytest.approx(1e-3 * float(sum(parts).max()), rel=1e-12)


def test_a_beam_without_units_needs_only_a_load(tmp_path, monkeypatch, capsys):
    """Its frequencies and stiffnesses are in SI units: the remedy, pasted, gives the same as without it."""
    monkeypatch.chdir(tmp_path)
    Path("beam.toml").write_text(BEAM)
    message = refusal(capsys, "map", "beam.toml")
    assert "units.stiffness" not in message
    assert "natural_frequency" not in message
    remedy = re.search(r'such as units\.(load = ".*")', message)[1]
    Path("beam.toml").write_text(f"{BEAM}[units]\n{remedy}\n")
    assert main(["map", "beam.toml", "--quiet"]) == 0
    with_scale = fm.load_config("beam.toml")
    beam = fm.Beam("clamped-free", 0.3, bending_stiffness=21.0, mass_per_length=0.78, points={"tip": 0.3})
    plain = fm.System(
        modes=beam, contact_masses=["tip"], load_mass="tip", contact_stiffness=5000.0, damping_ratios=0.01
    )
    assert with_scale.system.contact_stiffness == pytest.approx(
        plain.contact_stiffness / plain.stiffness_scale, rel=1e-12
    )


def test_a_path_in_the_place_of_a_record_is_refused_with_how_to_read_it():
    with pytest.raises(fm.InputError, match=re.escape("record must be a Record; got 'a.AT2': read it with")):
        fm.history(fm.System(), "a.AT2", beta=[0.1])


def test_response_to_a_record_names_history(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("quake.toml").write_text('[record]\nfile = "a.AT2"\n[history]\nfriction = [0.1]\n')
    assert "use frictionmap history" in refusal(capsys, "response", "quake.toml")


def test_the_peak_of_a_file_with_a_unit_has_one_too(tmp_path):
    (tmp_path / "a.AT2").write_text(AT2)
    with pytest.raises(fm.InputError, match=re.escape("such as '0.4 g', beside a file in g; got 0.4")):
        records_of(tomllib.loads('file = "a.AT2"\npeak = 0.4'), tmp_path)
    ((record,), _) = records_of(tomllib.loads('file = "a.AT2"\npeak = "0.4 g"'), tmp_path)
    assert record.scale == pytest.approx(0.4 / 0.25, rel=1e-15)


def test_info_describes_a_record(tmp_path, capsys):
    path = tmp_path / "a.AT2"
    path.write_text(AT2)
    assert main(["info", str(path)]) == 0
    out = capsys.readouterr().out
    for name, value in (
        ("quantity", "base acceleration"),
        ("samples", "4"),
        ("time step", "0.01 s"),
        ("duration", "0.03 s"),
        ("peak", "0.25 g at 0.01 s"),
    ):
        assert re.search(rf"^  {name} +{re.escape(value)}$", out, re.MULTILINE), out
    assert main(["info", str(path), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["kind"], found["quantity"], found["unit"]) == ("record", "acceleration", "g")
    assert (found["samples"], found["duration"]) == (4, 0.03)
    assert (found["peak"], found["peak_time"], found["steps"]) == (0.25, 0.01, {"least": 0.01, "most": 0.01})
    assert main(["info", str(path), "--at", "r=1"]) == 2
    assert "omit it" in capsys.readouterr().err


def test_small_numbers_have_their_power_at_the_end_of_the_axis():
    ds = fm.curves(fm.System(damping_ratios=0.1), [60.0, 80.0, 100.0], [0.0], quantities=["amplitude"])
    ax = fm.plot_curves(ds)[0]
    ax.figure.draw_without_rendering()
    assert 1e-5 < ax.get_ylim()[1] < 1e-3
    assert "10^{\N{MINUS SIGN}4}" in ax.yaxis.get_offset_text().get_text()
    assert max(len(tick.get_text()) for tick in ax.get_yticklabels()) <= len("$\\mathdefault{0.00}$")


def test_curves_without_a_resolved_point_have_all_variables():
    contacts = [fm.Contact("fixed-wall", 1), fm.Contact("fixed-wall", 2)]
    system = fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.001, contacts=contacts)
    few = fm.Solver(cycles=1, start="moving")
    wanted = dict(quantities=["amplitude", "phase", "first_harmonic", "energy", "harmonics"])
    none = fm.curves(system, [0.5], [0.05], solver=few, **wanted)
    every = fm.curves(system, [0.5], [0.05], **wanted)
    assert (none.status != 0).all()
    assert (every.status == 0).all()
    assert set(none.data_vars) == set(every.data_vars)
    assert {name: one.dims for name, one in none.data_vars.items()} == {
        name: one.dims for name, one in every.data_vars.items()
    }
    assert none.sizes == every.sizes
    assert np.isnan(none.amplitude).all()
    assert np.isnan(none.work_friction).all()
