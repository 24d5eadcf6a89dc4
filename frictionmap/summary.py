"""What a dataset holds, in words."""

import numpy as np
import xarray as xr

from . import regimes
from .reading import kind


def describe_map(ds: xr.Dataset) -> str:
    """One line: how many cells of each regime."""
    sizes = [ds.sizes[name] for name in ("mu", "r", "beta")]
    words = f"{int(np.prod(sizes)):,} cells"
    if "regime" in ds:
        values, counts = np.unique(ds["regime"].values, return_counts=True)
        names = {code.value: code.name.replace("_", " ") for code in regimes.REGIMES}
        parts = [f"{count:,} {names[int(v)]}" for v, count in zip(values, counts, strict=True)]
        words += f" ({', '.join(parts)})"
    return words


def describe_response(ds: xr.Dataset) -> str:
    """One line: regime, stops, amplitude, period."""
    regime = next(c for c in regimes.REGIMES if c.value == int(ds["regime"]))
    words = regime.name.replace("_", " ")
    if regime.value == regimes.STICK_SLIP:
        share = 100.0 * float(ds["stuck_fraction"])
        words += f", {float(ds['stops_per_cycle']):.4g} stops per cycle, stuck {share:.3g} % of the time"
    if regime.value != regimes.PERMANENT_STICKING:
        words += f", amplitude {float(ds['contact_amplitude']):.6g}"
    period = int(ds["period"])
    return f"{words}, period {period}" if period > 1 else words


def _axis(values: np.ndarray) -> str:
    if values.size <= 6:
        return ", ".join(f"{value:g}" for value in values)
    return f"{values[0]:g} to {values[-1]:g}, {values.size} values"


def describe_file(ds: xr.Dataset) -> str:
    """One screen: title, system, axes, variables, regimes and causes of unresolved cells."""
    what = kind(ds)
    lines = [f"{ds.attrs.get('title', '')} [{what}]"]
    lines += [f"  {name:8} {ds.attrs[name]}" for name in ("system", "source", "history") if name in ds.attrs]
    lines.append("axes")
    for name in ("mu", "r", "beta", "tau"):
        if name in ds.coords:
            lines.append(f"  {name:8} {_axis(np.atleast_1d(ds[name].values))}")
    lines.append("variables")
    for label, variable in ds.data_vars.items():
        dims = ", ".join(str(dim) for dim in variable.dims)
        lines.append(f"  {label!s:18} ({dims})  {variable.attrs.get('long_name', '')}")
    if what == "response":
        lines.append(describe_response(ds))
    if what == "map":
        lines.append(describe_map(ds))
    if "status" in ds and what == "map":
        values, counts = np.unique(ds["status"].values, return_counts=True)
        for code in regimes.STATUSES:
            for value, count in zip(values, counts, strict=True):
                if value == code.value != regimes.RESOLVED:
                    lines.append(f"  {count:,} cells {code.name}: {code.meaning}")
    if "stops_per_cycle" in ds and what == "map":
        stops = ds["stops_per_cycle"].values
        values, counts = np.unique(stops[stops > 0], return_counts=True)
        shown = [f"{v:.4g}: {c:,}" for v, c in zip(values[:12], counts[:12], strict=True)]
        if shown:
            more = " ..." if values.size > 12 else ""
            lines.append(f"cells by stops per cycle  {', '.join(shown)}{more}")
    return "\n".join(lines)
