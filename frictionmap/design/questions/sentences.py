"""Answers in sentences, for the summaries of questions."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from ...datasets.amounts import DOWN, UP, Amounts, amounts_of, band_of

if TYPE_CHECKING:
    import xarray as xr


def limit_of(ds: "xr.Dataset") -> str:
    """The limit of an answer, in the unit in which it was asked."""
    given = str(ds["limit"].attrs.get("given", ""))
    return given or amounts_of(ds).response(float(ds["limit"]), digits=6)


def whole_sentence(text: str) -> str:
    """Begin with a capital letter, except for a symbol, and end with a full stop."""
    begin = text if text.startswith(("beta ", "r =")) else text[:1].upper() + text[1:]
    return f"{begin}."


def peak_sentences(ds: "xr.Dataset") -> Iterator[str]:
    """The friction to set, and what the response is then; of a threshold or a plateau where it begins."""
    if not {"peak", "beta"} <= set(ds.variables):
        return
    words, kind = amounts_of(ds), str(ds["kind"].values) if "kind" in ds else ""
    beta, peak = float(ds["beta"]), float(ds["peak"][0])
    first = _with_second(ds, words)
    spread = f" +- {100.0 * float(ds['spread']):g} %" if "spread" in ds else ""
    samples = f"for {100.0 * float(ds['quantile']):g} % of the samples " if "quantile" in ds else ""
    if kind == "threshold":
        begin = f"{words.friction(beta, UP)}{spread}{first}"
        yield whole_sentence(f"from {begin} {samples}{words.rests()}{band_of(ds)}")
    elif kind == "plateau":
        yield whole_sentence(
            f"from {words.friction(beta, UP)}{spread}{first} {samples}"
            f"{words.stays(words.response(peak, UP))}{band_of(ds)}; more friction changes nothing"
        )
    else:
        itself = _at_itself(ds, words)
        yield whole_sentence(
            f"set {words.friction(beta)}{spread}{first}: {samples}{words.stays(words.response(peak, UP))}"
            f"{band_of(ds)}{itself}"
        )
    if kind == "at the bound":
        yield "It is an end of the range that was searched: a wider range (beta) may have a better answer."


def _with_second(ds: "xr.Dataset", words: Amounts) -> str:
    """The friction of the contact whose ratio was varied."""
    if not {"second", "second_ratio"} <= set(ds.variables):
        return ""
    other = float(ds["second_ratio"]) * float(ds["beta"])
    return f" and {words.friction(other)} in contact {int(ds['second'])}"


def _at_itself(ds: "xr.Dataset", words: Amounts) -> str:
    """The response with the friction itself, of an answer for a spread."""
    if "spread" not in ds or not {"offset", "peak_at_offset"} <= set(ds.variables):
        return ""
    middle = ds["peak_at_offset"].values[ds["offset"].values == 0.0]
    if not middle.size or not math.isfinite(middle[0]):
        return ""
    return f" ({words.response(float(middle[0]), UP)} at {words.friction(float(ds['beta']))})"


def range_of_regimes(ds: "xr.Dataset") -> Iterator[str]:
    """Up to which friction nothing stops in the band, and from which everything is stuck."""
    words, parts = amounts_of(ds), []
    no_stop = float(ds["beta_no_stop"]) if "beta_no_stop" in ds else math.nan
    stuck = float(ds["beta_stuck"]) if "beta_stuck" in ds else math.nan
    if no_stop == 0.0:
        parts.append("with any friction there are stops somewhere in the band")
    elif math.isfinite(no_stop):
        parts.append(f"no stops in the band up to {words.friction(no_stop, DOWN)}")
    if math.isfinite(stuck):
        parts.append(f"stuck over the whole band from {words.friction(stuck, UP)}")
    elif stuck == math.inf:
        parts.append("no friction keeps it stuck over the whole band")
    if parts:
        yield whole_sentence("; ".join(parts))
