"""The exceptions of the package, and hints for their messages."""

from collections.abc import Iterable


class InputError(ValueError):
    """Invalid input; the message names the argument or key, its value and the valid range."""


class NoSteadyState(RuntimeError):
    """A requested steady state does not exist, or was not found."""


def nearest(word: str, valid: Iterable[str], cutoff: float = 0.5) -> str:
    """Return ' (did you mean ...?)' if a valid word is similar, else ''.

    cutoff : least similarity, 0 to 1
    """
    import difflib  # only where something is wrong

    found = difflib.get_close_matches(word, list(valid), n=1, cutoff=cutoff)
    return f" (did you mean {found[0]}?)" if found else ""
