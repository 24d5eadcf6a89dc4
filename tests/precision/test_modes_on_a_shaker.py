"""Steady states of structures given by modes on a moving base: against chains, histories, closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

import frictionmap as fm
from frictionmap.command_line.cli import main
from frictionmap.errors import InputError
from frictionmap.steady.points import steady_states

MASS, SPRINGS, ZETA = (1.0, 0.7, 1.3), (1.0, 1.3, 0.8), (0.02, 0.03, 0.05)
UNIT = {"length": 1.0, "bending_stiffness": 1.0, "mass_per_length": 1.0}
R, BETA = np.array([0.35, 0.8, 1.3]), np.array([0.05, 0.3, 0.9, 25.0])

JOINED = "joined-base-wall"
CONTACTS = {
    "wall": [fm.Contact(masses=[2])],
    "on the base": [fm.Contact(JOINED, masses=[2])],
    "springs": [fm.Contact(masses=[1], stiffness=2.0), fm.Contact(JOINED, [3], stiffness=1.5, ratio=0.4)],
    "rigid": [fm.Contact(JOINED, masses=[2], mu=1.3), fm.Contact("between-masses", masses=[2, 3], ratio=0.5)],
    "mixed": [fm.Contact(masses=[1], mu=1.2), fm.Contact(JOINED, masses=[3], stiffness=0.7, ratio=0.6)],
    "belt": [fm.Contact(masses=[2], wall_velocity=0.2)],
}  # fmt: skip


def pair(contacts, **keys):
    """A chain, and its three modes."""
    stiffness = np.diag(np.add(SPRINGS, (*SPRINGS[1:], 0.0)))
    stiffness -= np.diag(SPRINGS[1:], 1) + np.diag(SPRINGS[1:], -1)
    squares, phi = eigh(stiffness, np.diag(MASS))
    phi = phi * [1.0, -1.0, 1.0]
    modes = fm.Modes(np.sqrt(squares), ZETA, phi, list("abc"), participation=phi.T @ MASS)
    keys = {"excitation": "base", "contacts": contacts} | keys
    chain = fm.System(mass_ratios=MASS, stiffness_ratios=SPRINGS, damping_ratios=ZETA, **keys)
    return chain, fm.System(modes=modes, frequency_scale=1.0, **keys)


def compare(found, expected, names, within=1e-11):
    for name in names:
        if name not in expected:
            continue
        one, other = found[name].values, expected[name].values
        assert one.shape == other.shape, name
        if other.dtype.kind in "iu":
            assert (one == other).all(), name
            continue
        assert (np.isnan(one) == np.isnan(other)).all(), name
        size = max(1.0, float(np.nanmax(np.abs(np.where(np.isfinite(other), other, 0.0)), initial=0.0)))
        np.testing.assert_allclose(one, other, rtol=0.0, atol=within * size, err_msg=name)


OUTPUTS = (
    "regime", "amplitude", "contact_amplitude", "peak_to_peak", "contact_peak_to_peak", "midpoint",
    "contact_midpoint", "sliding_distance", "work_friction", "acceleration_amplitude",
)  # fmt: skip


@pytest.mark.parametrize("control", ["displacement", "acceleration"])
@pytest.mark.parametrize("reference", ["ground", "base"])
@pytest.mark.parametrize("name", CONTACTS)
def test_all_modes_are_the_chain(name, reference, control):
    chain, modal = pair(CONTACTS[name], damping_reference=reference, base_control=control)
    for start in ("rest", "moving"):
        expected, found = (
            fm.sweep(one, r=R, beta=BETA, outputs=OUTPUTS, start=start) for one in (chain, modal)
        )
        assert len(np.unique(expected.regime)) >= 2
        compare(found, expected, [*OUTPUTS, "beta_stick", "origin"])
        compare(found, expected, ["beta_lim"], 1e-9)  # which is searched


@pytest.mark.parametrize("reference", ["ground", "base"])
@pytest.mark.parametrize("name", ["wall", "springs", "rigid", "belt"])
def test_motions_and_curves_are_those_of_the_chain(name, reference):
    chain, modal = pair(CONTACTS[name], damping_reference=reference)
    expected, found = (fm.response(one, r=0.8, beta=0.3) for one in (chain, modal))
    names = ["x", "v", "z", "friction", "displacement_harmonic", "contact_harmonic", "friction_harmonic",
             "work_input", "work_damping", "work_friction", "work_wall", "phase_lag", "y"]  # fmt: skip
    assert {"x", "work_input", "contact_harmonic"} <= set(expected.variables)
    compare(found, expected, names, 1e-10)
    quantities = ("amplitude", "first_harmonic", "harmonics", "energy", "phase")
    expected, found = (fm.curves(one, r=R, beta=[0.05, 9.0], quantities=quantities) for one in (chain, modal))
    names = [name for name in expected.data_vars if name not in ("beta_lim", "no_stop_begin", "no_stop_end")]
    # mean forces of contacts that hold points are not known of modes; a contact at rest has no phase
    without = (
        "friction_harmonic",
        "contact_first_harmonic_phase",
        "equivalent_stiffness",
        "equivalent_damping",
    )
    compare(found, expected, [name for name in names if name not in without], 1e-10)


def test_boundaries_are_those_of_the_chain():
    for name in ("wall", "on the base", "rigid", "belt"):
        chain, modal = pair(CONTACTS[name], damping_reference="base")
        expected, found = (fm.boundaries(one, r=[0.4, 0.9, 1.4], mu=[1.0, 1.2]) for one in (chain, modal))
        compare(found, expected, ["beta_stick", "beta_stick_contact", "wall_velocity_lim"])
        compare(found, expected, ["beta_lim", "no_stop_end"], 1e-9)


def test_several_harmonics_of_the_base():
    keys = {"load_harmonics": {1: 1.0, 2: 0.4j, 3: -0.2}, "damping_reference": "base"}
    chain, modal = pair(CONTACTS["springs"], **keys)
    expected, found = (fm.sweep(one, r=R, beta=BETA[:2], outputs=OUTPUTS) for one in (chain, modal))
    compare(found, expected, OUTPUTS)


def test_first_harmonics_are_those_of_the_chain():
    chain, modal = pair(CONTACTS["springs"])
    r, beta = np.array([0.7, 0.7, 1.1, 1.1]), np.array([0.0, 0.2, 0.2, 30.0])
    expected, found = (steady_states(one, r, beta, 1.0)[0] for one in (chain, modal))
    np.testing.assert_allclose(found.phasors, expected.phasors, rtol=0.0, atol=1e-10)
    assert (found.regime == expected.regime).all()


def shaken(modes=20, zeta=0.0, contacts=None, **keys):
    """A cantilever on a shaker, with a contact at its tip and one of no friction that shows its motion."""
    beam = fm.Beam(**UNIT, points={"middle": 0.4, "tip": 1.0}, modes=modes, **keys)
    contacts = contacts or [fm.Contact(JOINED, masses=["tip"], stiffness=0.5)]
    return fm.System(
        modes=beam, damping_ratios=zeta, contacts=contacts, excitation="base", damping_reference="base",
        frequency_scale=1.0, stiffness_scale=1.0,
    )  # fmt: skip


def test_a_cantilever_without_friction():
    # w = 1, w' = 0 at the clamp, w'' = w''' = 0 at the tip: (cos b + cosh b)/(1 + cos b cosh b), r = b^2
    b = np.array([0.9, 1.5, 2.4, 4.4])
    tip = (np.cos(b) + np.cosh(b)) / (1.0 + np.cos(b) * np.cosh(b))
    for control, size in (("displacement", 1.0), ("acceleration", b**-4)):
        contacts = [fm.Contact(kind, masses=["tip"], stiffness=0.5) for kind in (JOINED, "fixed-wall")]
        system = replace(shaken(contacts=contacts), base_control=control)
        ds = fm.sweep(system, r=b**2, beta=[0.0], outputs=["amplitude", "contact_amplitude"])
        np.testing.assert_allclose(ds.amplitude.squeeze()[:, 1], np.abs(tip) * size, rtol=1e-10)
        relative, absolute = ds.contact_amplitude.squeeze().values.T
        np.testing.assert_allclose(relative, np.abs(tip - 1.0) * size, rtol=1e-10)
        np.testing.assert_allclose(absolute, np.abs(tip) * size, rtol=1e-10)


@pytest.mark.parametrize("kind", [JOINED, "fixed-wall"])
def test_residuals_converge_on_a_shaker(kind):
    contacts = [fm.Contact(kind, masses=["tip"], stiffness=1.5),
                fm.Contact(JOINED, masses=["middle"], stiffness=3.0, ratio=0.6)]  # fmt: skip
    asked = {"r": [2.5, 4.2, 9.0], "beta": [0.1, 0.4], "outputs": ["regime", "amplitude"]}
    exact = fm.sweep(shaken(30, 0.02, contacts), **asked)
    assert (exact.regime.values == 1).any()
    errors = {}
    for residual in (False, True):
        one = fm.sweep(shaken(5, 0.02, contacts, with_residual=residual), **asked)
        errors[residual] = float(np.abs(one.amplitude / exact.amplitude - 1.0).max())
    assert errors[True] < 1e-4
    assert errors[True] < 0.1 * errors[False]


def test_a_plate_on_a_slow_base_sags_as_under_gravity():
    # n^2 r^2 sag: Timoshenko and Woinowsky-Krieger, 0.00406235 q a^4/D at the centre
    plate = fm.Plate(edges=["supported"] * 4, size=[1.0, 1.0], bending_stiffness=1.0, mass_per_area=1.0,
                     points={"centre": [0.5, 0.5]}, modes=3)  # fmt: skip
    system = fm.System(
        modes=plate, contacts=[fm.Contact(JOINED, masses=["centre"], stiffness=1.0)], excitation="base",
        frequency_scale=1.0, stiffness_scale=1.0,
    )  # fmt: skip
    ds = fm.sweep(system, r=[0.05], beta=[0.0], outputs=["contact_amplitude"])
    assert ds.contact_amplitude.item() == pytest.approx(0.00406235 * 0.05**2, rel=1e-5)


SINE = 3.0


def test_a_long_sine_leads_to_the_steady_state():
    system = shaken(5, 0.05, [fm.Contact("fixed-wall", masses=["tip"], stiffness=1.5),
                              fm.Contact(JOINED, masses=["middle"], stiffness=3.0, ratio=0.6)])  # fmt: skip
    steady = fm.response(system, r=SINE, beta=0.3)
    assert float(steady.slips_per_cycle.sum()) >= 2.0
    ends = []
    for count in (60, 61):
        # the base goes as the sine of the response, (its place, not its acceleration)
        sine = fm.Record.sweep(
            SINE, SINE, count * 2.0 * math.pi / SINE, quantity="displacement", rise=20.0, fall=20.0
        )
        ends.append(fm.history(system, sine, beta=0.3, after=0.0, samples="none", beta_hold=False))
    for name in ("sliding_distance", "work_friction"):
        found = (ends[1][name] - ends[0][name]).squeeze()
        np.testing.assert_allclose(found, steady[name], rtol=0.0, atol=1e-9 * float(steady[name].max()))


SHAKER = """
[system]
excitation = "base"
damping_reference = "base"
damping_ratios = 0.001
contacts = [
  { kind = "joined-base-wall", masses = ["tip"], stiffness = "2 N/mm", ratio = 1.0 },
  { kind = "joined-base-wall", masses = ["gauge"], stiffness = "1 N/m", force = 0.0 },
]
[system.beam]
ends = "clamped-free"
length = "300 mm"
bending_stiffness = "21 N m^2"
mass_per_length = "0.78 kg/m"
points = { tip = "300 mm", gauge = "120 mm" }
modes = 6
[units]
natural_frequency = "model"
base_amplitude = "0.5 mm"
[grid]
r = ["20 Hz", "30 Hz"]
beta = ["0 N", "0.5 N"]
[solver]
outputs = ["regime", "amplitude", "contact_amplitude"]
"""


def test_a_configuration_in_units(tmp_path):
    path = tmp_path / "shaker.toml"
    path.write_text(SHAKER)
    assert main(["map", str(path), "-o", str(tmp_path / "map.nc"), "--quiet"]) == 0
    ds = fm.open(tmp_path / "map.nc")
    root = (ds.frequency.values * 2.0 * math.pi * math.sqrt(0.78 * 0.3**4 / 21.0)) ** 0.5
    tip = (np.cos(root) + np.cosh(root)) / (1.0 + np.cos(root) * np.cosh(root))
    assert ds.contact_amplitude.shape[-1] == 2
    # a spring of 1 N/m without friction moves nothing; damping ratios of 0.001 change 1e-4 away from w_1
    without = ds.amplitude_m.isel(beta=0, dof=0).values.ravel()
    np.testing.assert_allclose(without, 0.5e-3 * np.abs(tip), rtol=5e-4)
    assert (ds.regime.isel(beta=1).values != 2).all()


def without_sag():
    modes = fm.Modes([1.0, 3.0], 0.1, [[1.0, 0.5]], ["tip"], [[0.1]], participation=[1.0, 0.2])
    return fm.System(modes=modes, contact_masses=["tip"], contact_stiffness=1.0, excitation="base")


@pytest.mark.parametrize(("ask", "message"), [
    (lambda: fm.sweep(without_sag(), r=[0.5], beta=[0.1]), "cannot use residual .* without base_residual"),
    (lambda: fm.System(modes=fm.Modes([1.0], 0.1, [[1.0]], ["tip"]), contact_masses=["tip"],
                       excitation="base"), "without participation"),
    (lambda: fm.sweep(shaken(4), r=[0.5], beta=[0.1], outputs=["drift"]), "cannot compute drift"),
    (lambda: fm.sweep(shaken(4), r=[0.5], beta=[0.1], outputs=["base_force"]), "cannot compute base_force"),
    (lambda: fm.sweep(shaken(4, contacts=[
        fm.Contact(JOINED, masses=["tip"], stiffness=[0.5, 0.3], ratio=[0.2, 0.4], bank="contact")
    ], with_residual=False), r=[0.5], beta=[0.1]), "on a moving base with .* a bank of 2 elements"),
])  # fmt: skip
def test_refusals(ask, message):
    with pytest.raises(InputError, match=message):
        ask()
