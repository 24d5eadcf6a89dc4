"""Motions in time of elastic contacts that residual flexibility couples: another integration, identities."""

import itertools
import math

import numpy as np
import pytest
from coupled_structures import Given, Load, March, load_at_last
from lcg_records import lcg
from scipy.interpolate import CubicSpline

import frictionmap as fm
from frictionmap.errors import InputError

VALUES = np.array([0.0, 1.0, -1.2, 0.8, 0.3, -0.9, 1.4, -0.2, 0.0])
STEP, AFTER = 1.1, 5.5

#: Sub-steps of an interval; time that a jump takes.
FINE, SHORT = 40, 1e-9


def shift(count):
    """c' = generator c of a polynomial by its derivatives."""
    return np.eye(count, k=1)


def lines(values):
    """Durations and coordinates (value, slope) of straight lines."""
    return [(STEP, (a, (b - a) / STEP)) for a, b in itertools.pairwise(values)]


def spline(values):
    """The same of a natural spline, by four derivatives."""
    curve = CubicSpline(np.arange(len(values)) * STEP, values, bc_type="natural")
    factors = np.array([1.0, 1.0, 2.0, 6.0])
    return [(STEP, tuple(factors * one[::-1])) for one in curve.c.T]


def jumps(values):
    """The same of values that each hold for a step, with short lines between them."""
    found, before = [], 0.0
    for value in values:
        found += [(SHORT, (before, (value - before) / SHORT)), (STEP, (value, 0.0))]
        before = value
    return [*found, (SHORT, (before, -before / SHORT))]


def march_through(given, load, pieces, march_after=AFTER):
    """The motion under pieces of a load and after them; displacements at the ends of the long pieces."""
    count = len(load.generator)
    march, path = March(given, load, np.zeros(count)), []
    for time, coordinates in [*pieces, (march_after, (0.0,) * len(pieces[0][1]))]:
        march.bend(np.append(coordinates, march.u[march.drive][len(coordinates) :]))
        fine = 1 if time == SHORT else FINE * max(1, round(time / STEP))
        for _ in range(fine):
            march.advance(time / fine)
        if time != SHORT:
            path.append(march.displacements())
    return march, np.array(path)


def at_samples(ds, name, count):
    """Values at the ends of intervals, at a jump those before it; (..., count)."""
    times = ds.time.values
    wanted = np.append(np.arange(1, count) * STEP, (count - 1) * STEP + AFTER)
    first = [int(np.argmin(np.abs(times - t) > 1e-9)) for t in wanted]
    return ds[name].squeeze().values[..., first]


def compare(ds, march, path, within):
    assert int(ds.events.item()) == march.events
    size = np.abs(path).max()
    np.testing.assert_allclose(at_samples(ds, "x", len(path)), path.T, rtol=0.0, atol=within * size)
    np.testing.assert_allclose(ds.sliding_distance.squeeze(), march.distance, rtol=0.0, atol=within * size)
    np.testing.assert_allclose(
        ds.friction.squeeze()[..., -1], march.u[march.forces], rtol=0.0, atol=within * size
    )


@pytest.mark.parametrize("seed", [21, 22, 23, 24])
@pytest.mark.parametrize("kind", ["linear", "cubic", "free"])
def test_another_integration(seed, kind):
    given = Given(seed, contacts=2 + seed % 3)
    if kind == "free":
        given.free()
    how = "cubic" if kind == "cubic" else "linear"
    pieces = (spline if kind == "cubic" else lines)(VALUES)
    march, path = march_through(given, load_at_last(given, shift(len(pieces[0][1]))), pieces)
    record = fm.Record(VALUES, STEP, quantity="force", mass="load", interpolation=how)
    ds = fm.history(given.system(), record, beta=1.0, after=AFTER)
    assert march.events > 8
    compare(ds, march, path, 1e-10)


@pytest.mark.parametrize("seed", [31, 32, 33, 34])
def test_jumps_are_short_ramps(seed):
    """Forces and sliders follow a load that jumps as one that rises in a billionth of the unit of time."""
    given = Given(seed, contacts=2 + seed % 3)
    values = VALUES + 0.05
    march, path = march_through(given, load_at_last(given, shift(2)), jumps(values))
    record = fm.Record(values, STEP, quantity="force", mass="load", interpolation="hold")
    ds = fm.history(given.system(), record, beta=1.0, after=AFTER)
    assert march.events > 8
    compare(ds, march, path, 1e-7)  # of the time that the ramps take


@pytest.mark.parametrize("moved", [False, True])
def test_on_a_moving_base(moved):
    """Beside a belt, or on walls that move with the base."""
    given = Given(41, contacts=3)
    rng = np.random.default_rng(5)
    participation, sag = rng.normal(size=given.w.size), 0.1 * rng.normal(size=4)
    given.more[1] = {"wall_velocity": 0.2}
    keys = {"excitation": "force"}
    if moved:
        given.more = [{"kind": "joined-base-wall"}] * 3
        keys = {"excitation": "base", "damping_reference": "base"}
    system = given.system(given.modes(participation=participation, base_residual=sag), **keys)
    ds = fm.history(system, fm.Record(VALUES, STEP), beta=1.0, after=AFTER)
    # coordinates: place, velocity, acceleration of the base and its slope; time; 1
    generator = np.zeros((6, 6))
    generator[:4, :4], generator[4, 5] = shift(4), 1.0
    e = np.eye(6)
    direct = -np.outer(sag[:3], e[2])
    if not moved:
        direct += np.outer(np.ones(3), e[0]) - np.outer([0.0, 0.2, 0.0], e[4])
    load = Load(generator, -np.outer(participation, e[2]), direct, -np.outer(sag, e[2]))
    march, path = March(given, load, e[5]), []
    for time, coordinates in [*lines(VALUES), (AFTER, (0.0, 0.0))]:
        march.bend(np.concatenate((march.u[march.drive][:2], coordinates, march.u[march.drive][4:])))
        fine = FINE * max(1, round(time / STEP))
        for _ in range(fine):
            march.advance(time / fine)
        path.append(march.displacements())
    assert march.events > 8
    compare(ds, march, np.array(path), 1e-10)


@pytest.mark.parametrize("how", ["linear", "cubic", "hold"])
def test_energies_balance(how):
    """Without damping nothing is lost in it: work_damping is what the other works leave of the energy."""
    given = Given(51, contacts=4)
    given.zeta = 0.0 * given.zeta
    values = VALUES + 0.4
    record = fm.Record(values, STEP, quantity="force", mass="load", interpolation=how)
    ds = fm.history(given.system(), record, beta=1.0, after=AFTER)
    assert float(ds.work_friction.sum()) > 0.1
    assert abs(ds.work_damping.item()) <= 1e-12
    friction = given.force * ds.sliding_distance.squeeze().values
    np.testing.assert_allclose(ds.work_friction.squeeze(), friction, rtol=1e-13)


SINE = 0.8


def cycles(system, count):
    sine = fm.Record.sweep(SINE, SINE, count * 2.0 * math.pi / SINE, quantity="force", mass="load")
    return fm.history(system, sine, beta=1.0, after=0.0, samples="none", beta_hold=False)


def test_a_long_sine_leads_to_the_steady_state():
    given = Given(61, contacts=3)
    given.load, given.zeta = {1: 1.0 + 0.0j}, given.zeta + 0.05
    steady = fm.response(given.system(), r=SINE, beta=1.0)
    first, second = (cycles(given.system(), count) for count in (60, 61))
    for name in ("sliding_distance", "work_friction"):
        found = (second[name] - first[name]).squeeze()
        np.testing.assert_allclose(found, steady[name], rtol=0.0, atol=1e-10 * float(steady[name].max()))
    assert (second.slips - first.slips).squeeze().values.tolist() == steady.slips_per_cycle.values.tolist()
    assert float(steady.slips_per_cycle.sum()) >= 4.0


SAMPLES = np.concatenate(([0.0], np.asarray(lcg(77, 160, [1.31, -0.76], [20, 110])), [0.0]))


def beam(**keys):
    found = fm.Beam(
        length=1.0,
        bending_stiffness=1.0,
        mass_per_length=1.0,
        points={"a": 0.4, "b": 0.7, "tip": 1.0},
        **keys,
    )
    contacts = [
        fm.Contact(masses=["a"], stiffness=60.0, ratio=4.0),
        fm.Contact(masses=["tip"], stiffness=2.0),
    ]
    return fm.System(modes=found, damping_ratios=0.02, contacts=contacts)


def test_modes_left_out_of_a_beam():
    """The residual flexibility is what all further modes add where the load is slow."""
    options = {"beta": 0.05, "after": 3.0, "samples": "none", "beta_hold": False}
    record = fm.Record(VALUES[:6], 0.9, quantity="force", mass="b", interpolation="cubic")
    exact = fm.history(beam(modes=18), record, **options)
    assert exact.slips.sum() >= 6
    errors = {}
    for residual in (False, True):
        one = fm.history(beam(modes=5, with_residual=residual), record, **options)
        errors[residual] = abs(one.contact_amplitude - exact.contact_amplitude).max().item()
    size = exact.contact_amplitude.max().item()
    assert errors[True] < 1e-4 * size
    assert errors[True] < 0.05 * errors[False]


def test_a_record_in_two_parts():
    whole = fm.history(beam(modes=4), fm.Record(SAMPLES, 0.13, quantity="force"), beta=0.1, after=2.0)
    first, second = (
        fm.Record(SAMPLES[:61], 0.13, quantity="force"),
        fm.Record(SAMPLES[60:], 0.13, quantity="force"),
    )
    before = fm.history(beam(modes=4), first, beta=0.1, after=0.0)
    found = fm.history(beam(modes=4), second, beta=0.1, after=2.0, start=before)
    assert before.events.item() + found.events.item() == whole.events.item()
    assert whole.slips.sum() > 6
    np.testing.assert_allclose(found.x[..., -1], whole.x[..., -1], rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(found.modal_place, whole.modal_place, rtol=0.0, atol=1e-12)


def test_the_place_of_rest():
    record = fm.Record(SAMPLES, 0.4, quantity="force", mass="b")
    ds = fm.history(beam(modes=5), record, beta=0.05, samples="none")
    later = fm.history(beam(modes=5), record, beta=0.05, after=400.0)
    assert ds.status.item() == 0
    size = ds.amplitude.max().item()
    assert np.abs(ds.residual).max() > 1e-3 * size
    np.testing.assert_allclose(ds.residual.squeeze(), later.x.squeeze()[..., -1], rtol=0.0, atol=1e-5 * size)
    np.testing.assert_allclose(
        ds.contact_residual.squeeze(), later.z.squeeze()[..., -1], rtol=0.0, atol=1e-5 * size
    )
    assert ds.sliding_distance.equals(later.sliding_distance)


def test_from_beta_hold_on_nothing_moves():
    record = fm.Record(SAMPLES, 0.4, quantity="force", mass="b")
    hold = fm.history(beam(modes=5), record, beta=1.0, samples="none").beta_hold.item()
    above, below = (
        fm.history(beam(modes=5), record, beta=hold * (1.0 + side), samples="none") for side in (1e-9, -1e-9)
    )
    assert above.events.item() == 0
    assert below.events.item() > 0


def test_the_same_bits_for_any_threads_and_grid():
    record = fm.Record(SAMPLES, 0.4, quantity="force", mass="b")
    options = {"beta": [0.02, 0.05, 0.1], "scale": [0.5, 1.0], "samples": 7}
    one = fm.history(beam(modes=5), [record, record], threads=1, **options)
    assert fm.history(beam(modes=5), [record, record], threads=3, **options).equals(one)
    alone = fm.history(beam(modes=5), record, beta=0.05, samples=7)
    assert (one.sel(beta=0.05, scale=1.0, record=1).work_friction.values == alone.work_friction.values).all()


def test_two_equal_contacts_are_one():
    """They reach their limits together, and stop together, at kinks and jumps of the load, too."""
    given = Given(7, contacts=1)
    modes = fm.Modes(given.w, given.zeta, given.shapes, ["tip", "load"], given.residual)
    one, twice = (
        fm.Contact(masses=["tip"], stiffness=5.0),
        fm.Contact(masses=["tip"], stiffness=10.0, ratio=2.0),
    )
    for how in ("linear", "hold"):
        record = fm.Record(VALUES, STEP, quantity="force", mass="load", interpolation=how)
        both, single = (
            fm.history(fm.System(modes=modes, contacts=list(c)), record, beta=[0.02, 0.1, 0.3])
            for c in ((one, one), (twice,))
        )
        np.testing.assert_allclose(both.beta_hold, single.beta_hold, rtol=1e-12)
        np.testing.assert_allclose(both.amplitude, single.amplitude, rtol=1e-11)
        for j in range(2):
            for name, share in (("sliding_distance", 1.0), ("work_friction", 0.5), ("largest_slide", 1.0)):
                wanted = share * single[name]
                np.testing.assert_allclose(both[name][..., j], wanted, rtol=1e-10, atol=1e-12, err_msg=name)
            if how == "linear":  # a jump makes a single contact turn, and coupled ones stop and slip
                assert (both.slips[..., j] == single.slips).all()


def test_refusals():
    given = Given(71, contacts=2)
    record = fm.Record(VALUES, STEP, quantity="force", mass="load")
    given.more[0] = {"normal_record": fm.Record([0.0, 0.1, 0.0], dt=1.0, quantity="force")}
    with pytest.raises(InputError, match="cannot use normal_record with a residual flexibility that couples"):
        fm.history(given.system(), record, beta=1.0)
