"""Invalid calls of the Python API, valid calls in unusual form, and settings that must not be ignored."""

import random
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from .child import Child, Ended
from .verdict import (
    ACCEPTED,
    ANSWER,
    CRASH,
    FOREIGN,
    HANG,
    LINES,
    NOISE,
    REFUSED,
    VAGUE,
    Family,
    Words,
    unsaid,
)

#: Calls of the quick form, of each family.
_QUICK = 8

#: A call that compiles what the others need, and the seconds that it may take.
_EVERY_KERNEL = "fm.sweep(s, [0.5], [0.5], outputs=['regime', 'also_reachable', 'multiplier', 'amplitude'])"
_COMPILES = 1800.0

_NOT_TEXT = (
    "1",
    "None",
    "b'fixed-wall'",
    "['fixed-wall']",
    "'fixed wall'",
    "np.array(['fixed-wall'])",
    "''",
    "fm",
)
_NOT_WHOLE = ("0", "-1", "1.5", "'2'", "True", "nan", "[1]", "1j", "np.float64(2.0)", "10**30", "object()")
_NOT_SCALARS = ("'0.5'", "None", "nan", "inf", "-1", "-0.1", "[0.5]", "1j", "True", "np.array([0.5, 0.6])",
"{}",
                "object()", "b'1'", "np.float64('nan')", "np.datetime64('2020')", "10**400",
                "np.array('a')")  # fmt: skip
_NOT_AXES = ("'text'", "None", "[]", "[0.5, 0.5]", "[0.6, 0.5]", "[nan]", "[inf]", "[-1.0]", "[[0.5, 0.6]]",
"1j", "{}",
             "object()", "[True]", "'0.5'", "np.ma.masked_array([0.5, 0.6], [False, True])",
             "np.array(['a'])", "[None]",
             "np.array([], float)", "range(0)", "b'1'", "[[0.5], [0.6, 0.7]]", "np.array([1 + 1j])",
             "fm.System()",
             "np.array(['2020'], 'M8[D]')", "xr.DataArray([[0.5]])", "{0.5, 0.6}")  # fmt: skip
_NOT_SYSTEMS = ("None", "1", "'fixed-wall'", "{}", "fm.System", "fm.Solver()", "ds", "[s]")
_NOT_SOLVERS = ("1", "'rest'", "{}", "fm.System()", "fm.Solver", "True", "[fm.Solver()]")

_SYSTEM = {
    "contact": _NOT_TEXT,
    "contact_masses": ("[0]", "[2]", "[-1]", "[1.5]", "['1']", "[True]", "[]", "[1, 2]", "1", "'1'", "None",
    "{1}",
                       "[nan]", "[[1]]", "np.array([1.0])", "np.array(1)"),
    "load_mass": (*_NOT_WHOLE, "2"),
    "mass_ratios": ("[]", "[0]", "[-1]", "[2.0]", "['1']", "[True]", "[nan]", "[inf]", "[[1.0]]", "'1'",
    "1.0", "{1.0}",
                    "[None]", "[1j]", "np.array([[1.0]])", "[1.0, 0.0]", "[1.0, 2.0]",
                    "np.ma.masked_array([1.0], [True])"),
    "stiffness_ratios": ("[]", "[0]", "[-1]", "[2.0]", "['1']", "[True]", "[nan]", "[inf]", "'1'", "1.0",
    "[None]",
                         "[1.0, 2.0]", "object()"),
    "damping_ratios": ("'0.1'", "nan", "inf", "-0.1", "[]", "[0.1, 0.1]", "[-0.1]", "True", "1j", "1e9",
    "{}", "[[0.1]]",
                       "['0.1']", "b'1'", "object()", "np.ma.masked_array([0.1], [True])"),
    "matrices": ("1", "[]", "np.eye(2)", "''", "'nothere.npz'", "'.'", "{}", "{'M': np.eye(2)}",
    "b'frame.npz'",
                 "{'M': 1, 'K': 1}", "{'M': np.eye(2), 'K': None}", "{'M': np.eye(2), 'K': -np.eye(2)}",
                 "{'M': np.eye(2), 'K': np.eye(3)}", "{'M': np.eye(2), 'K': [[1, 0], [0]]}",
                 "{'M': np.eye(2), 'K': np.eye(2) * nan}", "{'M': np.eye(2), 'K': np.eye(2), 1: 2}",
                 "{'M': np.eye(2), 'K': np.ma.masked_array(np.eye(2), np.eye(2))}", "object()",
                 "'a\\0b.npz'"),
    "frequency_scale": ("2.0", "'1'", "nan"),
    "stiffness_scale": ("2.0", "'1'", "0.0", "None"),
    "excitation": tuple(value for value in _NOT_TEXT if value != "None"),  # which is the default
    "damping_reference": (*_NOT_TEXT, "'base'"),
    "load": ("[]", "[1.0, 1.0]", "[0.0]", "'1'", "[nan]", "['1']", "1.0", "[None]", "[[1.0]]", "{1.0}",
    "[inf * 1j]"),
}  # fmt: skip
_SOLVER = {
    "start": _NOT_TEXT,
    "cycles": _NOT_WHOLE,
    "tolerance": (*_NOT_SCALARS, "0.0", "1.0", "1e-20"),
    "steps": (*_NOT_WHOLE, "1", "1001"),
    "skip": _NOT_TEXT,
    "steady": _NOT_TEXT,
    "outputs": ("[]", "'regime'", "1", "None", "['regimes']", "[1]", "{'regime'}", "[['regime']]",
    "b'regime'",
                "np.array(['regime'])", "[None]"),
}  # fmt: skip


@dataclass(frozen=True)
class Call:
    """A call, and the words that its error must contain."""

    code: str
    says: Words = ()
    plain: str = ""  # the call that has to give the same answer
    errors: tuple[str, ...] = ("InputError",)
    may_refuse: bool = False

    def __str__(self) -> str:
        return self.code


def _keywords() -> Iterator[Call]:
    """Arguments of System and Solver, one by one."""
    for kind, arguments in (("System", _SYSTEM), ("Solver", _SOLVER)):
        for name, values in arguments.items():
            for value in values:
                yield Call(f"fm.{kind}({name}={value})", ((name,),))


def _functions() -> Iterator[Call]:
    """Arguments of the functions that compute."""
    for value in _NOT_AXES:
        yield Call(f"fm.sweep(s, {value}, [0.5])", (("r",),))
        yield Call(f"fm.sweep(s, [0.5], {value})", (("beta",),))
        yield Call(f"fm.sweep(s, [0.5], [0.5], {value})", (("mu",),))
        yield Call(f"fm.boundaries(s, {value})", (("r",),))
    for value in (*_NOT_SCALARS, "0.0", "1e9"):
        yield Call(f"fm.response(s, {value}, 0.5)", (("r",),))
        yield Call(f"fm.continuous_motion(s, {value}, 0.1)", (("r",),))
    for value in _NOT_SCALARS:
        yield Call(f"fm.response(s, 0.5, {value})", (("beta",),))
        yield Call(f"fm.response(s, 0.5, 0.5, {value})", (("mu",),))
        yield Call(f"fm.continuous_motion(s, 0.5, {value})", (("beta",),))
    for value in _NOT_SYSTEMS:
        yield Call(f"fm.sweep({value}, [0.5], [0.5])", (("system",),))
        yield Call(f"fm.response({value}, 0.5, 0.5)", (("system",),))
        yield Call(f"fm.boundaries({value}, [0.5])", (("system",),))
        yield Call(f"fm.continuous_motion({value}, 0.5, 0.1)", (("system",),))
    for value in _NOT_SOLVERS:
        yield Call(f"fm.sweep(s, [0.5], [0.5], solver={value})", (("solver",),))
        yield Call(f"fm.response(s, 0.5, 0.5, solver={value})", (("solver",),))
    for value in ("0", "-1", "1.5", "'2'", "True", "nan", "[1]"):
        yield Call(f"fm.sweep(s, [0.5], [0.5], threads={value})", (("threads",),))
        yield Call(f"fm.response(s, 0.5, 0.5, points={value})", (("points",),))
    for value in ("1", "'x'", "[]"):
        yield Call(f"fm.sweep(s, [0.5], [0.5], progress={value})", (("progress",),))


def _others() -> Iterator[Call]:
    """Files, pictures, and unknown names."""
    for value in (
        "1",
        "None",
        "'nothere.toml'",
        "'.'",
        "['c.toml']",
        "b'c.toml'",
        "''",
        "object()",
        "'a\\0b'",
    ):
        yield Call(f"fm.load_config({value})", (("configuration", "path"),))
    for value in ("'grid.r=1'", "[1]", "1", "[None]", "{'grid.r': 1}", "['grid.r']", "[b'grid.r=1']"):
        yield Call(f"fm.load_config('c.toml', {value})", (("overrides", "--set"),))
    for value in (
        "1",
        "None",
        "xr.Dataset()",
        "one",
        "limits",
        "ds.regime",
        "'m.nc'",
        "ds.isel(mu=0).drop_vars('beta')",
    ):
        yield Call(f"fm.plot_regimes({value})")
    for value in ("1", "None", "xr.Dataset()", "ds", "limits", "one.z", "'x.nc'", "one.drop_vars('z')"):
        yield Call(f"fm.plot_response({value})")
    for value in ("1", "'x'", "[]", "ds"):
        yield Call(f"fm.plot_regimes(ds.isel(mu=0), ax={value})", (("ax",),))
    yield Call(
        "fm.plot_regimes(ds, ax=__import__('matplotlib.figure').figure.Figure().subplots())", (("ax",),)
    )
    unknown = ("InputError", "TypeError")  # Python's own word for an argument that does not exist
    for code in ("fm.sweep(s, [0.5], [0.5], step=3)", "fm.response(s, 0.5, 0.5, step=3)", "fm.Solver(step=3)",
                 "fm.sweep(s, [0.5], [0.5], output=['regime'])", "fm.System(zeta=0.1)"):  # fmt: skip
        yield Call(code, ((code.rpartition(", ")[2].rpartition("(")[2].partition("=")[0],),), errors=unknown)


#: Good calls, and the plain ones that they have to agree with.
_GOOD = (
    ("fm.response(s, np.array(0.4), 0.2)", "fm.response(s, 0.4, 0.2)"),
    ("fm.response(s, 0.4, np.array(0.2))", "fm.response(s, 0.4, 0.2)"),
    ("fm.response(s, xr.DataArray(0.4), xr.DataArray(0.2))", "fm.response(s, 0.4, 0.2)"),
    ("fm.response(s, ds.r[0], ds.beta[0])", "fm.response(s, 0.4, 0.2)"),
    ("fm.response(s, ds.r[0], ds.beta[0], ds.mu[1])", "fm.response(s, 0.4, 0.2, 1.5)"),
    ("fm.response(s, ds.r.values[0], ds.beta.values[0])", "fm.response(s, 0.4, 0.2)"),
    ("fm.response(s, 1, 0)", "fm.response(s, 1.0, 0.0)"),
    ("fm.response(s, np.int8(1), np.uint8(0))", "fm.response(s, 1.0, 0.0)"),
    ("fm.response(s, np.float32(0.5), np.float16(0.25))", "fm.response(s, 0.5, 0.25)"),
    ("fm.response(s, 0.5, 0.25, mu=2)", "fm.response(s, 0.5, 0.25, mu=2.0)"),
    ("fm.response(s, 0.5, 0.25, points=np.int64(64))", "fm.response(s, 0.5, 0.25, points=64)"),
    ("fm.sweep(s, 0.5, 0.25)", "fm.sweep(s, [0.5], [0.25])"),
    ("fm.sweep(s, (0.5, 0.6), (0.25,))", "fm.sweep(s, [0.5, 0.6], [0.25])"),
    ("fm.sweep(s, range(1, 4), [0, 1])", "fm.sweep(s, [1.0, 2.0, 3.0], [0.0, 1.0])"),
    ("fm.sweep(s, np.array(0.5), np.float32(0.25))", "fm.sweep(s, [0.5], [0.25])"),
    ("fm.sweep(s, ds.r, ds.beta, ds.mu)", "fm.sweep(s, [0.4, 0.9], [0.2, 0.5, 1.2], [1.0, 1.5])"),
    ("fm.sweep(s, ds.r[1], ds.beta[1:], ds.mu[0])", "fm.sweep(s, [0.9], [0.5, 1.2], [1.0])"),
    ("fm.sweep(s, np.arange(8)[2::3], [0.5])", "fm.sweep(s, [2.0, 5.0], [0.5])"),
    ("fm.sweep(s, np.array([2, 1], 'f4')[::-1], [0.5])", "fm.sweep(s, [1.0, 2.0], [0.5])"),
    ("fm.sweep(s, np.array([0.5], '>f8'), [0.5])", "fm.sweep(s, [0.5], [0.5])"),
    ("fm.sweep(s, np.ma.masked_array([0.5, 0.6]), [0.5])", "fm.sweep(s, [0.5, 0.6], [0.5])"),
    ("fm.sweep(s, [0.5], [0.5], threads=np.int32(1))", "fm.sweep(s, [0.5], [0.5])"),
    ("fm.sweep(s, [0.5], [0.5], threads=64)", "fm.sweep(s, [0.5], [0.5])"),
    ("fm.sweep(s, [0.5], [0.5], solver=fm.Solver(start='moving'))",
    "fm.sweep(s, [0.5], [0.5], start='moving')"),
    ("fm.sweep(s, [0.5], [0.5], outputs=('regime', 'regime'))",
    "fm.sweep(s, [0.5], [0.5], outputs=['regime'])"),
    ("fm.boundaries(s, 0.5)", "fm.boundaries(s, [0.5])"),
    ("fm.boundaries(s, ds.r, ds.mu)", "fm.boundaries(s, [0.4, 0.9], [1.0, 1.5])"),
    ("fm.boundaries(s, r=(1,), mu=2)", "fm.boundaries(s, [1.0], [2.0])"),
    ("fm.continuous_motion(s, np.array(0.5), xr.DataArray(0.1)).amplitude",
     "fm.continuous_motion(s, 0.5, 0.1).amplitude"),
    ("fm.continuous_motion(s, 1, 0).amplitude", "fm.continuous_motion(s, 1.0, 0.0).amplitude"),
    ("fm.System(damping_ratios=np.array(0.05))", "s"),
    ("fm.System(damping_ratios=np.array([0.05]))", "s"),
    ("fm.System(damping_ratios=(0.05,))", "s"),
    ("fm.System(damping_ratios=xr.DataArray([0.05]))", "s"),
    ("fm.System(damping_ratios=1)", "fm.System(damping_ratios=1.0)"),
    ("fm.System(contact_masses=np.array([1]), damping_ratios=0.05)", "s"),
    ("fm.System(mass_ratios=np.array([1, 2]), stiffness_ratios=(1, 2))",
     "fm.System(mass_ratios=[1.0, 2.0], stiffness_ratios=[1.0, 2.0])"),
    ("fm.System(matrices={'M': [[1, 0], [0, 1]], 'K': [[2, -1], [-1, 1]]})",
     "fm.System(matrices={'M': np.eye(2), 'K': np.array([[2.0, -1.0], [-1.0, 1.0]])})"),
    ("fm.Solver(cycles=np.int64(100), tolerance=np.float32(0.0009765625))",
     "fm.Solver(cycles=100, tolerance=0.0009765625)"),
    ("fm.load_config(__import__('pathlib').Path('c.toml')).text", "fm.load_config('c.toml').text"),
    ("fm.load_config('c.toml', ('grid.r=[1]',)).r", "fm.load_config('c.toml', ['grid.r=[1.0]']).r"),
)  # fmt: skip

#: Settings that may be honoured or refused, never dropped: true where they are honoured.
_HONOURED = (
    "'status' in fm.sweep(s, [0.5], [0.5], solver=fm.Solver(), outputs=['status'])",
    "'status' in fm.response(s, 0.4, 0.2, outputs=['status'])",
    "'multiplier' in fm.response(s, 0.4, 0.2, solver=fm.Solver(outputs=['multiplier']))",
    "fm.sweep(s, [0.5], [0.5], solver=fm.Solver(), cycles=0) is None",
    "fm.response(s, 0.5, 0.5, solver=fm.Solver(), start='nowhere') is None",
    "fm.System('joined-base-wall', excitation='force').excitation == 'force'",
    "fm.sweep(s, np.ma.masked_array([0.4, 0.5], [True, False]), [0.5]).r.size == 1",
    "fm.sweep(s, [0.5], np.ma.masked_array([0.4, 0.5], [True, False])).beta.size == 1",
    "fm.sweep(s, [0.5], [0.5], np.ma.masked_array([1.0, 2.0], [True, False])).mu.size == 1",
    "fm.boundaries(s, np.ma.masked_array([0.4, 0.5], [True, False])).r.size == 1",
    "fm.System(mass_ratios=[1, 1], stiffness_ratios=np.ma.masked_array([1.0, 2.0], [0, 1]))"
    ".stiffness_ratios == (1.0,)",
    "fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1],"
    " damping_ratios=np.ma.masked_array([0.1, 0.2], [0, 1])).damping_ratios == (0.1,)",
    "fm.load_config('c.toml', ['grid.r={ start = 0.1, stop = 1.0, num = 1 }']).r[-1] == 1.0",
    "fm.load_config('c.toml', ['grid.mu=[1.0]\\nx = 2']) is None",
    "fm.load_config('c.toml', ['system.contact=joined-base-wall', 'system.excitation=force'])"
    ".system.excitation == 'force'",
    "fm.sweep(s, np.array([1, 2], 'm8[s]'), [0.5]) is None",
)  # fmt: skip


def _wrong_error(call: Call, found: dict) -> str | None:
    """Check the error of a call; return the defect."""
    if call.plain and not call.may_refuse:
        return REFUSED
    if found["error"] not in call.errors:
        return FOREIGN
    if len(found["words"].splitlines()) != 1:
        return LINES
    return VAGUE if unsaid(found["words"], call.says) else None


def wrong_outcome(call: Call, found: dict) -> str | None:
    """Check the outcome of a call; return the defect."""
    if found["error"]:
        return _wrong_error(call, found)
    if not call.plain:
        return ACCEPTED
    if not found["same"]:
        return ANSWER
    return NOISE if found["warned"] or found["said"] else None


def families() -> dict[str, list[Call]]:
    """All calls, by name of the family."""
    return {
        "bad Python calls": [*_keywords(), *_functions(), *_others()],
        "good Python calls in unusual dress": [Call(code, plain=plain) for code, plain in _GOOD],
        "settings honoured or refused": [Call(code, plain="True", may_refuse=True) for code in _HONOURED],
    }


def run(child: Child, folder: Path, quick: bool) -> list[Family]:
    """Run all three families; `folder` holds c.toml."""
    tried = []
    child.ask(limit=_COMPILES, do="call", code=_EVERY_KERNEL, folder=str(folder))
    for name, calls in families().items():
        family = Family(name)
        for call in random.Random(2).sample(calls, min(_QUICK, len(calls))) if quick else calls:
            try:
                found = child.ask(do="call", code=call.code, plain=call.plain, folder=str(folder))
            except Ended as end:
                family.add(call, HANG if end.hang else CRASH, end)
                continue
            family.add(call, wrong_outcome(call, found), f"{found['error']}: {found['words']}")
        tried.append(family)
    return tried
