"""Description of a scene for the page: names, ranges, parameters that can be changed, colours."""

from typing import Any

import numpy as np

from ..errors import InputError
from ..pictures.palette import CLASSES
from ..theory.refinement import boundary_check
from ..units.scales import scales_of
from ..units.table import UNITS, handy_unit
from ..version import __version__
from .scene import Scene
from .views import View, marks, quantities

#: Frequencies of the range shown at which boundaries of a reduced structure are compared with finer ones.
_COMPARED = 60

#: Reference quantities of friction and lengths.
_UNITS = {
    "force": {"length": "P/k₁", "force": "P", "energy": "P²/k₁", "beta": "F/P"},
    "base": {"length": "Y", "force": "k₁Y", "energy": "k₁Y²", "beta": "F/(k₁Y)"},
}


def _physical(scene: Scene, view: View) -> dict[str, dict[str, Any]]:
    """Unit and scale factor of r, beta, lengths and work, if the scene has units."""
    try:
        scales = scales_of(scene.units, view.system)
    except InputError:  # a contact was chosen that the units do not go with
        return {}
    largest = {"frequency": scene.r[1], "force": scene.beta[1], "length": 1.0, "work": 1.0}
    found = {}
    for measure, most in largest.items():
        one = scales.of(measure)
        if one is not None:
            unit = handy_unit(one * most, measure)
            found[measure] = {"unit": unit.replace("um", "µm"), "factor": one / float(UNITS[unit].size)}
    return found


def _costs(view: View) -> list[str]:
    """Describe how the computed structure differs from the given one in the visible range of r."""
    costs = view.system.costs(np.array(view.r))
    some = np.linspace(*view.r, _COMPARED)
    return [*costs.values(), *boundary_check(view.system, some, np.array([view.mu])).values()]


def units_of(scene: Scene, view: View) -> dict[str, Any]:
    """Units of the results of a view: `units`, the reference of each ratio; `physical`, their SI units."""
    return {"units": _UNITS[str(view.system.excitation)], "physical": _physical(scene, view)}


def description(scene: Scene, view: View) -> dict[str, Any]:
    """Describe what results of a view belong to: system, units, marked frequencies and quantities.

    The page shows and saves it with the cells of the same answer, even if controls have changed meanwhile.
    """
    system = view.system
    return {
        "system": "; ".join((system.describe(), *_costs(view))),
        "quantities": [
            {"key": one.key, "label": one.label, "scale": one.scale} for one in quantities(system)
        ],
        "marks": marks(system),
        **units_of(scene, view),
    }


def describe_scene(scene: Scene, view: View) -> dict[str, Any]:
    """Describe the scene, with the system as changed in a view."""
    return {
        "title": scene.title,
        "version": __version__,
        "masses": view.system.n,
        "r": scene.r,
        "beta": scene.beta,
        "mu": scene.mu,
        "start": scene.solver.start,
        "sliders": [slider._asdict() for slider in scene.sliders],
        "contacts": [{"key": contact.key, "label": contact.label} for contact in scene.contacts],
        "classes": [look._asdict() for look in CLASSES],
        **description(scene, view),
    }
