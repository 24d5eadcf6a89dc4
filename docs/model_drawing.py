"""Drawing of the model with its four ratios: `python docs/model_drawing.py` writes model.svg beside it."""

from collections.abc import Iterator
from pathlib import Path

#: Size of the drawing in pixels.
WIDTH, HEIGHT = 760, 250

#: Floor on which the mass rubs, its left and right end, and the mass: left, top, width, height.
FLOOR, FLOOR_ENDS = 190, (150, 400)
MASS = (220, 100, 120, 90)
WALL = 60

_STYLE = (
    "text{font:15px system-ui,sans-serif;fill:#1a1a1a}"
    ".s{font-style:italic}.small{font-size:13px;fill:#444}"
    ".l{stroke:#1a1a1a;stroke-width:2;fill:none}.h{stroke:#888;stroke-width:1}"
    ".m{fill:#dce9f5;stroke:#1a1a1a;stroke-width:2}"
    ".f{stroke:#b3261e;stroke-width:2.5;fill:none}.p{stroke:#1f5fa8;stroke-width:2.5;fill:none}"
)

#: The four ratios: symbol, formula, what it is.
RATIOS = (
    ("r", "= ω / ωₙ", "frequency ratio"),
    ("β", "= F / P", "friction ratio"),
    ("μ", "= Fₛ / F", "static-to-kinetic ratio"),
    ("ζ", "= c / (2 √(k m))", "damping ratio"),
)


def line(points: list[tuple[float, float]], kind: str = "l", arrow: str = "") -> str:
    """A line through points; `arrow` is the end of the marker's name."""
    path = " ".join(f"{x:g},{y:g}" for x, y in points)
    head = f' marker-end="url(#{arrow})"' if arrow else ""
    return f'<polyline class="{kind}" points="{path}"{head}/>'


def text(x: float, y: float, words: str, kind: str = "", anchor: str = "middle") -> str:
    """Words at a place."""
    return f'<text x="{x:g}" y="{y:g}" class="{kind}" text-anchor="{anchor}">{words}</text>'


def hatch(start: tuple[float, float], end: tuple[float, float], away: tuple[float, float]) -> Iterator[str]:
    """Short strokes on the solid side of a line."""
    steps = int(max(abs(end[0] - start[0]), abs(end[1] - start[1])) // 12)
    for k in range(steps + 1):
        x = start[0] + (end[0] - start[0]) * k / steps
        y = start[1] + (end[1] - start[1]) * k / steps
        yield line([(x, y), (x + away[0], y + away[1])], "h")


def spring(left: float, right: float, y: float) -> str:
    """A spring between two places."""
    coils, lead = 6, 22
    inner = right - left - 2 * lead
    zigzag = [
        (left + lead + inner * (k + 0.5) / (2 * coils), y + (-9 if k % 2 else 9)) for k in range(2 * coils)
    ]
    return line([(left, y), (left + lead, y), *zigzag, (right - lead, y), (right, y)])


def dashpot(left: float, right: float, y: float) -> Iterator[str]:
    """A dashpot between two places."""
    middle = 0.5 * (left + right)
    yield line([(left, y), (middle, y)])
    yield line([(middle, y - 8), (middle, y + 8)])
    yield line([(middle + 16, y - 11), (middle - 12, y - 11), (middle - 12, y + 11), (middle + 16, y + 11)])
    yield line([(middle + 16, y - 11), (middle + 16, y + 11)])
    yield line([(middle + 16, y), (right, y)])


def model() -> Iterator[str]:
    """Mass, spring, dashpot, wall and floor, with the forces."""
    left, top, width, height = MASS
    middle = left + 0.5 * width
    yield line([(WALL, 70), (WALL, 180)])
    yield from hatch((WALL, 70), (WALL, 180), (-10, 10))
    yield spring(WALL, left, 120)
    yield text(0.5 * (WALL + left), 102, "k", "s")
    yield from dashpot(WALL, left, 162)
    yield text(0.5 * (WALL + left), 146, "c", "s")
    yield f'<rect class="m" x="{left}" y="{top}" width="{width}" height="{height}"/>'
    yield text(middle, top + 50, "m", "s")
    yield line([(FLOOR_ENDS[0], FLOOR), (FLOOR_ENDS[1], FLOOR)])
    yield from hatch((FLOOR_ENDS[0], FLOOR), (FLOOR_ENDS[1], FLOOR), (-8, 10))
    yield line([(left + width, 135), (left + width + 62, 135)], "p", "load")
    yield text(left + width + 8, 122, "P cos ωt", "s", "start")
    yield line([(middle, 88), (middle, 58), (middle + 40, 58)], "l", "axis")
    yield text(middle + 50, 63, "x", "s", "start")
    yield line([(left + 90, FLOOR + 16), (left + 20, FLOOR + 16)], "f", "friction")
    yield text(middle, FLOOR + 42, "friction: F while it slides, up to Fₛ while it sticks", "small")


def ratios() -> Iterator[str]:
    """The four ratios in words."""
    for k, (symbol, formula, meaning) in enumerate(RATIOS):
        y = 80 + 36 * k
        yield text(462, y, symbol, "s")
        yield text(476, y, formula, "", "start")
        yield text(600, y, meaning, "small", "start")


def drawing() -> str:
    """The whole drawing."""
    heads = "".join(
        f'<marker id="{name}" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="7" markerHeight="7" '
        f'orient="auto">'
        f'<path d="M0 0L10 5L0 10z" fill="{colour}"/></marker>'
        for name, colour in (("load", "#1f5fa8"), ("friction", "#b3261e"), ("axis", "#1a1a1a"))
    )
    parts = "\n".join([*model(), *ratios()])
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" role="img" '
        f'aria-label="A mass on a spring and a dashpot, with friction on the floor, under a harmonic load">\n'
        f"<style>{_STYLE}</style><defs>{heads}</defs>\n"
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#fff"/>\n{parts}\n</svg>\n'
    )


if __name__ == "__main__":
    (Path(__file__).resolve().parent / "model.svg").write_text(drawing(), encoding="utf-8")
