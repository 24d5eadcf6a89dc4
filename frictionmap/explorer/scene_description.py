"""Description of a scene for the page: names, ranges, parameters that can be changed, colours."""

from dataclasses import replace
from typing import Any

import numpy as np

from ..errors import InputError
from ..steady.refinement import boundary_check
from ..units.scales import scales_of
from ..units.table import UNITS, handy_unit
from ..version import __version__
from .contacts import is_placed, shown_contact
from .drawing import drawing_of
from .goal import describe_goals
from .lines import lines_of
from .pieces import marks
from .presets import PRESETS
from .quantities import counted_of, looks_of, quantities_of
from .scene import Scene
from .structure_picture import has_picture
from .subjects import describe_subjects
from .views import View

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
    largest = {view.across.measure: scene.r[1], "force": scene.beta[1], "length": 1.0, "work": 1.0}
    if scene.unloaded:
        largest["frequency"] = 1.0
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


def _describe_system(view: View) -> str:
    """The system in words, and how it differs from the given one."""
    if view.unloaded:
        return view.system.describe_unloaded()
    return "; ".join((view.system.describe(), *_costs(view)))


def units_of(scene: Scene, view: View) -> dict[str, Any]:
    """Units of the results of a view: `units`, the reference of each ratio; `physical`, their SI units."""
    units = _UNITS[str(view.system.excitation)]
    return {"units": units, "physical": _physical(scene, view), "across": view.across._asdict()}


def description(scene: Scene, view: View) -> dict[str, Any]:
    """Describe what results of a view belong to: system, units, marked frequencies and quantities.

    The page shows and saves it with the cells of the same answer, even if controls have changed meanwhile.
    """
    system = view.system
    return {
        "system": _describe_system(view),
        "quantities": offered_quantities(view),
        "marks": {} if view.unloaded else marks(system),
        "subjects": describe_subjects(system),
        "lines": [line._asdict() for line in lines_of(view)],
        **_classes(view),
        **units_of(scene, view),
    }


def _classes(view: View) -> dict[str, Any]:
    """Names and colours of the classes, what they count, and the contact that they are of."""
    name = "" if view.contact is None else view.contacts[0].name
    looks = [look._asdict() for look in looks_of(view)]
    events = "stops" if view.unloaded else counted_of(view).events
    return {"classes": looks, "events": events, "contact": name}


def _contacts(scene: Scene, view: View) -> list[dict[str, Any]]:
    """The contacts that can be chosen; of several that can be shown each with its quantities."""
    choices = [{"key": contact.key, "label": contact.label} for contact in scene.contacts]
    if view.system.contact_system.count == 1:
        return choices
    views = [replace(view, contact=shown_contact(contact.key)) for contact in scene.contacts]
    return [
        {**choice, "quantities": offered_quantities(one)} for choice, one in zip(choices, views, strict=True)
    ]


def offered_quantities(view: View) -> list[dict[str, str]]:
    """Quantities that can colour the cells of a view, for the page."""
    return [{"key": one.key, "label": one.label, "scale": one.scale} for one in quantities_of(view)]


def _drawing(view: View) -> dict[str, Any]:
    """The drawing of the system at rest."""
    if view.unloaded:
        from .unloaded_motion import drawing_on_belt

        return drawing_on_belt(view, 0.5 * sum(view.r))
    return drawing_of(view.system, view.shown)


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
        "contacts": _contacts(scene, view),
        "placed": is_placed(scene.system),
        "quick": view.is_quick,
        "drawing": _drawing(view),
        "unloaded": view.unloaded,
        "structure": has_picture(scene.system),
        "goals": [] if view.unloaded else describe_goals(),
        "presets": [{"key": key, "label": preset.label} for key, preset in PRESETS.items()],
        **{key: value for key, value in description(scene, view).items() if key != "contact"},
    }
