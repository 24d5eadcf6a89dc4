"""Files of measuring programs: UFF/UNV (set 58) and TDMS, through packages of the extra `lab`.

Columns are named by what the file says, with the unit that it gives; where it gives none, none is made up.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InputError
from ...packages import package, read_by
from ...units.table import COLUMN_UNITS, ending

#: Columns by their names.
Columns = dict[str, np.ndarray]

#: Data types of a set 58, and its functions: a record over time, a frequency response.
_TIME, _FREQUENCY = 17, 18
_RECORD, _RESPONSE = 1, 4


def read_uff(path: Path) -> Columns:
    """Sets 58 of a universal file: records over time, or frequency responses of like over like.

    A response is X_k over its reference: amplitude_ratio_k and phase_lag_k_deg, k the node of the response.
    """
    pyuff = package("pyuff", path, "lab")
    sets = read_by(path, "universal file", lambda: pyuff.UFF(str(path)).read_sets())
    sets = [one for one in (sets if isinstance(sets, list) else [sets]) if one.get("type") == 58]
    if not sets:
        raise InputError(f"cannot read {path}: it has no set 58; export a record or a frequency response")
    columns: Columns = {}
    for one in sets:
        for name, values in _columns_of_set_58(one):
            if name in columns and not np.array_equal(columns[name], values):
                raise InputError(
                    f"cannot read {path}: its sets 58 have different columns {name}; export one of them"
                )
            columns[name] = values
    return columns


def _columns_of_set_58(one: dict[str, Any]) -> Iterator[tuple[str, np.ndarray]]:
    """Columns of a set 58."""
    axis = {_TIME: "time_s", _FREQUENCY: "frequency_Hz"}.get(one["abscissa_spec_data_type"])
    kinds = one["ordinate_spec_data_type"], one["orddenom_spec_data_type"]
    if axis is None or one["func_type"] not in (_RECORD, _RESPONSE):
        return
    data = np.asarray(one["data"])
    if one["func_type"] == _RECORD and not np.iscomplexobj(data):
        label = _text(one["ordinate_axis_lab"]) or _text(one["id1"])
        yield axis, np.asarray(one["x"], dtype=float)
        yield _with_unit(label or f"node_{one['rsp_node']}", _text(one["ordinate_axis_units_lab"])), data
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
    return name if ending(name) in COLUMN_UNITS or not unit else f"{name}_{unit}"
