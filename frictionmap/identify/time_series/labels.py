"""Results of a record without any model, and warnings about the data."""

from typing import Any

import numpy as np
import xarray as xr

from ...model.system import System
from ..signals.phasors import changes
from ..signals.samples import largest_gap
from ..statistics.estimates import number
from ..statistics.levels import FOUND
from .data import MeasuredRecord

#: Harmonics of the base beyond this share of the first one are much.
_DISTORTED = 0.05

#: Squared change of a phasor over its variance that chance makes in one of a thousand: -2 ln 0.001.
_CHANGED = 13.8


def one_mass(contact: str, damping_reference: str) -> System:
    """Make one mass on a shaken base, whose words have been checked."""
    words: dict[str, Any] = {"contact": contact, "damping_reference": damping_reference}
    return System(excitation="base", **words)


def record_variables(given: MeasuredRecord, unit: str) -> dict[str, xr.Variable]:
    """Results of the record without any model."""
    time, phasors = given.time, given.phasors
    first = np.abs(phasors.values[:, 1])
    parts = np.stack((phasors.values.real, phasors.values.imag), axis=-1)
    dims = ("channel", "harmonic", "part")
    cycles = (time[-1] - time[0]) * phasors.frequency
    result = {
        "base_frequency": number(phasors.frequency, "frequency of the base", "Hz"),
        "base_frequency_standard_error": number(
            phasors.frequency_error, "standard error of the frequency of the base", "Hz"
        ),
        "cycles": number(cycles, "cycles of the base in the record"),
        "base_amplitude": number(first[0], "first harmonic of the base", unit),
        "base_distortion": number(
            np.linalg.norm(phasors.values[0, 2:]) / first[0],
            "higher harmonics of the base over the first one",
        ),
        "base_residual_rms": number(phasors.rms[0], "root mean square of the base less its harmonics", unit),
        "base_drift": number(phasors.drift[0], "drift of the base", f"{unit} s-1"),
        "x_drift": number(phasors.drift[1], "drift of the mass", f"{unit} s-1"),
        "phasor": xr.Variable(
            dims,
            parts,
            {"long_name": "harmonics of base and mass at the middle of the record", "units": unit},
        ),
        "phasor_standard_error": xr.Variable(
            dims[:2],
            phasors.errors,
            {"long_name": "standard error of either part of a phasor", "units": unit},
        ),
        "channel": xr.Variable("channel", ["base", "x"], {"long_name": "channel"}),
        "part": xr.Variable("part", ["real", "imaginary"], {"long_name": "part of a phasor"}),
    }
    moved = changes(time, given.channels, phasors)
    if moved.size:
        result["change"] = number(
            moved.max(),
            "squared change of a first harmonic from the first to the last third of the record, over its "
            "variance; 2 on average where nothing changes",
        )
    return result


def data_warnings(given: MeasuredRecord, ds: xr.Dataset) -> list[str]:
    """Warnings about the data."""
    words = []
    phasors, time = given.phasors, given.every_time
    if not given.good.all() or given.time.size < time.size:
        inside = np.sum(~given.clipped)
        cut_off, near = 1.0 - inside / time.size, (inside - given.good.sum()) / time.size
        words.append(
            f"clipped: {cut_off:.1%} of the samples are at the extremes and were ignored"
            + (f", with {near:.1%} so near to them that noise decides which are clipped" if near else "")
        )
    if gap := largest_gap(time):
        words.append(f"a gap of {gap:.4g} s in the times, which are used as given")
    distortion = float(ds["base_distortion"])
    if distortion > _DISTORTED:
        words.append(f"the base is distorted: its higher harmonics are {distortion:.1%} of the first one")
    if "change" in ds and float(ds["change"]) > _CHANGED:
        words.append("not steady: the first and last third of the record differ by more than their errors")
    for name, drift, error in zip(("base", "x"), phasors.drift, phasors.drift_errors, strict=True):
        if abs(drift) > FOUND * error:
            words.append(f"{name} drifts by {drift:.3g} {ds['base_amplitude'].attrs['units']} per second")
    return words
