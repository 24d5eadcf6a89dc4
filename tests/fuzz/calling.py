"""Python calls, given as text and run in the child with the tested package."""

import warnings
from typing import Any

import numpy as np
import xarray as xr


def _namespace() -> dict[str, Any]:
    """Names that calls may use: `s`, a system; `ds`, `limits`, `one`: a map, boundaries, a response."""
    import frictionmap as fm

    system = fm.System(damping_ratios=0.05)
    return {
        "fm": fm,
        "np": np,
        "xr": xr,
        "nan": float("nan"),
        "inf": float("inf"),
        "s": system,
        "ds": fm.sweep(system, [0.4, 0.9], [0.2, 0.5, 1.2], [1.0, 1.5]),
        "limits": fm.boundaries(system, [0.4, 0.9], [1.0, 1.5]),
        "one": fm.response(system, 0.4, 0.2),
    }


_names: dict[str, Any] = {}


def evaluate(code: str) -> Any:
    """Return the result of a call."""
    if not _names:
        _names.update(_namespace())
    return eval(code, dict(_names))


def _plain(answer: Any) -> Any:
    """Remove the time and the call from a result."""
    if isinstance(answer, xr.Dataset):
        answer = answer.copy()
        answer.attrs.clear()
    return answer


def same(one: Any, other: Any) -> bool:
    """Whether two results are the same."""
    one, other = _plain(one), _plain(other)
    if isinstance(one, xr.Dataset):
        return isinstance(other, xr.Dataset) and one.identical(other)
    if isinstance(one, tuple) and isinstance(other, tuple):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return bool(np.array_equal(np.asarray(one), np.asarray(other), equal_nan=True))
    return bool(one == other)


def outcome(code: str, plain: str) -> dict:
    """Result of a call: the error by name and message, or whether the result is that of the plain call."""
    import frictionmap as fm

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            answer = evaluate(code)
        except fm.InputError as error:
            return {"error": "InputError", "words": str(error), "same": False, "warned": len(caught)}
        except BaseException as error:
            return {"error": type(error).__name__, "words": str(error), "same": False, "warned": len(caught)}
        agrees = same(answer, evaluate(plain)) if plain else True
    return {"error": "", "words": "", "same": agrees, "warned": len(caught)}
