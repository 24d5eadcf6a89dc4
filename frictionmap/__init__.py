"""Exact regime maps of vibrating structures with one dry-friction contact.

In the order in which data flows: none imports one that stands below it.

=============  =================================================================================
module         what is in it
=============  =================================================================================
errors         the exceptions of the package
version        the number of this version
regimes        codes of regime, origin and status, their names and meanings
checks         checks of input, whose messages name the valid range
packages       packages of the extras, and what is said where one is missing
mat_files      arrays of MAT files, of all versions
structures     matrices from the files of finite-element programs, and their reduction
_kernels       all compiled code: numbers and arrays in, numbers and codes out
model          what is simulated: system, matrices, modes, settings of the solver
units          units of measurement: hertz and newtons for the ratios r and beta
datasets       what a dataset holds: names, types, units, valid values; how it was made
roots          the search for all roots of functions with known poles
features       limits, peak thresholds, invariant points: what needs no map
theory         closed forms over frequency: boundaries of the regimes, continuous motion
steady         steady states: cells, maps, response curves, one motion in time; what a map costs
files          configurations; places of output, storage, reading; files in words
probabilities  many samples of an uncertain structure as probabilities
stores         maps block by block into a zarr store, in this process or on workers
identify       measured data: tables, fits, estimates with their errors
examples       synthetic measurements of rigs whose truth is known
pictures       pictures of maps, curves, motions and fits; colours
plot           the functions `plot_...`, and which picture a file is drawn as
explorer       the map in a browser: a server for this machine, and the page
command_line   the command line: arguments, commands, completion, progress, interrupts
__main__       the program as a process: streams, exit status
=============  =================================================================================

The names in `__all__`, and what is written into files, may grow and not change: people have scripts and
files.  What begins with an underscore, `_kernels` first, may change at any time.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from .errors import InputError, NoSteadyState
from .version import __version__

if TYPE_CHECKING:
    from . import features, identify, regimes
    from .explorer.notebook import explore
    from .files.config import load_config
    from .model.settings import Solver
    from .model.system import System
    from .plot import (
        plot_boundaries,
        plot_curves,
        plot_fit,
        plot_orbit,
        plot_regimes,
        plot_response,
        plot_shares,
    )
    from .probabilities import shares
    from .steady.curves import curves
    from .steady.response import response
    from .steady.sweep import sweep
    from .theory.boundaries import boundaries
    from .theory.continuous_motion import continuous_motion
    from .units.scales import Units

__all__ = [
    "InputError",
    "NoSteadyState",
    "Solver",
    "System",
    "Units",
    "__version__",
    "boundaries",
    "continuous_motion",
    "curves",
    "explore",
    "features",
    "identify",
    "load_config",
    "plot_boundaries",
    "plot_curves",
    "plot_fit",
    "plot_orbit",
    "plot_regimes",
    "plot_response",
    "plot_shares",
    "regimes",
    "response",
    "shares",
    "sweep",
]

# Loaded when first used: numba, xarray and matplotlib together take most of a second to import, and
# `frictionmap --help` needs none of them.
_HOME = {
    "Solver": "model.settings",
    "System": "model.system",
    "Units": "units.scales",
    "boundaries": "theory.boundaries",
    "continuous_motion": "theory.continuous_motion",
    "curves": "steady.curves",
    "explore": "explorer.notebook",
    "load_config": "files.config",
    "plot_boundaries": "plot",
    "plot_curves": "plot",
    "plot_fit": "plot",
    "plot_orbit": "plot",
    "plot_regimes": "plot",
    "plot_response": "plot",
    "plot_shares": "plot",
    "response": "steady.response",
    "shares": "probabilities",
    "sweep": "steady.sweep",
}


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


def __getattr__(name: str) -> object:
    if name in ("features", "identify", "regimes"):
        return import_module(f".{name}", __name__)
    if name in _HOME:
        value = getattr(import_module(f".{_HOME[name]}", __name__), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
