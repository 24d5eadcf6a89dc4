"""Exact regime maps of vibrating structures with dry-friction contacts.

The rows follow the flow of data: a module imports only from rows above its own.

=============  =====================================================================================
module         what is in it
=============  =====================================================================================
errors         the exceptions of the package
version        version number of the package
regimes        codes of regime, origin and status, their names and meanings
checks         checks of input, whose messages name the valid range
jobs           jobs on a pool of threads
packages       optional packages (extras), and the message if one is missing
mat_files      arrays from MAT files of all versions
structures     matrices and modes from files of finite-element programs; reduction; beams and plates
_kernels       all compiled code: numbers and arrays in, numbers and codes out
model          what is simulated: system, matrices, modes, settings of the solver
units          units of measurement: hertz and newtons for the ratios r and beta
datasets       contents of datasets: names, types, units, valid values, provenance
roots          search for all roots of functions with known poles
features       high-frequency limits, peak thresholds, invariant points: features that need no map
theory         closed forms over frequency: beta_lim, beta_stick, continuous motion
single         one rigid contact under one harmonic load: cells, maps, curves, motions
general        several contacts, springs in contacts, belts, periodic loads: boundaries, maps, motions
phases         systems with linear phases: normal forces that move, separation, gaps, bilinear springs
banks          systems whose contacts are banks of elastic elements, each bank one contact
no_load        motions on belts without a load: steady sliding, its stability, and cycles
solvers        the engines behind one interface, and which of them answers for a system
steady         steady states: cells, maps, response curves, time histories; time and memory of a map
stop_counts    borders between numbers of stops per cycle, as exact curves
files          configurations; output files, reading, writing; summaries in words
probabilities  shares of the regimes over many samples of an uncertain structure
design         which friction to choose: least peak, within a limit, without stops, stuck, margins
identify       measured data: tables, fits, estimates with their errors
motions        motions in time under records: earthquakes, pulses, run-ups, random loads
stores         maps and spectra, written block by block into zarr stores, here or by workers
examples       synthetic measurements with known true values
pictures       pictures of maps, curves, motions and fits; colours of the regimes
plot           the functions `plot_...`, and the choice of the picture for a file
accessor       `ds.frictionmap`: names of regimes, cells of one regime, pictures
explorer       the map in a browser: a server for this machine, and the page
command_line   the command line: arguments, commands, completion, progress, interrupts
__main__       the program as a process: streams, exit status
=============  =====================================================================================

The names in `__all__` and the contents of files may be extended but not changed, because users have scripts
and files that rely on them.  Everything that begins with an underscore, such as `_kernels`, may change.
"""

import sys
from importlib import import_module
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from types import ModuleType
from typing import TYPE_CHECKING

from .errors import InputError, NoSteadyState
from .version import __version__

if TYPE_CHECKING:
    from . import design, features, identify, regimes
    from .explorer.notebook import explore
    from .files.config import load_config
    from .files.opening import open  # fm.open, as in other packages of files
    from .model.contact import Contact
    from .model.friction_law import FrictionLaw
    from .model.normal_contact import NormalForce
    from .model.periodic_load import PeriodicLoad
    from .model.sectors import ring
    from .model.settings import Solver
    from .model.spring_element import Spring
    from .model.system import System
    from .motions.dataset import history
    from .motions.record import Record
    from .motions.ring_down import ring_down
    from .motions.statistics import stationary
    from .plot import (
        animate,
        plot_belt,
        plot_belt_motion,
        plot_boundaries,
        plot_curves,
        plot_design,
        plot_energies,
        plot_fit,
        plot_forces,
        plot_history,
        plot_incremental,
        plot_modes,
        plot_orbit,
        plot_quantity,
        plot_regimes,
        plot_response,
        plot_shares,
        plot_spectrum,
        plot_structure,
    )
    from .probabilities import shares
    from .steady.boundaries import boundaries
    from .steady.curves import curves
    from .steady.response import response
    from .steady.sweep import sweep
    from .stop_counts.dataset import borders
    from .stores.spectrum import spectrum
    from .structures.modes import Modes
    from .structures.uniform import Beam, Plate
    from .theory.continuous_motion import continuous_motion
    from .units.dimensions import system_in_units
    from .units.scales import Units

__all__ = [
    "Beam",
    "Contact",
    "FrictionLaw",
    "InputError",
    "Modes",
    "NoSteadyState",
    "NormalForce",
    "PeriodicLoad",
    "Plate",
    "Record",
    "Solver",
    "Spring",
    "System",
    "Units",
    "__version__",
    "animate",
    "borders",
    "boundaries",
    "continuous_motion",
    "curves",
    "design",
    "explore",
    "features",
    "history",
    "identify",
    "load_config",
    "open",
    "plot_belt",
    "plot_belt_motion",
    "plot_boundaries",
    "plot_curves",
    "plot_design",
    "plot_energies",
    "plot_fit",
    "plot_forces",
    "plot_history",
    "plot_incremental",
    "plot_modes",
    "plot_orbit",
    "plot_quantity",
    "plot_regimes",
    "plot_response",
    "plot_shares",
    "plot_spectrum",
    "plot_structure",
    "regimes",
    "response",
    "ring",
    "ring_down",
    "shares",
    "spectrum",
    "stationary",
    "sweep",
    "system_in_units",
]

# Loaded when first used: numba, xarray and matplotlib together take most of a second to import, and
# `frictionmap --help` needs none of them.
_HOME = {
    "Beam": "structures.uniform",
    "Contact": "model.contact",
    "FrictionLaw": "model.friction_law",
    "NormalForce": "model.normal_contact",
    "Spring": "model.spring_element",
    "Modes": "structures.modes",
    "PeriodicLoad": "model.periodic_load",
    "Plate": "structures.uniform",
    "Record": "motions.record",
    "Solver": "model.settings",
    "System": "model.system",
    "Units": "units.scales",
    "system_in_units": "units.dimensions",
    "animate": "plot",
    "borders": "stop_counts.dataset",
    "boundaries": "steady.boundaries",
    "continuous_motion": "theory.continuous_motion",
    "curves": "steady.curves",
    "explore": "explorer.notebook",
    "history": "motions.dataset",
    "load_config": "files.config",
    "open": "files.opening",
    "plot_belt": "plot",
    "plot_belt_motion": "plot",
    "plot_boundaries": "plot",
    "plot_curves": "plot",
    "plot_design": "plot",
    "plot_energies": "plot",
    "plot_fit": "plot",
    "plot_forces": "plot",
    "plot_history": "plot",
    "plot_incremental": "plot",
    "plot_modes": "plot",
    "plot_orbit": "plot",
    "plot_quantity": "plot",
    "plot_regimes": "plot",
    "plot_response": "plot",
    "plot_shares": "plot",
    "plot_spectrum": "plot",
    "plot_structure": "plot",
    "ring": "model.sectors",
    "response": "steady.response",
    "ring_down": "motions.ring_down",
    "shares": "probabilities",
    "spectrum": "stores.spectrum",
    "stationary": "motions.statistics",
    "sweep": "steady.sweep",
}


class _WithAccessor(MetaPathFinder):
    """Adds the accessor `frictionmap` to datasets as soon as somebody loads xarray, which is slow to load."""

    def find_spec(self, name: str, path: object = None, target: object = None) -> ModuleSpec | None:
        if name != "xarray":
            return None
        sys.meta_path.remove(self)
        spec = find_spec(name)
        if spec is not None and spec.loader is not None:
            load = spec.loader.exec_module

            def load_both(module: ModuleType) -> None:
                load(module)
                import_module(".accessor", __name__)

            spec.loader.exec_module = load_both  # type: ignore[method-assign]
        return spec


def __dir__() -> list[str]:
    return sorted(__all__)


def __getattr__(name: str) -> object:
    if name in ("design", "features", "identify", "regimes"):
        return import_module(f".{name}", __name__)
    if name in _HOME:
        value = getattr(import_module(f".{_HOME[name]}", __name__), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


if "xarray" in sys.modules:
    import_module(".accessor", __name__)
else:
    sys.meta_path.insert(0, _WithAccessor())
