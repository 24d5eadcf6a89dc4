"""Contacts that open, and gaps, backlash and bilinear springs: values of an independent event-exact program.

A twin in small fixed steps, with forces from the law itself, knows nothing of phases and events.
"""

import numpy as np
import pytest
from phase_systems import split, system_of

from frictionmap import regimes
from frictionmap.model.spring_element import SpringElement
from frictionmap.phases.quantities import TABLE
from frictionmap.phases.solve import response_phases, sweep_phases
from frictionmap.phases.system import PhaseContact, PhaseSystem

TWO_MASSES = {
    "mass": np.eye(2), "damping": np.diag([0.04, 0.06]), "stiffness": np.array([[1.0, 0.2], [0.2, 1.2]]),
    "loads": {1: np.array([1.0, 0.5 + 0.6j])},
}  # fmt: skip
ONE_MASS = {
    "mass": np.eye(1), "damping": np.full((1, 1), 0.1), "stiffness": np.eye(1), "loads": {1: np.ones(1)},
}  # fmt: skip
C, D = np.array([1.0, 0.0]), np.array([0.0, 1.0])


def damper(**own):
    """A contact on mass 1, pressed by mass 2."""
    given = {"normal": D, "normal_stiffness": 1.0, "friction": 0.4, "preload": 0.5, **own}
    return PhaseSystem(**TWO_MASSES, contacts=[PhaseContact(C, **given)])


def one_cell(system, r, **own):
    found = sweep_phases(system, [r], [1.0], [1.0], outputs=tuple(TABLE), **own)
    return {name: table[0, 0, 0] for name, table in found.items()}


def check_extremes(cell, highest, lowest, tolerance=1e-10):
    size = max(np.abs(highest).max(), np.abs(lowest).max())
    half = 0.5 * cell["peak_to_peak"]
    assert np.abs(cell["midpoint"] + half - highest).max() < tolerance * size
    assert np.abs(cell["midpoint"] - half - lowest).max() < tolerance * size


def check_row(row):
    cell, elastic = one_cell(system_of(row), row["r"]), [c["kind"] == "elastic" for c in row["contacts"]]
    elastic = np.array(elastic)[[c["kind"] != "spring" for c in row["contacts"]]]
    assert cell["status"] == regimes.RESOLVED
    assert cell["period"] == row["period"]
    check_extremes(cell, row["x_max"], row["x_min"])
    for name, own in (("stops", "stops_per_cycle"), ("turns", "turns_per_cycle")):
        assert (cell[own][~elastic] == split(row, name)[0][~elastic] / row["period"]).all()
    assert (cell["slips_per_cycle"][elastic] == split(row, "slips")[0][elastic] / row["period"]).all()
    moves = np.array(["d" in c for c in row["contacts"] if c["kind"] != "spring"], dtype=bool)
    liftoffs, opened = split(row, "liftoffs")[0], split(row, "open_fraction")[0]
    assert (cell["separations_per_cycle"][moves] == liftoffs[moves] / row["period"]).all()
    assert np.abs(cell["open_fraction"][moves] - opened[moves]).max(initial=0.0) < 1e-10
    stuck = np.where(elastic, cell["elastic_fraction"], cell["stuck_fraction"])
    assert np.abs(stuck - split(row, "stuck_fraction")[0]).max(initial=0.0) < 1e-10
    assert (cell["spring_crossings"] == split(row, "break_point_crossings")[1] / row["period"]).all()
    work = split(row, "work")[0] / row["period"]
    assert np.abs(cell["work_friction"] - work).max(initial=0.0) <= 1e-10 * np.abs(work).max(initial=0.0)
    assert abs(cell["multiplier"] - row["multiplier"]) < 1e-9


def loaded_rows(content):
    rows = [row for row in content["B"] if row["load"] == "periodic"]
    return rows + [row for row in content["examples"] if row["law"] == "B" and row["load"] == "periodic"]


def test_rows_of_an_independent_program(reference_table):
    rows = loaded_rows(reference_table("laws.json"))
    assert len(rows) > 20
    for row in rows:
        check_row(row)


#: r, largest and least x_1, share of time open, lift-offs of `damper`.
DAMPER = (
    (0.8, 2.3309904118758054, -2.7138218453577636, 0.0, 0),
    (1.2, 2.1174842109092933, -1.2570789962742661, 0.5333617876152689, 1),
    (1.5, 1.0906744354820745, -1.4960715612356539, 0.4707128166993673, 1),
)


@pytest.mark.parametrize(("r", "highest", "lowest", "opened", "liftoffs"), DAMPER)
def test_an_elastic_contact_that_opens(r, highest, lowest, opened, liftoffs):
    cell = one_cell(damper(stiffness=3.0), r)
    assert abs(cell["midpoint"][0] + 0.5 * cell["peak_to_peak"][0] - highest) < 1e-12
    assert abs(cell["midpoint"][0] - 0.5 * cell["peak_to_peak"][0] - lowest) < 1e-12
    assert abs(cell["open_fraction"][0] - opened) < 1e-12
    assert cell["separations_per_cycle"] == liftoffs


def test_a_rigid_contact_that_opens():
    cell = one_cell(damper(), 1.5)
    assert abs(cell["midpoint"][0] + 0.5 * cell["peak_to_peak"][0] - 0.8975825682113759) < 1e-12
    assert abs(cell["open_fraction"][0] - 0.4685141349067165) < 1e-12
    assert (cell["stops_per_cycle"], cell["turns_per_cycle"], cell["separations_per_cycle"]) == (0, 1, 1)
    assert cell["regime"] == regimes.CONTINUOUS
    assert cell["normal_force_min"] == 0.0


@pytest.mark.parametrize(
    ("r", "knots", "below", "highest", "lowest", "crossings"),
    [
        (1.3, [0.5], 0.0, 3.6145435569785445, -7.0487722996193325, 2),
        (0.6, [-0.5, 0.5], 4.0, 0.8808091746636038, -0.8808091746636041, 4),
    ],
)
def test_gap_and_backlash(r, knots, below, highest, lowest, crossings):
    spring = SpringElement(np.ones(1), knots, [0.0] * len(knots), below, 4.0)
    cell = one_cell(PhaseSystem(**ONE_MASS, springs=[spring]), r)
    check_extremes(cell, [highest], [lowest], 1e-13)
    assert cell["spring_crossings"] == crossings
    furthest = max(highest - 0.5, -lowest - 0.5 if below else 0.0)
    assert abs(cell["spring_force_max"][0] - 4.0 * furthest) < 1e-12


def test_a_wedge():
    contact = PhaseContact(
        np.ones(1), normal=np.ones(1), normal_stiffness=0.3, friction=0.3, preload=1.0, static=1.0
    )
    given = ONE_MASS | {"damping": np.full((1, 1), 0.02)}
    cell = one_cell(PhaseSystem(**given, contacts=[contact]), 0.7)
    check_extremes(cell, [1.1486021133160609], [-1.3713551447365806], 1e-13)


SYSTEMS = {
    "elastic": (damper(stiffness=3.0), 1.2),
    "rigid": (damper(), 1.5),
    "rigid, belt": (damper(wall_speed=0.3), 0.6),
    "backlash": (
        PhaseSystem(
            **TWO_MASSES,
            contacts=[PhaseContact(C, ratio=None, limit=0.3)],
            springs=[SpringElement(D - C, [-0.4, 0.4], [0.0, 0.0], 2.0, 3.0)],
        ),
        0.9,
    ),
}


@pytest.mark.parametrize("name", SYSTEMS)
def test_balance_of_work(name):
    """What the load and the belt bring in is what friction and dashpots take; springs keep nothing."""
    system, r = SYSTEMS[name]
    found = response_phases(system, r, 1.0, 1.0, points=20)
    given = float(found["work_input"] + found["work_wall"].sum())
    taken = float(found["work_damping"] + found["work_friction"].sum())
    assert taken > 0.1
    assert abs(given - taken) < 1e-11 * taken


@pytest.mark.parametrize("name", SYSTEMS)
def test_the_law_holds_at_every_time(name):
    system, r = SYSTEMS[name]
    found = response_phases(system, r, 1.0, 1.0, points=500)
    for j, one in enumerate(system.contacts):
        limit = np.full(found["tau"].size, one.limit or 0.0)
        if one.normal is not None:
            force = one.preload + one.normal_stiffness * (one.normal @ found["x"])
            assert np.abs(found["normal_force"][j] - np.maximum(force, 0.0)).max() < 1e-12
            limit = one.friction * found["normal_force"][j]
        assert (np.abs(found["friction"][j]) <= limit + 1e-12).all()
        w = one.direction @ found["v"] - one.wall_speed / r
        slides = found["direction"][j] != 0
        assert np.abs(found["friction"][j] - found["direction"][j] * limit)[slides].max() < 1e-12
        if not one.stiffness:
            assert (found["direction"][j] * w > -1e-12)[slides].all()
            held = (found["direction"][j] == 0) & (found["open"][j] == 0)
            assert np.abs(w[held]).max(initial=0.0) < 1e-12


def twin(system, r, state, periods, steps):
    """x over one cycle in fixed steps, from a state at tau = 0; an elastic contact clips its force."""
    inverse = np.linalg.inv(system.mass) / (r * r)
    h = 2.0 * np.pi * periods / steps
    x, v, y = state
    path = [x]

    def rate(tau, x, v, y):
        force = system.loads[1] * np.exp(1j * tau)
        force = force.real - r * system.damping @ v - system.stiffness @ x
        for j, one in enumerate(system.contacts):
            normal = one.preload + one.normal_stiffness * (one.normal @ x)
            spring = one.stiffness * (one.direction @ x - y[j])
            force = force - one.direction * np.clip(
                spring, -one.friction * max(normal, 0), one.friction * max(normal, 0)
            )
            force = force - one.normal * (max(normal, 0.0) - max(one.preload, 0.0))
        for one in system.springs:
            force = force - one.direction * one(one.direction @ x)
        return inverse @ force

    for k in range(steps):
        tau = k * h
        a = rate(tau, x, v, y)
        middle = rate(tau + 0.5 * h, x + 0.5 * h * v + 0.125 * h * h * a, v + 0.5 * h * a, y)
        x, v = x + h * v + 0.5 * h * h * middle, v + h * middle
        for j, one in enumerate(system.contacts):
            most = one.friction * max(one.preload + one.normal_stiffness * (one.normal @ x), 0.0)
            z = one.direction @ x
            y[j] = z - np.clip(one.stiffness * (z - y[j]), -most, most) / one.stiffness
        path.append(x)
    return np.array(path).T


@pytest.mark.parametrize(
    ("system", "r"),
    [
        SYSTEMS["elastic"],
        (PhaseSystem(**TWO_MASSES, springs=[SpringElement(D - C, [-0.4, 0.4], [0.0, 0.0], 2.0, 3.0)]), 0.9),
    ],
    ids=["elastic", "backlash"],
)
def test_naive_twin(system, r):
    steps = 2**13
    found = response_phases(system, r, 1.0, 1.0, points=64)
    periods = int(found["period"])
    y = found["y"][:, 0].copy() if system.contacts else []
    path = twin(system, r, (found["x"][:, 0], found["v"][:, 0], y), periods, steps)
    every = path[:, :: steps // (64 * periods)]
    assert np.abs(every - found["x"]).max() < 2e-4 * np.abs(found["x"]).max()
