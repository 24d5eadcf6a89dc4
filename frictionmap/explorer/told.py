"""What the page is told at first: names, ranges, what can be changed, colours."""

from typing import Any

from ..pictures.palette import CLASSES
from ..version import __version__
from .queries import Query
from .scene import Scene
from .views import marks, quantities

#: What friction and lengths are over.
_UNITS = {
    "force": {"length": "P/k₁", "force": "P", "energy": "P²/k₁", "beta": "F/P"},
    "base": {"length": "Y", "force": "k₁Y", "energy": "k₁Y²", "beta": "F/(k₁Y)"},
}


def told(scene: Scene, query: Query) -> dict[str, Any]:
    """The scene, and the system as a query changes it."""
    system = query.view.system
    return {
        "title": scene.title,
        "version": __version__,
        "system": system.describe(),
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
        "marks": marks(system),
    }
