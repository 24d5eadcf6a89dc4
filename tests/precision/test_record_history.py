"""Records of any shape: motion and derivatives against other integrations, fits of known truth."""

import json
import re
import tomllib

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from shaken_masses import STEP, TURN, base_motion, marched

import frictionmap as fm
from benchmarks.measures.coverage import KINDS
from benchmarks.measures.coverage.histories import CASES
from frictionmap._kernels.history import tangents
from frictionmap.errors import InputError
from frictionmap.identify.history.drive import FORCE, Drive
from frictionmap.identify.history.model import NAMES, Measured, Model
from frictionmap.identify.rigs.configuration import identify, load_rig


def values_of(**given):
    found = dict.fromkeys(NAMES, 0.0) | {"mu": 1.0, "gain": 1.0, "stiffness": 1.0} | given
    return np.array([found[name] for name in NAMES])


TIMES, NOISY = np.arange(241) * STEP, np.ones(241, bool)
MOTIONS = {
    "base": (
        Drive(TIMES, base_motion(TIMES), 0, False, True, NOISY), 0,
        {"f_n": 3.1, "zeta": 0.01, "x_F": 0.8, "mu": 1.25, "offset_x": 0.1, "place": 0.7, "speed": 20.0},
    ),
    "spring": (
        Drive(TIMES, base_motion(TIMES), 0, True, False, NOISY), 0,
        {"f_n": 3.1, "zeta": 0.01, "x_F": 0.4, "contact_stiffness": 2.5, "place": 0.7, "speed": 20.0,
         "spring": 0.3},
    ),
    "force": (
        Drive(TIMES, base_motion(TIMES), FORCE, False, False,
              NOISY), 1,
        {"f_n": 3.1, "zeta": 0.01, "x_F": 0.3, "stiffness": 0.9, "place": 0.2, "speed": 20.0},
    ),
    "acceleration": (
        Drive(TIMES, 2000.0 * base_motion(TIMES), 2, True, True,
              NOISY), 2,
        {"f_n": 1.6, "zeta": 0.03, "x_F": 4.0, "place": 0.5, "speed": 20.0},
    ),
}  # fmt: skip


def model_of(name):
    drive, order, given = MOTIONS[name]
    record = Measured(drive, drive.time, np.zeros(drive.time.size), order, "contact_stiffness" in given)
    return Model(record), values_of(**given), given


def test_motion_is_that_of_another_integration():
    model, values, given = model_of("base")
    time = model.given.time
    expected = given["offset_x"] + marched(
        time, model.given.drive.values, 3.1, 0.01, 0.8, 1.25, (given["place"], given["speed"])
    )
    course = model.course(values)
    assert course.motion.counts[0] > 10
    assert set(course.motion.events[: course.motion.counts[0], 2]) == {0.0, 1.0, 2.0}
    np.testing.assert_allclose(course.x, expected, atol=2e-8)  # the error of DOP853 grows at the events


@pytest.mark.parametrize("mu", [1.0, 1.3])
def test_motion_is_that_of_the_engine_for_any_structure(mu):
    """Natural splines of an acceleration: the same polynomials."""
    rng = np.random.default_rng(3)
    values = 2.0 * np.convolve(rng.normal(size=160), np.ones(5) / 5.0, "same")
    step, zeta, beta = 0.2, 0.03, 0.3
    system = fm.System(contact="joined-base-wall", damping_ratios=zeta, excitation="base",
                       damping_reference="base")  # fmt: skip
    record = fm.Record(values, step, quantity="acceleration", interpolation="cubic")
    engine = fm.history(system, record, beta=[beta], mu=[mu], after=0.0)
    time = np.arange(values.size) * step
    drive = Drive(time, values, 2, True, True, np.ones(values.size, bool))
    model = Model(Measured(drive, time, np.zeros(values.size), 2, False))
    powers = step ** np.arange(4)
    model.cubics = CubicSpline(time, values, bc_type="natural").c[::-1].T * powers
    course = model.course(values_of(f_n=1.0 / TURN, zeta=zeta, x_F=beta, mu=mu))
    x, at = engine["x"].squeeze(), engine["time"].squeeze()
    _, first = np.unique(np.round(at.values / step, 9), return_index=True)
    of_samples = np.interp(time, at.values[first], x.values[first])
    assert course.motion.counts[0] > 10
    np.testing.assert_allclose(course.motion.state[:, tangents.U], of_samples, atol=1e-11)


@pytest.mark.parametrize("name", MOTIONS)
def test_derivatives_are_differences(name):
    """Central differences: errors of the step squared, and of 1e-13 over the step."""
    model, values, given = model_of(name)
    slopes = model.course(values).slopes
    for parameter in given:
        k = NAMES.index(parameter)
        step = 1e-6 * max(abs(values[k]), 0.01)
        ends = [model.course(values + sense * step * np.eye(len(NAMES))[k]).x for sense in (1.0, -1.0)]
        difference = (ends[0] - ends[1]) / (2.0 * step)
        size = np.abs(slopes[:, k]).max()
        assert size > 0.0
        np.testing.assert_allclose(slopes[:, k], difference, atol=3e-6 * size, err_msg=parameter)


@pytest.mark.parametrize("name", MOTIONS)
def test_derivatives_by_the_drive_are_differences(name):
    model, values, _ = model_of(name)
    drive = model.given.drive
    through = model.by_drive(model.course(values))
    step = 1e-6 * float(np.std(drive.values))
    for sample in (0, 1, 100, 180):
        ends = []
        for sense in (1.0, -1.0):
            moved = drive.values.copy()
            moved[sample] += sense * step
            ends.append(Model(model.given._replace(drive=drive._replace(values=moved))).course(values).x)
        difference = (ends[0] - ends[1]) / (2.0 * step)
        size = np.abs(through[:, sample]).max()
        assert size > 0.0
        np.testing.assert_allclose(through[:, sample], difference, atol=1e-5 * size)


@pytest.mark.parametrize("mu", [1.0, 1.25])
def test_fit_finds_the_truth(mu):
    """Data of another integration, noise in both channels: within four standard errors."""
    rng = np.random.default_rng(7)
    time = np.arange(600) * STEP
    base = base_motion(time)
    truth = {"f_n": 3.1, "zeta": 0.01, "x_F": 0.8, "offset_x": -0.3} | ({"mu": mu} if mu > 1.0 else {})
    x = -0.3 + marched(time, base, 3.1, 0.01, 0.8, mu, (0.5, 12.0)) + 0.02 * rng.normal(size=600)
    ds = fm.identify.history(
        time, x, base=base + 0.004 * rng.normal(size=600), damping_reference="base", sigma_x=0.02,
        sigma_drive=0.004, free=list(truth), known={} if mu > 1.0 else {"mu": 1.0},
    )  # fmt: skip
    found = ds.sel(parameter=list(truth))
    z = (found["estimate"] - list(truth.values())) / found["standard_error"]
    assert np.abs(z).max() < 4.0
    assert 0.85 < float(ds["reduced_chi_square"]) < 1.15
    assert ds["verdict"].attrs["flag_meanings"].split()[int(ds["verdict"])] == "stick_slip"


def record_of(friction, length=600):
    time = np.arange(length) * STEP
    base = base_motion(time)
    return time, base, marched(time, base, 3.1, 0.01, friction, 1.0, (0.2, 0.0), by_base=False)


def test_a_contact_that_holds_is_refused_with_a_bound():
    time, base, _ = record_of(0.5)
    x = 0.2 + 0.02 * np.random.default_rng(1).normal(size=time.size)
    half = 0.5 * np.ptp(base)
    with pytest.raises(InputError, match=f"nothing slips.*at least {half:.4g} mm"):
        fm.identify.history(time, x, base=base)


OF_STATIC = ["f_n", "zeta", "x_F", "mu", "offset_x"]


def test_static_friction_is_refused_if_nothing_sticks():
    time = np.arange(600) * STEP
    base = 2.0 * np.cos(TURN * 2.9 * time) + 0.3 * np.cos(TURN * 1.1 * time + 1.0)
    x = marched(time, base, 3.1, 0.01, 0.5, 1.25, (0.2, 0.0), by_base=False)
    x = x + 0.02 * np.random.default_rng(1).normal(size=time.size)
    with pytest.raises(InputError, match=r"cannot identify mu: .*never sticks.*known\.mu"):
        fm.identify.history(time, x, base=base, free=OF_STATIC)


@pytest.mark.parametrize("friction", [0.1, 0.8])
def test_the_interval_of_mu_holds_all_that_the_record_allows(friction):
    """Of a motion that nearly never sticks, any mu: the slope by mu is 0 to rounding."""
    time, base, x = record_of(friction)
    x = x + 0.02 * np.random.default_rng(1).normal(size=time.size)
    ds = fm.identify.history(time, x, base=base, free=OF_STATIC)
    mu = ds.sel(parameter="mu")
    assert float(mu["lower"]) == 1.0
    assert float(mu["upper"]) > (1.5 if friction == 0.1 else 1.01)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"base": None}, "base or force, one of both; got none"),
        ({"units": ("m/s^2", "mm")}, "base must be a displacement"),
        ({"units": ("m/s^2", "mm"), "contact": "joined-base-wall"}, "as the base is, or as a higher"),
        ({"gate": 1.0}, "gate_N with a base"),
        ({"free": ["f_n", "zeta", "x_F", "mu", "offset_x", "contact_stiffness"]}, "mu together with"),
        ({"known": {"mu": 1.0, "zeta": -0.1}}, "known.zeta must be"),
        ({"sigma_x": 0.0}, "sigma_x must be > 0"),
        ({"mask_samples": -1}, "mask_samples must be"),
        (
            {"free": ["f_n", "zeta", "x_F", "offset_x", "stiffness"], "known": {"mu": 1.0}},
            "fit stiffness",
        ),
    ],
)
def test_refusals(options, words):
    time, base, x = record_of(0.5)
    with pytest.raises(InputError, match=words):
        fm.identify.history(time, x, **({"base": base} | options))


def test_gain_and_stiffness_are_refused_together():
    time, base, x = record_of(0.5)
    free = ["f_n", "zeta", "x_F", "offset_x", "stiffness", "gain"]
    with pytest.raises(InputError, match="gain together with stiffness"):
        fm.identify.history(time, x, force=base, free=free, known={"mu": 1.0})


def test_static_friction_that_is_not_fitted_is_suggested():
    """And only that: noise twice as large as it is stated leaves the record as little explained."""
    time = np.arange(600) * STEP
    base = base_motion(time)
    free = ["f_n", "zeta", "x_F", "offset_x"]
    options = {"base": base, "damping_reference": "base", "known": {"mu": 1.0}, "free": free}
    x = marched(time, base, 3.1, 0.01, 0.8, 1.25, (0.5, 12.0))
    noise = 0.02 * np.random.default_rng(1).normal(size=600)
    found = fm.identify.history(time, x + noise, sigma_x=0.02, sigma_drive=0.0, **options)
    said = re.search(
        r"static friction explains the record better, mu (.*) instead of 1: name mu", found.warnings
    )
    assert abs(float(said[1]) - 1.25) < 0.03
    x = marched(time, base, 3.1, 0.01, 0.8, 1.0, (0.5, 12.0))
    found = fm.identify.history(time, x + noise, sigma_x=0.01, sigma_drive=0.0, **options)
    assert "does not explain" in found.warnings
    assert "static friction" not in found.warnings


VISIBLE = ("random", "runup", "quake", "hammer", "static", "elastic", "delay", "noisybase")


@pytest.mark.slow
@pytest.mark.parametrize("name", VISIBLE)
def test_records_of_the_specification(reference_path, name):
    """Within four standard errors of the truth; standard errors near those of another estimator."""
    folder = reference_path("identification-2")
    told = json.loads((folder / "truth.json").read_text())[f"record-{name}"]["parameters"]
    config = tomllib.loads((folder / f"record-{name}.toml").read_text())
    assert set(told) == set(config["fit"]["free"])
    ds = identify(load_rig(folder / f"record-{name}.toml"))
    for parameter, of in told.items():
        found = ds.sel(parameter=parameter)
        error = float(found["standard_error"])
        assert abs(float(found["estimate"]) - of["truth"]) < 4.0 * error
        assert 0.8 < error / of["standard_error"] < 1.25
        assert parameter != "mu" or float(found["lower"]) <= of["truth"] <= float(found["upper"])


def test_the_held_record_of_the_specification(reference_path):
    folder = reference_path("identification-2")
    bound = json.loads((folder / "truth.json").read_text())["record-held"]["x_F_lower"]
    with pytest.raises(InputError, match=f"at least {bound:.4g} mm"):
        identify(load_rig(folder / "record-held.toml"))


def test_a_rig_with_a_hammer(tmp_path):
    """Units of columns, the gate, and options of steady motions that are refused."""
    time = np.arange(700) * 0.004
    force = 30.0 * np.exp(-0.5 * ((time - 0.2) / 0.008) ** 2) - 25.0 * np.exp(
        -0.5 * ((time - 1.5) / 0.008) ** 2
    )
    x = marched(time, force / 12.0, 5.0, 0.01, 0.1, 1.0, (0.0, 0.0), by_base=False)
    rows = np.column_stack((time, force, 1e3 * x))
    np.savetxt(tmp_path / "hit.csv", rows, "%.9g", ",", header="time_s,force_N,x_um", comments="")
    text = """
        [data]
        kind = "record"
        file = "hit.csv"
        columns = { time = "time_s", force = "force_N", x = "x_um" }
        [system]
        excitation = "force"
        [known]
        mu = 1.0
        [fit]
        method = "history"
        sigma_drive = 0.01
        gate_N = 0.2
        free = ["f_n", "zeta", "x_F", "stiffness", "offset_x"]
    """
    (tmp_path / "hit.toml").write_text(text)
    ds = identify(load_rig(tmp_path / "hit.toml"))
    found = dict(zip(ds["parameter"].values, ds["estimate"].values, strict=True))
    assert abs(found["stiffness"] / 12.0 - 1.0) < 2e-3
    assert abs(found["x_F"] / 0.1 - 1.0) < 1e-2
    assert abs(found["f_n"] / 5.0 - 1.0) < 1e-4
    with pytest.raises(InputError, match=r"cannot use fit.sigma_drive with steady motions"):
        identify(load_rig(tmp_path / "hit.toml", ["fit.method=steady"]))


def test_noise_of_the_drive_moves_the_least_sum():
    """A hammer's record whose least sum without that noise leads to a minimum 12 standard errors away."""
    place = [case.name for case in CASES].index("hammer, gate")
    made = CASES[place].make(np.random.default_rng([list(KINDS).index("history"), place, 54]))
    ds = made.fit()
    for name, truth in made.truth.items():
        one = ds.sel(parameter=name)
        assert abs(float(one["estimate"]) - truth) < 4.0 * float(one["standard_error"])
