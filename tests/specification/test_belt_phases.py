"""Contacts that open and piecewise linear springs on belts without a load, through the public functions."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import frictionmap as fm
from frictionmap import regimes
from frictionmap.command_line.cli import main

STIFFNESS = np.array([[2.0, 0.35], [0.35, 1.2]])
NORMAL = {"mass": 2, "stiffness": 1.0, "friction": 0.6}

#: Of an independent event-exact program: mode coupling.  Belt speed, period, stops, separations, shares of
#: the cycle stuck.
CYCLES = (
    (0.05, 4.260037405975065, 1, 0, 0.38650177317372475),
    (0.3, 4.613711649760028, 1, 1, 0.19948813472660962),
)

#: Of the same program: a mass that stops and separates, and turns once in between.
ROW = {
    "M": [[1.0, 0.0], [0.0, 1.35]],
    "C": [[0.021758072004576367, -0.007681374132858979], [-0.00768137413285898, 0.01651839167206998]],
    "K": [[2.02, -1.02], [-1.02, 1.02]],
    "contacts": [
        {"kind": "friction", "c": [1.0, 0.0], "d": [0.0, 1.0], "phi": 0.85, "N0": 0.995, "kn": 2.87,
         "mu": 1.0, "wall_speed": -0.06}
    ],
    "period": 4.545915532591418, "x_max": [-0.30824711542546185, 0.6792930287492946],
    "x_min": [-0.6279753944611398, -1.302765926965015], "z_max": [-0.30824711542546185],
    "z_min": [-0.6279753944611398], "stops": [1.0], "turns": [1.0], "stuck_fraction": [0.190797193438204],
    "liftoffs": [1.0], "open_fraction": [0.5324747842147839], "multiplier": 0.7973444430667039,
    "regime": ["stops, separates"],
}  # fmt: skip


def coupled_modes(damping=0.02, **normal):
    matrices = {"M": np.eye(2), "K": STIFFNESS, "C": damping * np.eye(2)}
    return fm.System(matrices=matrices, frequency_scale=1.0, contacts=[{"normal": NORMAL | normal}])


def system_of(row):
    contacts = []
    for one in row["contacts"]:
        mass = int(np.flatnonzero(one["c"])[0]) + 1
        normal = {"vector": one["d"], "stiffness": one["kn"], "friction": one["phi"], "preload": one["N0"]}
        contacts.append(
            fm.Contact("fixed-wall", [mass], normal=normal, mu=one["mu"], wall_speed=one["wall_speed"])
        )
    matrices = {name: np.array(row[name]) for name in "MCK"}
    return fm.System(matrices=matrices, frequency_scale=1.0, contacts=contacts)


def check_row(row):
    """Some rows have two rounds of the cycle."""
    speed = abs(row["contacts"][0]["wall_speed"])
    ds = fm.sweep(system_of(row), wall_speed=[speed], beta=[1.0]).squeeze()
    rounds = round(row["period"] / ds.cycle_period.item())
    assert rounds in (1, 2)
    assert rounds * ds.cycle_period.item() == pytest.approx(row["period"], rel=1e-10)
    stops = row["regime"][0].startswith("stops")
    assert ds.regime.item() == (regimes.STICK_SLIP_CYCLE if stops else regimes.CYCLE_WITHOUT_STOPS)
    assert ds.also_reachable.item() >> ds.regime.item() & 1
    for name, own in (
        ("stops", "stops_per_cycle"), ("turns", "turns_per_cycle"), ("liftoffs", "separations_per_cycle")
    ):  # fmt: skip
        assert rounds * ds[own].item() == row[name][0]
    size = np.abs([row["x_max"], row["x_min"]]).max()
    for name in ("x_max", "x_min", "z_max", "z_min", "open_fraction", "stuck_fraction"):
        assert np.abs(ds[name].values - np.squeeze(row[name])).max() < 1e-10 * max(size, 1.0), name
    assert ds.multiplier.item() ** rounds == pytest.approx(row["multiplier"], abs=1e-9)


def test_a_row_of_an_independent_program():
    check_row(ROW)


@pytest.mark.reference
def test_rows_of_an_independent_program(reference_table):
    rows = [row for row in reference_table("laws.json")["B"] if row["r"] is None]
    assert len(rows) >= 8
    for row in rows:
        check_row(row)


def test_mode_coupling():
    """At beta = 0.6 the preload beta/phi is 1."""
    ds = fm.sweep(coupled_modes(), wall_speed=[one[0] for one in CYCLES], beta=[0.6]).squeeze()
    assert (ds.regime.values == regimes.STICK_SLIP_CYCLE).all()
    assert np.abs(ds.growth.values - 0.0858459277768).max() < 1e-12
    for k, (_, period, stops, separations, stuck) in enumerate(CYCLES):
        one = ds.isel(wall_speed=k)
        assert one.cycle_period.item() == pytest.approx(period, rel=1e-12)
        assert (one.stops_per_cycle.item(), one.separations_per_cycle.item()) == (stops, separations)
        assert one.stuck_fraction.item() == pytest.approx(stuck, abs=1e-12)
        assert not one.also_reachable.item() & 1 << regimes.STEADY_SLIDING


def test_everything_scales_with_friction_and_speed():
    """Twice the preload and the speed: the same motion, twice as large."""
    once = fm.sweep(coupled_modes(), wall_speed=[0.3], beta=[0.6]).squeeze()
    twice = fm.sweep(coupled_modes(), wall_speed=[0.6], beta=[1.2]).squeeze()
    for name in ("x_max", "x_min", "normal_force_max"):
        assert twice[name].values == pytest.approx(2.0 * once[name].values, rel=1e-11)
    assert twice.cycle_period.item() == pytest.approx(once.cycle_period.item(), rel=1e-11)


def test_a_preload_of_the_contact_does_not_follow_the_axis():
    grid = fm.sweep(coupled_modes(), wall_speed=[0.3], beta=[0.6]).squeeze()
    own = fm.sweep(coupled_modes(preload=1.0), wall_speed=[0.3], beta=[0.1, 5.0]).squeeze()
    assert own.cycle_period.values == pytest.approx(grid.cycle_period.item(), rel=1e-13)


@pytest.mark.parametrize("speed", [0.3, 0.05])
def test_a_motion_in_time(speed):
    """Traces satisfy the equations of motion, and their extremes are those of the cell."""
    ds = fm.response(coupled_modes(), wall_speed=speed, beta=0.6, points=20001)
    normal = np.maximum(0.0, 1.0 + ds.x.values[1])
    assert ds.normal_force.values == pytest.approx(normal, abs=1e-12)
    assert ((ds.open.values == 1) == (normal == 0.0)).all()
    time, x, v = ds.time.values, ds.x.values, ds.v.values
    assert ds.x_max.values == pytest.approx(x.max(axis=1), abs=1e-6)
    assert ds.x_min.values == pytest.approx(x.min(axis=1), abs=1e-6)
    assert x[:, -1] == pytest.approx(x[:, 0], abs=1e-11)
    moves = ds.direction.values != 0
    assert np.abs(ds.friction.values)[moves] == pytest.approx(0.6 * normal[moves], abs=1e-12)
    stuck = np.diff(time) @ (~moves[1:])
    assert stuck / time[-1] == pytest.approx(ds.stuck_fraction.item(), abs=2e-4)
    force = -STIFFNESS @ x - 0.02 * v - np.stack((ds.friction.values, normal - 1.0))
    change = (force[:, 1:] + force[:, :-1]) / 2.0 * np.diff(time)
    assert np.abs(np.diff(v, axis=1) - change).max() < 2.0 * np.abs(force).max() * np.diff(time).max() * 1e-1
    assert np.abs(np.cumsum(np.diff(v, axis=1) - change, axis=1)).max() < 2e-3


def test_steady_sliding():
    """x* of K_s x* = phi N0 c, and the growth of its roots."""
    system = coupled_modes(0.1, friction=0.2)
    ds = fm.sweep(system, wall_speed=[0.3], beta=[0.2]).squeeze()
    closed = STIFFNESS + np.outer([-0.2, 1.0], [0.0, 1.0])
    place = np.linalg.solve(closed, [0.2, 0.0])
    assert ds.regime.item() == regimes.STEADY_SLIDING
    for name in ("x_max", "x_min"):
        assert ds[name].values == pytest.approx(place, abs=1e-13)
    assert ds.z_max.item() == pytest.approx(place[0], abs=1e-13)
    assert ds.normal_force_min.item() == pytest.approx(1.0 + place[1], abs=1e-13)
    assert (ds.stops_per_cycle.item(), ds.open_fraction.item()) == (0.0, 0.0)
    companion = np.block([[np.zeros((2, 2)), np.eye(2)], [-closed, -0.1 * np.eye(2)]])
    assert ds.growth.item() == pytest.approx(np.linalg.eigvals(companion).real.max(), abs=1e-12)
    motion = fm.response(system, wall_speed=0.3, beta=0.2, points=5)
    assert motion.x.values == pytest.approx(np.tile(place[:, np.newaxis], 5), abs=1e-13)
    assert motion.friction.values == pytest.approx(-0.2 * (1.0 + place[1]) * np.ones(5), abs=1e-13)


#: Stiffness between the masses, of the second mass and of the normal force, friction, belt speed, damping;
#: the smoothed equations below pass many stops between slow beats before they settle.
BEATS = (
    (0.07112633797192286, 1.0740177004655007, 0.17571713892462365, 1.079765475326245,
     0.003563265717470724, 0.02),
    (0.04564636248263532, 1.0563374871917302, 0.10633300756260301, 0.7695812715443816,
     0.006199824215218518, 0.005),
)  # fmt: skip


@pytest.mark.parametrize("case", BEATS)
def test_slow_beats_end_in_steady_sliding(case):
    """From rest the friction is smoothed over 1e-3 of the belt speed, and the last vibrations fall."""
    coupling, second, kn, phi, speed, damping = case
    stiffness = np.array([[1.0, coupling], [coupling, second]])
    matrices = {"M": np.eye(2), "K": stiffness, "C": damping * np.eye(2)}
    normal = {"mass": 2, "stiffness": kn, "friction": phi, "preload": 1.0}
    system = fm.System(matrices=matrices, frequency_scale=1.0, contacts=[{"normal": normal}])
    ds = fm.sweep(system, wall_speed=[speed], beta=[1.0]).squeeze()

    def rates(_, y):
        force = max(0.0, 1.0 + kn * y[1])
        friction = phi * force * np.tanh((y[2] - speed) / (1e-3 * speed))
        return np.concatenate((y[2:], -stiffness @ y[:2] - damping * y[2:] - [friction, force - 1.0]))

    found = solve_ivp(rates, (0.0, 900.0), np.zeros(4), method="LSODA", rtol=1e-8, atol=1e-11, max_step=0.05)
    early, late = (
        np.abs(found.y[2, (found.t > begin) & (found.t < begin + 100.0)]).max() for begin in (500.0, 800.0)
    )
    assert late < 0.7 * early < 0.7 * speed
    assert ds.regime.item() == regimes.STEADY_SLIDING
    assert ds.x_max.values == pytest.approx(found.y[:2, -1], abs=2e-2)


def test_a_spring_with_equal_slopes_is_a_linear_one():
    """One mass whose stiffness is 3: an undamped cycle with the drop a = (mu - 1) beta."""
    linear = fm.System(matrices={"M": np.eye(1), "K": 3.0 * np.eye(1)}, frequency_scale=1.0)
    spring = {
        "masses": [1], "displacement": [0.1], "force": [0.2], "stiffness_below": 2.0, "stiffness_above": 2.0
    }  # fmt: skip
    kinked = fm.System(matrices={"M": np.eye(1), "K": np.eye(1)}, frequency_scale=1.0, springs=[spring])
    wanted, found = (
        fm.sweep(one, wall_speed=[0.3], beta=[0.8], mu=[1.4]).squeeze() for one in (linear, kinked)
    )
    assert found.regime.item() == wanted.regime.item() == regimes.STICK_SLIP_CYCLE
    half = 0.32 / 3.0 / 0.3
    period = 2.0 * half + 2.0 * (np.pi - np.arctan(half * np.sqrt(3.0))) / np.sqrt(3.0)
    for name in ("cycle_period", "x_max", "x_min", "stuck_fraction"):
        assert found[name].item() == pytest.approx(wanted[name].item(), rel=1e-11), name
    assert wanted.cycle_period.item() == pytest.approx(period, rel=1e-12)
    assert found.spring_crossings.item() == 2.0
    assert found.spring_force_max.item() == pytest.approx(2.0 * wanted.x_max.item(), rel=1e-11)


def test_a_gap_under_the_mass_on_a_belt():
    """In stick-slip with a drop of friction, against a Runge-Kutta method with events."""
    spring = {"masses": [1], "gap": 0.5, "stiffness": 4.0}
    system = fm.System(damping_ratios=0.05, springs=[spring])
    ds = fm.sweep(system, wall_speed=[0.3], beta=[0.8], mu=[1.5]).squeeze()
    assert ds.regime.item() == regimes.STICK_SLIP_CYCLE
    begin = (1.2 - 0.1 * 0.3 + 4.0 * 0.5) / 5.0  # where static friction gives way

    def force(x):
        return x + 4.0 * max(0.0, x - 0.5)

    def rates(_, y):
        return [y[1], 0.8 - 0.1 * y[1] - force(y[0])]

    def stops(t, y):
        return y[1] - 0.3 if t > 1e-3 else -1.0

    stops.terminal, stops.direction = True, 1
    slip = solve_ivp(
        rates, (0.0, 20.0), [begin, 0.3], events=stops, method="DOP853", rtol=1e-12, atol=1e-13, max_step=0.01
    )
    stuck = (begin - slip.y[0, -1]) / 0.3
    assert ds.cycle_period.item() == pytest.approx(slip.t[-1] + stuck, rel=1e-9)
    assert ds.stuck_fraction.item() == pytest.approx(stuck / (slip.t[-1] + stuck), rel=1e-8)
    assert ds.spring_crossings.item() == 2.0


def test_several_contacts_and_belts():
    """A second contact on a belt of the other sense: senses and stops are those of the velocities."""
    second = {"masses": [2], "force": 0.05, "wall_speed": -0.2}
    first = {"masses": [1], "normal": NORMAL | {"preload": 1.0}, "wall_speed": 0.4}
    matrices = {"M": np.eye(2), "K": STIFFNESS, "C": 0.02 * np.eye(2)}
    system = fm.System(matrices=matrices, frequency_scale=1.0, contacts=[first, second])
    ds = fm.sweep(system, wall_speed=[0.3], beta=[1.0]).squeeze()
    assert ds.status.item() == regimes.RESOLVED
    assert ds.open_fraction.dims == ("contact",)
    assert np.isnan(ds.open_fraction.values[1])
    motion = fm.response(system, wall_speed=0.3, beta=1.0, points=4001)
    walls = np.array([0.3, -0.15])
    senses = motion.direction.values
    assert (
        senses[senses != 0] == np.sign(motion.v.values - walls[:, np.newaxis])[senses != 0]
    ).mean() > 0.999
    held = motion.v.values - walls[:, np.newaxis]
    assert np.abs(held[senses == 0]).max(initial=0.0) < 1e-10


@pytest.mark.parametrize(
    ("contacts", "named"),
    [
        ([{"normal": NORMAL, "stiffness": 3.0}], r"cannot use contacts\[1\]\.stiffness"),
        ([{"normal": NORMAL, "wall_velocity": 0.3}], r"cannot use contacts\[1\]\.wall_velocity"),
        (
            [{"normal": NORMAL, "wall_speed": 0.3}, {"masses": [2]}],
            r"cannot use contacts\[2\] without a belt",
        ),
    ],
)
def test_what_is_not_offered_is_refused(contacts, named):
    matrices = {"M": np.eye(2), "K": STIFFNESS}
    system = fm.System(matrices=matrices, frequency_scale=1.0, contacts=contacts)
    with pytest.raises(fm.InputError, match=named):
        fm.sweep(system, wall_speed=[0.3], beta=[0.6])
    with pytest.raises(fm.InputError, match=named):
        fm.response(system, wall_speed=0.3, beta=0.6)


def test_limits_and_starts_are_refused():
    with pytest.raises(fm.InputError, match="contacts that open"):
        fm.boundaries(coupled_modes(), wall_speed=[0.3], beta=[0.6])
    with pytest.raises(fm.InputError, match="start"):
        fm.response(coupled_modes(), wall_speed=0.3, beta=0.6, start="release")


TEXT = """
[system]
mass_ratios = [1.0, 1.0]
stiffness_ratios = [1.0, 0.5]
damping_ratios = 0.01
[[system.contacts]]
masses = [1]
normal = { mass = 2, stiffness = 1.0, friction = 0.8 }
[[system.springs]]
masses = [2]
gap = "1 mm"
stiffness = 4.0
[units]
natural_frequency = "50 Hz"
load = "10 N"
stiffness = "10 N/mm"
[grid]
wall_speed = ["50 mm/s", "100 mm/s"]
beta = ["5 N", "10 N"]
"""


def test_commands(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "pad.toml").write_text(TEXT)
    assert main(["map", "pad.toml"]) == 0
    assert capsys.readouterr().out.startswith("4 cells (")
    ds = fm.open("pad.nc")
    assert ds.normal_force_max_N.values == pytest.approx(10.0 * ds.normal_force_max.values, nan_ok=True)
    assert ds.spring_crossings.dims == ("mu", "wall_speed", "beta", "spring")
    assert main(["export", "pad.nc"]) == 0
    assert "spring_force_max_1" in (tmp_path / "pad.csv").read_text().splitlines()[0]
    assert main(["plot", "pad.nc"]) == 0
    arguments = ["--wall-speed", "100 mm/s", "--beta", "5 N", "-o", "one.nc"]
    assert main(["response", "pad.toml", *arguments]) == 0
    assert main(["plot", "one.nc"]) == 0
    assert main(["info", "one.nc"]) == 0
