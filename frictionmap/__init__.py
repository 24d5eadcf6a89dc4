"""Exact regime maps of vibrating structures with one dry-friction contact.

=============  =========================================================================
room           what is in it, in the order in which data flows
=============  =========================================================================
regimes        the table of regime, origin and status codes
checks         checks of input, whose messages name what is valid; `errors`
structures     matrices from the files of finite-element programs; `packages`, `mat_files`
_kernels       the only home of jitted code: numbers and arrays in, numbers and codes out
model          what is simulated: system, matrices, modes, the structure held at its
               contact, settings of the solver
units          units of measurement: their table, `Units`, axes in hertz and newtons
datasets       what a dataset holds: labels, variables, schema, provenance
roots          the search for all roots of functions with poles
features       limits, peak thresholds, invariant points, quasi-static displacement
theory         closed forms over frequency: `boundary_curves`, `boundaries`, `continuous_motion`
steady         steady states: cells, maps, `sweep`, `curves`, `motion`, `response`; what a map costs
files          configurations; places of output, storage, reading; files in words
probabilities  many samples of an uncertain structure as probabilities
stores         maps block by block into a zarr store, in this process or on workers
identify       measured data: files, fits, estimates with their errors
examples       synthetic measurements of rigs whose truth is known
pictures       palette, panels, and a module for each kind of picture; `plot` is the door
explorer       the map in a browser: a server for this machine, and the page
cli            the command line; `arguments`, `completion`, `progress`, `interrupts`
=============  =========================================================================

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
