"""Files of measuring programs: UFF/UNV (set 58) and TDMS, through packages of the extra `lab`.

Columns are named by what the file says, with the unit that it gives; where it gives none, none is made up.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InputError
from ...packages import package, read_by
from ...units.table import COLUMN_UNITS
from .headings import heading

#: Columns by their names.
Columns = dict[str, np.ndarray]

#: Data types of a set 58, and its functions: a record over time, a frequency response.
_TIME, _FREQUENCY = 17, 18
_RECORD, _RESPONSE = 1, 4

#: Columns of the abscissa.
_AXES = {_TIME: "time_s", _FREQUENCY: "frequency_Hz"}

#: What other functions of a set 58 are called.
_FUNCTIONS = {
    0: "general functions", 1: "complex time histories", 2: "auto spectra", 3: "cross spectra",
    4: "frequency responses", 5: "transmissibilities", 6: "coherences", 7: "auto correlations",
    8: "cross correlations", 9: "power spectral densities", 10: "energy spectral densities",
    11: "probability densities", 12: "spectra",
}  # fmt: skip


def read_uff(path: Path) -> tuple[Columns, dict[str, str]]:
    """Sets 58 of a universal file: records over time, or frequency responses of like over like.

    A response is X_k over its reference: amplitude_ratio_k and phase_lag_k_deg, k the node of the response.
    Records with the same label have node and direction in their names, such as Acceleration 1:X+_m/s2; these,
    such as 1:X+, are other names of all records.
    """
    pyuff = package("pyuff", path, "lab")
    sets = read_by(path, "universal file", lambda: pyuff.UFF(str(path)).read_sets())
    sets = [one for one in (sets if isinstance(sets, list) else [sets]) if one.get("type") == 58]
    if not sets:
        raise InputError(f"cannot read {path}: it has no set 58; export a record or a frequency response")
    labels = [_label(one) for one in sets]
    columns: Columns = {}
    aliases: dict[str, str] = {}
    for one, label in zip(sets, labels, strict=True):
        point = _point(one)
        for name, values in _columns_of_set_58(one, f"{label} {point}" if labels.count(label) > 1 else label):
            if name in columns and not np.array_equal(columns[name], values):
                raise InputError(
                    f"cannot read {path}: its sets 58 have different columns {name}; export one of them"
                )
            columns[name] = values
            if one["func_type"] == _RECORD and name != _AXES[_TIME]:
                aliases[name] = point
    if not columns:
        kinds = ", ".join(dict.fromkeys(_FUNCTIONS.get(one["func_type"], "unknown") for one in sets))
        raise InputError(
            f"cannot read {path}: its sets 58 are {kinds}, neither time histories nor frequency responses of "
            "like over like; export the time histories"
        )
    return columns, aliases


def _label(one: dict[str, Any]) -> str:
    return _text(one["ordinate_axis_lab"]) or _text(one["id1"]) or f"node_{one['rsp_node']}"


def _point(one: dict[str, Any]) -> str:
    """Node and direction of a response, such as 1:X+."""
    direction = int(one["rsp_dir"])
    axis = ("", "X", "Y", "Z", "RX", "RY", "RZ")[abs(direction)] if abs(direction) <= 6 else ""
    return f"{one['rsp_node']}:{axis}{'-' if direction < 0 else '+'}" if axis else f"{one['rsp_node']}"


def _columns_of_set_58(one: dict[str, Any], label: str) -> Iterator[tuple[str, np.ndarray]]:
    """Columns of a set 58."""
    axis = _AXES.get(one["abscissa_spec_data_type"])
    kinds = one["ordinate_spec_data_type"], one["orddenom_spec_data_type"]
    if axis is None or one["func_type"] not in (_RECORD, _RESPONSE):
        return
    data = np.asarray(one["data"])
    if one["func_type"] == _RECORD and not np.iscomplexobj(data):
        yield axis, np.asarray(one["x"], dtype=float)
        yield _with_unit(label, _text(one["ordinate_axis_units_lab"])), data
    elif one["func_type"] == _RESPONSE and kinds[0] == kinds[1]:
        yield axis, np.asarray(one["x"], dtype=float)
        yield f"amplitude_ratio_{one['rsp_node']}", np.abs(data)
        yield f"phase_lag_{one['rsp_node']}_deg", -np.degrees(np.angle(data))


def read_tdms(path: Path) -> Columns:
    """Channels of a LabVIEW file; a waveform without a channel of times gets its own, time_s."""
    tdms = package("nptdms", path, "lab")

    def read() -> Columns:
        columns: Columns = {}
        for group in tdms.TdmsFile.read(path).groups():
            for channel in group.channels():
                name = _with_unit(channel.name, _text(channel.properties.get("unit_string")))
                columns[f"{group.name}/{name}" if name in columns else name] = np.asarray(channel[:])
                if "wf_increment" in channel.properties:
                    columns.setdefault("time_s", channel.time_track())
        return columns

    return read_by(path, "TDMS file", read)


def _text(value: object) -> str:
    """A text of a file; what stands for none is empty."""
    text = str(value).strip() if value is not None else ""
    return "" if text.upper() == "NONE" else text


def _with_unit(name: str, unit: str) -> str:
    """A name that ends in its unit, if one is known; it may do so already."""
    return name if heading(name).unit in COLUMN_UNITS or not unit else f"{name}_{unit}"
