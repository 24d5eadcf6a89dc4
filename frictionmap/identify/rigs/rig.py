"""Configuration of measured data, and the properties of a kind of data."""

from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import xarray as xr

from ...files.config import unknown_key
from ...files.key import Key, number, several, word
from ...model.system import DAMPING_REFERENCES
from ...units.table import conversion
from ..parameters import PARAMETERS, Parameter
from ..statistics.robust import LOSSES
from ..tables.choices import Choice
from ..tables.columns import Columns, unused_columns
from ..tables.files import Table


class Rig(NamedTuple):
    """A checked configuration; values that depend on the kind of data are checked where they are used."""

    title: str
    kind: str
    file: Path
    columns: Mapping[str, str]  # names in the file, by what the column is, once the file is read
    choices: Mapping[str, Choice]  # what [data] says about columns
    decimal: str | None  # decimal sign of a text file; None: as its numbers show it
    data: Mapping[str, object]  # what else [data] says
    missing: str
    system: Mapping[str, object]
    known: Mapping[str, float]  # in Hz, mm, s, N/m
    free: tuple[str, ...] | None  # None: by kind
    fit: Mapping[str, object]  # what else [fit] says
    text: str
    name: str  # of the configuration, without its ending
    files: tuple[Path, ...]


#: Keys of [system] of one mass, or a chain, on a shaken base.
BASE = Key("excitation", "kind of excitation", word("base"), "base")
REFERENCE = Key(
    "damping_reference", "damping acts on velocities relative to the ground, or relative to the base",
    word(*DAMPING_REFERENCES), DAMPING_REFERENCES[0],
)  # fmt: skip

#: Keys of [data] and [fit] of several kinds.
WINDOW = Key("window", "time window to be fitted, s", several(number(), 2, maxItems=2),
             example="[0.5, 4.0]", words="[begin, end]")  # fmt: skip
SIGMA_PHASE = Key(
    "sigma_phase_deg", "standard error of phase lags; default: from the residuals", number(above=0.0),
    example="1.0",
)  # fmt: skip
SIGMA_AMPLITUDE = Key(
    "sigma_amplitude", "relative standard error of amplitudes; default: from the residuals",
    number(above=0.0), example="0.02",
)  # fmt: skip
LOSS = Key("loss", "loss function: soft_l1 gives little weight to outliers", word(*LOSSES), LOSSES[0])

#: Scales of the results, further keys of [known].
BASE_AMPLITUDE = {
    "base_mm": Parameter("base amplitude Y for which beta = x_F/Y is reported, mm", "1.75", "mm")
}
STIFFNESS = {"stiffness": Parameter("spring stiffness, N/m: gives the friction force in N", "1191.0", "N/m")}

#: Numbers of [known] of one mass by their keys.
_NUMBERS = PARAMETERS | BASE_AMPLITUDE | STIFFNESS


def named(*names: str) -> dict[str, Parameter]:
    """Parameters of one mass, or of a structure with friction, by their names."""
    return {name: PARAMETERS[name] for name in names}


def in_unit(known: Mapping[str, float], unit: str) -> dict[str, float]:
    """Numbers of [known], lengths in the unit of the data."""
    scale = conversion("mm", unit)
    return {key: value * scale if _NUMBERS[key].unit == "mm" else value for key, value in known.items()}


class Kind(NamedTuple):
    """A kind of data: its keys, and the function that fits it.

    A further kind is a file like `decay`, and an entry of `configuration.KINDS`: the schema, the manual, the
    template and the checks of configurations follow from it.
    """

    identify: Callable[[Rig, Table], xr.Dataset]
    parameters: Mapping[str, Parameter]  # that [known] may hold and fit.free may name
    known: Mapping[str, Parameter] = {}  # further keys of [known]
    data: tuple[Key, ...] = ()  # further keys of [data]
    fit: tuple[Key, ...] = ()  # further keys of [fit]
    system: tuple[Key, ...] = ()  # of the table [system]; none: there is no such table
    needs_system: bool = False
    examples: Mapping[str, str] = {}  # of keys whose example is another one than for other kinds
    lists: tuple[Key, ...] = ()  # further keys of [known], which hold lists of numbers
    optional: tuple[str, ...] = ()  # parameters that may be neither known nor free

    @property
    def numbers(self) -> dict[str, Parameter]:
        """All keys of [known]; as text their values may be in another unit of the same kind."""
        return {**self.parameters, **self.known}


def check_columns(rig: Rig, valid: Sequence[str]) -> None:
    """Refuse unknown roles in data.columns."""
    for key in rig.columns:
        if key not in valid:
            raise unknown_key(key, "data.columns", tuple(valid))


def with_remarks(ds: xr.Dataset, table: Table, picked: Columns, known_of: Collection[str] = ()) -> xr.Dataset:
    """Put remarks about the table before the warnings of the dataset.

    known_of : columns that the configuration leaves out itself, or that are no numbers; they are not named
    """
    used = {column.name for column in picked.columns.values()} | set(known_of)
    remarks = (
        table.remark, picked.remark, _dropped_rows(table, picked), unused_columns(table, used),
        ds.attrs["warnings"],
    )  # fmt: skip
    ds.attrs["warnings"] = "; ".join(filter(None, remarks))
    return ds


def _dropped_rows(table: Table, picked: Columns) -> str:
    """Warning of ignored rows, or empty."""
    if not picked.dropped:
        return ""
    total = picked.dropped + picked.rows.size
    return f"{picked.dropped} of {total} rows of {table.file.name} have no number and were ignored"
