"""Table of docs/results.md about the intervals of `identify`: how often they contain the true value."""

import statistics
from collections.abc import Iterator

from .quoting import duration, markdown, two_digits

HEADER = (
    "fit",
    "data",
    "seeds",
    "refused",
    "warned",
    "intervals that contain the true value",
    "lowest coverage",
    "largest error over s.e.",
    "s.e. over Cramer-Rao bound",
    "processor time per fit",
)

#: Keys of the standard error over the Cramer-Rao bound, and of an error over its standard error.
_BOUND, _ERROR = "standard error over Cramer-Rao bound", "error over standard error"


def _share(part: int, whole: int) -> str:
    """Share in percent, as text."""
    return f"{100.0 * part / whole:.1f} %" if whole else "-"


def _cells(kind: str, name: str, case: dict) -> tuple[str, ...]:
    parameters = case["parameters"]
    beginning = f"`{kind}`", name, str(case["seeds"]), str(case["refused"]), str(case["warned"])
    end = duration(case["processor seconds a fit"]["median"])
    if not parameters:
        return (*beginning, "-", "-", "-", "-", end)
    least = min(parameters, key=lambda one: parameters[one]["coverage"])
    errors = [one[_ERROR]["worst"] for one in parameters.values() if one[_ERROR]["worst"] is not None]
    bounds = [one[_BOUND] for one in parameters.values() if one[_BOUND] is not None]
    inside, fits = (sum(one[key] for one in parameters.values()) for key in ("inside", "fits"))
    return (
        *beginning,
        _share(inside, fits),
        f"{_share(parameters[least]['inside'], parameters[least]['fits'])} ({least})",
        two_digits(max(errors)) if errors else "-",
        two_digits(statistics.median(bounds)) if bounds else "-",
        end,
    )


def coverage_rows(kinds: dict) -> list[tuple[str, ...]]:
    """One row per kind of fit and case."""
    return [_cells(kind, name, case) for kind, cases in kinds.items() for name, case in cases.items()]


def coverage_notes(kinds: dict) -> Iterator[str]:
    """Which parameters fall short of the stated coverage, and why fits were refused."""
    counts = [
        (f"{parameter} of `{kind}`, {name} ({_share(one['inside'], one['fits'])})", one)
        for kind, cases in kinds.items()
        for name, case in cases.items()
        for parameter, one in case["parameters"].items()
    ]
    short = [text for text, one in counts if one["short"]]
    below = sum(one["below the band"] for _, one in counts)
    yield (
        "By chance, 95 % of all counts lie in a certain range (92.8 to 97 % for 400 fits). The coverage of "
        f"{below} of {len(counts)} parameters is below this range; {round(0.025 * len(counts))} are expected."
    )
    words = "; ".join(short) or "none"
    yield f"Coverage so low that chance explains it in fewer than one of 1,000 counts: {words}."
    for kind, cases in kinds.items():
        for name, case in cases.items():
            for reason, count in case["refusals"].items():
                message = reason.replace("|", "/")
                yield f'Refused: {count} of {case["seeds"]} of `{kind}`, {name}, with "{message}".'


def coverage_lines(coverage: dict) -> list[str]:
    """Lines of the section on the coverage of the intervals."""
    kinds = coverage["kinds"]
    return [
        "",
        "### Intervals of identify",
        "",
        "For every seed, synthetic data with known true values are generated without the package, "
        "disturbed in one way, and fitted as a user would fit them. Every interval should contain its "
        "true value in 95 % of the fits. Fits with warnings count like the others. The Cramer-Rao bound "
        "is that of the noise alone, for the "
        'remaining samples. Outliers are fitted with `loss = "soft_l1"` if the fit has this option.',
        *markdown(HEADER, coverage_rows(kinds)),
        "",
        *(f"- {note}" for note in coverage_notes(kinds)),
        "",
        "![Coverage of the intervals](../benchmarks/results/coverage.png)",
    ]
