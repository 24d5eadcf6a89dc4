"""Contacts that open, on belts without a load: mode coupling; values of an independent program."""

import numpy as np
import pytest
from phase_systems import split, system_of

from frictionmap import regimes
from frictionmap.general.normal_force import NormalSpring, Structure, sliding_limit
from frictionmap.no_load.one_mass import portraits
from frictionmap.phases.free import OTHERS, response_free, sweep_free
from frictionmap.phases.quantities import FREE_TABLE
from frictionmap.phases.system import PhaseContact, PhaseSystem

C, D = np.array([1.0, 0.0]), np.array([0.0, 1.0])
STIFFNESS = np.array([[2.0, 0.35], [0.35, 1.2]])


def coupled_modes(speed, phi=0.6, damping=0.02, **own):
    contact = PhaseContact(
        C, normal=D, normal_stiffness=1.0, friction=phi, preload=1.0, wall_speed=speed, static=1.0, **own
    )
    return PhaseSystem(np.eye(2), damping * np.eye(2), STIFFNESS, [contact])


def one_cell(system, speed, beta=1.0, mu=1.0, **own):
    found = sweep_free(system, [speed], [beta], [mu], outputs=(*FREE_TABLE, *OTHERS), **own)
    return {name: table[0, 0, 0] for name, table in found.items()}


def check_row(row):
    """Some rows have two rounds of the cycle: counts and works are compared per round."""
    speed = next(one["wall_speed"] for one in row["contacts"] if "wall_speed" in one)
    cell = one_cell(system_of(row), speed, starts=["rest"])
    rounds = round(row["period"] / cell["cycle_period"])
    assert rounds in (1, 2)
    assert abs(rounds * cell["cycle_period"] - row["period"]) < 1e-10 * row["period"]
    size = max(np.abs(row["x_max"]).max(), np.abs(row["x_min"]).max())
    assert np.abs(cell["midpoint"] + 0.5 * cell["peak_to_peak"] - row["x_max"]).max() < 1e-10 * size
    assert np.abs(cell["midpoint"] - 0.5 * cell["peak_to_peak"] - row["x_min"]).max() < 1e-10 * size
    for name, own in (
        ("stops", "stops_per_cycle"), ("turns", "turns_per_cycle"), ("liftoffs", "separations_per_cycle")
    ):  # fmt: skip
        assert (rounds * cell[own] == split(row, name)[0]).all()
    assert np.abs(cell["open_fraction"] - split(row, "open_fraction")[0]).max() < 1e-10
    assert np.abs(cell["stuck_fraction"] - split(row, "stuck_fraction")[0]).max() < 1e-10
    assert np.abs(rounds * cell["work_friction"] - split(row, "work")[0]).max() < 1e-10
    assert abs(cell["multiplier"] ** rounds - row["multiplier"]) < 1e-9
    stops = row["regime"][0].startswith("stops")
    assert cell["regime"] == (regimes.STICK_SLIP_CYCLE if stops else regimes.CYCLE_WITHOUT_STOPS)


def test_rows_of_an_independent_program(reference_table):
    content = reference_table("laws.json")
    rows = [row for row in (*content["B"], *content["examples"]) if row["law"] == "B" and row["r"] is None]
    assert len(rows) >= 10
    for row in rows:
        check_row(row)


#: Belt speed, period, stops, lift-offs, share of time stuck.
CYCLES = (
    (0.05, 4.260037405975065, 1, 0, 0.38650177317372475),
    (0.3, 4.613711649760028, 1, 1, 0.19948813472660962),
)


@pytest.mark.parametrize(("speed", "period", "stops", "liftoffs", "stuck"), CYCLES)
def test_mode_coupling(speed, period, stops, liftoffs, stuck):
    cell = one_cell(coupled_modes(speed), speed, starts=["rest"])
    assert cell["regime"] == regimes.STICK_SLIP_CYCLE
    assert abs(cell["cycle_period"] - period) < 1e-12
    assert (cell["stops_per_cycle"], cell["separations_per_cycle"]) == (stops, liftoffs)
    assert abs(cell["stuck_fraction"] - stuck) < 1e-12
    assert abs(cell["growth"] - 0.0858459277768) < 1e-12
    assert not cell["also_reachable"] & 1 << regimes.STEADY_SLIDING


def test_steady_sliding_attracts_below_the_limit_of_mode_coupling():
    structure = Structure(np.eye(2), 0.1 * np.eye(2), STIFFNESS)
    limit = sliding_limit(structure, NormalSpring(C, D, 1.0), -1).phi
    below = one_cell(coupled_modes(0.3, 0.99 * limit, 0.1), 0.3, starts=["sliding"])
    above = one_cell(coupled_modes(0.3, 1.01 * limit, 0.1), 0.3, starts=["sliding"])
    assert below["growth"] < 0.0 < above["growth"]
    assert below["regime"] == regimes.STEADY_SLIDING
    assert above["regime"] in (regimes.STICK_SLIP_CYCLE, regimes.CYCLE_WITHOUT_STOPS)
    place = np.linalg.solve(STIFFNESS + np.outer(D - 0.99 * limit * C, D), 0.99 * limit * C)
    assert np.abs(below["midpoint"] - place).max() < 1e-13
    assert (below["peak_to_peak"] == 0.0).all()


@pytest.mark.parametrize("start", ["rest", "sliding", "far"])
def test_balance_of_work(start):
    found = response_free(coupled_modes(0.3), 1.0, 1.0, points=10, start=start)
    given, taken = (
        float(found["work_wall"].sum()),
        float(found["work_friction"].sum() + found["work_damping"]),
    )
    assert found["regime"] == regimes.STICK_SLIP_CYCLE
    assert taken > 0.1
    assert abs(given - taken) < 1e-11 * taken
    assert np.abs(found["x"][:, -1] - found["x"][:, 0]).max() < 1e-11


def test_the_cycle_of_one_mass_with_a_drop_of_friction():
    """The other engine follows it in closed form."""
    zeta, mu, speed, beta = 0.05, 1.3, 0.2, 1.0
    flat = tuple(np.array([value]) for value in (0.0, 1.0, 0.0))
    wanted = portraits(flat, zeta, np.array([mu]), np.array([speed]), np.array([beta]))
    contact = PhaseContact(np.ones(1), wall_speed=speed)
    system = PhaseSystem(np.eye(1), np.full((1, 1), 2.0 * zeta), np.eye(1), [contact])
    cell = one_cell(system, speed, beta, mu, starts=["rest"])
    assert cell["regime"] == wanted.regime[0, 0, 0] == regimes.STICK_SLIP_CYCLE
    assert abs(cell["cycle_period"] - wanted.period[0, 0, 0]) < 1e-11
    assert abs(cell["stuck_fraction"][0] - wanted.stuck[0, 0, 0]) < 1e-11
    assert cell["multiplier"] < 1e-12


def test_elastic_contacts_tend_to_the_rigid_one():
    """Without stops the error falls like 1/sqrt(kt), with them like 1/kt: here there are some."""
    rigid = one_cell(coupled_modes(0.3), 0.3, starts=["rest"])
    errors = []
    for stiffness in (1e3, 4e3):
        cell = one_cell(coupled_modes(0.3, stiffness=stiffness), 0.3, starts=["rest"])
        errors.append(abs(cell["cycle_period"] / rigid["cycle_period"] - 1.0))
    assert errors[1] < 0.6 * errors[0] < 1e-2
