"""The exceptions of the package."""


class InputError(ValueError):
    """Invalid input; the message names the argument or key, its value and the valid range."""


class NoSteadyState(RuntimeError):
    """A requested steady state does not exist, or was not found."""
