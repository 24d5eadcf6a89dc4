"""Motions in time with friction over the speed: closed forms, other integrations, steady states."""

import numpy as np
import pytest
from lcg_records import lcg
from scipy.integrate import solve_ivp

import frictionmap as fm

_VALUES = lcg(11, 240, [1.31, -0.76], [30, 120])
_VALUES[0] = 0.0
_STEP = 0.2
_RECORD = fm.Record(_VALUES, _STEP, quantity="force")
_LAW = {"speed": [0.0, 0.15, 0.4], "factor": [1.0, 0.75, 0.7], "slope": 0.1}


@pytest.mark.parametrize("mu", [1.0, 1.3])
def test_a_single_segment_is_a_dashpot(mu):
    """f = beta s (1 + a V): the damping ratio is beta a/2 more while the mass slides."""
    slope, beta, zeta = 0.7, 0.25, 0.03
    contact = fm.Contact(law={"speed": [0.0], "factor": [1.0], "slope": slope})
    one = fm.history(fm.System(contacts=[contact], damping_ratios=zeta), _RECORD, beta=beta, mu=mu)
    two = fm.history(fm.System(damping_ratios=zeta + beta * slope / 2), _RECORD, beta=beta, mu=mu)
    assert one.events.item() == two.events.item() > 20
    for name in ("x", "v", "event_time", "residual", "beta_hold", "stuck_fraction", "sliding_distance"):
        np.testing.assert_allclose(one[name].values, two[name].values, rtol=0.0, atol=3e-14, err_msg=name)
    heat = one.work_friction + one.work_damping  # the dashpot takes a part of what the contact took
    assert heat.item() == pytest.approx((two.work_friction + two.work_damping).item(), rel=1e-12)


def _factor(speed):
    knots, factors = [*_LAW["speed"], 10.0], [*_LAW["factor"], 0.7 + 9.6 * _LAW["slope"]]
    return np.interp(speed, knots, factors)


def _integrated(beta, mu, zeta, times):
    """One mass by DOP853 from event to event, with the load as straight lines; (x at the times, events)."""
    load = lambda t: np.interp(t, _STEP * np.arange(_VALUES.size), _VALUES, right=0.0)  # noqa: E731
    now, end, x, sense, events = 0.0, times[-1], 0.0, 0, 0
    found = np.full(times.size, np.nan)
    options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13, "max_step": _STEP / 2, "dense_output": True}
    while end - now > 1e-9:
        if sense == 0:
            fine = np.linspace(now, end, 400_001)
            over = np.abs(load(fine) - x) > mu * beta
            k = int(np.argmax(over)) if over.any() else fine.size
            later = fine[k - 1] if k < fine.size else end
            if k < fine.size:  # the load is a straight line between the two
                a, b = fine[k - 1], fine[k]
                sense = 1 if load(b) > x else -1
                rise = (load(b) - load(a)) / (b - a)
                later = a + (sense * mu * beta - (load(a) - x)) / rise
                events += 1
            found[(times >= now) & (times <= later)] = x
            now = later
            continue
        s = sense
        slide = lambda t, y, s=s: [  # noqa: E731
            y[1], load(t) - 2.0 * zeta * y[1] - y[0] - s * beta * _factor(max(s * y[1], 0.0))
        ]  # fmt: skip
        stop = lambda t, y, s=s, now=now: s * y[1] if t > now + 1e-9 else 1.0  # noqa: E731
        stop.terminal, stop.direction = True, -1.0
        part = solve_ivp(slide, (now, end), [x, 0.0], events=stop, **options)
        inside = (times >= now) & (times <= part.t[-1])
        if inside.any():
            found[inside] = part.sol(times[inside])[0]
        now, x = part.t[-1], part.y[0, -1]
        if part.status == 1:
            events += 1
            pull = load(now) - x
            sense = 0 if abs(pull) <= mu * beta else int(np.sign(pull))
    return found, events


@pytest.mark.parametrize("mu", [1.0, 1.2])
def test_one_mass_by_another_integration(mu):
    """A falling and a rising part; 1e-12 a step of DOP853, which crosses break points without an event."""
    beta, zeta = 0.25, 0.03
    system = fm.System(contacts=[fm.Contact(law=_LAW)], damping_ratios=zeta)
    ds = fm.history(system, _RECORD, beta=beta, mu=mu, after=0.0)
    _, first = np.unique(np.round(ds.time.values / _STEP, 9), return_index=True)
    samples = first[np.isclose(np.round(ds.time.values[first] / _STEP) * _STEP, ds.time.values[first])]
    x, events = _integrated(beta, mu, zeta, ds.time.values[samples])
    assert ds.events.item() == events > 20
    np.testing.assert_allclose(ds.x.values.ravel()[samples], x, rtol=0.0, atol=1e-8)


_PAIR = {"mass_ratios": [1, 1], "stiffness_ratios": [1, 1], "damping_ratios": 0.04}


def _stepped(beta, mu, steps):
    """Two masses with a law on each by fixed steps: velocities in contacts are those of a projected step."""
    h = _STEP * (_VALUES.size - 1) / steps
    stiffness = np.array([[2.0, -1.0], [-1.0, 1.0]])
    system = fm.System(**_PAIR)
    damping = system.modes.damping
    x, v, highest = np.zeros(2), np.zeros(2), np.zeros(2)
    inverse = np.linalg.inv(np.eye(2) + 0.5 * h * damping + 0.25 * h * h * stiffness)
    for k in range(steps):
        push = np.array([np.interp((k + 0.5) * h, _STEP * np.arange(_VALUES.size), _VALUES), 0.0])
        free = inverse @ (v + h * (push - stiffness @ (x + 0.25 * h * v) - 0.5 * damping @ v))
        new, force = free.copy(), np.zeros(2)
        limits = np.where(np.abs(v) <= 1e-14, mu, _factor(np.abs(v))) * beta
        for _ in range(30):  # Gauss and Seidel
            before = force.copy()
            for j in range(2):
                rest = new[j] + h * inverse[j, j] * force[j]
                force_j = np.clip(rest / (h * inverse[j, j]), -limits[j], limits[j])
                new -= h * inverse[:, j] * (force_j - force[j])
                force[j] = force_j
            if np.abs(force - before).max() <= 1e-15:
                break
        new[np.abs(new) <= 1e-14] = 0.0
        x, v = x + 0.5 * h * (v + new), new
        highest = np.maximum(highest, np.abs(x))
    return x, highest


def test_two_masses_by_fixed_steps():
    """2^14 steps, of the first order at every stop: 1e-3 of the peak."""
    beta = np.array([0.12, 0.05])
    contacts = [fm.Contact(masses=[1], law=_LAW, ratio=0.12), fm.Contact(masses=[2], law=_LAW, ratio=0.05)]
    ds = fm.history(fm.System(**_PAIR, contacts=contacts), _RECORD, beta=1.0, after=0.0)
    x, highest = _stepped(beta, 1.0, 2**14)
    assert ds.events.item() > 40
    size = highest.max()
    np.testing.assert_allclose(ds.amplitude.values.ravel(), highest, rtol=0.0, atol=1e-3 * size)
    np.testing.assert_allclose(ds.x.values[..., -1].ravel(), x, rtol=0.0, atol=1e-3 * size)


def test_a_long_sine_leads_to_the_steady_state_of_the_map():
    """Two masses whose damping is above every falling slope: one steady state, with stops."""
    contacts = [fm.Contact(masses=[1], law=_LAW), fm.Contact(masses=[2], law=_LAW, ratio=0.3)]
    system = fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.3, contacts=contacts)
    r, beta = 0.6, 0.25
    period = 2.0 * np.pi / r
    sine = fm.Record.sweep(r, r, 40 * period, quantity="force")
    ds = fm.history(system, sine, beta=beta, after=0.0, beta_hold=False)
    curve = fm.curves(system, [r], beta=[beta])
    last = ds.x.squeeze().isel(time=ds.time.values > 39.0 * period)
    found = np.abs(last).max("time").values
    steady = curve.amplitude.squeeze().values
    # the record has 32 samples a cycle, at which the peaks are read: 1 - cos(pi/32)
    assert found == pytest.approx(steady, rel=5e-3)
    again = fm.history(system, fm.Record.sweep(r, r, 41 * period, quantity="force"), beta=beta, after=0.0,
                       beta_hold=False)  # fmt: skip
    shift = again.x.values[..., -1] - ds.x.values[..., -1]
    assert np.abs(shift).max() <= 1e-12
    assert (curve.stops_per_cycle.values > 0).any()


def test_a_motion_in_two_parts_is_one():
    """The segment follows from the velocity where the second part begins."""
    system = fm.System(contacts=[fm.Contact(law=_LAW)], damping_ratios=0.03)
    whole = fm.history(system, _RECORD, beta=0.1, after=0.0)
    cut = 100
    parts = [fm.Record(values, _STEP, quantity="force") for values in (_VALUES[: cut + 1], _VALUES[cut:])]
    first = fm.history(system, parts[0], beta=0.1, after=0.0)
    second = fm.history(system, parts[1], beta=0.1, after=0.0, start=first)
    assert abs(first.v.values[..., -1].item()) > _LAW["speed"][1]
    assert second.x.values[..., -1].item() == pytest.approx(whole.x.values[..., -1].item(), abs=1e-13)


def test_energies_are_balanced_by_the_dashpot():
    """The work of damping from the balance is the integral of 2 zeta v^2."""
    system = fm.System(contacts=[fm.Contact(law=_LAW)], damping_ratios=0.03)
    fine = fm.Record(np.interp(np.arange(239 * 200 + 1) / 200, np.arange(240), _VALUES), _STEP / 200,
                     quantity="force")  # fmt: skip
    ds = fm.history(system, fine, beta=0.1, after=0.0)
    t, v = ds.time.values, ds.v.values.ravel()
    assert ds.work_damping.item() == pytest.approx(np.trapezoid(0.06 * v * v, t), rel=1e-5)


def test_bounds_do_not_hold_for_friction_over_speed():
    """Their proof needs a force that grows with the speed, or does not depend on it."""
    from frictionmap.motions.bounds import friction_bounds, record_bounds

    other = fm.Record(0.9 * _VALUES, _STEP, quantity="force")
    falling = fm.System(contacts=[fm.Contact(law=_LAW)], damping_ratios=0.03)
    rising = fm.System(contacts=[fm.Contact(law={"speed": [0.0], "factor": [1.0], "slope": 0.5})])
    assert np.isnan(record_bounds(falling, _RECORD, other).amplitude).all()
    bound = record_bounds(rising, _RECORD, other).amplitude.item()
    motions = [fm.history(rising, one, beta=0.2, after=0.0) for one in (_RECORD, other)]
    assert abs(motions[0].x_max - motions[1].x_max).item() <= bound
    assert np.isnan(friction_bounds(rising, motions[0], 0.1).amplitude).all()
