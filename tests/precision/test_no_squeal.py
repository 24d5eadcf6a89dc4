"""The least belt speed without squeal: closed forms, all cycles of one mass, and a structure."""

import numpy as np
import pytest
import xarray as xr
from layouts import assert_inside_and_apart
from scipy.integrate import solve_ivp

import frictionmap as fm
from frictionmap.command_line.cli import main
from frictionmap.design.configuration import load_design
from frictionmap.files.reading import read
from frictionmap.files.summary import describe_file
from frictionmap.model.friction_law import FrictionLaw
from frictionmap.no_load.quiet import proved_speed

STRIBECK = {"speed": [0.0, 0.2, 0.6, 1.2], "factor": [1.0, 0.8, 0.7, 0.68], "slope": 0.08}

#: Falls to nearly nothing just above a speed.
STEP = {"speed": [0.0, 0.5, 0.6], "factor": [1.0, 0.99, 0.05], "slope": 0.0}


TWO = fm.System(
    contacts=[fm.Contact("fixed-wall", [1]), fm.Contact("fixed-wall", [2])], mass_ratios=[1, 1],
    stiffness_ratios=[1, 1], damping_ratios=0.1,
)  # fmt: skip


def pad(law=None, zeta=0.03, **more):
    return fm.System(damping_ratios=zeta, contacts=[fm.Contact("fixed-wall", [1], law=law, **more)])


def test_the_largest_speed_with_a_cycle():
    """A value of an independent program; by itself up to the last fall steeper than 2 zeta."""
    ds = fm.design.no_squeal(pad(STRIBECK), 1.0)
    assert ds.wall_speed.item() == pytest.approx(1.124273429839, rel=1e-12)
    assert ds.cycle_speed_lim.item() == ds.wall_speed.item()
    assert ds.sliding_speed_lim.item() == 0.6
    # beta g + 2 zeta V is back at beta where 0.68 + 0.08 (V - 1.2) + 0.06 V = 1
    assert ds.proved_speed.item() == pytest.approx(1.2 + (1.0 - 0.752) / 0.14, rel=1e-12)


@pytest.mark.parametrize(("zeta", "rho"), [(0.05, 0.910669990890), (0.2, 2.724989235560)])
def test_a_drop_alone(zeta, rho):
    """Flat friction: a cycle exists up to (mu - 1) beta/v = rho(zeta), a closed form."""
    ds = fm.design.no_squeal(pad(zeta=zeta), 0.8, mu=1.5)
    assert ds.wall_speed.item() == pytest.approx(0.5 * 0.8 / rho, rel=1e-9)
    assert ds.sliding_speed_lim.item() == 0.0
    assert ds.proved_speed.item() == pytest.approx(0.5 * 0.8 / (2.0 * zeta), rel=1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_one_mass_squeals_just_below_and_nowhere_above(seed):
    rng = np.random.default_rng(seed)
    speed = np.append(0.0, np.cumsum(rng.uniform(0.1, 0.6, 3)))
    factor = np.append(1.0, rng.uniform(0.3, 1.1, 3))
    law = {"speed": speed.tolist(), "factor": factor.tolist(), "slope": rng.uniform(0.0, 0.2)}
    law = STEP if seed == 0 else law
    system, beta = pad(law, rng.uniform(0.005, 0.1)), rng.uniform(0.3, 2.0)
    mu = 1.0 + seed % 2 * rng.uniform(0.0, 0.5)
    ds = fm.design.no_squeal(system, beta, mu=mu)
    quiet, proved = ds.wall_speed.item(), ds.proved_speed.item()
    assert quiet <= proved
    above = fm.sweep(
        system, wall_speed=np.geomspace(quiet * (1.0 + 1e-6), 1.5 * proved, 150), beta=[beta], mu=[mu]
    )
    assert (above.also_reachable == 1 << 4).all()
    if quiet > 0.0:
        below = fm.sweep(system, wall_speed=[quiet * (1.0 - 1e-6)], beta=[beta], mu=[mu])
        assert (below.also_reachable != 1 << 4).all()


def test_cycles_without_stops_count():
    """Above the limits of sliding and of sticking a vibration goes on at 1.42; at 1.5 it dies out."""
    law = {"speed": [0.0, 0.4338662, 1.196714, 1.3548337], "factor": [1.0, 1.1394063, 0.3879611, 0.5195252]}
    zeta, beta = 0.125, 0.99564
    ds = fm.design.no_squeal(pad(law, zeta), beta)
    assert max(ds.sliding_speed_lim.item(), ds.cycle_speed_lim.item()) < 1.3
    assert ds.wall_speed.item() == pytest.approx(1.459, abs=2e-3)

    def left(v):
        def rates(_, y):
            force = beta * np.interp(abs(v - y[1]), law["speed"], law["factor"])
            return [y[1], np.sign(v - y[1]) * force - y[0] - 2.0 * zeta * y[1]]

        place = beta * np.interp(v, law["speed"], law["factor"])
        found = solve_ivp(rates, (0.0, 200.0), [place + 0.95 * v, 0.0], rtol=1e-8, atol=1e-10, max_step=0.05)
        return np.ptp(found.y[0][found.t > 180.0])

    assert left(1.42) > 0.3
    assert left(1.5) < 1e-6


@pytest.mark.parametrize("share", [-2e-16, 2e-16, 4e-16])
def test_next_to_a_break_point_nothing_vibrates_by_rounding_errors(share):
    """The friction falls below a speed and rises above: a speed rounded apart made a cycle of 1e-16."""
    law = {
        "speed": [0.0, 0.5351246019850423, 0.77853320652882, 1.180107281554601],
        "factor": [1.0, 0.9220272663361431, 0.8728597036828523, 1.0323040963924062],
        "slope": 0.17207872983657693,
    }
    speed = law["speed"][2] * (1.0 + share)
    found = fm.sweep(
        pad(law, 0.09223257475963244), wall_speed=[speed], beta=[0.34519914859491524], mu=[1.2186240000647544]
    )
    assert found.regime.item() == 4
    assert found.also_reachable.item() == 1 << 4


def test_the_energy_of_every_deviation_falls_from_the_proved_speed_on():
    """beta (g(v) - g(V)) (V - v) <= s (V - v)^2 at all V, with mu at rest; not just below."""
    law, slope, beta, mu = FrictionLaw(**STRIBECK), 0.1, 0.9, 1.1
    found = proved_speed(law, beta, mu, slope)
    speeds = np.linspace(0.0, 8.0, 4001)
    friction = beta * law(speeds)
    friction[0] = mu * beta

    def worst(v):
        off = speeds - v
        return ((beta * law(v) - friction) * off - slope * off**2).max()

    assert max(worst(v) for v in np.linspace(found, 6.0, 50)) <= 1e-12
    assert worst(0.97 * found) > 0.0


def test_quiet_at_all_speeds_and_at_none():
    rising = {"speed": [0.0], "factor": [1.0], "slope": 0.1}
    ds = fm.design.no_squeal(pad(rising), 1.0)
    assert (ds.wall_speed.item(), ds.proved_speed.item(), ds.sliding_speed_lim.item()) == (0.0, 0.0, 0.0)
    assert np.isinf(fm.design.no_squeal(pad(zeta=0.0), 1.0).wall_speed.item())


@pytest.mark.slow
def test_structures_are_quiet_from_the_proved_speed_on():
    chain = {"mass_ratios": [1, 1], "stiffness_ratios": [1, 1], "damping_ratios": 0.05}
    system = fm.System(contacts=[fm.Contact("fixed-wall", [2], law=STRIBECK)], **chain)
    ds = fm.design.no_squeal(system, 0.5)
    damping = system.modes.damping
    assert ds.proved_speed.item() == pytest.approx(
        proved_speed(FrictionLaw(**STRIBECK), 0.5, 1.0, 1.0 / np.linalg.inv(damping)[1, 1]), rel=1e-9
    )
    assert "a push may begin a cycle" in ds.attrs["warnings"]
    limit = ds.sliding_speed_lim.item()
    found = fm.sweep(system, wall_speed=[0.99 * limit, 1.01 * ds.wall_speed.item()], beta=[0.5])
    assert found.growth.values[0, 0, 0] > 0.0
    assert found.also_reachable.values[0, 1, 0] == 1 << 4


def test_file_summary_configuration_and_picture(tmp_path, capsys):
    path = tmp_path / "pad.toml"
    path.write_text(
        '[units]\nload = "160 N"\n[system]\nmasses = ["0.5 kg"]\nsprings = ["500 N/mm"]\n'
        "damping_ratios = 0.05\n"
        '[[system.contacts]]\nkind = "fixed-wall"\nmasses = [1]\n'
        'law = { formula = "exponential", kinetic = 0.75, speed = "0.1 m/s", error = 0.005 }\n'
        '[design]\nquestion = "no-squeal"\nbeta = "160 N"\n'
    )
    assert main(["design", str(path), "-o", str(tmp_path / "pad.nc")]) == 0
    out = capsys.readouterr().out
    assert "From 309 mm/s nothing squeals with 160 N (least)." in out
    assert "frequency of the squeal" in out
    assert "159.15 Hz" in out
    ds = read(tmp_path / "pad.nc")
    with xr.open_dataset(tmp_path / "pad.nc") as plain:
        assert plain.wall_speed_m_s.item() == pytest.approx(0.31, abs=0.01)
    assert "squeals by itself up to" in describe_file(ds)
    axes = fm.plot_design(ds)
    assert_inside_and_apart(axes[0].figure)
    call = fm.design.no_squeal(pad(STRIBECK), 1.0)
    (tmp_path / "again.toml").write_text(call.attrs["config"])
    assert load_design(tmp_path / "again.toml").ask().wall_speed == call.wall_speed
    assert main(["export", str(tmp_path / "pad.nc"), "-o", str(tmp_path / "pad.csv"), "--quiet"]) == 0
    assert len((tmp_path / "pad.csv").read_text().splitlines()) > 100


@pytest.mark.parametrize(
    ("system", "words"),
    [
        (TWO, "several contacts.*compute a map"),
        (pad(normal={"mass": 1, "stiffness": 1.0, "friction": 0.3}), "contacts that open.*compute a map"),
        (fm.System(contact_stiffness=2.0, damping_ratios=0.1), "contact_stiffness"),
    ],
)  # fmt: skip
def test_what_has_no_such_speed_is_refused(system, words):
    with pytest.raises(fm.InputError, match=words):
        fm.design.no_squeal(system, 1.0)


def test_friction_must_be_there():
    with pytest.raises(fm.InputError, match="beta must be > 0"):
        fm.design.no_squeal(pad(), 0.0)
    with pytest.raises(fm.InputError, match="beta must be one number; got 2"):
        fm.design.no_squeal(pad(), [0.1, 0.2])
