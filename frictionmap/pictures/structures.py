"""Pictures of structures: masses and springs, beams, plates, points, with contacts, loads and supports."""

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Unpack

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.transforms import ScaledTranslation

from .. import checks
from ..errors import InputError
from ..model.matrices import Matrices
from ..model.system import System
from ..structures.modes import Modes
from ..structures.uniform import Beam, Plate
from .drawing import with_options
from .options import FigureOptions
from .palette import LINES
from .panels import Handle, given_axes, halo, legend_below, legend_under, new_figure, patch, title_figure
from .shapes import check_options
from .sizes import points

if TYPE_CHECKING:
    from .panels import AxesArray

#: Colours of contacts, loads, structure and ground.
CONTACT, LOAD, BODY, GROUND = LINES[4], LINES[0], "#dce9f5", "#606060"

#: Half the side of a mass, and height of springs and loads in it, where masses are 1 apart.
_HALF, _SPRING, _LOAD = 0.25, -0.08, 0.12

#: Names of points are written next to them up to this number of points.
_NAMED = 40

#: Springs of matrices are drawn if they are above this share of the largest one.
_SPRINGS = 1e-9

#: Sizes of marks [points].
_MARK, _LARGE = 5.0, 8.0

#: How far from its point the mark of a contact to the ground is, and the tail of a load [points].
_BELOW, _TAIL = 8.0, 26.0

#: Contacts have their numbers up to this number; of points on a ring at most `_ON_RING` have their names,
#: at a distance inside the ring [points].
_NUMBERED, _ON_RING, _INSIDE = 16, 12, 26.0

#: Letters of a description, at most.
_LETTERS = 360


class Place(NamedTuple):
    """A contact of a system: its ends by row, one or two, and what is drawn of it."""

    rows: tuple[int, ...]
    number: int
    moves: bool  # whether its wall moves with the base
    elastic: bool


def contacts_of(system: System) -> list[Place]:
    """The contacts of a system."""
    dofs = system.dofs
    found = []
    for number, group in enumerate(system.contact_system.groups, 1):
        first = group.first
        masses: tuple = first.masses  # type: ignore[assignment]
        ends = masses if first.kind == "between-masses" else masses[:1]
        rows = tuple(dofs.row(dofs.number(mass, "masses")) for mass in ends)
        found.append(Place(rows, number, first.kind == "joined-base-wall", group.stiffness is not None))
    return found


def loaded_rows(system: System) -> list[int]:
    """Rows of the masses or points under load."""
    general = system.contact_system
    if general.points is not None:
        return general.points.loaded
    loads = [np.abs(load) for load in general.forces.values()]
    return np.flatnonzero(np.any(loads, axis=0)).tolist() if loads else []


def geometry_of(given: object) -> Beam | Plate | Modes | None:
    """The beam, plate or modes of a structure; None of masses and springs."""
    if isinstance(given, System):
        given = given.matrices
    if isinstance(given, Modes) and given.geometry is not None:
        given = given.geometry
    return given if isinstance(given, Beam | Plate | Modes) else None


def _zigzag(ax: Axes, start: tuple[float, float], end: tuple[float, float], colour: str = "black") -> None:
    """Draw a spring between two places."""
    first, last = np.array(start), np.array(end)
    along = last - first
    aside = np.array([-along[1], along[0]]) / (np.hypot(*along) or 1.0)
    shares = np.array([0.0, 0.2, *np.linspace(0.25, 0.75, 6), 0.8, 1.0])
    heights = 0.06 * np.array([0, 0, 1, -1, 1, -1, 1, -1, 0, 0])
    x, y = (first + shares[:, np.newaxis] * along + heights[:, np.newaxis] * aside).T
    ax.plot(x, y, color=colour, linewidth=1.1, zorder=1.0)


def _wall(ax: Axes, middle: tuple[float, float], half: float, normal: tuple[float, float]) -> None:
    """Draw a wall, with hatching on the side opposite to `normal`."""
    centre, away = np.array(middle), -np.array(normal)
    along = np.array([-away[1], away[0]])
    ends = np.array([centre - half * along, centre + half * along])
    ax.plot(*ends.T, color=GROUND, linewidth=1.6, zorder=1.2)
    for share in np.linspace(-1.0, 1.0, max(3, int(12 * half) + 1)):
        foot = centre + share * half * along
        stroke = np.array([foot, foot + 0.1 * away + 0.06 * along])
        ax.plot(*stroke.T, color=GROUND, linewidth=0.7, zorder=1.1)


def _pad(ax: Axes, x: float, y: float, height: float = 0.1) -> None:
    """Draw the friction pad of a contact."""
    ax.add_patch(Rectangle((x - 0.09, y - 0.5 * height), 0.18, height, facecolor=CONTACT, zorder=3.0))


def _write(ax: Axes, words: str, at: tuple[float, float], colour: str = "black", **style: Any) -> None:
    own = {"ha": "center", "va": "center", "fontsize": points(8.0), "path_effects": halo(2.0)}
    ax.text(*at, words, color=colour, parse_math=False, zorder=5.0, **{**own, **style})


def _arrow(ax: Axes, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Draw a load."""
    style = {"arrowstyle": "-|>", "color": LOAD, "linewidth": 1.6, "shrinkA": 0.0, "shrinkB": 0.0}
    ax.annotate("", end, start, arrowprops={**style, "mutation_scale": 10.0}, zorder=4.0)


def _bare(ax: Axes, low: tuple[float, float], high: tuple[float, float]) -> None:
    """Limits of a drawing without axes."""
    ax.set_xlim(low[0], high[0])
    ax.set_ylim(low[1], high[1])
    ax.set_aspect("equal")
    ax.axis("off")


def _draw_chain(ax: Axes, system: System) -> None:
    """Draw the masses and springs of a chain from left to right, ground or base at the left."""
    springs = list(system.stiffness_ratios or ())
    _wall(ax, (0.35, 0.0), 0.35, (1.0, 0.0))
    for k, stiffness in enumerate(springs):
        x = k + 1.0
        if stiffness > 0.0:
            left = 0.35 if k == 0 else x - 1.0 + _HALF
            _zigzag(ax, (left, _SPRING), (x - _HALF, _SPRING))
        ax.add_patch(
            Rectangle(
                (x - _HALF, -_HALF), 2 * _HALF, 2 * _HALF, facecolor=BODY, edgecolor="black", zorder=2.0
            )
        )
        _write(ax, str(k + 1), (x, 0.0))
    for row in loaded_rows(system):
        _arrow(ax, (row + 1.0 + _HALF, _LOAD), (row + 1.0 + _HALF + 0.4, _LOAD))
    if system.contact_system.base:
        _arrow(ax, (0.12, -0.55), (0.58, -0.55))
        _write(ax, "base", (0.35, -0.7), LOAD)
    top, bottom = _chain_contacts(ax, system)
    _bare(ax, (0.0, bottom), (len(springs) + 0.9, top))


def _chain_contacts(ax: Axes, system: System) -> tuple[float, float]:
    """Draw the contacts of a chain: to the ground below, to the base and between masses above.

    Returns
    -------
    the upper and the lower end of the drawing
    """
    top, bottom = _HALF + 0.15, -0.8
    levels: list[list[tuple[int, int]]] = []
    used: dict[tuple[int, bool], int] = {}
    for place in contacts_of(system):
        x = place.rows[0] + 1.0
        if len(place.rows) == 2:
            level = _level(levels, (min(place.rows), max(place.rows)))
            top = max(top, _between(ax, place, _HALF + 0.25 * (level + 1)))
            continue
        side = 1.0 if place.moves else -1.0
        aside = used[place.rows[0], place.moves] = used.get((place.rows[0], place.moves), -1) + 1
        x += 0.22 * aside
        height = 0.3 if place.elastic else 0.1
        if place.elastic:
            _zigzag(ax, (x, side * _HALF), (x, side * (_HALF + 0.2)), CONTACT)
        _pad(ax, x, side * (_HALF + height - 0.05))
        _wall(ax, (x, side * (_HALF + height)), 0.16, (0.0, -side))
        _write(ax, str(place.number), (x + 0.2, side * (_HALF + height - 0.05)), CONTACT)
        if place.moves:
            y = _HALF + height + 0.1
            ax.plot([0.35, 0.35, x], [0.35, y, y], color=GROUND, linewidth=1.6, zorder=1.0)
            top = max(top, y + 0.1)
    return top, bottom


def _level(levels: list[list[tuple[int, int]]], ends: tuple[int, int]) -> int:
    """The lowest level on which a bracket between two masses crosses none that is there; it is put there."""
    for level, there in enumerate(levels):
        if all(ends[1] <= a or ends[0] >= b for a, b in there):
            there.append(ends)
            return level
    levels.append([ends])
    return len(levels) - 1


def _between(ax: Axes, place: Place, height: float) -> float:
    """Draw a contact between two masses of a chain as a bracket over them; return its upper end."""
    left, right = (row + 1.0 + aside for row, aside in zip(sorted(place.rows), (0.06, -0.06), strict=True))
    middle = 0.5 * (left + right)
    ax.plot([left, left, middle], [_HALF, height, height], color=CONTACT, linewidth=1.1, zorder=1.0)
    start = middle
    if place.elastic:
        start = middle + 0.3
        _zigzag(ax, (middle, height), (start, height), CONTACT)
    ax.plot([start, right, right], [height + 0.05, height + 0.05, _HALF], color=CONTACT, linewidth=1.1)
    _pad(ax, middle, height + 0.025, 0.05)
    _write(ax, str(place.number), (middle - 0.2, height + 0.1), CONTACT)
    return height + 0.25


def _is_ring(system: System) -> int:
    """Number of sectors of a structure whose masses are called "sector.mass"; 0 of others."""
    words = [word.split(".") for word in system.dofs.written_labels]
    if not words or any(len(word) != 2 or not all(part.isdigit() for part in word) for word in words):
        return 0
    return max(int(sector) for sector, _ in words)


def _nodes(system: System) -> np.ndarray:
    """Places of the degrees of freedom: of a ring on circles, else in a row, (n, 2)."""
    count, sectors = len(system.dofs.numbers), _is_ring(system)
    if not sectors or count % sectors:
        return np.column_stack((np.arange(count) + 1.0, np.zeros(count)))
    each = count // sectors
    sector, mass = np.divmod(np.arange(count), each)
    radius = (sectors / (2.0 * np.pi)) * 1.2 + mass - 0.5 * (each - 1)
    angle = 0.5 * np.pi - 2.0 * np.pi * sector / sectors
    return np.column_stack((radius * np.cos(angle), radius * np.sin(angle)))


def _draw_graph(ax: Axes, system: System) -> None:
    """Draw degrees of freedom as points, springs between them as lines, and contacts and loads."""
    at, shown = _nodes(system), _rows_shown(system)
    places = {row: at[row] for row in shown} if _is_ring(system) else _in_a_row(shown)
    matrices = system.matrices
    if isinstance(matrices, Matrices):
        size = np.abs(np.triu(np.asarray(matrices.stiffness), 1))
        for a, b in np.argwhere(size > _SPRINGS * size.max(initial=0.0)).tolist():
            if a in places and b in places:
                _join(ax, places[a], places[b], "0.6", 1.0, -1.0)
    names = dict(enumerate(system.dofs.written_labels or map(str, system.dofs.numbers)))
    _mark_places(ax, system, places, names, round_ring=bool(_is_ring(system)))
    whole, margin = np.array([*places.values()]), 1.6 if _is_ring(system) else 0.8  # loads are around a ring
    (left, below), (right, above) = whole.min(axis=0) - margin, whole.max(axis=0) + margin
    _bare(ax, (left, below), (right, above))
    if len(shown) < len(at):
        _write(ax, f"{len(shown)} of {len(at)} degrees of freedom", (0.5, 0.02), transform=ax.transAxes)


def _join(
    ax: Axes, first: np.ndarray, last: np.ndarray, colour: str, width: float, side: float
) -> np.ndarray:
    """Join two places, in a row by an arc over or below those between them; return its middle."""
    far = float(abs(last[0] - first[0]))
    bent = first[1] == last[1] and far > 1.5
    height = side * min(0.6, 0.12 * far) if bent else 0.0
    share = np.linspace(0.0, 1.0, 41)[:, np.newaxis]
    line = first + share * (last - first) + 4.0 * height * share * (1.0 - share) * np.array([0.0, 1.0])
    ax.plot(*line.T, color=colour, linewidth=width, zorder=1.0)
    return np.asarray(line[20])


def _rows_shown(system: System) -> list[int]:
    """All degrees of freedom, or of many those with contacts and loads."""
    count = len(system.dofs.numbers)
    if count <= _NAMED or _is_ring(system):
        return list(range(count))
    return sorted({*loaded_rows(system), *(row for place in contacts_of(system) for row in place.rows)})


def _in_a_row(rows: Sequence[int]) -> dict[int, np.ndarray]:
    return {row: np.array([k + 1.0, 0.0]) for k, row in enumerate(rows)}


def _mark_places(
    ax: Axes,
    system: System | None,
    places: dict[int, np.ndarray],
    names: dict[int, str],
    round_ring: bool = False,
) -> None:
    """Mark points with their names, and the contacts and loads of a system at them.

    On a ring loads come from outside; contacts to the ground and names are inside.
    """
    out = {row: at / np.hypot(*at) if round_ring else np.array([0.0, 1.0]) for row, at in places.items()}
    named = list(places)[:: -(-len(places) // _ON_RING)] if round_ring else list(places)
    for row, (x, y) in places.items():
        ax.plot(x, y, "o", color="black", markersize=_MARK, zorder=3.0, clip_on=False)
        if row in named and len(named) <= _NAMED:
            _name_place(ax, names[row], (x, y), -_INSIDE * out[row] if round_ring else None)
    if system is None:
        return
    contacts = contacts_of(system)
    for place in contacts:
        ends = [places[row] for row in place.rows]
        _mark_contact(ax, place, ends, -out[place.rows[0]], len(contacts) <= _NUMBERED)
    for row in loaded_rows(system):
        (x, y), (right, up) = places[row], _TAIL * out[row]
        ax.annotate(
            "", (x, y), xytext=(right, up), textcoords="offset points", annotation_clip=False, zorder=4.0,
            arrowprops={"arrowstyle": "-|>", "color": LOAD, "linewidth": 1.6},
        )  # fmt: skip


def _name_place(ax: Axes, name: str, at: tuple[float, float], shift: np.ndarray | None) -> None:
    """Write the name of a point next to it, or at a distance [points] from it."""
    beside: dict[str, Any] = {"xytext": (4.0, 4.0), "ha": "left"}
    if shift is not None:
        beside = {"xytext": shift, "ha": "center", "va": "center"}
    ax.annotate(
        name, at, textcoords="offset points", zorder=5.0, fontsize=points(8.0), path_effects=halo(2.0),
        parse_math=False, annotation_clip=False, **beside,
    )  # fmt: skip


def _mark_contact(
    ax: Axes, place: Place, ends: Sequence[np.ndarray], down: np.ndarray, numbered: bool
) -> None:
    """Mark a contact: between its two points, or beside its point, towards the ground."""
    style: dict[str, Any] = {
        "markersize": _LARGE,
        "markeredgecolor": CONTACT,
        "clip_on": False,
        "zorder": 3.5,
    }
    style["markerfacecolor"] = "white" if place.elastic else CONTACT
    number: dict[str, Any] = {
        "color": CONTACT,
        "fontsize": points(8.0),
        "annotation_clip": False,
        "va": "center",
    }
    if len(ends) == 2:
        x, y = _join(ax, ends[0], ends[1], CONTACT, 1.4, 1.0)
        ax.plot(x, y, "s", **style)
        if numbered:
            ax.annotate(str(place.number), (x, y), (7.0, 6.0), textcoords="offset points", **number)
        return
    x, y = ends[0]
    figure = ax.get_figure(root=True)
    assert figure is not None

    def below(size: float) -> Any:
        right, up = size / 72.0 * down
        return ax.transData + ScaledTranslation(right, up, figure.dpi_scale_trans)

    ax.plot(x, y, "D" if place.moves else "s", transform=below(_BELOW), **style)
    ground = (2, 0, float(np.degrees(np.arctan2(down[1], down[0]))))  # a line across the way down
    ax.plot(
        x, y, marker=ground, color=GROUND, markersize=18.0, clip_on=False,
        transform=below(_BELOW + 0.7 * _LARGE),
    )  # fmt: skip
    if numbered:
        ax.annotate(str(place.number), (x, y), (8.0, -_BELOW), textcoords="offset points", **number)


def _draw_beam(ax: Axes, beam: Beam, system: System | None) -> None:
    """Draw a beam with its ends, points, contacts and loads; lengths are over that of the beam times 6."""
    whole = 6.0
    ax.plot([0.0, whole], [0.0, 0.0], color="black", linewidth=4.0, solid_capstyle="butt", zorder=1.5)
    for kind, x, inward in zip(beam.kinds, (0.0, whole), (1.0, -1.0), strict=True):
        _end(ax, kind, x, inward)
    for spring, mass, x in zip(beam.end_springs, beam.end_masses, (0.0, whole), strict=True):
        if spring:
            _zigzag(ax, (x, 0.0), (x, -0.5))
            _wall(ax, (x, -0.5), 0.2, (0.0, 1.0))
        if mass:
            ax.add_patch(
                Rectangle((x - 0.15, -0.15), 0.3, 0.3, facecolor=BODY, edgecolor="black", zorder=2.0)
            )
    names = dict(enumerate(beam.points))
    places = {
        row: np.array([whole * place / beam.length, 0.0]) for row, place in enumerate(beam.points.values())
    }
    _mark_places(ax, system, places, names)
    _bare(ax, (-0.6, -0.75), (whole + 0.6, 0.75))


def _end(ax: Axes, kind: str, x: float, inward: float) -> None:
    """Draw the support of an end of a beam."""
    if kind == "clamped":
        _wall(ax, (x, 0.0), 0.35, (inward, 0.0))
    elif kind == "pinned":
        ax.plot([x, x - 0.15, x + 0.15, x], [0.0, -0.25, -0.25, 0.0], color=GROUND, linewidth=1.4)
        _wall(ax, (x, -0.25), 0.25, (0.0, 1.0))
    elif kind == "guided":
        ax.plot([x, x], [-0.25, 0.25], color=GROUND, linewidth=1.4)
        for y in (-0.15, 0.15):
            ax.plot(x - 0.07 * inward, y, "o", color=GROUND, markersize=4.0)
        _wall(ax, (x - 0.14 * inward, 0.0), 0.35, (inward, 0.0))


#: Edges of a plate: style of their lines.
_EDGES: dict[str, dict[str, Any]] = {
    "clamped": {"color": "black", "linewidth": 4.0},
    "supported": {"color": "black", "linewidth": 1.6, "linestyle": (0, (4, 2))},
    "free": {"color": GROUND, "linewidth": 0.9},
}


def _draw_plate(ax: Axes, plate: Plate, system: System | None) -> None:
    """Draw a plate from above with its edges, points, contacts and loads."""
    a, b = plate.size
    ax.add_patch(Rectangle((0.0, 0.0), a, b, facecolor=BODY, linewidth=0.0, zorder=0.5))
    corners = (((0, 0), (0, b)), ((a, a), (0, b)), ((0, a), (0, 0)), ((0, a), (b, b)))
    for kind, (x, y) in zip(plate.kinds, corners, strict=True):
        ax.plot(x, y, zorder=1.0, **_EDGES[kind])
    places = {row: np.array(place, dtype=float) for row, place in enumerate(plate.points.values())}
    _mark_places(ax, system, places, dict(enumerate(plate.points)))
    edge = 0.1 * max(a, b)
    _bare(ax, (-edge, -edge), (a + edge, b + edge))


def _handles(given: object) -> list[Handle]:
    """Legend entries of what the drawing shows."""
    handles: list[Handle] = []
    geometry = geometry_of(given)
    if isinstance(geometry, Plate):
        there = dict.fromkeys(geometry.kinds)
        handles += [Line2D([], [], label=f"{kind} edge", **_EDGES[kind]) for kind in there]
    if not isinstance(given, System):
        return handles
    chain = geometry is None and given.matrices is None
    seen = {(place.elastic, place.moves) for place in contacts_of(given)}
    for elastic, moves in sorted(seen):
        words = ("contact with a spring" if elastic else "contact") + (" to the base" if moves else "")
        if chain:
            handles.append(patch(words, CONTACT))
            continue
        style: dict[str, Any] = {
            "markeredgecolor": CONTACT,
            "markerfacecolor": "white" if elastic else CONTACT,
        }
        handles.append(
            Line2D(
                [],
                [],
                linestyle="none",
                marker="D" if moves else "s",
                markersize=_LARGE,
                label=words,
                **style,
            )
        )
    if loaded_rows(given):
        handles.append(Line2D([], [], color=LOAD, linewidth=1.6, label="load"))
    if given.contact_system.base:
        handles.append(Line2D([], [], color=LOAD, linewidth=1.6, label="motion of the base"))
    return handles


def _extent(given: object) -> tuple[float, float]:
    """Width and height of a figure by default [inch]."""
    geometry = geometry_of(given)
    if isinstance(geometry, Plate):
        return 6.4, max(2.0, 5.6 * geometry.size[1] / geometry.size[0])
    if isinstance(given, System) and geometry is None and _is_ring(given):
        return 6.4, 6.0
    return 7.2, 2.0 if geometry is not None else 2.6


@with_options
def plot_structure(
    structure: System | Beam | Plate | Modes,
    ax: "Axes | Sequence[Axes] | AxesArray | None" = None,
    **options: Unpack[FigureOptions],
) -> "AxesArray":
    """Draw a structure with its points, contacts, loads and supports; not to scale, except for plates.

    Masses of a chain are joined by their springs; contacts to the ground are below them, contacts to the base
    and between masses above.  Other structures are points, with lines where their stiffness matrix couples
    them: those of sectors on circles, others in a row, of many those with contacts and loads.  Up to
    16 contacts have their numbers.

    Parameters
    ----------
    structure : System, Beam, Plate or Modes
    ax : matplotlib axes, optional

    Returns
    -------
    An array of the axes.

    Raises
    ------
    InputError
        The argument is no structure, or there is more than one axes.

    Examples
    --------
    >>> import frictionmap as fm
    >>> len(fm.plot_structure(fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1], contact_masses=[2])))
    1
    """
    if not isinstance(structure, System | Beam | Plate | Modes):
        raise InputError(
            "structure",
            f"must be a frictionmap.System, Beam, Plate or Modes; got {checks.one_line(structure)}",
        )
    check_options("plot_structure")
    if ax is None:
        figure: Figure = new_figure(*_extent(structure))
        axes = np.array([figure.subplots()], dtype=object)
    else:
        axes = given_axes(ax, 1, "for a structure")
    _draw(axes[0], structure)
    handles = _handles(structure)
    if ax is None:
        title_figure(figure, "Structure")
        legend_below(figure, handles, _caption(structure))
    elif handles:
        legend_under(axes[0], handles)
    return axes


def _caption(given: System | Beam | Plate | Modes) -> str:
    if isinstance(given, Modes):
        return given.source or f"modes at {len(given.points)} points"
    return textwrap.shorten(given.describe(), _LETTERS, placeholder=" ...")


def _draw(ax: Axes, given: System | Beam | Plate | Modes) -> None:
    system = given if isinstance(given, System) else None
    geometry = geometry_of(given)
    if isinstance(geometry, Beam):
        _draw_beam(ax, geometry, system)
    elif isinstance(geometry, Plate):
        _draw_plate(ax, geometry, system)
    elif isinstance(geometry, Modes):
        places = _in_a_row(range(len(geometry.points)))
        ax.plot([0.7, len(places) + 0.3], [0.0, 0.0], color="0.6", linewidth=2.0, zorder=1.0)
        _mark_places(ax, system, places, dict(enumerate(geometry.points)))
        _bare(ax, (0.2, -0.8), (len(places) + 0.8, 0.8))
    elif system is not None and system.matrices is None:
        _draw_chain(ax, system)
    elif system is not None:
        _draw_graph(ax, system)
