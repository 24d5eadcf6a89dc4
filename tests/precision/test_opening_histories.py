"""Motions under records of contacts that open and piecewise linear springs: an independent integration,
steady states, limiting cases that other systems cover, and the balance of energy.
"""

import numpy as np
import pytest
from opening_truth import Course, Truth

import frictionmap as fm
from frictionmap.command_line.cli import main

MATRICES = {"M": np.eye(2), "K": np.array([[1.0, 0.2], [0.2, 1.2]]), "C": np.diag([0.04, 0.06])}
PUSH = [1.0, 0.5]
GAP = {"masses": [1], "gap": 0.5, "stiffness": 4.0}
PLAY = {"masses": [1, 2], "backlash": 0.4, "stiffness": 3.0}
FIRST, SECOND = np.array([1.0, 0.0]), np.array([0.0, 1.0])
BOTH = {"c": FIRST, "d": SECOND, "kn": 1.0, "phi": 0.4, "N0": 0.5, "kt": 0.0, "mu": 1.0, "belt": 0.0}

CASES = {
    "spring": ({"kt": 3.0}, []), "rigid": ({}, []), "static": ({"mu": 1.3}, []),
    "springs": ({}, [GAP, PLAY]), "all with springs": ({"kt": 3.0}, [GAP, PLAY]),
    "wedge": ({"d": FIRST, "kn": 0.3, "phi": 0.3, "N0": 1.0}, []), "open at first": ({"N0": -0.3}, []),
    "belt": ({"kt": 3.0, "belt": 0.2}, [GAP]),
}  # fmt: skip


def noise(seed, count=50):
    values = np.convolve(np.random.default_rng(seed).normal(size=count), [0.75, 1.5, 0.75], mode="same")
    values[0] = 0.0
    return fm.Record(values, 0.35, quantity="force", vector=PUSH)


def system_of(own, springs=(), **keys):
    normal = {
        "vector": own["d"].tolist(), "stiffness": own["kn"], "friction": own["phi"], "preload": own["N0"]
    }  # fmt: skip
    contact = {"normal": {name: one for name, one in normal.items() if one is not None}}
    contact["wall_velocity"] = own["belt"]
    if own.get("moved"):
        contact["kind"] = "joined-base-wall"
    contact |= {"stiffness": own["kt"]} if own["kt"] else {"mu": own["mu"]}
    found = {"springs": list(springs)} if springs else {}
    return fm.System(matrices=MATRICES, frequency_scale=1.0, contacts=[contact], **found, **keys)


def at_samples(ds, name, times):
    """Values (dof, samples)."""
    k = np.searchsorted(ds["time"].values, times * (1.0 - 1e-12))
    return ds[name].squeeze().values[:, k]


def elements_of(system):
    """The springs of a system as the independent integration takes them."""
    springs = system.contact_system.springs
    return [(one.direction, np.array(one.displacement), np.array(one.force), one.slopes) for one in springs]


def check_against(truth, ds, least=5):
    """States at the samples, events, and works of a motion are those of an independent integration."""
    states, damped, slid = truth.follow()
    times, n = truth.times, truth.n
    assert ds["status"].item() == 0
    np.testing.assert_allclose(at_samples(ds, "x", times).T, states[:, :n], rtol=0.0, atol=1e-10)
    np.testing.assert_allclose(at_samples(ds, "v", times).T, states[:, n:], rtol=0.0, atol=1e-10)
    times = [time for time, _ in truth.events]
    assert ds["events"].item() == len(times) >= least
    np.testing.assert_allclose(ds["event_time"].values.ravel(), times, rtol=0.0, atol=1e-9)
    opened = sum(what == ("normal",) for _, what in truth.events)
    kinds = ds["event_kind"].values.ravel()
    assert ((kinds == 3) | (kinds == 4)).sum() == opened
    assert (kinds == 5).sum() == sum(what[0] == "knot" for _, what in truth.events)
    assert ds["work_damping"].item() == pytest.approx(damped, abs=1e-10)
    assert ds["work_friction"].item() == pytest.approx(slid, abs=1e-10)


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("seed", [1, 2])
def test_an_independent_integration(case, seed):
    changed, springs = CASES[case]
    own, record = BOTH | changed, noise(seed)
    system = system_of(own, springs)
    load = Course.through(record.times, record.values)
    check_against(
        Truth(MATRICES, own, elements_of(system), PUSH, load), fm.history(system, record, after=0.0)
    )


def held_sine(r, cycles, samples=128):
    """A sine of constant amplitude as a run-up from r to r, exact to rounding."""
    return fm.Record.sweep(r, r, 2.0 * np.pi * cycles / r, quantity="force", vector=PUSH)


@pytest.mark.parametrize(("r", "kt", "springs"), [(1.5, 3.0, ()), (0.8, 0.0, ()), (1.2, 3.0, (GAP,))])
def test_a_long_sine_ends_in_the_steady_state(r, kt, springs):
    system = system_of(BOTH | {"kt": kt}, springs, load=[-1.0j * one for one in PUSH])
    cycles = 300
    steady = fm.response(system, r, 0.2)
    assert steady["period"].item() == 1
    ds = fm.history(system, held_sine(r, cycles), after=0.0)
    last = ds["time"].values >= 2.0 * np.pi * (cycles - 1) / r * (1.0 - 1e-12)
    tau = np.mod(r * ds["time"].values[last], 2.0 * np.pi)
    for name in ("x", "v"):
        rate = r if name == "v" else 1.0
        found = ds[name].squeeze().values[:, last]
        end = rate * steady[name].values[:, -1]
        np.testing.assert_allclose(found[:, -1], end, rtol=0.0, atol=1e-10)
        np.testing.assert_allclose(found[:, 0], end, rtol=0.0, atol=1e-10)
    assert tau[0] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("stiffness", [None, 3.0])
@pytest.mark.parametrize("base", [False, True])
def test_a_spring_that_nothing_reaches_changes_nothing(stiffness, base):
    contact = {} if stiffness is None else {"stiffness": stiffness}
    own = {"mass_ratios": [1, 2], "stiffness_ratios": [1, 0.5], "damping_ratios": 0.02, "contacts": [contact]}
    record = noise(3)
    if base:
        own |= {"excitation": "base", "damping_reference": "base"}
        record = fm.Record(record.values, 0.35)
    far = {"masses": [1, 2], "backlash": 1e3, "stiffness": 3.0}
    asked = {"beta": [0.1, 0.4], "mu": 1.2 if stiffness is None else 1.0, "after": 10.0 if base else "rest"}
    one = fm.history(fm.System(**own), record, **asked)
    other = fm.history(fm.System(**own, springs=[far]), record, **asked)
    tied = ("friction_amplitude_time", "beta_hold")  # a slide has one force all the time
    for name, values in one.drop_vars([name for name in tied if name in one]).items():
        size = max(1.0, np.abs(np.nan_to_num(values)).max())
        np.testing.assert_allclose(other[name], values, rtol=0.0, atol=1e-11 * size, err_msg=name)


def test_nearly_constant_normal_forces_are_those_of_contacts_without_them():
    """The error is proportional to k_n: with 1e-13 it is below 1e-11."""
    record = noise(4)
    for kt in (0.0, 3.0):
        system = system_of(BOTH | {"kn": 1e-13, "kt": kt})
        flat = {"stiffness": kt} if kt else {}
        other = fm.System(matrices=MATRICES, frequency_scale=1.0, contacts=[flat])
        one, two = (fm.history(each, record, beta=0.2, samples="none") for each in (system, other))
        for name in ("x_max", "x_min", "acceleration_max", "residual", "work_friction", "work_damping"):
            np.testing.assert_allclose(one[name], two[name], rtol=0.0, atol=1e-11, err_msg=name)
        assert one["events"].item() == two["events"].item()


def test_cut_and_continued():
    system, record = system_of(BOTH | {"kt": 3.0}, [GAP, PLAY]), noise(5)
    whole = fm.history(system, record, after=3.0)
    k = 20
    first = fm.Record(record.values[: k + 1], 0.35, quantity="force", vector=PUSH)
    rest = fm.Record(record.values[k:], 0.35, quantity="force", vector=PUSH)
    one = fm.history(system, first, after=0.0)
    two = fm.history(system, rest, after=3.0, start=one)
    np.testing.assert_allclose(two["x"].values[..., -1], whole["x"].values[..., -1], rtol=0.0, atol=1e-12)
    assert one["events"].item() + two["events"].item() == whole["events"].item()
    for name in ("work_load", "work_friction", "work_damping", "sliding_distance"):
        both = one[name].item() + two[name].item()
        assert both == pytest.approx(whole[name].item(), abs=1e-12), name


def test_peaks_and_energies_over_time():
    """Peaks are those of a record with 40 times the samples, and what lies between these."""
    system, record = system_of(BOTH | {"kt": 3.0}, [GAP, PLAY]), noise(6)
    ds = fm.history(system, record, after=5.0)
    fine = fm.Record(
        np.interp(np.linspace(0.0, record.duration, 40 * 49 + 1), record.times, record.values), 0.35 / 40,
        quantity="force", vector=PUSH,
    )  # fmt: skip
    many = fm.history(system, fine, after=5.0)
    for name in ("x", "acceleration", "normal_force", "friction", "z", "piecewise_force"):
        values = many[name].squeeze().values
        found = {"piecewise_force": "spring_force_max"}.get(name)
        if found:
            most = np.abs(values).max(axis=-1)
            np.testing.assert_allclose(ds[found].squeeze(), most, rtol=0.0, atol=1e-3, err_msg=name)
            assert (ds[found].squeeze().values >= most - 1e-12).all()
            continue
        high, low = values.max(axis=-1), values.min(axis=-1)
        assert (ds[f"{name}_max"].squeeze().values >= high - 1e-12).all(), name
        assert (ds[f"{name}_min"].squeeze().values <= low + 1e-12).all(), name
        np.testing.assert_allclose(ds[f"{name}_max"].squeeze(), high, rtol=0.0, atol=1e-3, err_msg=name)
    lost = many["lost_friction"].squeeze().values[-1] + many["lost_damping"].squeeze().values[-1]
    kept = many["stored_energy"].squeeze().values
    assert kept[0] == 0.0
    assert lost + kept[-1] == pytest.approx(ds["work_load"].item(), rel=2e-5)  # trapezoidal rule
    assert kept[-1] == pytest.approx(ds["energy"].item(), abs=1e-10)


def test_asleep_is_permanent_and_at_the_place_of_rest():
    system, record = system_of(BOTH | {"kt": 3.0}, [GAP, PLAY]), noise(7)
    ds = fm.history(system, record)
    assert ds["status"].item() == 0
    long = fm.history(system, record, after=ds["asleep_time"].item() - record.duration + 1500.0)
    assert long["events"].item() == ds["events"].item()
    np.testing.assert_allclose(
        long["x"].squeeze().values[:, -1], ds["residual"].squeeze().values, rtol=0.0, atol=1e-9
    )


def test_the_command_writes_what_it_reads(tmp_path, capsys):
    text = """\
[system]
mass_ratios = [1.0, 1.0]
stiffness_ratios = [1.0, 0.5]
damping_ratios = 0.02
contacts = [{ stiffness = 3.0, normal = { mass = 2, stiffness = 1.0, friction = 0.4, preload = 0.3 } }]
springs = [{ masses = [1, 2], gap = 0.5, stiffness = 4.0 }]
[record]
pulse = { kind = "half-sine", amplitude = 1.0, duration = 4.0 }
quantity = "force"
mass = 2
"""
    (tmp_path / "pulse.toml").write_text(text)
    assert main(["history", str(tmp_path / "pulse.toml"), "-o", str(tmp_path / "pulse.nc")]) == 0
    ds = fm.open(tmp_path / "pulse.nc")
    assert ds["separations"].item() == (ds["event_kind"] == 3).sum() > 0
    assert ds["spring_crossings"].item() == (ds["event_kind"] == 5).sum() > 0
    assert main(["info", str(tmp_path / "pulse.nc")]) == 0
    assert main(["plot", str(tmp_path / "pulse.nc"), "-o", str(tmp_path / "pulse.png")]) == 0
    assert (tmp_path / "pulse.png").stat().st_size > 10_000


def test_what_is_refused_is_named():
    varying = fm.Contact(normal_record=fm.Record([0.0, 0.5, 0.0], 0.1, quantity="force"))
    with pytest.raises(fm.InputError, match=r"contacts\[1\].normal_record"):
        fm.history(fm.System(contacts=[varying], springs=[GAP]), fm.Record([0.0, 1.0], 0.1, quantity="force"))
