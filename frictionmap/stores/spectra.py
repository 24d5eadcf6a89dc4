"""Friction response spectra as the contents of a store.

A row is one period; a block has complete rows under one record.  The store holds the samples of the records,
from which workers read those of their own blocks.
"""

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
import xarray as xr

from .. import checks
from ..datasets.motion_labels import NOT_COMPUTED, STATUSES
from ..datasets.provenance import quoted, value_text
from ..motions.lanes import Grid, parts_of
from ..motions.origins import record_attributes
from ..motions.pieces import Pieces
from ..motions.record import Record
from ..motions.spectra import DIMS, VARIABLES, Asked, computed, load_of
from .contents import BLOCK_CELLS, Batch, Contents, Cut

#: Seconds of a sample of one oscillator: eight at a time, and by the general engine.
_SECONDS = {False: 3e-8, True: 3e-6}

#: What of a record is stored as arrays; the rest but the words about it is text.
_ARRAYS = ("values", "time", *(f"series_{name}" for name in Pieces._fields))
_WORDS = ("source", "note")

_GROUP = "records"

#: Statuses of spectra in a store.
_STATUSES = (*STATUSES[:4], STATUSES[NOT_COMPUTED])


class _Stored(Sequence[Record]):
    """Records in a store; samples are read when a record is asked for, and not kept."""

    def __init__(self, keys: Sequence[Mapping[str, Any]], arrays: Mapping[str, np.ndarray]) -> None:
        self._keys, self._arrays = keys, arrays

    def __len__(self) -> int:
        return len(self._keys)

    def __getitem__(self, k: Any) -> Any:
        k = range(len(self))[k]
        keys = {name: value for name, value in self._keys[k].items() if name != "sha256"}
        names = {name: f"{_GROUP}/{k + 1}_{name}" for name in _ARRAYS}
        given: dict[str, Any] = {
            name: np.asarray(self._arrays[place]) for name, place in names.items() if place in self._arrays
        }
        series = [given.pop(name) for name in _ARRAYS if name.startswith("series_") and name in given]
        return Record(**keys, **given, series=Pieces(*series) if series else None)


@dataclass(frozen=True)
class Spectra(Contents):
    """Spectra under one record or many.

    records : read one by one, so that they need not be in memory
    asked : all else; its grid has the first record only
    names : variables to store
    """

    kind: ClassVar[str] = "spectrum"
    row_axis: ClassVar[str] = "period"
    described_in: ClassVar[str] = "described"
    hashes_data: ClassVar[bool] = False

    records: Sequence[Record]
    asked: Asked
    names: tuple[str, ...]
    config: str = ""
    block_cells: int = BLOCK_CELLS
    cut: Cut | None = None

    @property
    def _grid(self) -> Grid:
        return self.asked.grid

    @classmethod
    def stored(cls, text: str, arrays: Mapping[str, np.ndarray]) -> "Spectra":
        """Spectra by their description."""
        from ..files.config import parse  # knows all tables, which no cell comes from

        tree = parse(text)
        given, names = dict(tree["spectrum"]), tuple(tree["names"])
        records = _Stored(tree["records"], arrays)
        stiffness = given.pop("contact_stiffness", None)
        axes = {name: np.array(given[name], dtype=float) for name in ("scale", "mu", "period", "friction")}
        return cls(records, Asked(Grid((records[0],), **axes, damping=given["damping"]), stiffness), names)

    def description(self, title: str) -> str:
        """Axes, settings, and every record with the checksum of its samples."""
        grid = self._grid
        axes = {name: getattr(grid, name).tolist() for name in ("scale", "mu", "period", "friction")}
        further = {} if self.asked.stiffness is None else {"contact_stiffness": self.asked.stiffness}
        given = {**axes, "damping": grid.damping, **further}
        lines = [f"title = {quoted(title)}", f"names = {value_text(self.names)}", "[spectrum]"]
        lines += [f"{key} = {value_text(value)}" for key, value in given.items()]
        for record in self.records:
            lines += [
                "[[records]]",
                *(f"{key} = {value_text(value)}" for key, value in _keys(record).items()),
            ]
        return "\n".join(lines) + "\n"

    def attributes(self) -> dict[str, Any]:
        """What spectra say of themselves, and the configuration of a command."""
        config = {"config": self.config} if self.config else {}
        return {"damping": self._grid.damping, **config, **record_attributes(None, self.records)}

    def arrays(self) -> Iterator[tuple[str, np.ndarray]]:
        """The samples of the records."""
        for k, record in enumerate(self.records):
            for name, values in _arrays(record).items():
                yield f"{_GROUP}/{k + 1}_{name}", values

    @property
    def outer(self) -> dict[str, int]:
        """The records."""
        return {"record": len(self.records)}

    @property
    def row_count(self) -> int:
        """Number of periods."""
        return self._grid.period.size

    @property
    def row_cells(self) -> int:
        """Oscillators of one period under one record."""
        return self._grid.scale.size * self._grid.mu.size * self._grid.friction.size

    @property
    def sizes(self) -> dict[str, int]:
        """The axes."""
        return dict(zip(DIMS, (len(self.records), *self._grid.shape[1:]), strict=True))

    @cached_property
    def sample(self) -> xr.Dataset:
        """One oscillator under a short record."""
        first, last = self._grid.records[0], self._grid.period[-1:]
        step = float(last[0]) if np.isfinite(last[0]) else 1.0
        short = Record(
            [0.0, 1.0, 0.0], step, quantity=first.quantity, unit=first.unit, mass=first.mass,
            vector=first.vector,
        )  # fmt: skip
        one = self._grid._replace(
            records=(short,), scale=np.ones(1), mu=self._grid.mu[:1], period=last,
            friction=self._grid.friction[-1:],
        )  # fmt: skip
        ds = computed(self.asked._replace(grid=one), 1)[list(self.names)]
        ds["status"].attrs |= {
            "flag_values": np.array([code.value for code in _STATUSES], dtype=np.int8),
            "flag_meanings": " ".join(code.name for code in _STATUSES),
        }
        return ds

    def companions(self) -> dict[str, tuple[str, ...]]:
        """Nothing."""
        return {}

    def coordinates(self) -> dict[str, xr.Variable]:
        """The axes."""
        numbers = np.arange(1, len(self.records) + 1)
        values = dict(zip(DIMS, (numbers, *self._grid[1:5]), strict=True))
        return {name: xr.Variable((name,), one, self.sample[name].attrs) for name, one in values.items()}

    def fill_value(self, name: str) -> float:
        """NaN, 0 of counts, and a status of its own."""
        return NOT_COMPUTED if name == "status" else np.nan

    def compute(self, batch: Batch, threads: int | None) -> dict[str, np.ndarray]:
        """The variables of a batch, record by record."""
        records = range(batch.places[0].start, batch.places[0].stop)
        period = self._grid.period[self.rows_of(batch)]
        parts = [
            computed(
                self.asked._replace(grid=self._grid._replace(records=(self.records[k],), period=period)),
                checks.threads(threads),
            )
            for k in records
        ]
        return {name: np.concatenate([one[name].values for one in parts]) for name in self.names}

    def cell_seconds(self, threads: int | None) -> float:
        """By the samples of the first record, and the parts that they are divided into."""
        w = 2.0 * np.pi / self._grid.period
        pieces = load_of(self._grid.records[0])
        elastic = self.asked.stiffness is not None
        parts = 1.0 if elastic else parts_of(pieces, w, np.full(w.shape, self._grid.damping)).mean()
        return _SECONDS[elastic] * pieces.steps.size * float(parts)


def _arrays(record: Record) -> dict[str, np.ndarray]:
    series = record.series or (None,) * len(Pieces._fields)
    given = zip(_ARRAYS, (record.values, record.time, *series), strict=True)
    return {name: np.asarray(value) for name, value in given if value is not None}


def _keys(record: Record) -> dict[str, Any]:
    """What identifies a record: its fields, and the checksum of its arrays."""
    found = {
        one.name: getattr(record, one.name) for one in fields(record)
        if one.name not in (*_ARRAYS, "series", *_WORDS) and getattr(record, one.name) is not None
    }  # fmt: skip
    digest = hashlib.sha256(b"".join(array.tobytes() for array in _arrays(record).values()))
    return {**found, "sha256": digest.hexdigest()}


def spectra_of(wanted: Asked, names: Sequence[str] | None = None, config: str = "") -> Spectra:
    """The spectra that are asked for, of the variables of these names; by default all."""
    own = tuple(names or VARIABLES)
    names = own if "status" in own else (*own, "status")
    grid = wanted.grid
    first = wanted._replace(grid=grid._replace(records=grid.records[:1]))
    return Spectra(grid.records, first, names, config)
