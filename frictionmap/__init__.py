"""Exact regime maps of vibrating structures with one dry-friction contact.

============  ==========================================================================
module        what is in it
============  ==========================================================================
system        what is simulated: masses, springs, damping, load, contact
continuous    `continuous_motion`: the motion that never sticks, in closed form
curves        `boundaries`: beta_lim, beta_stick and the response functions over frequency
features      limits, peak thresholds, invariant points, quasi-static displacement
matrices      M, K and C from a file or from arrays, checked
modes         modes, participation of contact and load, the structure held at its contact
held          the held structure as a set of oscillators
structures    a structure in the numbers that the kernels take
cells         what the cells of a map need: one mass, or any structure
maps          `sweep`: regime maps; plan, run in parallel, label
steady        `response`: one steady state in time
settings      settings of the steady-state solver
regimes       the table of regime, origin and status codes
labels        names, units and meanings of everything in a dataset
checks        checks of input
config        configuration files
outputs       output files: claimed, written beside their place, put there whole or not at all
storage       datasets as NetCDF files
provenance    history and configuration of a dataset
schema        what a dataset may hold, checked against `labels`
reading       files: read with a check, brought into one form
stored        what a dataset remembers of how it was made
summary       what a dataset holds, in words
plot          pictures: the door to what is in `pictures`
cost          memory and time that a map will take
progress      what a long run is at
arguments     the arguments of the command line
cli           the command line
interrupts    Ctrl-C and termination end the program at once
_kernels      the only home of jitted code: numbers and arrays in, numbers and codes out
============  ==========================================================================

The names in `__all__`, and what is written into files, may grow and not change: people have scripts and
files.  What begins with an underscore, `_kernels` first, may change at any time.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from .errors import InputError, NoSteadyState
from .version import __version__

if TYPE_CHECKING:
    from . import features
    from .config import load_config
    from .continuous import continuous_motion
    from .curves import boundaries
    from .maps import sweep
    from .plot import plot_boundaries, plot_regimes, plot_response
    from .settings import Solver
    from .steady import response
    from .system import System

__all__ = [
    "InputError",
    "NoSteadyState",
    "Solver",
    "System",
    "__version__",
    "boundaries",
    "continuous_motion",
    "features",
    "load_config",
    "plot_boundaries",
    "plot_regimes",
    "plot_response",
    "response",
    "sweep",
]

# Loaded when first used: numba, xarray and matplotlib together take most of a second to import, and
# `frictionmap --help` needs none of them.
_HOME = {
    "Solver": "settings",
    "System": "system",
    "boundaries": "curves",
    "continuous_motion": "continuous",
    "load_config": "config",
    "plot_boundaries": "plot",
    "plot_regimes": "plot",
    "plot_response": "plot",
    "response": "steady",
    "sweep": "maps",
}


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


def __getattr__(name: str) -> object:
    if name == "features":
        return import_module(".features", __name__)
    if name in _HOME:
        value = getattr(import_module(f".{_HOME[name]}", __name__), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
