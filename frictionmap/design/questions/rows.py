"""Rows of summaries of answers about the largest response: name and text."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ... import regimes

if TYPE_CHECKING:
    import xarray as xr

#: Peaks, or ranges, that a summary lists.
LISTED = 6


def answer_rows(ds: "xr.Dataset") -> Iterator[tuple[str, str]]:
    """The friction, and the frequency that decides."""
    return friction_rows(ds, "friction ratio beta", "decided at r")


def friction_rows(ds: "xr.Dataset", friction: str, frequency: str) -> Iterator[tuple[str, str]]:
    """Friction and frequency under these names."""
    if "beta" in ds:
        force = f" ({float(ds['friction_force']):.6g} N)" if "friction_force" in ds else ""
        yield friction, f"{float(ds['beta']):.9g}{force}"
    if "at_r" in ds:
        yield frequency, f"{float(ds['at_r']):.9g}"


def peak_rows(ds: "xr.Dataset") -> Iterator[tuple[str, str]]:
    """The largest response and its peaks."""
    if "peak" not in ds.coords:
        return
    response = str(ds.attrs.get("response", "response"))
    kind = f", {ds['kind'].values}" if "kind" in ds else ""
    length = f" ({1e3 * float(ds['peak_m'][0]):.6g} mm)" if "peak_m" in ds else ""
    yield f"least peak, {response}", f"{float(ds['peak'][0]):.10g}{length}{kind}"
    if "kind" in ds and str(ds["kind"].values) == "threshold":
        yield "", "with this friction or more it does not move, at any frequency of the band"
    for k in range(min(ds.sizes["peak"], LISTED) if "peak_r" in ds else 0):
        yield ("peaks" if k == 0 else ""), _peak(ds, k)


def change_rows(ds: "xr.Dataset") -> Iterator[tuple[str, str]]:
    """The response with other friction, and the second-best answer."""
    for one, value in zip(_offsets(ds), _changes(ds), strict=True):
        yield f"with {abs(one):.0%} {'less' if one < 0.0 else 'more'} friction".replace("%", " %"), value
    if "second_beta" in ds and np.isfinite(float(ds["second_beta"])):
        yield "second best: beta", f"{float(ds['second_beta']):.6g} ({float(ds['second_peak']):.6g})"


def _peak(ds: "xr.Dataset", k: int) -> str:
    words = [f"{float(ds['peak'][k]):.6g}"]
    if "peak_r" in ds:
        hertz = f" ({float(ds['peak_frequency'][k]):.6g} Hz)" if "peak_frequency" in ds else ""
        words.append(f"at r = {float(ds['peak_r'][k]):.6g}{hertz}")
    if "peak_regime" in ds:
        names = {code.value: code.name for code in regimes.BELT_REGIMES}
        words.append(names[int(ds["peak_regime"][k])].replace("stick_slip", "stick-slip").replace("_", " "))
    if "peak_stops" in ds and float(ds["peak_stops"][k]) > 0.0:
        words.append(f"{float(ds['peak_stops'][k]):.4g} stops per cycle")
    return ", ".join(words)


def _offsets(ds: "xr.Dataset") -> list[float]:
    return ds["offset"].values.tolist() if "peak_at_offset" in ds and "offset" in ds.coords else []


def _changes(ds: "xr.Dataset") -> list[str]:
    """The largest response with other friction, as a change in per cent unless the least one is 0."""
    least = float(ds["peak"][0])
    values = ds["peak_at_offset"].values.tolist() if _offsets(ds) else []
    return [f"{100.0 * (value / least - 1.0):+.2f} %" if least > 0.0 else f"{value:.6g}" for value in values]
