"""What the cells of a map show: classes of their regime, or a quantity."""

from ..model.system import System
from ..pictures.classes import OVERALL, OVERALL_ELASTIC, SLIPS, STOPS, Counted
from ..pictures.palette import CLASSES, ONE_WAY, ONE_WAY_LABEL, Look
from ..structures.dofs import POINT
from .belt_classes import LOOKS, belt_quantities
from .scene_parts import CellQuantity
from .views import View

#: Masses whose amplitudes are offered one by one.
_OFFERED_MASSES = 12

#: Colour of one-way sliding: pale, as it has no stops either; pictures on paper hatch it.
_ONE_WAY = "#d5ecc8"

#: Outputs of a contact, or of all contacts together, with their labels and the scales of their colours: of
#: displacements in it; of rigid and of elastic ones; of all.
_DISPLACEMENTS = (
    ("contact_amplitude", "amplitude in the contact", "log"),
    ("contact_peak_to_peak", "peak to peak in the contact", "log"),
)
_RIGID = (
    ("stops_per_cycle", "stops per cycle", "linear"),
    ("turns_per_cycle", "turns without a stop per cycle", "linear"),
    ("stuck_fraction", "share of time stuck", "linear"),
)
_ELASTIC = (
    ("slips_per_cycle", "slips per cycle", "linear"),
    ("slip_reversals_per_cycle", "slip reversals per cycle", "linear"),
    ("elastic_fraction", "share of time without slip", "linear"),
)
_OPENING = (
    ("open_fraction", "share of time open", "linear"),
    ("separations_per_cycle", "separations per cycle", "linear"),
    ("normal_force_max", "largest normal force", "log"),
)
_ALWAYS = (
    ("multiplier", "Floquet multiplier", "linear"),
    ("period", "period in excitation cycles", "linear"),
)
_WORK = "work_friction"


def quantities_of(view: View) -> tuple[CellQuantity, ...]:
    """Quantities that can colour the cells: of the contact that is shown, or of all together."""
    if view.unloaded:
        return belt_quantities(view, amplitudes(view.system, "peak to peak of", "peak_to_peak"))
    together, elastic = view.shown is None, view.is_elastic
    first = "regime of all contacts" if together else f"regime and {counted_of(view).events}"
    work = "energy dissipated by all contacts" if together else "energy dissipated by friction"
    of_contact = () if together else _ELASTIC if elastic else _RIGID
    opens = () if together or all(one.normal is None for one in view.contacts) else _OPENING
    rows = (*of_contact, *opens, *_ALWAYS, (_WORK, work, "log"))
    offered = view.engine.outputs

    def known(table: tuple[tuple[str, str, str], ...]) -> list[CellQuantity]:
        return [CellQuantity(name, label, name, scale) for name, label, scale in table if name in offered]

    return (
        CellQuantity("regime", first, "", "classes"),
        *known(() if together else _DISPLACEMENTS), *amplitudes(view.system), *known(rows),
    )  # fmt: skip


def amplitudes(system: System, what: str = "amplitude of", output: str = "amplitude") -> list[CellQuantity]:
    """Amplitudes of the masses, or what else is known of each."""
    numbers = system.dofs.numbers[:_OFFERED_MASSES]
    labels = [f"{what} {name_of_mass(system, number)}" for number in numbers]
    return [
        CellQuantity(f"{output}_{number}", label, output, "log", row)
        for row, (number, label) in enumerate(zip(numbers, labels, strict=True))
    ]


def name_of_mass(system: System, number: int) -> str:
    """Name of a mass: its number and label; without a number if it is the only one; of a point its name."""
    return system.dofs.name(number) if system.dofs.noun == POINT or system.n > 1 else "the mass"


def counted_of(view: View) -> Counted:
    """The quantity that classifies the cells, and the names of the classes."""
    if view.shown is None:
        return OVERALL_ELASTIC if view.is_elastic else OVERALL
    return SLIPS if view.is_elastic else STOPS


def looks_of(view: View) -> tuple[Look, ...]:
    """Names and colours of the classes, with that of one-way sliding where there are belts."""
    if view.unloaded:
        return LOOKS
    labels = counted_of(view).labels
    looks = tuple(look._replace(label=label) for look, label in zip(CLASSES, labels, strict=False))
    if not any(one.first.belt for one in view.system.contact_system.groups):
        return looks
    further = (Look(labels[len(CLASSES)], CLASSES[0].colour),) * (ONE_WAY - len(CLASSES))
    return (*looks, *further, Look(ONE_WAY_LABEL, _ONE_WAY))
