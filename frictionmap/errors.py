"""The exceptions of the package, and hints for their messages."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager


class InputError(ValueError):
    """Invalid input; the message names the argument or key, its value and the valid range.

    InputError(message), or InputError(where, problem), or InputError(lead, where, problem): `where` is the
    argument or key that the message is about, and `lead` the words before it.  Callers that know it by
    another name rename it: `InputError("mu", "must be >= 1; got 0").renamed("grid.mu")`.

    Examples
    --------
    >>> import frictionmap as fm
    >>> try:
    ...     fm.System(damping_ratios=-0.1)
    ... except fm.InputError as error:
    ...     print(error)
    ...
    damping_ratios must be >= 0; got -0.1
    """

    def __init__(self, *parts: str) -> None:
        lead, where, self.problem = ("", "", *parts)[-3:]
        self.lead, self.where = lead, where
        before = " ".join(filter(None, (lead, where)))
        super().__init__(f"{before}{'' if not before or self.problem[0] == ':' else ' '}{self.problem}")

    def renamed(self, where: str) -> "InputError":
        """The same error, about an argument or key of another name."""
        return InputError(self.lead, where, self.problem)


@contextmanager
def naming(place: object) -> Iterator[None]:
    """Put a place, such as the name of a file, before the messages of errors."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{place}: {error}") from None


class NoSteadyState(RuntimeError):
    """A requested steady state does not exist, or was not found.

    Examples
    --------
    Without damping, friction below pi/4 does not limit the vibration at resonance:

    >>> import frictionmap as fm
    >>> try:
    ...     fm.response(fm.System(), r=1.0, beta=0.5)
    ... except fm.NoSteadyState as error:
    ...     print(error)
    ...
    r = 1, beta = 0.5, mu = 1: an undamped resonance; the motion grows without bound
    """


def nearest(word: str, valid: Iterable[str], cutoff: float = 0.5) -> str:
    """Return ' (did you mean ...?)' if a valid word is similar, else ''.

    cutoff : least similarity, 0 to 1
    """
    import difflib  # only where something is wrong

    found = difflib.get_close_matches(word, list(valid), n=1, cutoff=cutoff)
    return f" (did you mean {found[0]}?)" if found else ""
