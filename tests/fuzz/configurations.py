"""Invalid configurations: every key with values of the wrong kind, size or order, and invalid files."""

import math
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from .folders import CONFIG, CONFIG_TWO
from .verdict import Words

_NOT_NUMBERS = ("true", '"0.5"', '""', "{}", "1979-05-27", "[[0.5]]")
_NOT_WORDS = ("1", "true", "nan", '""', "[]", "{}", "1979-05-27", '"rest "', '"Rest"')
_NOT_WHOLE = ("1.5", "true", '"2"', "[]", "nan", "inf", "0", "-1")
_NOT_FINITE = ("nan", "inf", "-inf", "-1.0", "1e400", "[nan]", "[0.5, inf]", "[-0.1]")
_NOT_RISING = ("[]", "[0.5, 0.5]", "[0.9, 0.4]", "[0.4, 0.9, 0.8]")
_NOT_AXES = (
    "{ start = 0.1 }", "{ start = 0.1, stop = 1.0 }", "{ start = 0.1, stop = 1.0, step = 0.0 }",
    "{ start = 0.1, stop = 1.0, step = -0.1 }", "{ start = 0.1, stop = 1.0, step = nan }",
    "{ start = 0.1, stop = 1.0, step = 1e-300 }", "{ start = 0.1, stop = 1.0, num = 0 }",
    "{ start = 0.1, stop = 1.0, num = -3 }", "{ start = 0.1, stop = 1.0, num = 2.5 }",
    "{ start = 0.1, stop = 1.0, num = 10000000000 }", "{ start = 0.1, stop = 1.0, num = 1 }",
    '{ start = 0.1, stop = 1.0, num = "3" }', "{ start = 1.0, stop = 0.1, step = 0.1 }",
    "{ start = 0.1, stop = inf, step = 0.1 }", "{ start = nan, stop = 1.0, step = 0.1 }",
    "{ start = true, stop = 1.0, step = 0.1 }", "{ start = 0.1, stop = 1.0, step = 0.1, num = 10 }",
    "{ start = 0.1, stop = 1.0, stepp = 0.1 }", "{ start = 0.1, end = 1.0, step = 0.1 }",
    "{ values = [] }", "{ values = 0.5 }", "{ values = [0.5, 0.4] }", '{ values = ["0.5"] }',
    "{ values = [0.5], num = 1 }",
)  # fmt: skip

#: Key: values, as TOML, that it must not have.
WRONG_VALUES: dict[str, tuple[str, ...]] = {
    "title": ("1", "1.5", "true", "[]", "{}", "1979-05-27"),
    "system.contact": (*_NOT_WORDS, '"fixed wall"', '"fixed-walls"', '"FIXED-WALL"', '["fixed-wall"]'),
    "system.contact_masses": (
        "[0]", "[2]", "[-1]", "[1.5]", '["1"]', "[true]", "[]", "[1, 2]", "[1, 1]", '"1"', "{}", "[nan]",
        "[1.0]",
    ),
    "system.load_mass": (*_NOT_WHOLE, "2", "1.0"),
    "system.mass_ratios": (
        "[]", "[0.0]", "[-1.0]", "[2.0]", '["1"]', "[true]", "[nan]", "[inf]", "[[1.0]]", '"1"', "1.0", "{}",
        "[1.0, 0.0]", "[1.0, -2.0]",
    ),
    "system.stiffness_ratios": (
        "[]", "[0.0]", "[-1.0]", "[2.0]", '["1"]', "[true]", "[nan]", "[inf]", "[[1.0]]", '"1"', "1.0", "{}",
        "[1.0, 1.0]",
    ),
    "system.damping_ratios": (*_NOT_NUMBERS, "nan", "inf", "-0.1", "[]", "[0.1, 0.1]", "[-0.1]", "1e9"),
    "system.frequency_scale": ("0.0", "-1.0", "nan", "true", '"1"', "2.0"),
    "system.stiffness_scale": ("0.0", "-1.0", "nan", "true", '"1"', "2.0"),
    "system.excitation": _NOT_WORDS,
    "system.damping_reference": (*_NOT_WORDS, '"base"'),
    "system.matrices": ("1", "true", "[]", '""', '"nothere.npz"', '"."', '"c.toml"', '"a\\u0000b.npz"'),
    "grid.r": (*_NOT_NUMBERS, *_NOT_FINITE, *_NOT_RISING, *_NOT_AXES, "1e9"),
    "grid.beta": (*_NOT_NUMBERS, *_NOT_FINITE, *_NOT_RISING, *_NOT_AXES),
    "grid.mu": (*_NOT_NUMBERS, *_NOT_FINITE, *_NOT_RISING, "0.5", "0", "[0.99, 1.0]"),
    "solver.start": (*_NOT_WORDS, '"sliding"'),
    "solver.cycles": (*_NOT_WHOLE, "1e3", "10000000000000000000000"),
    "solver.tolerance": (*_NOT_NUMBERS, "nan", "inf", "0.0", "-1e-12", "1.0", "1e-20"),
    "solver.steps": (*_NOT_WHOLE, "1", "24.0", "1001"),
    "solver.skip": (*_NOT_WORDS, '"all"', "false"),
    "solver.steady": (*_NOT_WORDS, '"solve"'),
    "solver.outputs": ("[]", "1", '"regime"', '["regimes"]', '["regime", 1]', '[["regime"]]', "{}", '[""]'),
}  # fmt: skip

#: Keys that do not exist, most of them by a slip.
MISSPELT = (
    "system.contacts", "system.Contact", "system.contact_mass", "system.mass_ratio", "system.zeta",
    "system.damping", "system.stiffness", "system.matrix", "system.exitation", "system.load_masses",
    "grid.R", "grid.betas", "grid.beta_", "grid.frequency", "grid.mus", "grid.zeta",
    "solver.cycle", "solver.tol", "solver.step", "solver.output", "solver.Start", "solver.threads",
    "solver.seed", "systems", "grids", "Solver", "titel", "Title", "mu",
)  # fmt: skip


@dataclass(frozen=True)
class Case:
    """A command line in a folder with additional files."""

    arguments: tuple[str, ...]
    says: Words = ()
    files: dict[str, bytes] = field(default_factory=dict)
    about: str = ""

    def __str__(self) -> str:
        return self.about or " ".join(map(repr, self.arguments))


def _ways(value: object) -> Iterator[str]:
    """Forms in which a message may quote a value."""
    yield repr(value)
    yield str(value)
    if isinstance(value, float):
        yield f"{value:g}"
    if isinstance(value, list | dict):
        yield from ("none", "nothing", "missing", f"got {len(value)}")
        inside = value.values() if isinstance(value, dict) else value
        for item in inside:
            yield from _ways(item)
        if isinstance(value, dict):
            yield from value
    if value == "":
        yield "''"
    if isinstance(value, float) and math.isinf(value):
        yield "1e400"


def ways(text: str) -> tuple[str, ...]:
    """Forms in which a message may quote a TOML value."""
    return (text, *_ways(tomllib.loads(f"value = {text}")["value"]))


def _with(key: str, text: str) -> str:
    """The small configuration with one key replaced or added."""
    section, _, name = key.rpartition(".")
    lines = [line for line in CONFIG.splitlines() if not line.startswith(f"{name} =")]
    if not section:
        return "\n".join([f"{name} = {text}", *lines])
    if f"[{section}]" not in lines:
        lines.append(f"[{section}]")
    place = lines.index(f"[{section}]") + 1
    return "\n".join([*lines[:place], f"{name} = {text}", *lines[place:]])


def by_key() -> Iterator[Case]:
    """Every key with every invalid value, in the file and by --set, and every misspelt key."""
    for key, texts in WRONG_VALUES.items():
        for text in texts:
            says = ((key,), ways(text))
            bad = {"bad.toml": _with(key, text).encode()}
            yield Case(("map", "bad.toml", "-o", "out.nc"), says, bad, f"{key} = {text}")
            if not text.startswith('"rest'):  # --set takes a word without quotes, and its blanks off
                yield Case(("map", "c.toml", "--set", f"{key}={text}", "-o", "out.nc"), says)
    for key in MISSPELT:
        says = ((key.rpartition(".")[2],),)
        bad = {"bad.toml": _with(key, "1").encode()}
        yield Case(("map", "bad.toml", "-o", "out.nc"), says, bad, f"{key} = 1")
        yield Case(("boundaries", "c.toml", "--set", f"{key}=1", "-o", "out.nc"), says)


_GOOD = CONFIG.encode()

#: Whole files that are no configurations.
_WHOLE_FILES: dict[str, tuple[bytes, Words]] = {
    "empty": (b"", (("[system]",),)),
    "blanks": (b" \n\t\n", (("[system]",),)),
    "a comment": (b"# nothing", (("[system]",),)),
    "NUL bytes": (b"\0" * 100, ()),
    "no UTF-8": (_GOOD.replace(b"small", b"\xff\xfe"), (("UTF-8",),)),
    "Latin-1": (_GOOD.replace(b"small", "kleine Übersicht".encode("latin-1")), (("UTF-8",),)),
    "UTF-16": (CONFIG.encode("utf-16"), (("UTF-8", "TOML"),)),
    "a carriage return alone": (_GOOD.replace(b"\n", b"\r"), ()),
    "a picture": (b"\x89PNG\r\n\x1a\n" + bytes(range(256)), ()),
    "JSON": (b'{"system": {"contact": "fixed-wall"}}', (("TOML",),)),
    "YAML": (b"system:\n  contact: fixed-wall\n", (("TOML",),)),
    "cut off": (_GOOD[:120], ()),
    "cut off in a text": (_GOOD[:12], (("TOML",),)),
    "no quotes": (_GOOD.replace(b'"fixed-wall"', b"fixed-wall"), (("TOML",), ("line 4",))),
    "a key twice": (_GOOD.replace(b"[grid]", b"damping_ratios = 0.1\n[grid]"), (("TOML",),)),
    "a table twice": (_GOOD + b"[system]\n", (("TOML",),)),
    "system a list of tables": (_GOOD.replace(b"[system]", b"[[system]]"), (("system",),)),
    "grid a number": (b"grid = 1\n" + _GOOD.split(b"[grid]")[0], (("grid",),)),
    "solver a text": (b'solver = "exact"\n' + _GOOD, (("solver",),)),
    "no grid": (_GOOD.split(b"[grid]")[0], (("grid.r",),)),
    "no r": (_GOOD.replace(b"r = [0.4, 0.9]\n", b""), (("grid.r",),)),
    "no beta": (_GOOD.replace(b"beta = [0.2, 0.5, 1.2]\n", b""), (("grid.beta",),)),
    "no system": (b"[grid]\nr = 1\nbeta = 1\n", (("[system]",),)),
    "brackets a thousand deep": (b"a = " + b"[" * 1000 + b"]" * 1000, ()),
    "brackets a million deep": (b"a = " + b"[" * 10**6, (("TOML",),)),
    "a number of 10,000 digits": (_GOOD.replace(b"1.5", b"1" * 10_000), ()),
    "a key of 100,000 letters": (b"a" * 100_000 + b" = 1\n" + _GOOD, (("unknown key",),)),
    "a key with a line break": (b'"a\\nb" = 1\n' + _GOOD, (("unknown key",),)),
    "more cells than memory": (
        CONFIG.replace("[0.4, 0.9]", "{ start = 0.1, stop = 2.0, num = 40000 }")
        .replace("[0.2, 0.5, 1.2]", "{ start = 0.1, stop = 2.0, num = 40000 }").encode(),
        (("cells",),),
    ),
    "masses 1 and 2 of one": (_GOOD.replace(b"fixed-wall", b"between-masses"), (("system.contact",),)),
    "load on mass 2 of a joined base-wall": (
        CONFIG_TWO.replace("fixed-wall", "joined-base-wall").replace("[grid]",
        "load_mass = 2\n[grid]").encode(),
        (("system.load_mass",), ("2",)),
    ),
    "force on a joined base-wall": (
        CONFIG.replace("fixed-wall", "joined-base-wall").replace("[grid]",
        'excitation = "force"\n[grid]').encode(),
        (("excitation",), ("force",)),
    ),
    "contact of masses in the wrong order": (
        CONFIG_TWO.replace("fixed-wall", "between-masses").replace("[grid]",
        "contact_masses = [2, 1]\n[grid]")
        .encode(),
        (("system.contact_masses",),),
    ),
    "contact of a mass with itself": (
        CONFIG_TWO.replace("fixed-wall", "between-masses").replace("[grid]",
        "contact_masses = [2, 2]\n[grid]")
        .encode(),
        (("system.contact_masses",),),
    ),
    "three dampings of two masses": (
        CONFIG_TWO.replace("= 0.05", "= [0.1, 0.1, 0.1]").encode(), (("system.damping_ratios",),),
    ),
}  # fmt: skip


def whole_files() -> Iterator[Case]:
    """Files that are not configurations, for every command that takes one."""
    for about, (content, says) in _WHOLE_FILES.items():
        for arguments in (
            ("map", "bad.toml", "-o", "out.nc"),
            ("boundaries", "bad.toml", "-o", "out.nc"),
        ):
            if arguments[0] == "boundaries" and about == "more cells than memory":
                continue
            yield Case(arguments, says, {"bad.toml": content}, f"{arguments[0]}: {about}")


_TWO = np.array([[2.0, -1.0], [-1.0, 1.0]])
_ONE = np.eye(2)
_TURN = np.array([[0.1, 0.05], [0.0, 0.1]])

#: Contents of a matrices file, and what a message has to name.
_MATRICES: dict[str, dict[str, object]] = {
    "no K": {"M": _ONE},
    "no M": {"K": _TWO},
    "nothing": {},
    "other names": {"m": _ONE, "k": _TWO},
    "one name more": {"M": _ONE, "K": _TWO, "B": _ONE},
    "M not square": {"M": np.ones((2, 3)), "K": _TWO},
    "K of three dimensions": {"M": _ONE, "K": np.ones((2, 2, 2))},
    "K a number": {"M": _ONE, "K": np.array(1.0)},
    "K of other size": {"M": _ONE, "K": np.eye(3)},
    "M empty": {"M": np.empty((0, 0)), "K": np.empty((0, 0))},
    "K not symmetric": {"M": _ONE, "K": np.array([[2.0, -1.0], [0.0, 1.0]])},
    "K not definite": {"M": _ONE, "K": np.array([[1.0, -1.0], [-1.0, 1.0]])},
    "K negative": {"M": _ONE, "K": -_TWO},
    "M of zeros": {"M": np.zeros((2, 2)), "K": _TWO},
    "M with nan": {"M": np.array([[1.0, math.nan], [math.nan, 1.0]]), "K": _TWO},
    "K with inf": {"M": _ONE, "K": np.array([[math.inf, 0.0], [0.0, 1.0]])},
    "K of 1e200": {"M": _ONE, "K": 1e200 * _TWO},
    "M complex": {"M": _ONE * 1j, "K": _TWO},
    "M text": {"M": np.array([["1", "0"], ["0", "1"]]), "K": _TWO},
    "M of dates": {"M": np.zeros((2, 2), "M8[s]"), "K": _TWO},
    "C negative": {"M": _ONE, "K": _TWO, "C": -0.1 * _TWO},
    "C not symmetric": {"M": _ONE, "K": _TWO, "C": _TURN},
    "M pickled": {"M": np.array([[1, None], [None, 1]], dtype=object), "K": _TWO},
}


def _frame(**more: str) -> bytes:
    lines = "".join(f"{key} = {value}\n" for key, value in more.items())
    system = f'[system]\nmatrices = "bad.npz"\ndamping_ratios = 0.05\n{lines}'
    return f"{system}[grid]\nr = [0.4, 0.9]\nbeta = [0.2]\n".encode()


def _archive(folder: Path, content: dict) -> bytes:
    path = folder / "made.npz"
    np.savez(path, **content)
    return path.read_bytes()


def matrices(folder: Path) -> Iterator[Case]:
    """Invalid matrix files of every kind."""
    good = _archive(folder, {"M": _ONE, "K": _TWO})
    np.save(folder / "made.npy", _ONE)
    contents = {name: _archive(folder, content) for name, content in _MATRICES.items()}
    contents |= {
        "empty": b"", "text": b"M = 1\n", "cut off": good[:-40], "half": good[: len(good) // 2],
        "one array": (folder / "made.npy").read_bytes(), "zeros": bytes(500),
        "an archive of nothing": good[-22:],
        "flipped": good[:80] + bytes(255 - byte for byte in good[80:120]) + good[120:],
    }  # fmt: skip
    for about, content in contents.items():
        config = _frame()
        if about.startswith("C "):
            config = config.replace(b"damping_ratios = 0.05\n", b"")
        files = {"bad.toml": config, "bad.npz": content}
        yield Case(("map", "bad.toml", "-o", "out.nc"), (("system.matrices",),), files, f"matrices: {about}")
    for key, value in (
        ("mass_ratios", "[1.0, 1.0]"), ("stiffness_ratios", "[1.0, 1.0]"), ("frequency_scale", "0.0"),
        ("frequency_scale", "-1"), ("frequency_scale", "nan"), ("stiffness_scale", "inf"),
        ("contact_masses", "[3]"), ("load_mass", "3"), ("frequency_scale", "1e200"),
    ):  # fmt: skip
        files = {"bad.toml": _frame(**{key: value}), "bad.npz": good}
        says = ((f"system.{key}",), ways(value))
        yield Case(("boundaries", "bad.toml", "-o", "out.nc"), says, files, f"with matrices, {key} = {value}")


def configurations(folder: Path) -> list[Case]:
    """All of them; `folder` to work in."""
    return [*by_key(), *whole_files(), *matrices(folder)]
