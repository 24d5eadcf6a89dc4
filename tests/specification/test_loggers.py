"""One record as measuring programs write it: read right, or refused with a line that helps when pasted."""

import json
import re

import numpy as np
import pytest

import frictionmap as fm
from frictionmap.errors import InputError
from frictionmap.identify.rigs.configuration import load_rig
from frictionmap.identify.tables.choices import chosen
from frictionmap.identify.tables.columns import pick_columns
from frictionmap.identify.tables.files import read_table

#: The record: 0.5 s at 200 Hz, displacements in mm.
RATE = 200
TIME = np.arange(100) / RATE
X = 10.0 * np.exp(-2.0 * TIME) * np.cos(40.0 * TIME)
BASE = 2.0 * np.sin(40.0 * TIME)


def rows(*columns, decimals=6, separator=",", comma=False, end=""):
    lines = []
    for values in zip(*columns, strict=True):
        fields = [one if isinstance(one, str) else f"{one:.{decimals}f}" for one in values]
        lines.append(separator.join(field.replace(".", ",") if comma else field for field in fields) + end)
    return lines


def clocks(times, date="", start=36000.0, mark="."):
    """Times of day; the record may begin before midnight."""
    texts = []
    for one in times:
        ms = round((start + one) * 1000) % 86400000
        texts.append(
            f"{date}{ms // 3600000:02d}:{ms // 60000 % 60:02d}:{ms // 1000 % 60:02d}{mark}{ms % 1000:03d}"
        )
    return texts


def text(head, lines, before=(), after=()):
    return "\n".join([*before, head, *after, *lines]) + "\n"


SEMI = {"separator": ";"}

#: Files that are read as they are: name, content.
READ = {
    "suffixes.csv": text("time_s,x_mm", rows(TIME, X)),
    "brackets.csv": text("Time [s],X [mm]", rows(TIME, X)),
    "parentheses.csv": text("Time (s),x (mm)", rows(TIME, X)),
    "german.csv": text("Zeit/s;x/mm", rows(TIME, X, comma=True, **SEMI)),
    "short-time.csv": text("t [ms];X [µm]", rows(1e3 * TIME, 1e3 * X, **SEMI)),
    "minutes.csv": text("time (min),x (m)", rows(TIME / 60.0, X / 1e3, decimals=12)),
    "inches.csv": text("time (s)\tx (in)", rows(TIME, X / 25.4, decimals=8, separator="\t")),
    "feet.txt": text("Time [sec]\tx [ft]", rows(TIME, X / 304.8, decimals=9, separator="\t")),
    "centimetres.dat": text("time_s x_cm", rows(TIME, X / 10.0, decimals=7, separator=" ")),
    "blanks.asc": text("time_s    x_mm", rows(TIME, X, separator="    ")),
    "bars.csv": text("time_s|x_mm", rows(TIME, X, separator="|")),
    "excel.csv": text("time_s;x_mm", rows(TIME, X, **SEMI), before=["sep=;"]),
    "quoted-excel.csv": text("time_s,x_mm", rows(TIME, X), before=['"sep=,"']),
    "preamble.csv": text(
        "time_s,x_mm", rows(TIME, X),
        before=["Logger 3000", "Serial: 12-345", "", "Rate, 200 Hz", "Channels, 2"],
    ),
    "long-preamble.csv": text(
        "Time (s);Channel 1 (N);x (mm)", rows(TIME, BASE, X, **SEMI),
        before=[f"Setting {k}: {k}" for k in range(60)],
    ),
    "comments.csv": text("time_s,x_mm", rows(TIME, X), before=["# a logger", "# rate 200 Hz"]),
    "numpy.txt": text("# time_s x_mm", rows(TIME, X, separator=" ", decimals=12)),
    "units-below.csv": text("Time;x", rows(TIME, X, **SEMI), after=["s;mm"]),
    "units-below-brackets.csv": text("Time,x", rows(TIME, X), after=["(s),(mm)"], before=["Instrument: X"]),
    "quoted-commas.csv": text(
        '"time_s","x_mm"',
        [",".join(f'"{one:.6f}"'.replace(".", ",") for one in pair) for pair in zip(TIME, X, strict=True)],
    ),
    "quoted-names.csv": text('"Time [s]","x [mm]"', rows(TIME, X)),
    "empty-columns.csv": text("time_s;x_mm;;", rows(TIME, X, end=";;", **SEMI)),
    "trailing-marks.csv": text("time_s,x_mm", rows(TIME, X, end=",")),
    "empty-end.csv": text("time_s,x_mm", [*rows(TIME, X), "", ""]),
    "other-columns.csv": text("time_s,F [N],x_mm,label", [f"{line},a" for line in rows(TIME, BASE, X)]),
    "clock.csv": text("time,x_mm", rows(clocks(TIME), X)),
    "clock-comma.csv": text("Time;x (mm)", rows(clocks(TIME, mark=","), X, comma=True, **SEMI)),
    "midnight.csv": text("time,x_mm", rows(clocks(TIME, start=86399.75), X)),
    "iso.csv": text("time,x_mm", rows(clocks(TIME, date="2024-05-31T"), X)),
    "iso-blank.csv": text("Time;x [mm]", rows(clocks(TIME, date="2024-05-31 "), X, **SEMI)),
    "dates.csv": text("time,x_mm", rows(clocks(TIME, date="31.05.2024 "), X)),
    "exponents.csv": text("time_s,x_mm", [f"{t:.6E},{x:.9E}" for t, x in zip(TIME, X, strict=True)]),
}  # fmt: skip

#: Files that are refused at first: the message has a line that, pasted below [data], makes them right.
PASTED = {
    "weg.csv": text("Zeit [s];Weg [mm]", rows(TIME, X, comma=True, **SEMI)),
    "disp.csv": text("Time (s),Disp (mm)", rows(TIME, X)),
    "no-unit.csv": text("time_s,x", rows(TIME, X)),
    "no-units.csv": text("time,x", rows(TIME, X)),
    "unknown-unit.csv": text("time_s,x [milli]", rows(TIME, X)),
    "channels.csv": text("time_s,Channel 1", rows(TIME, X)),
    "two-places.csv": text("time_s,x_left_mm,x_right_mm", rows(TIME, X, BASE)),
    "volts.csv": text("time_s,x [V]", rows(TIME, X)),
}

_LINE = re.compile(r"(columns = \{.*\}|decimal = \"[.,]\")")


def read(path, lines):
    """Times and displacements of a file, as `identify` reads them."""
    config = path.parent / "rig.toml"
    config.write_text(
        f'[data]\nkind = "free-decay"\nfile = "{path.name}"\n' + "\n".join(lines), encoding="utf-8"
    )
    rig = load_rig(config)
    table, names = chosen(read_table(path, rig.decimal), rig.choices)
    picked = pick_columns(table, {"time": "time", "x": "length"}, names, rig.missing)
    time, x = picked.columns["time"], picked.columns["x"]
    scale = {"mm": 1.0, "m": 1e3, "um": 1e-3, "in": 25.4, "cm": 10.0, "ft": 304.8}[x.unit]
    seconds = {"s": 1.0, "ms": 1e-3, "min": 60.0}[time.unit]
    return time.values * seconds, x.values * scale, table.remark


def refusal(path, lines):
    try:
        read(path, merged(lines))
    except InputError as error:
        return str(error)
    return ""


def merged(lines):
    """Several lines `columns = ..` as one, as a table of TOML may stand only once."""
    inner = [line[len("columns = {") : -1].strip() for line in lines if line.startswith("columns")]
    others = [line for line in lines if not line.startswith("columns")]
    return [*others, *(["columns = { " + ", ".join(inner) + " }"] if inner else [])]


@pytest.mark.parametrize("name", READ)
def test_files_are_read_as_they_are(tmp_path, name):
    (tmp_path / name).write_text(READ[name], encoding="utf-8")
    time, x, _ = read(tmp_path / name, [])
    np.testing.assert_allclose(time, TIME, atol=2e-6)
    np.testing.assert_allclose(x, X, atol=2e-6)


@pytest.mark.parametrize("name", PASTED)
def test_a_refusal_holds_the_line_to_paste(tmp_path, name):
    (tmp_path / name).write_text(PASTED[name], encoding="utf-8")
    lines = []
    while (message := refusal(tmp_path / name, lines)) and len(lines) < 3:
        lines += _LINE.findall(message)
    assert lines
    time, x, _ = read(tmp_path / name, merged(lines))
    np.testing.assert_allclose(time, TIME, atol=2e-6)
    np.testing.assert_allclose(x, X, atol=2e-6)


def test_commas_between_thousands_or_decimals(tmp_path):
    """With a point in other numbers 1,234 may be either: it is asked, not guessed."""
    path = tmp_path / "data.csv"
    path.write_text(text("time_s;x_mm", [f"{t:.3f};{1234 + k // 2:,d}" for k, t in enumerate(TIME)]))
    with pytest.raises(InputError, match=r'decimal = "," or decimal = "\.'):
        read(path, [])
    with pytest.raises(InputError, match=r"must be a finite number; got '1,234'"):
        read(path, ['decimal = "."'])


def test_dates_that_change_are_read_year_first_only(tmp_path):
    path = tmp_path / "data.csv"
    stamps = [*clocks(TIME[:50], "01/02/2024 ", 86399.75), *clocks(TIME[50:], "02/02/2024 ", 86399.75)]
    path.write_text(text("time,x_mm", rows(stamps, X)))
    with pytest.raises(InputError, match="write dates as 2024-05-31"):
        read(path, [])
    path.write_text(path.read_text().replace("01/02/2024", "2024-02-01").replace("02/02/2024", "2024-02-02"))
    time, _, _ = read(path, [])
    np.testing.assert_allclose(time, TIME, atol=1e-9)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252", "latin-1"])
def test_encodings(tmp_path, encoding):
    path = tmp_path / "data.csv"
    path.write_bytes(
        text("Zeit [s];x [µm];Größe [°]", rows(TIME, 1e3 * X, X, comma=True, **SEMI)).encode(encoding)
    )
    _, x, _ = read(path, [])
    np.testing.assert_allclose(x, X, atol=2e-6)


def test_what_is_not_read_is_said(tmp_path):
    path = tmp_path / "preamble.csv"
    path.write_text(READ["preamble.csv"])
    assert read(path, [])[2] == "4 lines above the names of preamble.csv are not read: 'Logger 3000', .."


def test_a_calibration(tmp_path):
    """value = scale * (number in the file) + offset, in the unit."""
    path = tmp_path / "data.csv"
    path.write_text(text("time_s,Weg [V]", rows(TIME, (X - 2.5) / 4.0, decimals=9)))
    _, x, _ = read(path, ['columns = { x = { name = "Weg", unit = "mm", scale = 4.0, offset = 2.5 } }'])
    np.testing.assert_allclose(x, X, atol=1e-7)


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ('{ x = { unit = "furlong" } }', "data.columns.x.unit must be one of Hz, kHz"),
        ("{ x = { scale = 0.0 } }", "data.columns.x.scale must not be 0"),
        ('{ x = { scale = "4" } }', "data.columns.x.scale must be a number"),
        ('{ x = { names = "Weg" } }', "unknown key 'data.columns.x.names' (did you mean name?)"),
        ("{ x = 3 }", "data.columns must be a table of column names"),
        ('{ x = { name = "" } }', "data.columns.x.name must be text"),
    ],
)
def test_bad_choices(tmp_path, columns, message):
    path = tmp_path / "data.csv"
    path.write_text(READ["suffixes.csv"])
    with pytest.raises(InputError, match=re.escape(message)):
        read(path, [f"columns = {columns}"])


def test_rounded_times_are_equidistant(tmp_path):
    """Times written with two decimals at 200 Hz repeat; the step is known to the last digit there is."""
    path = tmp_path / "data.csv"
    time, x = np.arange(2000) / RATE + 0.0013, np.tile(X, 20)
    path.write_text(text("time_s,x_mm", [f"{t:.2f},{v:.6f}" for t, v in zip(time, x, strict=True)]))
    found, _, _ = read(path, [])
    assert np.abs(np.diff(found) - 1.0 / RATE).max() < 0.01 / 2000
    assert np.abs(found - time).max() < 0.01


def test_one_repeated_time_is_refused(tmp_path):
    """It is a mistake, not a rounding."""
    path = tmp_path / "data.csv"
    time = TIME.copy()
    time[40] = time[39]
    path.write_text(text("time_s,x_mm", rows(time, X)))
    config = tmp_path / "rig.toml"
    config.write_text('[data]\nkind = "free-decay"\nfile = "data.csv"\n')
    with pytest.raises(InputError, match=r"must be > 0\.195"):
        fm.identify.rigs.configuration.identify(load_rig(config))


def test_json_and_structures_of_matlab(tmp_path):
    from scipy.io import savemat

    nested = {"run": {"time_s": TIME.tolist(), "x_mm": X.tolist(), "rate": RATE}}
    (tmp_path / "columns.json").write_text(json.dumps(nested["run"]))
    records = [{"time_s": t, "x_mm": x} for t, x in zip(TIME, X, strict=True)]
    (tmp_path / "records.json").write_text(json.dumps(records))
    (tmp_path / "nested.json").write_text(json.dumps(nested))
    savemat(tmp_path / "struct.mat", {"run": {"time_s": TIME, "x_mm": X}})
    for name in ("columns.json", "records.json"):
        np.testing.assert_allclose(read(tmp_path / name, [])[1], X)
    for name in ("nested.json", "struct.mat"):
        columns = 'columns = { time = "run.time_s", x = "run.x_mm" }'
        np.testing.assert_allclose(read(tmp_path / name, [columns])[1], X)


def test_a_spectrum_is_named(tmp_path):
    path = tmp_path / "data.csv"
    path.write_text(text("frequency_Hz,x_mm", rows(TIME, X)))
    with pytest.raises(InputError, match="it is a spectrum or a response; export the time history"):
        read(path, [])
