"""Rows of summaries of answers about the largest response: name and text."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ... import regimes
from ...datasets.amounts import DIGITS, Amounts, amounts_of, per_cycle

if TYPE_CHECKING:
    import xarray as xr

#: Peaks, or ranges, that a summary lists.
LISTED = 6


def answer_rows(ds: "xr.Dataset") -> Iterator[tuple[str, str]]:
    """The friction, and the frequency that decides."""
    return friction_rows(ds, "friction", "decided at")


def friction_rows(ds: "xr.Dataset", friction: str, frequency: str) -> Iterator[tuple[str, str]]:
    """Friction and frequency under these names."""
    words = amounts_of(ds)
    if "beta" in ds and np.isfinite(float(ds["beta"])):
        yield friction, words.friction_and_ratio(float(ds["beta"]))
    if "at_r" in ds and np.isfinite(float(ds["at_r"])):
        yield frequency, words.frequency_and_ratio(float(ds["at_r"]))


def peak_rows(ds: "xr.Dataset") -> Iterator[tuple[str, str]]:
    """The largest response and its peaks; a threshold has none."""
    if "peak" not in ds.coords:
        return
    response = str(ds.attrs.get("response", "response"))
    kind = str(ds["kind"].values) if "kind" in ds else ""
    if kind != "threshold":
        size = amounts_of(ds).response(float(ds["peak"][0]), digits=DIGITS)
        yield f"least peak, {response}", f"{size}{kind and f', {kind}'}"
    for k in range(min(ds.sizes["peak"], LISTED) if "peak_r" in ds else 0):
        yield ("peaks" if k == 0 else ""), _peak(ds, k)


def change_rows(ds: "xr.Dataset") -> Iterator[tuple[str, str]]:
    """The response with other friction, and the second-best answer."""
    words = amounts_of(ds)
    for one, value in zip(_offsets(ds), _changes(ds, words), strict=True):
        yield _other_friction(one), value
    if "second_beta" in ds and np.isfinite(float(ds["second_beta"])):
        beta, peak = float(ds["second_beta"]), float(ds["second_peak"])
        yield "second best", f"{words.friction_and_ratio(beta)}: {words.response(peak, digits=DIGITS)}"


def _other_friction(change: float) -> str:
    """A relative change of the friction."""
    if change == 0.0:
        return "with this friction itself"
    return f"with {100.0 * abs(change):.0f} % {'less' if change < 0.0 else 'more'} friction"


def _peak(ds: "xr.Dataset", k: int) -> str:
    words = amounts_of(ds)
    parts = [words.response(float(ds["peak"][k]), digits=DIGITS)]
    if "peak_r" in ds:
        parts.append(f"at {words.frequency(float(ds['peak_r'][k]), digits=DIGITS)}")
    if "peak_regime" in ds:
        names = {code.value: code.name for code in regimes.BELT_REGIMES}
        parts.append(names[int(ds["peak_regime"][k])].replace("stick_slip", "stick-slip").replace("_", " "))
    if "peak_stops" in ds and float(ds["peak_stops"][k]) > 0.0:
        parts.append(per_cycle([float(ds["peak_stops"][k])], "stops"))
    return ", ".join(parts)


def _offsets(ds: "xr.Dataset") -> list[float]:
    return ds["offset"].values.tolist() if "peak_at_offset" in ds and "offset" in ds.coords else []


def _changes(ds: "xr.Dataset", words: Amounts) -> list[str]:
    """The largest response with other friction, and its change in per cent unless the least one is 0."""
    least = float(ds["peak"][0])
    values = ds["peak_at_offset"].values.tolist() if _offsets(ds) else []
    return [words.response(value, digits=DIGITS) + _in_per_cent(value, least) for value in values]


def _in_per_cent(value: float, least: float) -> str:
    """The change from the least response; empty if that is 0 or the value is infinite."""
    if least <= 0.0 or not np.isfinite([value, least]).all():
        return ""
    change = f"{100.0 * (value / least - 1.0):+.1f}"
    return f" ({'0.0' if change in ('+0.0', '-0.0') else change} %)"
