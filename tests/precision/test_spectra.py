"""Friction response spectra: closed forms, and motions by matrix exponentials."""

import numpy as np
import pytest
from lcg_records import lcg
from matrix_motion import followed
from mpmath import mp

from frictionmap import spectrum
from frictionmap.motions.record import Record

#: Rounding of some hundred samples and events.
ROUNDING = 1e-11


def one(ds, name):
    return float(ds[name].squeeze())


def test_block_under_a_rectangular_pulse():
    """Newmark (1965): V^2/(2 N) (1 - N/A) with V = A t0."""
    push = Record([1.0, 1.0], dt=1.0, quantity="force", interpolation="hold")
    ds = spectrum(push, np.inf, 0.3)
    exact = 2.0**2 / (2 * 0.3) * (1 - 0.3)
    assert one(ds, "amplitude") == pytest.approx(exact, rel=1e-15)
    assert one(ds, "amplitude") == pytest.approx(4.666666666666667, rel=1e-15)
    assert one(ds, "sliding_distance") == one(ds, "residual") == one(ds, "amplitude")
    assert one(ds, "stops") == 1
    assert one(ds, "asleep_time") == pytest.approx(2.0 / 0.3, rel=1e-15)  # V = N t


@pytest.mark.parametrize(("a", "n", "t0"), [(1.0, 0.25, 2.0), (3.0, 1.0, 0.7)])
def test_block_under_a_falling_triangle(a, n, t0):
    ds = spectrum(Record([a, 0.0], dt=t0, quantity="force"), np.inf, n)
    exact = (a - n) * t0**2 / 2 - a * t0**2 / 6 + (a / 2 - n) ** 2 * t0**2 / (2 * n)
    assert one(ds, "amplitude") == pytest.approx(exact, rel=1e-14)


@pytest.mark.parametrize("samples", [8, 20, 50])
def test_a_sampled_half_sine_moves_a_block_less(samples):
    """The error of straight lines between m samples of a half sine is -3.4/m^2 of the distance."""

    def moved(m):
        pulse = Record(np.sin(np.linspace(0.0, np.pi, m + 1)), dt=np.pi / m, quantity="force")
        return one(spectrum(pulse, np.inf, 0.4), "amplitude")

    error = moved(samples) / moved(3000) - 1
    assert error * samples**2 == pytest.approx(-3.4, abs=1.0)


@pytest.mark.parametrize(("ratio", "stops"), [(0.5365, 0), (0.5375, 2)])
def test_block_under_a_long_cosine(ratio, stops):
    """It never stops below beta/A = 2/sqrt(4 + pi^2) = 0.53703, and twice a cycle above."""
    per_cycle, cycles = 64, 60

    def count(n):
        angle = 2 * np.pi * np.arange(n * per_cycle + 1) / per_cycle
        wave = Record(np.cos(angle), dt=2 * np.pi / per_cycle, quantity="force", interpolation="cubic")
        return one(spectrum(wave, np.inf, ratio), "stops")

    assert count(cycles) - count(cycles - 10) == 10 * stops


@pytest.mark.parametrize("zeta", [0.0, 0.02, 0.1])
@pytest.mark.parametrize("dt", [0.03, 0.4])
def test_free_decay_after_a_held_load(zeta, dt):
    """A half cycle takes x to (x - b) e^(-pi zeta/s) - b on the other side, and lasts pi/s.

    A load that is held moves the mass in one half cycle to where it is stuck; then the load ends.
    """
    beta, b = 0.2, 0.2
    s = np.sqrt(1 - zeta**2)
    decay = np.exp(-np.pi * zeta / s)
    load = 2.7 * beta
    places = [(load - beta) * (1 + decay)]
    while abs(places[-1]) > b:
        x = places[-1]
        places.append(-np.sign(x) * ((abs(x) - b) * decay - b))
    count = int(4 / dt)
    push = Record(np.full(count, load), dt=dt, quantity="force", interpolation="hold")
    ds = spectrum(push, 2 * np.pi, beta, damping=zeta)
    assert one(ds, "amplitude") == pytest.approx(places[0], rel=1e-13)
    assert one(ds, "residual") == pytest.approx(places[-1], rel=1e-12)
    assert one(ds, "sliding_distance") == pytest.approx(places[0] + np.abs(np.diff(places)).sum(), rel=1e-13)
    assert (one(ds, "stops"), one(ds, "turns")) == (2, len(places) - 2)
    assert one(ds, "asleep_time") == pytest.approx(count * dt + (len(places) - 1) * np.pi / s, rel=1e-14)
    assert one(ds, "status") == 0


def test_free_decay_from_a_moving_mass():
    """Without damping x falls by 2 beta a half cycle, from the first turn after the load ends."""
    beta, load, duration = 0.01, 0.3, 1.2
    x, v = (load - beta) * (1 - np.cos(duration)), (load - beta) * np.sin(duration)
    place = np.hypot(x + beta, v) - beta
    halves = int(np.ceil((place - beta) / (2 * beta)))
    push = Record(np.full(12, load), dt=0.1, quantity="force", interpolation="hold")
    ds = spectrum(push, 2 * np.pi, beta)
    assert one(ds, "amplitude") == pytest.approx(place, rel=1e-13)
    assert one(ds, "turns") == halves > 10
    assert abs(one(ds, "residual")) == pytest.approx(abs(place - 2 * halves * beta), rel=1e-11)
    distance = halves * (2 * place - 2 * beta * halves) + place  # sum of the half cycles, and the way there
    assert one(ds, "sliding_distance") == pytest.approx(distance, rel=1e-12)
    till = duration + np.arctan2(v, x + beta)
    assert one(ds, "asleep_time") == pytest.approx(till + halves * np.pi, rel=1e-13)


def test_an_overdamped_mass_creeps_to_where_friction_and_spring_balance():
    push = Record([1.0, 1.0], dt=40.0, quantity="force", interpolation="hold")
    ds = spectrum(push, 2 * np.pi, 0.2, damping=1.5)
    assert one(ds, "status") == 2
    assert one(ds, "amplitude") == pytest.approx(0.8, rel=1e-12)
    assert one(ds, "residual") == pytest.approx(0.2, rel=1e-12)
    assert np.isnan(one(ds, "asleep_time"))


def test_without_friction_a_mass_does_not_rest():
    push = Record([1.0, 1.0], dt=1.0, quantity="force", interpolation="hold")
    swinging, sliding = spectrum(push, 2 * np.pi, 0.0), spectrum(push, np.inf, 0.0)
    assert one(swinging, "status") == one(sliding, "status") == 1
    assert np.isnan(one(swinging, "residual"))
    assert one(sliding, "amplitude") == np.inf
    # a step of 2 time units, then free: x = 1 - cos, of amplitude 2 sin(1)
    assert one(swinging, "amplitude") == pytest.approx(2 * np.sin(1.0), rel=1e-13)


@pytest.mark.parametrize("step", [0.001, 0.05])
def test_an_undamped_motion_keeps_its_amplitude(step):
    """After 200,000 samples under a constant load another load shows place and velocity in the peak."""
    count = 200_000
    load = np.append(np.full(count, 1.0), np.full(int(7 / step), -5.0))
    ds = spectrum(Record(load, dt=step, quantity="force", interpolation="hold"), 2 * np.pi, 0.0)
    with mp.workdps(30):
        time = mp.mpf(step) * count
        exact = float(5 + mp.hypot(6 - mp.cos(time), mp.sin(time)))
    assert one(ds, "amplitude") == pytest.approx(exact, rel=2e-14)


CELLS = [
    # period, damping, friction, mu
    (0.9, 0.05, 0.12, 1.0),
    (3.0, 0.0, 0.3, 1.0),
    (3.0, 0.02, 0.25, 1.3),
    (6.0, 0.3, 0.1, 1.6),
    (2.0, 1.4, 0.2, 1.0),
    (np.inf, 0.0, 0.2, 1.2),
    (0.15, 0.05, 0.21, 1.0),  # parts of samples
]


@pytest.mark.parametrize("base", [True, False])
@pytest.mark.parametrize(("period", "zeta", "beta", "mu"), CELLS)
def test_against_matrix_exponentials(period, zeta, beta, mu, base):
    values, dt = lcg(seed=7, n=120, ar=(1.5, -0.7), envelope=(20, 80)), 0.11
    record = Record(values, dt=dt, quantity="acceleration" if base else "force")
    ds = spectrum(record, period, beta, mu=mu, damping=zeta)
    found = followed(values, dt, 2 * np.pi / period, zeta, beta, mu, base)
    for name in ("amplitude", "acceleration_amplitude", "sliding_distance"):
        assert one(ds, name) == pytest.approx(found[name], rel=1e-10), name
    assert one(ds, "stops") == found["stops"]
    assert one(ds, "turns") == found["turns"]


def test_a_limit_that_is_just_reached_is_no_release():
    values = lcg(seed=5, n=400, ar=(1.5, -0.7), envelope=(50, 200))
    for mu, beta in ((1.0, 1.0), (2.0, 0.5), (1.25, 0.8)):
        record = Record(values, dt=0.1)
        ds = spectrum(record, 2 * np.pi, [beta * (1 - 1e-6), beta], mu=mu, damping=0.05).squeeze()
        np.testing.assert_array_equal(ds.stops, [1, 0])
        assert ds.amplitude[1] == ds.sliding_distance[1] == 0.0
        assert ds.acceleration_amplitude[1] == 1.0


def test_a_record_that_begins_above_the_limit_and_a_record_that_does_not_end_at_zero():
    """The acceleration of a mass that slides at once is that of friction alone."""
    ds = spectrum(Record([1.0, 1.0, 1.0], dt=0.1), np.inf, 0.2)
    assert one(ds, "acceleration_amplitude") == 0.2
    assert one(ds, "amplitude") == pytest.approx(0.2**2 / 0.4 * (1 - 0.2), rel=1e-14)


def test_reference_spectrum(reference_table):
    for row in reference_table("history.json")["spectra"]:
        given = row["record"]
        values = lcg(given["seed"], given["n"], given["ar"], given["envelope"])
        periods = [np.inf if w == 0 else 2 * np.pi / w for w in row["w"]]
        order = np.argsort(periods)
        ds = spectrum(
            Record(values, dt=given["dt"]), np.array(periods)[order], row["beta"], mu=row["mu"],
            damping=row["zeta"],
        ).squeeze()  # fmt: skip
        for name, own in (("amplitude", "peak"), ("acceleration_amplitude", "acceleration"),
                          ("residual", "residual"), ("sliding_distance", "sliding_distance")):  # fmt: skip
            wanted = np.array(row[own])[:, order]
            np.testing.assert_allclose(ds[name], wanted, rtol=0, atol=1e-10 * np.abs(wanted).max())
        np.testing.assert_array_equal(ds.stops, np.array(row["stops"])[:, order])


def test_reference_ties(reference_table):
    for row in reference_table("history.json")["ties"]:
        given = row["record"]
        values = lcg(given["seed"], given["n"], given["ar"], given["envelope"])
        below = row["result"]["below"]
        ds = spectrum(
            Record(values, dt=given["dt"]), 2 * np.pi, [below["beta"], *row["beta"]], mu=row["mu"],
            damping=row["C"][0][0] / 2,
        ).squeeze()  # fmt: skip
        np.testing.assert_array_equal(ds.stops, [below["stops"], 0])
        assert float(ds.sliding_distance[0]) == pytest.approx(below["sliding_distance"], rel=1e-9)
        assert float(ds.sliding_distance[1]) == 0.0


def test_a_spring_in_the_contact(reference_table):
    """Rows of two independent programs; their ring-down of 40 time units has no further peak."""
    rows = [row for row in reference_table("history.json")["rows"] if row["family"] == "sdof-elastic"]
    assert len(rows) > 2
    for row in rows:
        given = row["record"]
        record = Record(lcg(*(given[key] for key in ("seed", "n", "ar", "envelope"))), given["dt"])
        damping, stiffness = row["C"][0][0] / 2.0, row["kt"][0]
        ds = spectrum(record, [2.0 * np.pi], row["beta"], damping=damping, contact_stiffness=stiffness)
        wanted = row["result"]
        largest = max(wanted["x_max"][0], -wanted["x_min"][0])
        acceleration = max(wanted["acceleration_max"][0], -wanted["acceleration_min"][0])
        assert one(ds, "amplitude") == pytest.approx(largest, rel=1e-10)
        assert one(ds, "acceleration_amplitude") == pytest.approx(acceleration, rel=1e-10)
        assert one(ds, "residual") == pytest.approx(wanted["x_rest"][0], rel=1e-9)
        assert one(ds, "stops") == wanted["stops"][0]
