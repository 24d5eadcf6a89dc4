"""Contacts with a spring under a varying normal load, |f| <= beta nu(tau).

Values of an independent event-exact program, a twin in small fixed steps, limits that other laws cover, the
balance of work, and the uniqueness that is proved: the energy of the difference of two motions cannot grow.
"""

import math

import numpy as np
import pytest
from general_systems import Solved

import frictionmap as fm
from frictionmap._kernels.general.counts import MOVED

TWO_PI = 2.0 * math.pi

OUTPUTS = [
    "slips_per_cycle", "elastic_fraction", "peak_to_peak", "midpoint", "work_friction", "multiplier",
]  # fmt: skip


def solve(system, r, beta):
    return fm.sweep(system, [r], [beta], outputs=OUTPUTS).isel(mu=0, r=0, beta=0)


def extremes(ds):
    return (
        ds.midpoint.values + 0.5 * ds.peak_to_peak.values,
        ds.midpoint.values - 0.5 * ds.peak_to_peak.values,
    )


def check_work(system, r, beta):
    """What the load and the belt bring in is what friction and dashpots take; the spring keeps nothing."""
    ds = fm.response(system, r, beta)
    given = float(ds.work_input) + float(ds.work_wall.sum() if "work_wall" in ds else 0.0)
    taken = float(ds.work_friction.sum() + ds.work_damping)
    assert abs(given - taken) < 1e-11 * (abs(given) + abs(taken))


def test_rows_of_an_independent_program(reference_table):
    for row in reference_table("laws.json")["elastic_normal_load"]:
        load = np.eye(len(row["M"]))[row["load_mass"] - 1]
        contact = fm.Contact(
            "fixed-wall", row["contact_mass"], stiffness=row["kt"], normal_load=row["normal_load"],
            wall_speed=row.get("wall_speed", 0.0),
        )  # fmt: skip
        matrices = {key: row[key] for key in "MKC"}
        system = fm.System(
            matrices=matrices, frequency_scale=1.0, load_harmonics={1: load}, contacts=[contact]
        )
        ds = solve(system, row["r"], row["beta"])
        highest, lowest = extremes(ds)
        size = max(np.abs(row["x_max"]).max(), np.abs(row["x_min"]).max())
        assert np.abs(highest - row["x_max"]).max() < 1e-10 * size
        assert np.abs(lowest - row["x_min"]).max() < 1e-10 * size
        assert ds.slips_per_cycle == row["slips"][0]
        assert abs(ds.elastic_fraction - row["elastic_fraction"][0]) < 6e-8  # is stored in single precision
        assert abs(ds.work_friction - row["work"][0]) < 1e-10 * row["work"][0]
        assert abs(ds.multiplier - row["multiplier"]) < 1e-9
        check_work(system, row["r"], row["beta"])


def test_wedge_damper():
    """A mass on a spring of 12, a contact spring of 5: integrated in 16,000 steps with return mapping."""
    system = fm.System(
        matrices={"M": [[1.0]], "K": [[12.0]], "C": [[0.1 * math.sqrt(12.0)]]}, frequency_scale=1.0,
        contact_stiffness=5.0,
        normal_load=[{"n": 1, "amplitude": 0.11103458545799544, "phase_deg": -3.6829234239970337}],
    )  # fmt: skip
    (highest,), (lowest,) = extremes(solve(system, 3.5, 0.14752066115702478))
    assert abs(100.0 * highest - 67.0471) < 1e-4
    assert abs(100.0 * lowest + 67.2555) < 1e-4


def waves(harmonics, tau):
    return sum((value * np.exp(1j * n * tau)).real for n, value in harmonics.items()) + np.zeros_like(tau)


def twin(zeta, r, beta, kt, load, normal, steps, cycles=30, rigid=0.0):
    """March one mass from rest with the mean of both ends of a step; its friction force is clipped.

    rigid : friction of a rigid contact beside the spring
    """
    h, damping = TWO_PI / steps, zeta * 2.0 * r
    middle, end = h * (np.arange(steps) + 0.5), h * (np.arange(steps) + 1.0)
    drive, limit = waves(load, middle).tolist(), (beta * (1.0 + waves(normal, end))).tolist()
    inertia = r * r + 0.5 * h * damping + 0.25 * h * h
    x = v = f = 0.0
    for cycle in range(cycles):
        low, high, slip = x, x, 0
        for k in range(steps):
            known = r * r * v + h * (drive[k] - 0.5 * damping * v - x - 0.25 * h * v - 0.5 * f)

            def moved(push, f=f, v=v, known=known, most=limit[k]):
                """Velocity and force after a step with this impulse of the rigid contact."""
                stretch = 0.5 * h * kt
                new = (known + push - 0.5 * h * (f + stretch * v)) / (inertia + 0.5 * h * stretch)
                force = f + stretch * (v + new)
                if abs(force) > most:
                    force = math.copysign(most, force)
                    new = (known + push - 0.5 * h * force) / inertia
                return new, force

            new, force = moved(0.0)
            if rigid and new != 0.0:
                at_rest = max(-limit[k], min(limit[k], f + 0.5 * h * kt * v))
                holding = -(known - 0.5 * h * at_rest)
                if abs(holding) <= h * rigid:
                    new, force = 0.0, at_rest
                else:
                    new, force = moved(math.copysign(h * rigid, holding))
            slip += abs(force) == limit[k]
            x += 0.5 * h * (v + new)
            v, f = new, force
            if cycle == cycles - 1:
                low, high = min(low, x), max(high, x)
    return high, low, 1.0 - slip / steps


#: zeta, r, beta, k_t, load, normal load; the last touches zero.
CELLS = [
    (0.05, 0.6, 0.6, 1.5, {1: 1.0}, {1: 0.6 * np.exp(1.9j)}),
    (0.10, 0.8, 0.5, 4.0, {1: 1.0, 2: 0.6 * np.exp(-1.2j)}, {1: 0.3 * np.exp(0.5j), 2: 0.4}),
    (0.08, 1.4, 0.4, 3.0, {1: 1.0}, {2: 0.7j}),
    (0.10, 0.9, 0.5, 2.0, {1: 1.0}, {1: 1.0}),
]


@pytest.mark.parametrize("cell", CELLS)
def test_twin_in_fixed_steps(cell):
    zeta, r, beta, kt, load, normal = cell
    system = fm.System(damping_ratios=zeta, load_harmonics=load, contact_stiffness=kt, normal_load=normal)
    ds = solve(system, r, beta)
    check_work(system, r, beta)
    (highest,), (lowest,) = extremes(ds)
    off = []
    for steps in (512, 4096):
        found = twin(*cell, steps)
        off.append(max(abs(found[0] - highest), abs(found[1] - lowest)) / (highest - lowest))
        assert off[-1] < 4.0 / steps
        assert abs(found[2] - ds.elastic_fraction) < 4.0 * (ds.slips_per_cycle + 1.0) / steps
    assert off[1] < 0.3 * off[0]
    other = twin(zeta, r, 1.02 * beta, kt, load, normal, 4096)
    assert max(abs(other[0] - highest), abs(other[1] - lowest)) / (highest - lowest) > 4.0 / 4096


def test_slider_slips_between_ends_at_rest():
    """Beside a rigid contact at rest the slider follows its limit down as the normal load falls."""
    zeta, r, kt, load, normal, rigid, beta = 0.1, 0.7, 3.0, {1: 1.0}, {1: 0.8 * np.exp(2.0j)}, 0.35, 0.5
    contacts = [
        fm.Contact(ratio=rigid / beta), fm.Contact(ratio=1.0, stiffness=kt, normal_load=normal, name="spring")
    ]  # fmt: skip
    system = fm.System(damping_ratios=zeta, load_harmonics=load, contacts=contacts)
    ds = solve(system, r, beta)
    check_work(system, r, beta)
    (highest,), (lowest,) = extremes(ds)
    for steps in (512, 4096):
        found = twin(zeta, r, beta, kt, load, normal, steps, rigid=rigid)
        assert max(abs(found[0] - highest), abs(found[1] - lowest)) < 4.0 / steps * (highest - lowest)
        assert abs(found[2] - ds.elastic_fraction.values[1]) < 8.0 / steps


def test_constant_normal_load():
    """A variation of 1e-14 changes nothing beyond rounding."""
    for r, beta, kt in ((0.4, 0.6, 3.0), (1.5, 0.4, 1.0), (0.9, 1.2, 10.0)):
        plain = solve(fm.System(damping_ratios=0.05, contact_stiffness=kt), r, beta)
        varied = solve(fm.System(damping_ratios=0.05, contact_stiffness=kt, normal_load={1: 1e-14}), r, beta)
        assert plain.slips_per_cycle == varied.slips_per_cycle
        for a, b in zip(extremes(plain), extremes(varied), strict=True):
            assert np.abs(a - b).max() < 1e-12 * np.abs(a).max()


def test_stiff_springs_are_rigid_contacts():
    normal = {1: 0.4 * np.exp(1.0j)}
    rigid = fm.System(damping_ratios=0.05, normal_load=normal)
    wanted = fm.sweep(rigid, [0.4], [0.6], outputs=["peak_to_peak", "midpoint"]).isel(mu=0, r=0, beta=0)
    off = []
    for kt in (1e3, 1e5):
        ds = solve(fm.System(damping_ratios=0.05, normal_load=normal, contact_stiffness=kt), 0.4, 0.6)
        off.append(max(np.abs(a - b).max() for a, b in zip(extremes(ds), extremes(wanted), strict=True)))
    assert off[1] < 0.02 * off[0] < 0.02 * 0.05  # about 1/kt where the contact stops


def test_friction_without_slip():
    """beta_noslip is the least friction with max(F - beta nu) <= min(F + beta nu)."""
    normal, kt, r = {1: 0.5 * np.exp(0.7j), 2: 0.3}, 2.0, np.array([0.6, 1.5, 2.2])
    system = fm.System(damping_ratios=0.05, contact_stiffness=kt, normal_load=normal)
    limits = fm.boundaries(system, r).beta_noslip.values
    tau = np.linspace(0.0, TWO_PI, 20001)
    nu = 1.0 + waves(normal, tau)
    for one, limit in zip(r, limits, strict=True):
        force = (kt / (1.0 + kt - one**2 + 0.1j * one) * np.exp(1j * tau)).real
        assert abs((force - limit * nu).max() - (force + limit * nu).min()) < 1e-6
        assert solve(system, one, 0.999 * limit).slips_per_cycle > 0
        assert solve(system, one, 1.001 * limit).slips_per_cycle == 0


@pytest.mark.parametrize("kt", [None, 3.0])
def test_normal_loads_that_vanish_at_an_instant(kt):
    """No friction holds a contact that is loaded there; one in phase with its normal load is held by |F|."""
    zeta, r = 0.05, np.array([0.7, 1.6])
    held = np.ones(2) if kt is None else kt / (1.0 + kt - r**2 + 2j * zeta * r)
    further = {"damping_ratios": zeta, "contact_stiffness": kt}
    name = "beta_stick" if kt is None else "beta_noslip"
    for angle in np.linspace(0.1, 6.1, 7):
        for order in (1, 2):
            system = fm.System(normal_load={order: np.exp(1j * angle)}, **further)
            assert np.isinf(fm.boundaries(system, r)[name].values).all()
    for one, force in zip(r, held, strict=True):
        system = fm.System(normal_load={1: force / abs(force)}, **further)
        found = fm.boundaries(system, [one])[name].values.item()
        assert abs(found - abs(force)) < 1e-13 * abs(force)


def test_steady_state_does_not_depend_on_the_start():
    rng = np.random.default_rng(11)
    slipped = 0
    for _ in range(40):
        n = int(rng.integers(1, 4))
        stiffness = np.diag(rng.uniform(1.0, 3.0, n)) + (n > 1) * 0.3 * (np.eye(n) - np.ones((n, n)) / n)
        damping = rng.uniform(0.05, 0.15) * stiffness
        w, load = np.eye(n)[:, :1], {1: rng.normal(size=n) + 1j * rng.normal(size=n)}
        depth, phase = rng.uniform(0.3, 1.0), rng.uniform(0.0, TWO_PI)
        further = {"normal": {1: depth * np.exp(1j * phase)}, "spring": [rng.uniform(0.3, 10.0)]}
        beta = [rng.uniform(0.1, 0.8)]
        r = rng.uniform(0.4, 1.8)
        found = [
            Solved(np.eye(n), stiffness, damping, w, r, load, (beta, beta), state=state, **further)
            for state in (np.zeros((2, n)), rng.normal(scale=5.0, size=(2, n)))
        ]
        assert all(one.resolved and one.period == 1 for one in found)
        if found[0].counts[MOVED, 0]:
            slipped += 1
            size = np.abs(found[0].highest[1]).max()
            assert np.abs(found[0].highest[1] - found[1].highest[1]).max() < 1e-10 * size
            assert np.abs(found[0].lowest[1] - found[1].lowest[1]).max() < 1e-10 * size
    assert slipped >= 25


def test_responses_and_curves():
    """The loop of f over z stays within the limits, and the slider moves only at them."""
    normal = {1: 0.6 * np.exp(1.9j)}
    system = fm.System(damping_ratios=0.05, contact_stiffness=1.5, normal_load=normal)
    ds = fm.response(system, 0.6, 0.6)
    limit = 0.6 * (1.0 + waves(normal, ds.tau.values))
    assert (np.abs(ds.friction.values) <= limit * (1.0 + 1e-12)).all()
    moves = ds.direction.values != 0
    assert np.abs(ds.friction.values - ds.direction.values * limit)[moves].max() < 1e-12
    assert np.abs(ds.friction.values - 1.5 * (ds.z.values - ds.y.values)).max() < 1e-12
    both = moves[:-1] & moves[1:]
    assert (np.diff(ds.y.values)[both] * ds.direction.values[:-1][both] > -1e-12).all()
    curve = fm.curves(system, [0.6, 1.1], beta=[0.6]).sel(r=0.6)
    assert abs(float(curve.amplitude.squeeze()) - float(ds.amplitude.squeeze())) < 1e-12


def test_motions_in_time_refuse_it():
    pulse = fm.Record([0.0, 1.0, 0.0], dt=1.0, quantity="force")
    with pytest.raises(fm.InputError, match="cannot use normal_load in a motion in time"):
        fm.history(fm.System(contact_stiffness=1.0, normal_load={1: 0.5}), pulse, beta=[0.2])
