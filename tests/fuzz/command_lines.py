"""Invalid command lines: overrides, inputs, and outputs in places where they must not be written.

Invalid arguments are in the table of `specification/test_refusals.py`.
"""

from .configurations import Case
from .verdict import Words

#: The most of a bad argument that a message has to repeat.
_LONG = 30


def _key(text: str) -> str:
    """Part of an override that a message must contain: its key, or the part of it that exists."""
    parts = " ".join(text.partition("=")[0].split())[:_LONG].split(".")
    return ".".join(parts[:2])


def _overrides() -> list[Case]:
    """--set with an argument that is not KEY=VALUE, or with several statements."""
    texts = (
        "", "=", "=1", "grid", "grid.r", "grid=", "grid.r=", "grid.=1", ".r=1", "grid..r=1", "grid.r.=1",
        " =1",
        "x=1", "system=1", "grid=1", "solver=exact", "grid.r.values=", "grid.r=[0.1", "grid.r={start=0}",
        'grid.r="[0.1]"', "grid.mu=1.5 2.0", "grid.mu=1,2", "grid.r=0.1..0.5", "grid.r=0.1:0.5", "grid.r=1/2",
        "grid.r=0,5", "grid.r.step=0", "grid.r.step=-1", "grid.r.step=abc", "grid.r.num=5", "grid.r.first=1",
        "grid.r[0]=0.5", "grid.r.0=0.5", "system.contact=wall", "system.contact=fixed-wall # comment",
        "system.contact='fixed-wall", "solver.start=rest moving", "solver.outputs=regime,status",
        "solver.outputs=[regime]", "solver.outputs=", "grid.r=[0.5]\ngrid.beta=[0.1]", "grid.mu=[1.0]\nx = 2",
        "title=a\n[solver]\nstart='moving'", "grid.mu=1.0\r\n2.0", "solver.cycles=1_0_", "grid.r=1979-05-27",
        "title.a=1", "title=1", "system.contact.x=1", "solver.start.x=rest", "\n=1",
        "grid.r=" + "9" * 5000, "a" * 5000, "grid.r=" + "[" * 3000, "title=\udcff",
    )  # fmt: skip
    return [
        Case(
            ("map", "c.toml", "-o", "x.nc", "--set", text),
            ((_key(text), "--set", "UTF-8"),),
        )
        for text in texts
    ]


def _outputs() -> list[tuple[str, Words]]:
    """Outputs that must not be written, for every command: inputs under any name, folders, existing files."""
    lines: list[tuple[str, Words]] = []
    for verb in ("map c.toml", "boundaries c.toml", "response one.toml --r 0.5 --beta 0.5"):
        config = verb.split()[1]
        for output in (config, f"./{config}", f"folder/../{config}", "/proc/self/cwd/" + config):
            lines.append((f"{verb} -o {output} --overwrite", ((config,),)))
        for output in (
            "folder",
            ".",
            "nothere/x.nc",
            "c.toml/x.nc",
            "taken.nc",
            "-",
            "/dev/null",
            "fifo",
            "dead/x.nc",
        ):
            lines.append((f"{verb} -o {output}", ((output,),)))
        lines.append((f"{verb} -o folder --overwrite", (("folder",),)))
        lines.append((f"{verb} -o fifo --overwrite", (("fifo",),)))
        lines.append((f"{verb} -o=", (("-o",),)))
        lines.append((f"{verb} -o {'x' * 300}.nc", (("xxx",),)))
    for output in ("link.toml", "hard.toml", "folder/up.toml"):
        lines.append((f"map c.toml -o {output} --overwrite", ((output.split("/")[-1],),)))
        lines.append((f"boundaries c.toml -o {output} --overwrite", ((output.split("/")[-1],),)))
        lines.append((f"map {output} -o c.toml --overwrite", (("c.toml",),)))
    lines += [
        ("map frame.toml -o frame.npz --overwrite", (("frame.npz",),)),
        ("boundaries frame.toml -o ./frame.npz --overwrite", (("frame.npz",),)),
        ("map c.nc --overwrite", (("c.nc",),)),
        ("map taken.toml", (("taken.nc",),)),
        ("plot m.nc -o m.nc --overwrite", (("m.nc",),)),
        ("plot map.png --overwrite", (("map.png",),)),
        ("plot m.nc -o maplink.png --overwrite", (("maplink.png", "m.nc"),)),
        ("plot taken.nc", (("taken",),)),
        ("plot m.nc -o taken.png", (("taken.png",),)),
    ]
    for output in (
        "p",
        "p.txt",
        "p.nc",
        "p.png.bak",
        ".png",
        "p.",
        "folder",
        "nothere/p.png",
        "-",
        "p.jpgx",
    ):
        lines.append((f"plot m.nc -o {output}", ((output,),)))
    lines.append(("plot m.nc -o p.gif", (("a map as a moving picture",),)))
    return lines


def _inputs() -> list[tuple[str, Words]]:
    """Inputs that do not exist or have the wrong kind."""
    lines: list[tuple[str, Words]] = []
    for name in ("nothere.toml", "folder", ".", "m.nc", "dead.toml", "nothere/c.toml", "\udcff.toml"):
        for verb in ("map", "boundaries"):
            lines.append((f"{verb} {name} -o x.nc", ((name, "UTF-8"),)))
        lines.append((f"response {name} --r 0.5 --beta 0.5 -o x.nc", ((name, "UTF-8"),)))
    names = ("nothere.nc", "folder", ".", "c.toml", "empty.nc", "text.nc", "cut.nc", "foreign.nc",
    "frame.npz",
             "taken.nc", "dead.toml", "/dev/null")  # fmt: skip
    for name in names:
        lines.append((f"info {name}", ((name,),)))
        lines.append((f"plot {name} -o x.png", ((name,),)))
    return [*lines, (f"map {'y' * 5000}.toml -o x.nc", (("yyy",),))]


def command_lines() -> list[Case]:
    """All of them."""
    split = [*_outputs(), *_inputs()]
    cases = [Case(tuple(line.split()), says) for line, says in split]
    blank = [
        Case((verb, "", "-o", "x.nc"), ((verb, "CONFIG", "''", "configuration"),))
        for verb in ("map", "boundaries")
    ]
    blank += [Case((verb, ""), (("FILE", "''", "file"),)) for verb in ("info", "plot")]
    return [*cases, *_overrides(), *blank]
