"""Springs in contacts under normal loads that are records, and the friction from which nothing moves."""

import numpy as np
import pytest
from lcg_records import lcg

import frictionmap as fm

_STEP = 0.2
_VALUES = lcg(11, 240, [1.31, -0.76], [30, 120])
_VALUES[0] = 0.0
_NORMAL = 0.95 * lcg(29, 240, [1.2, -0.6], [20, 200])
_RECORD = fm.Record(_VALUES, _STEP, quantity="force")
_TIMES = _STEP * np.arange(_VALUES.size)


def _normal(values, how):
    return fm.Record(values, _STEP, quantity="force", interpolation=how)


def _at(values, how):
    if how == "hold":
        return lambda t: values[np.minimum((t / _STEP + 1e-9).astype(int), values.size - 1)]
    return lambda t: np.interp(t, _TIMES, values)


def _stepped(stiffness, beta, zeta, normal, end, belt=0.0):
    """One mass by the trapezoidal rule with a slider that is brought back to its limit in every step."""
    steps = round(200 * end / _STEP)
    h = end / steps
    t = h * (np.arange(steps) + 1.0)
    load, limit = np.interp(t - 0.5 * h, _TIMES, _VALUES, right=0.0), beta * (1.0 + normal(t))
    x = v = f = distance = work = damping = 0.0
    highest = 0.0
    for k in range(steps):
        a = load[k] - x - f - 2.0 * zeta * v
        middle = v + 0.5 * h * a
        for _ in range(3):
            place = x + h * middle
            trial = f + stiffness * (place - x - belt * h)
            new = min(max(trial, -limit[k]), limit[k])
            mean = load[k] - 0.5 * (x + place) - 0.5 * (f + new) - 2.0 * zeta * middle
            middle = v + 0.5 * h * mean
        way = (trial - new) / stiffness
        distance += abs(way)
        work += 0.5 * (trial + new) * way  # of a slip at once: what the spring loses
        x, v, f = x + h * middle, v + h * mean, new
        damping += h * 2.0 * zeta * middle * middle
        highest = max(highest, abs(x))
    return {"amplitude": highest, "last": x, "sliding_distance": distance, "work_friction": work,
            "work_damping": damping}  # fmt: skip


@pytest.mark.parametrize("belt", [0.0, 0.05])
@pytest.mark.parametrize("how", ["linear", "hold"])
def test_one_mass_by_fixed_steps(how, belt):
    """Limits that jump or bend at samples; 200 steps a sample: 1e-3 of the largest."""
    stiffness, beta, zeta = 2.0, 0.2, 0.02
    contact = fm.Contact(stiffness=stiffness, normal_record=_normal(_NORMAL, how), wall_speed=belt)
    system = fm.System(contacts=[contact], damping_ratios=zeta)
    ds = fm.history(system, _RECORD, beta=beta, after=0.0)
    wanted = _stepped(stiffness, beta, zeta, _at(_NORMAL, how), ds.end_time.item(), belt)
    assert ds.events.item() > 40
    assert ds.amplitude.item() == pytest.approx(wanted["amplitude"], rel=1e-3)
    assert ds.x.values[..., -1].item() == pytest.approx(wanted["last"], abs=1e-3 * wanted["amplitude"])
    for name in ("sliding_distance", "work_friction", "work_damping"):
        assert ds[name].item() == pytest.approx(wanted[name], rel=3e-3), name


def test_a_limit_that_falls_lets_a_slider_go_at_once():
    """f = k_t x = (1 - cos 2 t)/4 for k = 1, k_t = 3 under a unit step; at t = 1 the limit falls below it."""
    falls = fm.Record([0.0, -0.8, -0.8], 1.0, quantity="force", interpolation="hold")
    contact = fm.Contact(stiffness=3.0, normal_record=falls)
    step = fm.Record([1.0, 1.0, 1.0], 1.0, quantity="force")
    ds = fm.history(fm.System(contacts=[contact]), step, beta=2.0, after=0.0)
    held = 0.75 * (1.0 - np.cos(2.0))
    assert held > 0.4
    k = np.flatnonzero(ds.time.values == 1.0)
    f = ds.friction.squeeze().values
    assert f[k[0]] == pytest.approx(held, rel=1e-14)
    assert f[k[-1]] == pytest.approx(0.4, rel=1e-14)
    way = (held - 0.4) / 3.0
    y = ds.y.squeeze().values
    assert y[k[-1]] - y[k[0]] == pytest.approx(way, rel=1e-13)
    assert ds.first_motion.item() == 1.0


def test_energies_are_balanced_without_damping():
    """All jumps and bends of the limit, of a chain with two springs: no work of damping is left."""
    contacts = [
        fm.Contact(masses=[1], stiffness=2.0, normal_record=_normal(_NORMAL, "hold")),
        fm.Contact("between-masses", [2, 3], stiffness=1.0, normal_record=_normal(-_NORMAL, "linear")),
        fm.Contact(masses=[3], ratio=0.3, normal_record=_normal(_NORMAL, "cubic")),
    ]
    system = fm.System(mass_ratios=[1, 1, 1], stiffness_ratios=[1, 1, 1], contacts=contacts)
    ds = fm.history(system, _RECORD, beta=0.1, after=0.0)
    assert ds.events.item() > 200
    assert abs(ds.work_damping.item()) <= 1e-12 * ds.work_friction.sum().item()
    y, sense = (ds[name].squeeze().values for name in ("y", "direction"))
    moves = np.diff(y[:2], axis=1)
    both = (sense[:2, 1:] == sense[:2, :-1]) & (sense[:2, 1:] != 0)
    assert (moves[both] * sense[:2, 1:][both] > -1e-13).all()
    # at a jump a slider slips and stops at once
    held = (sense[:2, 1:] == 0) & (sense[:2, :-1] == 0) & (np.diff(ds.time.values) > 0.0)
    assert np.abs(moves[held]).max() <= 1e-13 * np.abs(y[:2]).max()


def test_a_long_sine_leads_to_the_steady_state_of_the_map():
    r, beta = 0.7, 0.4
    period = 2.0 * np.pi / r
    sine = [fm.Record.sweep(r, r, 60 * period, quantity="force", amplitude=a) for a in (1.0, 0.5)]
    contact = fm.Contact(stiffness=1.5, normal_record=sine[1])
    ds = fm.history(fm.System(contacts=[contact], damping_ratios=0.05), sine[0], beta=beta, after=0.0,
                    beta_hold=False)  # fmt: skip
    steady = fm.System(contacts=[fm.Contact(stiffness=1.5, normal_load={1: 0.5})], damping_ratios=0.05)
    motion = fm.response(steady, r, beta)
    last = ds.isel(time=ds.time.values >= 59.0 * period - 1e-9).squeeze()
    # both records begin as sines: a quarter of a period before the load of the map
    phase = r * last.time.values - 118.0 * np.pi - 0.5 * np.pi
    for name in ("x", "friction"):
        wanted = np.interp(phase % (2.0 * np.pi), motion.tau.values, motion[name].squeeze().values)
        assert last[name].values == pytest.approx(wanted, abs=2e-3 * np.abs(wanted).max())
    again = fm.response(steady, r, beta).amplitude.item()
    peak = np.abs(last.x).max().item()
    assert peak == pytest.approx(again, rel=5e-3)


@pytest.mark.parametrize("stiffness", [None, 2.0])
@pytest.mark.parametrize("how", ["linear", "cubic", "hold"])
def test_from_beta_hold_on_nothing_moves_under_varying_normal_loads(how, stiffness):
    """The largest of abs(f)/nu, at the samples or between them."""
    values = 0.6 * _NORMAL
    contacts = [
        fm.Contact(masses=[1], stiffness=stiffness, normal_record=_normal(values, how)),
        fm.Contact(masses=[2], ratio=0.8),
    ]
    system = fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.05, contacts=contacts)
    hold = fm.history(system, _RECORD, beta=1.0, scale=1.5).beta_hold.item()
    events = [
        fm.history(system, _RECORD, beta=hold * factor, scale=1.5).events.item()
        for factor in (1.0 + 1e-9, 1.0 - 1e-9)
    ]
    assert events[0] == 0
    assert events[1] > 0


@pytest.mark.parametrize("quantity", ["acceleration", "displacement"])
def test_a_base_keeps_its_place_while_the_normal_load_lasts(quantity):
    """As with samples of no acceleration, or of the last place, up to the end of the normal load."""
    lasts = fm.Record(np.concatenate((_NORMAL, _NORMAL)), _STEP, quantity="force")
    contacts = [fm.Contact("fixed-wall", normal_record=lasts)]
    system = fm.System(damping_ratios=0.02, excitation="base", damping_reference="base", contacts=contacts)
    more = np.zeros(240) if quantity == "acceleration" else np.full(240, _VALUES[-1])
    ends = [_VALUES, np.concatenate((_VALUES, more))]
    if quantity == "acceleration":
        assert _VALUES[-1] == 0.0
    one, two = (
        fm.history(system, fm.Record(values, _STEP, quantity=quantity), beta=0.01, after=0.0)
        for values in ends
    )
    assert one.end_time.item() == pytest.approx(two.end_time.item(), rel=1e-14)
    atol = 1e-12 if quantity == "acceleration" else 2e-3
    assert one.events.item() > 5
    for name in ("z_max", "z_min", "work_friction", "amplitude"):
        size = np.abs(two[name].values).max()
        np.testing.assert_allclose(one[name].values, two[name].values, rtol=0.0, atol=atol * size)


def test_a_spring_between_ends_at_rest_rests_at_its_limit():
    """A rigid contact holds the mass while the limit of the spring beside it falls, sample by sample."""
    normal = _normal(np.linspace(0.8, -0.9, 240), "hold")
    contacts = [fm.Contact(stiffness=3.0, normal_record=normal), fm.Contact(ratio=1.5)]
    ds = fm.history(fm.System(contacts=contacts), _RECORD, beta=0.2, after=0.0)
    assert ds.status.item() == 0
    assert ds.events.item() < 600
    assert abs(ds.work_damping.item()) <= 1e-13
    assert ds.stuck_fraction.values.ravel()[1] > 0.5


_OFF = np.where(np.arange(240) % 40 < 15, -1.0, _NORMAL)


@pytest.mark.parametrize("belt", [0.0, 0.05])
@pytest.mark.parametrize("how", ["linear", "hold"])
def test_a_contact_without_load_is_open(how, belt):
    """Its slider follows it without a force, and the contact closes with a spring that is not stretched."""
    stiffness, beta, zeta = 2.0, 0.3, 0.02
    contact = fm.Contact(stiffness=stiffness, normal_record=_normal(_OFF, how), wall_speed=belt)
    ds = fm.history(fm.System(contacts=[contact], damping_ratios=zeta), _RECORD, beta=beta, after=0.0)
    wanted = _stepped(stiffness, beta, zeta, _at(_OFF, how), ds.end_time.item(), belt)
    assert ds.status.item() == 0
    assert ds.amplitude.item() == pytest.approx(wanted["amplitude"], rel=1e-3)
    assert ds.x.values[..., -1].item() == pytest.approx(wanted["last"], abs=1e-3 * wanted["amplitude"])
    for name in ("sliding_distance", "work_friction", "work_damping"):
        assert ds[name].item() == pytest.approx(wanted[name], rel=3e-3), name
    assert ds.turns.item() >= 4
    f, t = ds.friction.values.ravel(), ds.time.values / _STEP
    inside = (t % 40.0 > 0.5) & (t % 40.0 < 13.5) & (t < 239.0)
    assert inside.sum() > 60
    assert not f[inside].any()


def test_an_open_contact_at_rest_stays_there():
    off = fm.Record([-1.0, -1.0, 0.0], 1.0, quantity="force")
    late = fm.Record([0.0, 0.0, 0.0, 0.5, 0.0], 0.75, quantity="force")
    contact = fm.Contact(stiffness=1.0, normal_record=off)
    ds = fm.history(fm.System(contacts=[contact]), late, beta=0.1)
    assert ds.status.item() == 0
    assert ds.first_motion.item() > 1.5
    rigid = fm.history(fm.System(contacts=[fm.Contact(normal_record=off)]), _RECORD, beta=0.1)
    assert np.isinf(rigid.beta_hold.item())
    touched = fm.Record([0.0, -1.0, 0.0], 1.0, quantity="force")
    once = fm.Contact(stiffness=1.0, normal_record=touched)
    assert fm.history(fm.System(contacts=[once]), _RECORD, beta=0.1).status.item() == 0


@pytest.mark.parametrize(
    ("force", "normal", "how", "hold"),
    [
        ([0.0, 0.5, 1.0], [0.0, 0.25, 0.5], "linear", 1.0 / 1.5),  # both end there
        ([1.0, 2.0, 0.5], [0.5, 1.0, -0.5], "hold", 1.0),
        ([1.0, 2.0, 0.5], [0.5, -0.5, 1.0], "hold", 4.0),
        ([1.0, 2.0, 2.0], [0.5, 1.0, -1.0], "hold", np.inf),
    ],
)
def test_beta_hold_where_normal_loads_jump(force, normal, how, hold):
    contact = fm.Contact(normal_record=fm.Record(normal, 1.0, quantity="force", interpolation=how))
    record = fm.Record(force, 1.0, quantity="force", interpolation=how)
    ds = fm.history(fm.System(contacts=[contact]), record)
    assert ds.beta_hold.item() == pytest.approx(hold, rel=1e-12)
