"""Records from files: the formats of strong-motion databases and tables, and what is refused.

The files are written here from the public descriptions of the formats.
"""

import zlib

import numpy as np
import pytest

from frictionmap import InputError
from frictionmap.motions.record import Record

VALUES = np.array([0.0123, -0.5, 0.25, 0.125, -0.0625, 0.03, -0.01])


def written(path, lines):
    path.write_text("\n".join(lines) + "\n")
    return path


def peer(path, line="NPTS=      7, DT=   .0100 SEC", unit="G"):
    head = [
        "PEER NGA STRONG MOTION DATABASE RECORD",
        "Imperial Valley-02, 5/19/1940, El Centro Array #9, 180",
        f"ACCELERATION TIME SERIES IN UNITS OF {unit}",
        line,
    ]
    rows = ["".join(f"{value:15.7E}" for value in VALUES[k : k + 5]) for k in (0, 5)]
    return written(path, head + rows)


KNET = """Origin Time       1998/05/03 18:48:00
Lat.              34.95
Long.             139.15
Depth. (km)       5
Mag.              4.2
Station Code      SZO007
Station Lat.      34.9762
Station Long.     139.0969
Station Height(m) 23
Record Time       1998/05/03 18:48:25
Sampling Freq(Hz) 100Hz
Duration Time(s)  1
Dir.              N-S
Scale Factor      2000(gal)/8388608
Max. Acc. (gal)   11.735
Last Correction   1998/05/03 18:48:25
Memo."""

COUNTS = (np.arange(100) ** 2 % 97 * 50 - 1200).astype(int)


def knet(path, counts=COUNTS, head=KNET):
    rows = ["".join(f"{count:9d}" for count in counts[k : k + 8]) for k in range(0, len(counts), 8)]
    return written(path, [*head.splitlines(), *rows])


def esm(path, count=7, unit="cm/s^2", kind="ACCELERATION"):
    keys = {
        "EVENT_NAME": "CENTRAL_ITALY", "EVENT_ID": "EMSC-20160824_0000006", "STATION_CODE": "AMT",
        "SAMPLING_INTERVAL_S": "0.005000", "NDATA": f"{count}", "STREAM": "HGE", "UNITS": unit,
        "BASELINE_CORRECTION": "", "DATA_TYPE": kind,
    }  # fmt: skip
    head = [f"{key}: {value}" for key, value in keys.items()]
    head += [f"USER{k}: " for k in range(1, 65 - len(head))]
    return written(path, head + [f"{value:.6f}" for value in VALUES])


def block(title, values, text, per_line):
    rows = [
        "".join(text.format(value) for value in values[k : k + per_line])
        for k in range(0, len(values), per_line)
    ]
    return [title.format(len(values), len(rows)), *rows]


def cosmos(kind=1, unit=4, ms=5.0, values=VALUES, count=None):
    whole, real = np.full(100, -999), np.full(100, -999.0)
    whole[:3], real[61], real[62] = (2, kind, unit), ms, ms * len(values) / 1000
    name = {1: "acceleration", 2: "velocity", 3: "displacement"}.get(kind, "counts")
    lines = ["Corrected acceleration   (Format v01.20 with 13 text lines) Src: 999", "Somewhere Earthquake"]
    lines += [f"text {k}" for k in range(11)]  # 13 with the first one
    lines += block("{:4d} Integer-header values follow on {:3d} lines, Format=(10I8)", whole, "{:8d}", 10)
    lines += block("{:4d} Real-header values follow on {:3d} lines , Format = (6F13.6)", real, "{:13.6f}", 6)
    lines += ["   2 Comment line(s) follow, each starting with a '|':", "| one", "| two"]
    rows = block("", values, "{:10.3f}", 8)[1:]
    title = (
        f"{count or len(values):8d} {name} pts, approx  1 secs, units=cm/sec2 ({unit:02d}), Format=(8F10.3)"
    )
    return [*lines, title, *rows, f"End-of-data for 1 {name}"]


def test_peer(tmp_path):
    file = peer(tmp_path / "RSN6_IMPVALL.I_I-ELC180.AT2")
    record = Record.read(file)
    np.testing.assert_array_equal(record.values, VALUES)
    assert (record.dt, record.quantity, record.unit, record.interpolation) == (
        0.01,
        "acceleration",
        "g",
        "linear",
    )
    assert record.name == "RSN6_IMPVALL.I_I-ELC180"
    assert "El Centro Array #9" in record.source
    assert f"{zlib.crc32(file.read_bytes()):08x}" in record.source


def test_peer_values_may_touch(tmp_path):
    """14 characters each: a minus fills the place of the blank.  The unit may end a sentence."""
    file = peer(tmp_path / "a.at2", unit="G. FILTER POINTS: HP=0.2 Hz LP=20 Hz")
    values = [-0.0012345671, -0.36162, 0.25, -7.5e-5, 0.0, -0.1, -0.2]
    rows = ["".join(f"{value:14.7E}" for value in values[k : k + 5]) for k in (0, 5)]
    assert "E-03-3" in rows[0]
    written(file, file.read_text().splitlines()[:4] + rows)
    np.testing.assert_allclose(Record.read(file).values, values, rtol=1e-7)


def test_old_peer_velocity(tmp_path):
    record = Record.read(peer(tmp_path / "a.vt2", "    7    0.0200    NPTS, DT", "CM/SEC"))
    assert (record.dt, record.quantity, record.unit) == (0.02, "velocity", "cm/s")


def test_peer_displacement_is_a_spline(tmp_path):
    record = Record.read(peer(tmp_path / "a.DT2", unit="CM"))
    assert (record.quantity, record.unit, record.interpolation) == ("displacement", "cm", "cubic")


@pytest.mark.parametrize("name", ["SZO0079805031848.NS", "ABC.EW2", "ABC.ud1"])
def test_knet_without_its_offset(tmp_path, name):
    record = Record.read(knet(tmp_path / name))
    gal = COUNTS * 2000 / 8388608
    np.testing.assert_allclose(record.values, gal - gal.mean(), rtol=0, atol=1e-15 * abs(gal).max())
    assert (record.dt, record.unit) == (0.01, "cm/s^2")
    assert f"the mean, {gal.mean():.6g} cm/s^2, is taken off" == record.note
    np.testing.assert_array_equal(Record.read(tmp_path / name, baseline="none").values, gal)


def test_esm(tmp_path):
    record = Record.read(esm(tmp_path / "IT.AMT..HGE.D.20160824.C.ACC.ASC"))
    np.testing.assert_array_equal(record.values, np.round(VALUES, 6))
    assert (record.dt, record.quantity, record.unit) == (0.005, "acceleration", "cm/s^2")
    assert "CENTRAL_ITALY" in record.source


def test_a_table_may_have_the_ending_of_esm(tmp_path):
    record = Record.read(written(tmp_path / "a.asc", ["time_s\tforce_N", "0\t1", "0.5\t2", "1\t0"]))
    assert (record.quantity, record.unit, record.dt) == ("force", "N", None)
    np.testing.assert_array_equal(record.times, [0, 0.5, 1])


def test_cosmos(tmp_path):
    record = Record.read(written(tmp_path / "a.V2", cosmos()))
    np.testing.assert_array_equal(record.values, np.round(VALUES, 3))
    assert (record.dt, record.quantity, record.unit) == (0.005, "acceleration", "cm/s^2")
    assert "Somewhere" in record.source


@pytest.mark.parametrize("end", ["End-of-data for ChanBNZ", "/&  ----  End of data for channel  1  ----", ""])
def test_ends_of_cosmos_files(tmp_path, end):
    record = Record.read(written(tmp_path / "a.V2c", [*cosmos()[:-1], end]))
    np.testing.assert_array_equal(record.values, np.round(VALUES, 3))


def test_numbers_of_cosmos_may_touch(tmp_path):
    values = np.array([-12345.678, -23456.789, -34567.891])
    record = Record.read(written(tmp_path / "a.v2", cosmos(values=values)))
    np.testing.assert_array_equal(record.values, values)


def test_one_quantity_of_a_cosmos_file(tmp_path):
    file = written(tmp_path / "a.v2", cosmos() + cosmos(2, 5, values=VALUES * 7))
    record = Record.read(file, quantity="velocity")
    np.testing.assert_array_equal(record.values, np.round(VALUES * 7, 3))
    assert record.unit == "cm/s"
    with pytest.raises(InputError, match="acceleration, velocity; give one of them as quantity"):
        Record.read(file)


@pytest.mark.parametrize(
    ("heading", "quantity", "unit"),
    [
        ("acceleration_g", "acceleration", "g"),
        ("acceleration [m/s²]", "acceleration", "m/s^2"),
        ("velocity_m_s", "velocity", "m/s"),
        ("displacement_mm", "displacement", "mm"),
        ("force_kN", "force", "kN"),
    ],
)
def test_tables_name_quantity_and_unit(tmp_path, heading, quantity, unit):
    rows = [f"{40 * k};{str(value).replace('.', ',')}" for k, value in enumerate(VALUES)]
    record = Record.read(written(tmp_path / "a.csv", ["Logger 7", f"time_ms;{heading}", *rows]))
    np.testing.assert_array_equal(record.values, VALUES)
    np.testing.assert_allclose(record.times, 0.04 * np.arange(7), rtol=1e-15)
    assert (record.quantity, record.unit) == (quantity, unit)


def test_a_table_without_units_is_dimensionless(tmp_path):
    record = Record.read(written(tmp_path / "a.csv", ["time,force", "0,1", "0.5,2", "2,0"]))
    assert (record.quantity, record.unit) == ("force", None)
    np.testing.assert_array_equal(record.times, [0, 0.5, 2])


def test_one_column_and_the_step(tmp_path):
    named = written(tmp_path / "a.csv", ["acceleration_g", *map(str, VALUES)])
    bare = written(tmp_path / "b.txt", list(map(str, VALUES)))
    for record in (
        Record.read(named, dt=0.02),
        Record.read(bare, dt=0.02, quantity="acceleration", unit="g"),
    ):
        np.testing.assert_array_equal(record.values, VALUES)
        assert (record.dt, record.unit) == (0.02, "g")


def test_columns_with_other_names(tmp_path):
    file = written(tmp_path / "a.csv", ["t [s],Kanal 3", "0,1", "0.5,2", "1,0"])
    columns = {"force": {"name": "Kanal 3", "unit": "N", "scale": 2.0}}
    record = Record.read(file, columns=columns)
    np.testing.assert_array_equal(record.values, [2, 4, 0])
    assert record.unit == "N"


def test_one_of_several_columns(tmp_path):
    file = written(tmp_path / "a.csv", ["time_s,acceleration_g,velocity_cm_s", "0,1,3", "0.5,2,4", "1,0,5"])
    assert Record.read(file, quantity="velocity").unit == "cm/s"
    with pytest.raises(InputError, match="acceleration, velocity; give one of them as quantity"):
        Record.read(file)


def test_arrays(tmp_path):
    from scipy.io import savemat

    columns = {"time_s": np.arange(7) * 0.01, "acceleration_m_s2": VALUES}
    np.savez(tmp_path / "a.npz", **columns)
    savemat(tmp_path / "a.mat", columns)
    for name in ("a.npz", "a.mat"):
        record = Record.read(tmp_path / name)
        np.testing.assert_array_equal(record.values, VALUES)
        assert record.unit == "m/s^2"


def test_a_line_taken_off(tmp_path):
    rows = [f"{0.1 * k},{3 + 2 * k + (-1) ** k}" for k in range(200)]
    record = Record.read(written(tmp_path / "a.csv", ["time_s,force_N", *rows]), baseline="linear")
    k = np.arange(200)
    found = np.polynomial.Polynomial.fit(k, 3 + 2 * k + (-1.0) ** k, 1)
    np.testing.assert_allclose(record.values, 3 + 2 * k + (-1.0) ** k - found(k), atol=1e-11)
    assert record.note.startswith("a straight line of least squares, from 3.")
    assert abs(record.values.sum()) < 1e-9
    assert abs(record.values @ k) < 1e-7


def test_a_trace_of_miniseed(tmp_path):
    obspy = pytest.importorskip("obspy")
    trace = obspy.Trace(VALUES.astype(np.float64), {"delta": 0.02, "station": "ABC"})
    file = tmp_path / "a.mseed"
    trace.write(str(file), format="MSEED")
    record = Record.read(file, unit="m/s")
    np.testing.assert_array_equal(record.values, VALUES)
    assert (record.dt, record.quantity, record.unit) == (0.02, "velocity", "m/s")
    assert "ABC" in record.source


def test_seismic_files_need_obspy(tmp_path, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "obspy", None)
    (tmp_path / "a.sac").write_bytes(b"\0" * 700)
    with pytest.raises(InputError, match=r"obspy is not installed; run pip install 'frictionmap\[seismic\]'"):
        Record.read(tmp_path / "a.sac", unit="m/s^2")


PEER_COUNT = "NPTS says 8 values; got 7: it is truncated"


@pytest.mark.parametrize(
    ("make", "arguments", "message"),
    [
        (lambda p: peer(p / "a.at2", "NPTS= 8, DT= .01 SEC"), {}, PEER_COUNT),
        (lambda p: peer(p / "a.at2", "NPTS= 6, DT= .01 SEC"), {}, "says 6 values; got 7: it is damaged"),
        (lambda p: peer(p / "a.at2", "NPTS= 7, DT= .0 SEC"), {}, r"must state DT > 0; got DT= \.0"),
        (lambda p: peer(p / "a.at2", "no numbers"), {}, "must state NPTS > 0; got none"),
        (lambda p: peer(p / "a.at2", unit="CM/SEC"), {}, r"is in g, but its header says 'CM/SEC'"),
        (lambda p: peer(p / "a.at2"), {"unit": "m/s^2"}, r"unit must be that of a\.at2, g, or be left out"),
        (lambda p: peer(p / "a.at2"), {"quantity": "velocity"}, "quantity must be that of a.at2, accel"),
        (lambda p: peer(p / "a.at2"), {"dt": 0.1}, "cannot use dt with a.at2: the file states it itself"),
        (lambda p: peer(p / "a.at2"), {"baseline": "cubic"}, "baseline must be one of none, mean, linear"),
        (lambda p: peer(p / "a.at3"), {}, "file must end in .AT2"),
        (lambda p: p / "none.at2", {}, "cannot read .*none.at2: No such file"),
        (lambda p: written(p / "a.at2", ["x"] * 3), {}, "4 lines of header and then values; got 3 lines"),
        (lambda p: knet(p / "a.ns", COUNTS[:50], KNET.replace("(s)  1", "(s)  2")), {}, "it is truncated"),
        (lambda p: knet(p / "a.ns", head=KNET.replace("2000(gal)", "?")), {}, "must state Scale Factor"),
        (lambda p: knet(p / "a.ns", head=KNET.replace("100Hz", "0Hz")), {}, r"Sampling Freq\(Hz\) > 0"),
        (lambda p: written(p / "a.ew", ["1 2 3"] * 30), {}, "the first one 'Origin Time'"),
        (lambda p: esm(p / "a.asc", 9), {}, "NDATA says 9 values; got 7: it is truncated"),
        (lambda p: esm(p / "a.asc", unit="s"), {}, "UNITS must be one of .*; got 's'"),
        (lambda p: esm(p / "a.asc", kind="VELOCITY"), {}, r"DATA_TYPE must agree with UNITS cm/s\^2"),
        (lambda p: written(p / "a.v2", cosmos(count=9)), {}, "says 9 values; got 7: it is truncated"),
        (lambda p: written(p / "a.v2", cosmos(unit=50)), {}, "got type 1 and unit 50"),
        (lambda p: written(p / "a.v2", cosmos(ms=0.0)), {}, "the sample interval, must be > 0; got 0"),
        (lambda p: written(p / "a.v2", cosmos()[:20]), {}, "it is truncated"),
        (lambda p: written(p / "a.v2", ["1 2 3"]), {}, "a COSMOS file begins with"),
        (lambda p: written(p / "a.v2", cosmos() + cosmos()), {}, "save its channels in files of their own"),
        (lambda p: written(p / "a.mseed", ["x"]), {}, "unit must be given for a.mseed"),
    ],
)  # fmt: skip
def test_refused_files(tmp_path, make, arguments, message):
    with pytest.raises(InputError, match=message) as error:
        Record.read(make(tmp_path), **arguments)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("lines", "arguments", "message"),
    [
        (["time_s,force_N", "0,1", "0.1,nan"], {}, "force_N, line 3 must be a finite number; got 'nan'"),
        (["time_s,force_N", "0,1", "0.1,2", "0.1,2"], {}, "line 4 must be > 0.1, the time of the previous"),
        (["time_s,force_N", "0,1"], {}, "at least 2 samples; got 1"),
        (["time_s,force_mm", "0,1", "1,2"], {}, "its name must end in a unit"),
        (["time_s,force", "0,1", "1,2"], {}, "column time is missing; the file has time_s"),
        (["force_N", "1", "2"], {}, "it has no times; give dt, or write a column time_s"),
        (["time_s,force_N", "0,1", "1,2"], {"dt": 0.1}, "cannot use dt with column time_s"),
        (["time_s,x_mm", "0,1", "1,2"], {}, "it must have a column acceleration_g"),
        (["1", "2", "3"], {"dt": 0.1}, "its column has no name"),
        (["time_s,force_N", "0,1", "1,2"], {"unit": "kN"}, "unit must be that of column force_N, N"),
        (["time_s,force_N", "0,1", "1,2"], {"unit": "parsec"}, "unit must be one of"),
        (["time_s,force_N", "0,1", "1,2"], {"columns": {"x": "force_N"}}, "columns must name time, force"),
        (["time_s,force_N", "0,1", "1,2"], {"columns": {"force": "f"}}, "named by record.columns.force"),
    ],
)  # fmt: skip
def test_refused_tables(tmp_path, lines, arguments, message):
    with pytest.raises(InputError, match=message) as error:
        Record.read(written(tmp_path / "a.csv", lines), **arguments)
    assert "\n" not in str(error.value)
    assert "data.columns" not in str(error.value)


@pytest.mark.parametrize("unit", ["mm", "parsec", 3])
def test_units_of_another_kind(unit):
    with pytest.raises(
        InputError, match=r"unit must be one of m/s\^2, .* for this quantity, acceleration; got"
    ):
        Record(VALUES, 0.1, unit=unit)


def test_a_unit_of_another_kind_names_its_quantity():
    with pytest.raises(InputError, match=r"it is a unit of force; give quantity = .force.$"):
        Record(VALUES, 0.1, unit="N")
    assert Record(VALUES, 0.1, unit="N", quantity="force").unit == "N"
