"""miniSEED and SAC files, through obspy of the extra `seismic`.

Neither states the unit of its values: they are counts until somebody has divided them by the response of the
instrument.  The unit must therefore be given.
"""

from pathlib import Path

import numpy as np

from ...errors import InputError
from ...packages import package, read_by
from ...units.table import UNITS, known_unit
from .series import Series, shortened

ENDINGS = (".mseed", ".miniseed", ".sac")

_QUANTITIES = {
    "acceleration": "acceleration", "velocity": "velocity", "length": "displacement", "force": "force",
}  # fmt: skip


def read_seismic(path: Path, unit: str | None) -> Series:
    """Read the only trace of a file; its quantity follows from the unit."""
    known = known_unit(unit) if isinstance(unit, str) else None
    if known is None or UNITS[known].measures not in _QUANTITIES:
        raise InputError(
            "unit",
            f"must be given for {path.name}, which does not state it, such as 'm/s^2' once the response of "
            f"the instrument is removed; got {unit!r}",
        )
    obspy = package("obspy", path, "seismic")
    traces = read_by(path, "miniSEED or SAC file", lambda: list(obspy.read(str(path))))
    if len(traces) != 1:
        names = ", ".join(trace.id for trace in traces[:8])
        raise InputError(
            f"cannot read {path}: it must hold one trace without gaps; got {len(traces)}: {names}; save the "
            "channel in a file of its own, and its gaps filled"
        )
    values: np.ndarray = np.ma.masked_invalid(np.ma.asarray(traces[0].data, dtype=float))
    if np.ma.is_masked(values):
        raise InputError(f"cannot read {path}: it has gaps or values that are not finite; fill them")
    stats = traces[0].stats
    said = shortened([str(traces[0].id), str(stats.starttime)])
    quantity = _QUANTITIES[UNITS[known].measures]
    return Series(np.asarray(values), float(stats.delta), None, quantity, known, said)
