"""Motions in time under records, against independent programs, closed forms and what is proved about them."""

import math

import numpy as np
import pytest
from lcg_records import lcg
from scipy.linalg import expm

import frictionmap as fm

_KINDS = {"wall": "fixed-wall", "base": "joined-base-wall", "masses": "between-masses"}
_QUANTITIES = {"force": "force", "base acceleration": "acceleration", "base displacement": "displacement"}
_HOW = {"zoh": "hold", "natural": "cubic", "clamped": "cubic", "linear": "linear"}


def _record(given, **options):
    kind, how = given["kind"], _HOW[given.get("interpolation", "linear")]
    options = {"interpolation": how, "scale": given.get("scale", 1.0), **options}
    if kind == "polyline":
        time, values = np.array(given["points"], dtype=float).T
        return fm.Record(values, time=time, **options)
    if kind == "lcg":
        values = lcg(*(given[key] for key in ("seed", "n", "ar", "envelope")))
    elif kind == "samples":
        values = given["values"]
    else:
        t = np.arange(given["n"]) * given["dt"]
        rate = (given["f1"] - given["f0"]) / (2.0 * t[-1])
        values = np.sin(2.0 * np.pi * (given["f0"] * t + rate * t * t))
    return fm.Record(values, given["dt"], **options)


def _system(row):
    base = row["load"]["kind"] != "force"
    contacts = []
    for j, (kind, *masses) in enumerate(row["contacts"]):
        own = {"kind": _KINDS[kind], "masses": masses, "ratio": row["beta"][j]}
        if row.get("kt") and row["kt"][j]:
            own["stiffness"] = row["kt"][j]
        else:
            own["mu"] = row["mu"][j]
        if "belt" in row:
            own["wall_velocity"] = row["belt"][j]
        if "normal" in row:
            factor = row["normal"]["factor"]
            own["normal_record"] = _record(
                row["normal"]["record"] | {"scale": factor[j] if isinstance(factor, list) else factor},
                quantity="force",
            )
        contacts.append(fm.Contact(**own))
    moved = {"excitation": "base", "damping_reference": "base"} if base else {}
    matrices = {name: np.array(row[name]) for name in "MKC"}
    return fm.System(matrices=matrices, frequency_scale=1.0, contacts=contacts, **moved)


#: Variable of a dataset, and its name in the table of the reference.
_COMPARED = {
    "x_max": "x_max", "x_min": "x_min", "z_max": "z_max", "z_min": "z_min", "friction_max": "force_max",
    "friction_min": "force_min", "acceleration_max": "acceleration_max",
    "acceleration_min": "acceleration_min", "base_force_max": "base_force_max",
    "base_force_min": "base_force_min", "sliding_distance": "sliding_distance",
    "work_friction": "work_friction",
}  # fmt: skip


def _check(row):
    system, load = _system(row), row["load"]
    vector = {"vector": load["vector"]} if load["kind"] == "force" else {}
    record = _record(row["record"], quantity=_QUANTITIES[load["kind"]], **vector)
    start = {key: row[f"{key}0"] for key in "xv" if f"{key}0" in row} or "rest"
    ds = fm.history(system, record, beta=1.0, start=start, after=row["ring"])
    wanted = row["result"]
    for name, theirs in _COMPARED.items():
        pair = wanted[theirs]
        ends = [wanted[theirs.replace(*swap)] for swap in (("max", "min"), ("min", "max"))]
        size = max(np.abs(values).max() for values in (pair, *ends))
        assert ds[name].values.ravel() == pytest.approx(pair, rel=0.0, abs=1e-10 * max(size, 1e-9)), name
    works = [abs(wanted[name]) for name in ("work_load", "work_walls", "work_damping")]
    for name in ("work_load", "work_walls", "work_damping"):
        assert ds[name].item() == pytest.approx(wanted[name], rel=0.0, abs=1e-10 * max(works)), name
    elastic = np.array(row.get("kt", [0.0] * len(row["contacts"]))) > 0.0
    ends = np.where(elastic, ds.get("slips", 0.0 * ds.turns).values, ds.get("stops", 0.0 * ds.turns).values)
    assert ends.ravel().tolist() == wanted["stops"]
    assert ds.turns.values.ravel().tolist() == wanted["turns"]
    assert ds.events.item() == wanted["events"]
    stuck = ds.stuck_fraction.values.ravel() * ds.end_time.item()
    assert stuck == pytest.approx(wanted["stuck_time"], rel=1e-10)
    if wanted["events"]:
        assert ds.event_time[..., 0].item() == pytest.approx(wanted["first_event"], rel=1e-11)
        assert ds.event_time[..., -1].item() == pytest.approx(wanted["last_event"], rel=1e-11)
    if wanted["asleep"]:
        size = np.abs([wanted["x_max"], wanted["x_min"]]).max()
        assert ds.residual.values.ravel() == pytest.approx(wanted["x_rest"], rel=0.0, abs=1e-10 * size)


def test_motions_of_independent_programs(reference_table):
    rows = reference_table("history.json")["rows"]
    assert len(rows) > 50
    for row in rows:
        _check(row)


def test_a_limit_that_a_sample_touches_is_no_release(reference_table):
    for row in reference_table("history.json")["ties"]:
        row = row | {"contacts": [["base", 1]]}
        ds = fm.history(_system(row), _record(row["record"]), beta=1.0)
        assert ds.events.item() == 0


_ROW = {
    "M": [[1.0]], "K": [[1.0]], "C": [[0.1]], "contacts": [["base", 1]], "beta": [0.26], "mu": [1.0],
    "load": {"kind": "base acceleration"},
    "record": {
        "kind": "lcg", "seed": 470941797, "n": 330, "dt": 0.11, "ar": [1.31, -0.76], "envelope": [41, 165],
    },
}  # fmt: skip


def test_one_mass():
    ds = fm.history(_system(_ROW), _record(_ROW["record"]), beta=1.0, after=40.0)
    # two programs that share no code, history.md: Taylor series in long double, matrix exponentials
    assert ds.x_max.item() == pytest.approx(0.076678602069532, rel=1e-12)
    assert ds.acceleration_max.item() == pytest.approx(0.3644953442039622, rel=1e-12)
    assert ds.sliding_distance.item() == pytest.approx(0.8806398485310015, rel=1e-12)
    assert ds.residual.item() == pytest.approx(-0.04236166338634339, rel=1e-11)
    assert (ds.stops.item(), ds.turns.item(), ds.events.item()) == (28, 11, 67)


def _free(zeta, x0, beta):
    record = fm.Record([0.0, 0.0], 0.5, quantity="force")
    return fm.history(fm.System(damping_ratios=zeta), record, beta=beta, start={"x": [x0]})


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.4])
def test_free_decay(zeta):
    x0, b = 7.3, 0.5
    ds = _free(zeta, x0, b)
    s, x, k = math.sqrt(1.0 - zeta * zeta), x0, 0
    while x > b:  # history.md 7, 4: a half cycle is a damped one about -+b
        x, k = (x - b) * math.exp(-math.pi * zeta / s) - b, k + 1
    assert ds.residual.item() == pytest.approx((-1) ** k * x, rel=1e-11)
    assert ds.event_time[..., -1].item() == pytest.approx(k * math.pi / s, rel=1e-12)
    assert ds.turns.item() == k - 1


def test_an_overdamped_slide_creeps_to_its_limit():
    ds = _free(1.5, 5.0, 0.2)
    assert ds.status.item() == 2  # creeping
    assert ds.residual.item() == pytest.approx(0.2, rel=1e-12)


_FRAME = fm.System(
    mass_ratios=[1.0, 1.2, 0.8], stiffness_ratios=[1.0, 0.9, 0.7], damping_ratios=0.03, excitation="base",
    damping_reference="base",
    contacts=[fm.Contact("joined-base-wall", 1), fm.Contact("between-masses", [2, 3], ratio=0.4)],
)  # fmt: skip
_QUAKE = fm.Record(lcg(11, 500, [1.5, -0.7], [50, 200]), 0.1)


def test_a_long_sine_leads_to_the_steady_state():
    r, beta = 0.8, 0.35
    system = fm.System(damping_ratios=0.1)
    steady = fm.response(system, r, beta)
    t = np.arange(60 * 256 + 1) * (2.0 * np.pi / r / 256)
    sine = fm.Record(np.cos(r * t), t[1], quantity="force", interpolation="cubic")
    ds = fm.history(system, sine, beta=beta, after=0)
    last = ds.sel(time=slice(t[-257] - 1e-9, None))
    # the spline of 256 samples a cycle is off by its own error, 256^-4
    assert float(abs(last.x).max()) == pytest.approx(steady.amplitude.item(), rel=1e-8)
    kinds = ds.event_kind.values.ravel()[ds.event_time.values.ravel() > t[-257]]
    assert (kinds == 0).sum() == pytest.approx(steady.stops_per_cycle.item(), abs=0)


def test_scaled_records_and_friction_scale_the_motion():
    one = fm.history(_FRAME, _QUAKE, beta=0.2, samples="none")
    two = fm.history(_FRAME, _QUAKE, beta=0.5, scale=2.5, samples="none")
    assert two.amplitude.values == pytest.approx(2.5 * one.amplitude.values, rel=1e-12)
    assert two.stops.values.tolist() == one.stops.values.tolist()
    turned = fm.history(_FRAME, _QUAKE, beta=0.2, scale=-1.0, samples="none")
    assert turned.x_max.values == pytest.approx(-one.x_min.values, rel=1e-12)


def test_a_record_cut_in_two_gives_the_same_motion():
    values, cut = _QUAKE.values, 233
    whole = fm.history(_FRAME, _QUAKE, beta=0.2, after=0)
    first = fm.history(_FRAME, fm.Record(values[: cut + 1], 0.1), beta=0.2, after=0)
    second = fm.history(_FRAME, fm.Record(values[cut:], 0.1), beta=0.2, after=0, start=first)
    at_end = whole.x.values[..., -1]
    assert second.x.values[..., -1] == pytest.approx(at_end, rel=1e-11)
    assert first.events.item() + second.events.item() == whole.events.item()


def test_the_same_bits_for_any_threads():
    options = {"beta": [0.05, 0.2, 0.4], "mu": [1.0, 1.3], "scale": [0.5, 1.0], "samples": 7}
    one = fm.history(_FRAME, [_QUAKE, _QUAKE], threads=1, **options)
    assert fm.history(_FRAME, [_QUAKE, _QUAKE], threads=3, **options).equals(one)


def test_from_beta_hold_on_nothing_moves():
    hold = fm.history(_FRAME, _QUAKE, beta=1.0, samples="none").beta_hold.item()
    above = fm.history(_FRAME, _QUAKE, beta=hold * (1.0 + 1e-9), samples="none")
    below = fm.history(_FRAME, _QUAKE, beta=hold * (1.0 - 1e-9), samples="none")
    assert above.events.item() == 0
    assert below.events.item() > 0


def test_a_base_that_moves_is_the_force_in_absolute_coordinates():
    """Relative coordinates under -M iota a, and absolute ones under K iota u + C iota u'."""
    t = np.arange(200) * 0.1
    u = np.sin(0.9 * t) * (t / t[-1]) ** 2 * (1.0 - t / t[-1]) ** 2
    system = fm.System(damping_ratios=0.04, contacts=[fm.Contact("fixed-wall", 1)])
    base = fm.history(system, fm.Record(u, 0.1, quantity="displacement"), beta=0.01, after=0)
    from scipy.interpolate import CubicSpline

    fine = np.arange(199 * 40 + 1) * 0.0025
    spline = CubicSpline(t, u, bc_type="clamped")
    force = spline(fine) + 0.08 * spline(fine, 1)
    absolute = fm.history(
        system, fm.Record(force, 0.0025, quantity="force", interpolation="cubic"), beta=0.01, after=0
    )
    # z is the absolute place of the mass in front of a wall at rest
    assert base.z_max.item() == pytest.approx(absolute.z_max.item(), rel=1e-9)
    assert base.work_friction.item() == pytest.approx(absolute.work_friction.item(), rel=1e-8)
    assert base.stops.item() == absolute.stops.item()


@pytest.mark.parametrize("springs", [{}, {"springs": [{"masses": [1, 2], "gap": 1e3, "stiffness": 1.0}]}])
@pytest.mark.parametrize(("mu", "stiffness"), [(1.2, None), (1.0, None), (1.0, 2.0)])
def test_a_wall_is_left_behind_by_a_base_that_keeps_its_velocity(mu, stiffness, springs):
    """After the record as under one that continues with zeros; the wall moves relative to the base."""
    own = {} if stiffness is None else {"stiffness": stiffness}
    system = fm.System(
        mass_ratios=[1.0] * 3, stiffness_ratios=[1.0] * 3, damping_ratios=0.05, excitation="base",
        contacts=[fm.Contact("fixed-wall", 3, **own)], **springs,
    )  # fmt: skip
    values = np.append(np.random.default_rng(5).normal(size=12), np.zeros(101))
    options = {"beta": 0.1, "mu": mu}
    short = fm.history(system, fm.Record(values[:13], 0.7, quantity="acceleration"), after=70.0, **options)
    long = fm.history(system, fm.Record(values, 0.7, quantity="acceleration"), after=0, **options)
    assert short.friction_amplitude.item() <= mu * 0.1 * (1.0 + 1e-12)
    assert short.events.item() == long.events.item() > 5
    for name in ("friction_max", "friction_min", "z_max", "z_min", "work_friction", "sliding_distance"):
        assert short[name].item() == pytest.approx(long[name].item(), rel=1e-10), name
    np.testing.assert_allclose(short.x.values[..., -1], long.x.values[..., -1], rtol=0.0, atol=1e-10)


def test_the_least_median_of_a_suite(reference_table):
    """Three local minima, the least one on a kink where two records are equal."""
    wanted = reference_table("history.json")["design"]
    records = [fm.Record(lcg(seed, 400, [1.5, -0.7], [50, 200]), 0.1) for seed in range(1, 12)]
    system = fm.System(
        damping_ratios=0.05, excitation="base", damping_reference="base",
        contacts=[fm.Contact("joined-base-wall", 1)],
    )  # fmt: skip
    ds = fm.design.least_median(system, records, (0.02, 1.0), after=20.0)
    assert ds.beta_search.values == pytest.approx(wanted["grid_beta"], rel=1e-12)
    assert ds.peak_of_beta.values == pytest.approx(wanted["median_acceleration"], rel=1e-10)
    assert ds.peak.item() == pytest.approx(wanted["median_peak_acceleration"], rel=1e-11)
    assert ds.beta.item() == pytest.approx(wanted["beta"], rel=1e-10)
    assert ds.peak_of_record.values == pytest.approx(wanted["peaks"], rel=1e-9)


@pytest.mark.parametrize(
    ("values", "how", "mu", "events"),
    [
        ([1.0, 1.0, 1.0, 0.5], "hold", 2.0, 0),  # at its limit all the time
        ([0.0, 0.25, 0.5, 0.5, 0.375, 0.5, -0.5, -0.5, 0.0] * 20, "hold", 1.0, 0),
        ([0.0, 0.3, 0.8, 1.0, 0.8, 0.3, 0.0], "cubic", 2.0, 0),  # the largest value is that of a sample
        ([0.0, 0.3, 1.0, 0.95, 0.8, 0.3, 0.0], "cubic", 2.0, 2),  # the spline exceeds it between samples
    ],
)
def test_a_limit_that_is_touched_holds(values, how, mu, events):
    record = fm.Record(values, 0.25, quantity="force", interpolation=how)
    system = fm.System(contacts=[fm.Contact("fixed-wall", 1)])
    ds = fm.history(system, record, beta=0.5, mu=mu)
    assert ds.events.item() == events
    if not events:
        assert ds.x_max.item() == 0.0


def test_nothing_moves_after_the_record_either():
    """A kick on the upper mass arrives at the contact of the lower one when the record is over."""
    system = fm.System(
        mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0], damping_ratios=0.02,
        contacts=[fm.Contact("fixed-wall", 1)],
    )  # fmt: skip
    kick = fm.Record([0.0, 1.0, 0.0], 0.1, quantity="force", mass=2)
    hold = fm.history(system, kick, beta=1.0, samples="none").beta_hold.item()
    assert fm.history(system, kick, beta=hold * (1.0 + 1e-9), samples="none").events.item() == 0
    assert fm.history(system, kick, beta=hold * (1.0 - 1e-9), samples="none").events.item() > 0


def test_the_time_after_a_record_in_seconds_is_in_seconds():
    units = fm.Units(natural_frequency="2 Hz")
    quake = fm.Record([0.0, 1.0, -1.0, 0.0], 0.1, unit="m/s^2")
    ds = fm.history(fm.System(), quake, beta=0.1, units=units, after=1.5)
    assert ds.end_time.item() == pytest.approx(0.3 + 1.5, rel=1e-12)


@pytest.mark.parametrize("step", [0.002 / 0.25, 0.25, 0.5])
@pytest.mark.parametrize("springs", [None, [{"masses": [1], "gap": 10.0, "stiffness": 1.0}]])
def test_a_turn_at_a_sample_is_no_creep(step, springs):
    """The amplitude falls by 2 beta in half a cycle; a sample, or every one, is at a turn; both engines."""
    record = fm.Record([0.0, 0.0], 2.0 * np.pi * step, quantity="force")
    start = {"x": [3.05], "v": [0.0]}
    ds = fm.history(fm.System(springs=springs), record, beta=0.1, start=start).squeeze()
    assert int(ds.status) == 0
    assert float(ds.turns) == 14.0
    assert float(ds.residual) == pytest.approx(-0.05, abs=1e-12)


@pytest.mark.parametrize("mass", np.linspace(0.5, 1.4, 10))
def test_a_block_that_swings_on_its_contact_does_not_slip_again(mass):
    """No spring and no damper: after its slip the force swings to its limit, and exactly to it, for ever."""
    stiffness, friction = 0.53854953, 0.15026955
    matrices = {"M": [[mass]], "K": [[0.0]], "C": [[0.0]]}
    contact = fm.Contact(kind="fixed-wall", masses=(1,), stiffness=stiffness)
    system = fm.System(matrices=matrices, frequency_scale=1.0, stiffness_scale=1.0, contacts=[contact])
    record = fm.Record([0.0, 0.0, -1.99948058, 1.14852332, 0.26699955], 0.81511205, quantity="force", mass=1)
    found = fm.history(system, record, beta=[friction], mu=[1.0], after=40.0)
    assert found.slips.item() == 1
    assert found.turns.item() == 0
    stop = found.event_time.values.ravel()[1]
    x = found.x.values.ravel()[found.time.values.ravel() >= stop]
    assert np.ptp(x) <= 2.0 * friction / stiffness * (1.0 + 1e-12)


@pytest.mark.parametrize("how", ["hold", "linear"])
@pytest.mark.parametrize("stiffness", [(3.75, 1.75), (None, 3.25)])
def test_springs_of_contacts_without_friction_do_nothing(how, stiffness):
    """beta = 0: the linear motion, also of a mass that the load reaches only through another one."""
    mass, spring = np.eye(2), np.array([[1.75, -1.0], [-1.0, 1.25]])
    contacts = [fm.Contact(kind="fixed-wall", masses=(1 + j,), stiffness=k) for j, k in enumerate(stiffness)]
    matrices = {"M": mass, "K": spring, "C": np.zeros((2, 2))}
    system = fm.System(matrices=matrices, frequency_scale=1.0, stiffness_scale=1.0, contacts=contacts)
    values, step = np.array([0.0, 0.0, 2.0, -0.5, -1.0]), 0.25
    record = fm.Record(values, step, quantity="force", mass=1, interpolation=how)
    found = fm.history(system, record, beta=[0.0], mu=[1.0], after=4.0)
    assert found.status.item() == 0
    matrix = np.zeros((6, 6))
    matrix[:2, 2:4], matrix[2:4, :2] = np.eye(2), -spring
    matrix[2, 4], matrix[4, 5] = 1.0, 1.0
    state = np.zeros(4)
    slopes = np.diff(values) / step if how == "linear" else np.zeros(5)
    for load, slope in zip(values, slopes, strict=False):
        state = (expm(step * matrix) @ np.append(state, [load, slope]))[:4]
    state = (expm(4.0 * matrix) @ np.append(state, [0.0, 0.0]))[:4]
    motion = np.concatenate((found.x.values[..., -1].ravel(), found.v.values[..., -1].ravel()))
    np.testing.assert_allclose(motion, state, rtol=0, atol=1e-12)
    np.testing.assert_allclose(found.work_damping.item(), 0.0, atol=1e-12)


def test_forty_contacts_are_forty_masses():
    """Masses that nothing couples move as each does alone."""
    stiffness, ratio = np.linspace(0.5, 3.0, 40), np.linspace(0.2, 1.5, 40)
    samples = np.sin(0.7 * np.arange(60)) * np.exp(-0.03 * np.arange(60))
    record, all_of_it = (fm.Record(samples, 0.4, quantity="force", vector=one) for one in (None, [1.0] * 40))
    contacts = [fm.Contact("fixed-wall", k + 1, ratio=one) for k, one in enumerate(ratio)]
    matrices = {"M": np.eye(40), "K": np.diag(stiffness), "C": np.zeros((40, 40))}
    scales = {"frequency_scale": 1.0, "stiffness_scale": 1.0}
    every = fm.history(
        fm.System(matrices=matrices, contacts=contacts, **scales), all_of_it, beta=0.3
    ).squeeze()
    assert float(every.events) > 100.0
    for k in (0, 20, 31, 32, 39):
        one = {"M": np.eye(1), "K": stiffness[k : k + 1, np.newaxis], "C": np.zeros((1, 1))}
        contact = fm.Contact("fixed-wall", 1, ratio=ratio[k])
        alone = fm.history(fm.System(matrices=one, contacts=[contact], **scales), record, beta=0.3).squeeze()
        assert float(every.stops[k]) == float(alone.stops)
        assert float(every.turns[k]) == float(alone.turns)
        assert float(every.sliding_distance[k]) == pytest.approx(float(alone.sliding_distance), abs=1e-11)
        assert float(every.residual[k]) == pytest.approx(float(alone.residual), abs=1e-11)
