"""Periodic loads: harmonics, waveforms, tables and samples of one period.

p(tau) = Re sum_n p_n e^{i n tau},  n = 1, 2, ...;  an amplitude A at a phase a is p_n = A e^{i a}
"""

import csv
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .. import checks
from ..errors import InputError
from .shown import Shown

#: Highest harmonic of a load.
MOST_HARMONICS = 200

#: Harmonics of a waveform where none are asked for.
DEFAULT_HARMONICS = 20

WAVEFORMS = ("square", "sawtooth", "triangle")

#: Mean load of a waveform below this share of its amplitude is rounding error.
_NO_MEAN = 1e-12

_ENTRY = ("n", "mass", "amplitude", "phase_deg")

#: Keys of the phasor of one harmonic: amplitude and phase, or real and imaginary part.
_PARTS = ("amplitude", "phase_deg", "re", "im")
ENTRY_KEYS = ("n", "mass", *_PARTS)


@dataclass(frozen=True, repr=False)
class PeriodicLoad(Shown):
    """One load of several harmonics, over its reference load P.

    Parameters
    ----------
    harmonics : mapping of int to complex
        The phasors p_n.
    mean : float
        Its constant part, which moves positions only.
    cut_off : float
        Root mean square of what higher harmonics would add.

    Examples
    --------
    >>> import numpy as np
    >>> import frictionmap as fm
    >>> t = np.arange(256) / 256
    >>> load = fm.PeriodicLoad.from_samples(t, 3 * np.cos(2 * np.pi * t) + np.cos(6 * np.pi * t), harmonics=3)
    >>> {n: complex(np.round(p, 9)) for n, p in load.harmonics.items()}
    {1: (3-0j), 3: (1-0j)}
    """

    harmonics: Mapping[int, complex]
    mean: float = 0.0
    cut_off: float = 0.0

    @classmethod
    def from_samples(
        cls, t: ArrayLike, force: ArrayLike, harmonics: int = DEFAULT_HARMONICS
    ) -> "PeriodicLoad":
        """Build a load from samples of one period.

        Parameters
        ----------
        t : array_like, shape (k,)
            Times or phases at equal distances, the first included and the end of the period not.
        force : array_like, shape (k,)
            The load there, over P.
        harmonics : int
            Highest harmonic that is kept; 2 harmonics + 1 samples are needed.

        Raises
        ------
        InputError
            There are too few samples, or they are not at equal distances.
        """
        times, values = (
            checks.array(given, name).astype(float) for given, name in ((t, "t"), (force, "force"))
        )
        highest = checks.whole(harmonics, "harmonics", least=1, most=MOST_HARMONICS)
        if times.ndim != 1 or times.shape != values.shape:
            raise InputError("force", f"must have as many values as t ({times.size}); got {values.size}")
        if values.size < 2 * highest + 1:
            raise InputError(
                "force", f"must have at least 2 harmonics + 1 = {2 * highest + 1} samples; got {values.size}"
            )
        if not (np.isfinite(times).all() and np.isfinite(values).all()):
            raise InputError("force", "must be finite at finite times; got a value that is not")
        steps = np.diff(times)
        if not (steps > 0.0).all() or np.ptp(steps) > 1e-6 * steps.mean():
            raise InputError(
                "t", f"must increase in equal steps; got steps from {steps.min():g} to {steps.max():g}"
            )
        spectrum = np.fft.rfft(values) / values.size
        phasors = 2.0 * spectrum[1 : highest + 1]
        kept = np.fft.irfft(
            np.concatenate((spectrum[: highest + 1], np.zeros(spectrum.size - highest - 1))), values.size
        )
        rms = float(np.sqrt(np.mean((values - kept * values.size) ** 2)))
        size = float(np.abs(phasors).max())
        found = {n: complex(p) for n, p in enumerate(phasors, 1) if abs(p) > 1e-15 * size}
        return cls(found, float(spectrum[0].real), rms)


def waveform(name: str, harmonics: int) -> PeriodicLoad:
    """The first harmonics of a waveform between -P and P; square and triangle have a maximum at tau = 0, the
    sawtooth rises through 0 there.
    """
    orders = range(1, harmonics + 1)
    if name == "square":
        found = {n: complex(4.0 / (math.pi * n) * (1.0 if n % 4 == 1 else -1.0)) for n in orders if n % 2}
    elif name == "triangle":
        found = {n: complex(8.0 / (math.pi * n) ** 2) for n in orders if n % 2}
    else:
        found = {n: complex(0.0, -2.0 / (math.pi * n) * (1.0 if n % 2 else -1.0)) for n in orders}
    square = {"square": 1.0, "triangle": 1.0 / 3.0, "sawtooth": 1.0 / 3.0}[name]
    rest = square - 0.5 * sum(abs(p) ** 2 for p in found.values())
    return PeriodicLoad(found, 0.0, math.sqrt(max(rest, 0.0)))


def number_rows(path: Path, columns: Sequence[str], name: str) -> list[dict[str, float]]:
    """Read a CSV file with a header of these columns."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            lines = list(csv.reader(line for line in file if line.strip() and not line.startswith("#")))
    except (OSError, ValueError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(name, f": cannot read {path}: {reason}; give a CSV file") from None
    header = [word.strip() for word in lines[0]] if lines else []
    if header != list(columns):
        without = " without units, forces over P" if any("[" in word for word in header) else ""
        raise InputError(
            name,
            f"must have the columns {', '.join(columns)}{without}; "
            f"got {', '.join(header) or 'none'} in {path}",
        )
    rows = []
    for number, line in enumerate(lines[1:], 2):
        try:
            rows.append(dict(zip(columns, map(float, line), strict=True)))
        except ValueError:
            raise InputError(
                name, f"must have a number in each column; got {','.join(line)!r} in line {number} of {path}"
            ) from None
    if not rows:
        raise InputError(name, f"must have at least one line of numbers; got none in {path}")
    return rows


def load_table(path: str | os.PathLike) -> list[dict[str, float]]:
    """Read a table of harmonics: n, mass, amplitude, phase_deg."""
    return number_rows(Path(path), _ENTRY, "load_file")


def sampled(path: str | os.PathLike, harmonics: int) -> PeriodicLoad:
    """Read a CSV file of one period: time, force."""
    rows = number_rows(Path(path), ("time", "force"), "waveform")
    t, force = (np.array([row[key] for row in rows]) for key in ("time", "force"))
    return PeriodicLoad.from_samples(t, force, harmonics)


def order(value: object, name: str) -> int:
    """Check the order of a harmonic."""
    if isinstance(value, float) and value == int(value):
        value = int(value)
    return checks.whole(value, name, least=1, most=MOST_HARMONICS)


def phasor(entry: Mapping[str, Any], name: str, over: str = "") -> complex:
    """Phasor of an entry with `amplitude` and `phase_deg`, or `re` and `im`.

    over : what it is a ratio to, for the message about a number with a unit
    """
    for part in ("amplitude", "re", "im"):
        if over and isinstance(entry.get(part), str):
            raise InputError(
                f"{name}.{part}", f"must be a ratio to {over}, without a unit; got {entry[part]!r}"
            )
    if "re" in entry or "im" in entry:
        return complex(*(checks.number(entry.get(part, 0.0), f"{name}.{part}") for part in ("re", "im")))
    amplitude = checks.number(entry.get("amplitude"), f"{name}.amplitude")
    angle = math.radians(checks.number(entry.get("phase_deg", 0.0), f"{name}.phase_deg"))
    # exact where a multiple of 90 degrees is meant
    quarter = checks.number(entry.get("phase_deg", 0.0), f"{name}.phase_deg") / 90.0
    if quarter == math.floor(quarter):
        return amplitude * (1.0, 1j, -1.0, -1j)[int(quarter) % 4]
    return complex(amplitude * math.cos(angle), amplitude * math.sin(angle))


def check_entry(entry: object, name: str, valid: Sequence[str]) -> Mapping[str, Any]:
    """Check the keys of one harmonic."""
    if not isinstance(entry, Mapping):
        raise InputError(name, f"must be a table {{ {', '.join(valid)} }}; got {checks.one_line(entry)}")
    for key in entry:
        if key not in valid:
            raise InputError(
                f"unknown key {name + '.' + str(key)!r}{checks.nearest(str(key), valid)}; "
                f"valid: {', '.join(valid)}"
            )
    polar, cartesian = {"amplitude", "phase_deg"} & set(entry), {"re", "im"} & set(entry)
    if "n" not in entry or bool(cartesian) == ("amplitude" in entry) or (polar and cartesian):
        raise InputError(
            name,
            f"must have n, and amplitude and phase_deg or re and im; "
            f"got {', '.join(map(str, entry)) or 'nothing'}",
        )
    return entry


def scalar_harmonics(given: object, name: str, over: str = "") -> dict[int, complex]:
    """Harmonics of one quantity: a mapping {n: phasor}, or a list of { n, amplitude, phase_deg }.

    over : see `phasor`
    """
    found: dict[int, complex] = {}
    if isinstance(given, Mapping):
        for n, value in given.items():
            if not isinstance(value, (int, float, complex, np.number)) or isinstance(value, bool):
                raise InputError(f"{name}[{n}]", f"must be a number; got {checks.one_line(value)}")
            found[order(n, f"{name}: order")] = complex(value)
    elif isinstance(given, Sequence) and not isinstance(given, (str, bytes)):
        for k, one in enumerate(given):
            entry = check_entry(one, f"{name}[{k}]", ("n", *_PARTS))
            n = order(entry["n"], f"{name}[{k}].n")
            found[n] = found.get(n, 0.0) + phasor(entry, f"{name}[{k}]", over)
    else:
        raise InputError(
            name,
            f"must be a list of {{ n, amplitude, phase_deg }} or a mapping of orders to phasors; "
            f"got {checks.one_line(given)}",
        )
    for n, value in found.items():
        if not (math.isfinite(value.real) and math.isfinite(value.imag)):
            raise InputError(name, f"must be finite; got {value} at order {n}")
    return {n: value for n, value in found.items() if value != 0.0}
