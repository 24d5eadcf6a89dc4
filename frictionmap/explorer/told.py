"""What the page is told at first: names, ranges, what can be changed, colours."""

from typing import Any

import numpy as np

from ..errors import InputError
from ..pictures.palette import CLASSES
from ..theory.refinement import boundary_check
from ..units.scales import scales_of
from ..units.table import UNITS, handy_unit
from ..version import __version__
from .queries import Query
from .scene import Scene
from .views import marks, quantities

#: Frequencies of the range shown at which boundaries of a reduced structure are compared with finer ones.
_COMPARED = 60

#: What friction and lengths are over.
_UNITS = {
    "force": {"length": "P/k₁", "force": "P", "energy": "P²/k₁", "beta": "F/P"},
    "base": {"length": "Y", "force": "k₁Y", "energy": "k₁Y²", "beta": "F/(k₁Y)"},
}


def _physical(scene: Scene, query: Query) -> dict[str, dict[str, Any]]:
    """Of r, beta, lengths and works, if the scene has units: the unit, and how many of it 1 is."""
    try:
        scales = scales_of(scene.units, query.view.system)
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


def _costs(query: Query) -> list[str]:
    """What the structure that is computed differs from the one given, in the range of r that is shown."""
    view = query.view
    costs = view.system.costs(np.array(view.r))
    some = np.linspace(*view.r, _COMPARED)
    return [*costs.values(), *boundary_check(view.system, some, np.array([view.mu])).values()]


def told(scene: Scene, query: Query) -> dict[str, Any]:
    """The scene, and the system as a query changes it."""
    system = query.view.system
    return {
        "title": scene.title,
        "version": __version__,
        "system": "; ".join((system.describe(), *_costs(query))),
        "masses": system.n,
        "r": scene.r,
        "beta": scene.beta,
        "mu": scene.mu,
        "start": scene.solver.start,
        "sliders": [slider._asdict() for slider in scene.sliders],
        "contacts": [{"key": contact.key, "label": contact.label} for contact in scene.contacts],
        "quantities": [
            {"key": one.key, "label": one.label, "scale": one.scale} for one in quantities(system)
        ],
        "classes": [look._asdict() for look in CLASSES],
        "units": _UNITS[str(system.excitation)],
        "physical": _physical(scene, query),
        "marks": marks(system),
    }
