"""The exceptions of the package."""


class InputError(ValueError):
    """Input is at fault; the message names the argument or key, its value and what is legal."""


class NoSteadyState(RuntimeError):
    """A steady state was asked for where there is none, or none was found."""
