"""Summaries of datasets, in plain ASCII except for texts of the file itself."""

import textwrap
from collections.abc import Hashable, Iterator, Sequence

import numpy as np
import xarray as xr

from .. import regimes
from ..datasets.amounts import amounts_of, per_cycle
from ..datasets.labels import CELL, IN_SI, LABELS, OLDER_NAMES, regime_of_choice
from ..datasets.physical import describe_scales
from ..datasets.schema import TEXTS, kind
from ..units.table import wrapped
from .belts import describe_belts, is_in_si
from .designs import describe_design
from .estimates import describe_estimates, source_of_data
from .motions import describe_motions
from .reading import standard_form
from .slices import further_axes

_WIDTH = 99
_INDENT = 24

#: Values of a list that are shown.
_SHOWN = 6

#: Kinds of files whose variables are only named in short.
_IN_SHORT = ("map", "curves", "response", "shares", "belt")

#: Dimensions of lists short enough to be printed; what has others is only named.
_LISTS = frozenset(("mu", "mode", "held_mode", "invariant", "dof", "mass_invariant"))


def describe_map(ds: xr.Dataset) -> str:
    """Describe a map, or response curves, in one line: the number of cells, or of points, by regime."""
    name = regime_of_choice(ds)
    counts = _counts(ds[name], regimes.BELT_REGIMES) if name in ds else []
    if kind(ds) == "curves":
        curves, frequencies = ds.sizes["mu"] * ds.sizes["beta"], ds.sizes["r"]
        words = f"{curves:,} response curve{'s' * (curves != 1)}, {frequencies:,} points each"
        return words + _by_regime(counts)
    further = [dim for dim in ds[name].dims if dim not in CELL] if name in ds else []
    return in_cells(int(np.prod([ds.sizes[dim] for dim in (*further, *CELL)])), counts)


def in_cells(cells: int, counts: Sequence[tuple[regimes.Code, int]]) -> str:
    """Describe the number of cells, in total and by regime."""
    return f"{cells:,} cells{_by_regime(counts)}"


def _by_regime(counts: Sequence[tuple[regimes.Code, int]]) -> str:
    return f" ({', '.join(f'{count:,} {_plain(code)}' for code, count in counts)})" if counts else ""


def _noun(ds: xr.Dataset) -> str:
    """What a result is of: a cell of a map, or a point of a response curve."""
    return "point" if kind(ds) == "curves" else "cell"


def describe_causes(ds: xr.Dataset) -> list[str]:
    """Describe every cause of unresolved or doubtful cells, and the remedy, one per line."""
    if "status" not in ds:
        return []
    return in_causes(_counts(ds["status"], regimes.STATUSES), _noun(ds))


def describe_locking(ds: xr.Dataset) -> list[str]:
    """Describe contacts whose friction holds any load."""
    if "self_locking" not in ds or not (ds["self_locking"].values == 1).any():
        return []
    locks = np.ravel(ds["self_locking"].values == 1)
    mu = np.ravel(ds["mu"].values) if "mu" in ds.coords else np.empty(0)
    where = "" if locks.all() or mu.size != locks.size else f" with mu = {_numbers(mu[locks])}"
    return [
        f"self-locking{where}: a constant force in the contact holds any load, and sliding one way diverges"
    ]


def describe_reduction(ds: xr.Dataset) -> list[str]:
    """Describe the effect of all modes, or many more, of a reduced structure."""
    found = ds.attrs.get("reduction_check")
    return [] if found is None else [f"reduction: {found}"]


def in_causes(counts: Sequence[tuple[regimes.Code, int]], noun: str = "cell") -> list[str]:
    """Describe every status except resolved, one per line; `noun`: what is counted."""
    return [
        f"{count:,} {noun}{'s' * (count != 1)} {code.name}: {code.advice}"
        for code, count in counts
        if code.value != regimes.RESOLVED
    ]


def _counts(variable: xr.DataArray, codes: tuple[regimes.Code, ...]) -> list[tuple[regimes.Code, int]]:
    """Codes that occur, and their numbers of cells."""
    counts = ((code, int(np.count_nonzero(variable.values == code.value))) for code in codes)
    return [(code, count) for code, count in counts if count]


def _plain(code: regimes.Code) -> str:
    return code.name.replace("_", " ")


def describe_response(ds: xr.Dataset) -> str:
    """Describe a response in one line: regime, stops, amplitude, period, as far as available."""
    name = regime_of_choice(ds)
    regime = next((code for code in regimes.BELT_REGIMES if name in ds and code.value == int(ds[name])), None)
    words = [_plain(regime)] if regime else []
    moving = regime is None or regime.value != regimes.PERMANENT_STICKING
    if regime is None or regime.value == regimes.STICK_SLIP:
        if "stops_per_cycle" in ds:
            words.append(per_cycle(np.ravel(ds["stops_per_cycle"]), "stops"))
        if "slips_per_cycle" in ds:
            words.append(per_cycle(np.ravel(ds["slips_per_cycle"]), "slips"))
        if "stuck_fraction" in ds:
            words.append(f"stuck {_each(100.0 * ds['stuck_fraction'], '.3g')} % of the time")
    if moving and "contact_amplitude" in ds:
        words.append(f"amplitude {_sizes(ds, ds['contact_amplitude'].values)}")
    if "period" in ds and int(ds["period"]) > 1:
        words.append(f"period {int(ds['period'])}")
    if "status" in ds and int(ds["status"]) in regimes.WITHOUT_PERIOD:
        words.append("irregular: an excerpt of the motion, and averages")
    return ", ".join(words)


def _each(values: xr.DataArray, form: str) -> str:
    """Format a number, or those of all contacts."""
    return ", ".join(f"{value:{form}}" for value in np.atleast_1d(values.values))


def _sizes(ds: xr.Dataset, values: np.ndarray) -> str:
    """Displacements with their unit, the first ones of many."""
    words, flat = amounts_of(ds), np.ravel(values)
    more = f", ... ({flat.size:,})" if flat.size > _SHOWN else ""
    return ", ".join(words.response(value, digits=6) for value in flat[:_SHOWN].tolist()) + more


def describe_shares(ds: xr.Dataset) -> str:
    """Describe shares in one line: number of samples, share of each regime over all cells."""
    words = f"{ds.attrs.get('samples', 'unknown')} samples"
    if "regime_share" in ds:
        means = ds["regime_share"].mean(CELL)
        parts = (
            f"{100.0 * float(mean):.3g} % {name}"
            for name, mean in zip(means["outcome"].values, means.values, strict=True)
        )
        words += f"; over all cells {', '.join(part.replace('_', ' ') for part in parts)}"
    return words


def describe_file(ds: xr.Dataset, verbose: bool = False) -> str:
    """Describe a file on one screen: title, system, results, axes, and the names of its variables.

    Parameters
    ----------
    ds : xarray.Dataset
        A map, curves, a response, boundaries, estimates, shares or the result of a design question, or a
        slice of one.
    verbose : bool
        Also the meanings and values of variables, the program and the command that wrote it.

    Raises
    ------
    InputError
        It is none of these; see `standard_form`.
    """
    ds = standard_form(ds)
    what = kind(ds)
    lines = header_lines(ds, what, verbose)
    if what == "estimates":
        return "\n".join([*lines, *_estimates(ds, verbose)])
    if what == "design":
        return "\n".join([*lines, "answer", *(f"  {line}" for line in describe_design(ds))])
    if what in ("history", "spectrum"):
        return "\n".join(
            [*lines, *axis_lines(ds), "motions", *(f"  {line}" for line in describe_motions(ds))]
        )
    lines += axis_lines(ds)
    if not verbose and what in _IN_SHORT:
        return "\n".join([*lines, *name_lines(ds), *_describe_results(ds, what)])
    if what == "belt":  # all of them, as they are of no other kind
        names = [str(name) for name in ds.data_vars if not is_in_si(str(name))]
        in_si = ", ".join(str(name) for name in ds.data_vars if name not in names)
        beside = _entry("in SI units", in_si) if in_si else []
        return "\n".join(
            [*lines, "variables", *(_named(ds[name]) for name in names), *beside, *describe_belts(ds)]
        )
    listed = [name for name in ds.data_vars if _is_list(ds[name])]
    lines += _variables(ds, [str(name) for name in ds.data_vars if name not in listed])
    if listed:
        few = [name for name in listed if ds[name].dims in ((), ("dof",))]
        others = [name for name in listed if name not in few]
        lines += ["values", *_numbers_in_lines(ds, few)]
        lines += [line for name in others for line in _entry(str(name), _values(ds[name]))]
    lines += list(_describe_results(ds, what))
    return "\n".join(lines)


def name_lines(ds: xr.Dataset) -> list[str]:
    """The names of the variables, without those in SI units, and how to list their meanings."""
    listed = ", ".join(str(n) for n in ds.data_vars if n not in IN_SI and not is_in_si(str(n)))
    lines = textwrap.wrap(listed, _WIDTH, initial_indent="  ", subsequent_indent="  ")
    return ["variables (info --verbose describes them)", *lines]


def header_lines(ds: xr.Dataset, what: str, verbose: bool = True) -> list[str]:
    """Title and kind, system, units; with `verbose` also source and history."""
    texts = {name: _printable(ds.attrs.get(name, "")) for name in TEXTS}
    lines = [textwrap.shorten(texts["title"], _WIDTH - len(what) - 3, placeholder="...") + f" [{what}]"]
    names = ["system", "reduction", "reduction_check", "decoupling", "modes", "comment"]
    for name in [*names, "source", "history"] if verbose else names:
        if texts[name]:
            lines += _entry(name.replace("_", " "), texts[name])
    units = describe_scales(ds)
    return [*lines, *(_entry("units", units) if units else [])]


def axis_lines(ds: xr.Dataset) -> list[str]:
    """Describe every axis and its further coordinates."""
    names = sorted(map(str, ds.coords), key=lambda name: name not in CELL)  # those of every cell first
    return ["axes", *(line for name in names for line in _entry(name, _axis(ds[name])))]


def variable_lines(ds: xr.Dataset) -> list[str]:
    """Every variable with its dimensions, further ones as three dots, and meaning."""
    further = further_axes(ds)
    return _variables(ds, [str(name) for name in ds.data_vars], further)


def _variables(ds: xr.Dataset, names: Sequence[str], further: Sequence[str] = ()) -> list[str]:
    """Variables with their meanings; of those in SI units, of errors and of older names, only the names."""
    older = [name for name in names if name in OLDER_NAMES.get(kind(ds), {})]
    beside = [name for name in names if name in IN_SI]
    errors = [name for name in names if name.endswith("_error") and name.removesuffix("_error") in names]
    lines = ["variables"]
    lines += [_named(ds[name], further) for name in names if name not in (*beside, *older, *errors)]
    lines += _entry("standard errors", ", ".join(errors)) if errors else []
    lines += _entry("in SI units", ", ".join(beside)) if beside else []
    return lines + (_entry("older names", ", ".join(older)) if older else [])


def _estimates(ds: xr.Dataset, verbose: bool) -> Iterator[str]:
    """Describe the origin of the data and the estimates."""
    yield from _entry("data", _printable(source_of_data(ds)), break_long_words=False)  # a path can be copied
    yield "estimates"
    for line in describe_estimates(ds, verbose):
        shown = "".join(c if c.isprintable() else "?" for c in f"  {line}")
        yield from wrapped(shown, _WIDTH, subsequent_indent=" " * 6)


def _numbers_in_lines(ds: xr.Dataset, names: Sequence[Hashable]) -> list[str]:
    """Format scalars, or one number per mass, with their names, several per line."""
    words = [f"{name} {_values(ds[name])}".replace(" ", "\0") for name in names]  # none is torn apart
    lines = textwrap.wrap("; ".join(words), _WIDTH, initial_indent="  ", subsequent_indent="  ")
    return [line.replace("\0", " ") for line in lines]


def _printable(text: str) -> str:
    """Text on one line, without control characters."""
    return "".join(c if c.isprintable() else "?" for c in " ".join(text.split()))


def _entry(name: str, text: str, break_long_words: bool = True) -> list[str]:
    """Format a name and its text, wrapped to at most three lines."""
    return wrapped(
        f"  {name:<{_INDENT - 3}} {text}",
        _WIDTH,
        subsequent_indent=" " * _INDENT,
        max_lines=3,
        placeholder=" ...",
        break_long_words=break_long_words,
    )


def _named(variable: xr.DataArray, further: Sequence[str] = ()) -> str:
    own = [str(dim) for dim in variable.dims if dim not in further]
    dims = f"({', '.join(own if len(own) == variable.ndim else ['...', *own])})"
    begin = f"  {variable.name!s:<{_INDENT - 3}} {dims:<16} "
    meaning = _printable(str(variable.attrs.get("long_name", "")))  # foreign variables may have none
    return (begin + textwrap.shorten(meaning, _WIDTH - len(begin), placeholder="...")).rstrip()


def _axis(axis: xr.DataArray) -> str:
    values = axis.values
    if values.dtype.kind == "U":
        return ", ".join(np.atleast_1d(values))
    unit = axis.attrs.get("units", "1")
    unit = _printable(str(unit)).replace(" s-1", "/s").replace(" s-2", "/s2")
    beside = "" if unit == "1" else f" {unit}"
    if values.size <= _SHOWN:
        return _numbers(values) + beside
    ends = f"{values.min():g} to {values.max():g}"  # of what stands beside an axis, in any order
    return f"{ends}{beside}, {values.size:,} values"


def _numbers(values: np.ndarray) -> str:
    """The first values of a list; NaN only fills it up."""
    flat = np.ravel(values)
    flat = flat[~np.isnan(flat)]
    more = f", ... ({flat.size:,})" if flat.size > _SHOWN else ""
    return ", ".join(f"{value:.6g}" for value in flat[:_SHOWN]) + more


def _is_list(variable: xr.DataArray) -> bool:
    return set(variable.dims) <= _LISTS


def _values(variable: xr.DataArray) -> str:
    """The values of a short variable: codes by their names, others row by row."""
    label = LABELS[str(variable.name)]
    if label.codes and variable.ndim == 0:
        codes = regimes.BELT_REGIMES if label.codes == regimes.REGIMES else label.codes
        return next(code.name for code in codes if code.value == int(variable))
    if variable.ndim < 2:
        return _numbers(variable.values) or "none"
    return "; ".join(
        f"{variable.dims[0]} {k}: {_numbers(row) or 'none'}" for k, row in enumerate(variable.values, 1)
    )


def _describe_results(ds: xr.Dataset, what: str) -> Iterator[str]:
    """Describe the results and unresolved cells in the last lines."""
    if what in ("map", "curves"):
        yield describe_map(ds)
    elif what == "shares":
        yield describe_shares(ds)
    elif what == "belt":
        yield from describe_belts(ds)
        return
    elif what == "response":
        yield describe_response(ds)
        yield from _motion(ds)
    yield from (f"  {line}" for line in (*describe_causes(ds), *describe_locking(ds)))
    if what in ("map", "curves") and "stops_per_cycle" in ds:
        yield from _stops(ds["stops_per_cycle"].values, _noun(ds))


def _motion(ds: xr.Dataset) -> Iterator[str]:
    """Numbers of a motion in time: how far the masses go, and when the contact stops."""
    if "x" in ds:
        yield f"largest displacement, mass by mass  {_sizes(ds, np.abs(ds['x'].values).max(axis=1))}"
    if "event_tau" in ds and "event_direction" in ds and (ds["event_direction"] == 0).any():
        begins = ds["event_tau"].values[ds["event_direction"].values == 0]
        yield f"stops begin at tau/pi =  {_numbers(begins / np.pi)}"


def _stops(stops: np.ndarray, noun: str) -> Iterator[str]:
    """Count cells, or points, by stops per cycle: integers one by one, non-integer numbers together."""
    found = stops[stops > 0]
    whole = found == np.rint(found)
    values, counts = np.unique(found[whole], return_counts=True)
    entries = [f"{v:.0f}: {c:,}" for v, c in zip(values[:12], counts[:12], strict=True)]
    if values.size > 12:
        entries.append(f"more, to {values[-1]:.0f}: {counts[12:].sum():,}")
    if not whole.all():
        non_integer = found[~whole]
        ends = f"{non_integer.min():.4g} to {non_integer.max():.4g}"
        entries.append(f"non-integer, {ends}: {non_integer.size:,}")
    if entries:
        yield f"{noun}s by stops per cycle  {', '.join(entries)}"
