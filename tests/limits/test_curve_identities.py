"""Response curves: balances and identities, the FFT of motions in time, conventions in limits."""

import math

import numpy as np
import pytest

import frictionmap as fm

TWO = {"mass_ratios": [1.0, 1.0], "stiffness_ratios": [1.0, 1.0]}
BASE = fm.System("joined-base-wall")
ALL = ["amplitude", "phase", "first_harmonic", "energy", "harmonics", "transmitted_force", "distortion"]

#: Fig. 3.14, 6.13 and 7.5, coarse: system, r, beta.
FIGURES = {
    "3.14": (BASE, np.linspace(0.02, 2.5, 32), [0.2, 0.5, 0.8, 1.0, 1.25, 1.5, 2.0]),
    "6.13": (
        fm.System(contact_masses=[2], **TWO),
        np.linspace(0.05, 2.5, 25),
        [0.0, 0.2, 0.5, 1.0, 2.0, 5.0],
    ),
    "7.5": (
        fm.System(contact_masses=[2], damping_ratios=[0.01 / 0.618034, 0.01 / 1.618034], **TWO),
        np.linspace(0.05, 2.5, 25),
        [0.0, 0.2, 0.5, 1.0, 2.0],
    ),
}


def complex_of(variable):
    return variable.values[..., 0] + 1j * variable.values[..., 1]


@pytest.fixture(scope="module", params=FIGURES)
def figure(request):
    system, r, beta = FIGURES[request.param]
    return system, fm.curves(system, r, beta, quantities=ALL)


def resolved(ds):
    return (ds.status == 0) & np.isfinite(ds.work_input)


def test_works_balance_in_every_cell(figure):
    """What the load gives is what friction and dampers take; each is integrated in a way of its own."""
    _, ds = figure
    off = (ds.work_input - ds.work_friction - ds.work_damping).where(resolved(ds))
    # where the contact sticks and nothing is damped all are 0 to the rounding of the load's
    size = np.maximum(ds.work_input, 1e-3)
    assert float(abs(off / size).max()) < 1e-11
    assert int(resolved(ds).sum()) > 0.9 * resolved(ds).size


def test_lag_of_the_loaded_mass_follows_from_the_works(figure):
    """sin(phi) = (W_f + W_v)/(pi X_1) of the mass that is loaded, where the load is on one mass."""
    system, ds = figure
    if system.base_motion:
        pytest.skip("the base feeds the wall, too")
    first = ds.first_harmonic_amplitude.isel(dof=0)
    taken = (ds.work_friction + ds.work_damping) / (math.pi * first)
    off = (np.sin(ds.first_harmonic_phase.isel(dof=0)) - taken).where(resolved(ds) & np.isfinite(first))
    assert float(abs(off).max()) < 1e-12


def test_masses_behind_the_contact_see_its_mass_only():
    """X_2n/X_1n = kappa/(kappa - gamma n^2 r^2) in any regime, where contact and load are on mass 1."""
    r, gamma, kappa = np.linspace(0.11, 2.47, 13), 0.9, 1.2
    system = fm.System(mass_ratios=[1.0, gamma], stiffness_ratios=[1.0, kappa])
    ds = fm.curves(system, r, [0.1, 0.4, 0.7], quantities=["harmonics"])
    x = complex_of(ds.displacement_harmonic)[0]
    n = np.arange(1, 8, 2)
    behind = kappa / (kappa - gamma * n**2 * r[:, np.newaxis, np.newaxis] ** 2)
    one, two = x[:, :, 0, n], x[:, :, 1, n]
    known = ~np.isnan(one)
    assert np.abs((two - behind * one)[known]).max() < 1e-12 * np.nanmax(np.abs(x))


#: Systems and chosen cells (r, beta, mu) for the FFT: every contact, damping and regime; n r = w to the
#: bit and nearly, held oscillators in step with the load, periods above 1, asymmetric motions.
CELLS = {
    "one mass": (
        fm.System(),
        [
            (0.2, 0.3, 1.0),
            (0.3333333333, 0.4, 1.0),
            (0.85, 0.2, 1.0),
            (1.0, 0.9, 1.0),
            (0.25, 0.2, 1.0),
            (2.3, 0.57, 1.0),
            (0.12, 0.4, 1.3),
        ],
    ),
    "damped": (fm.System(damping_ratios=0.02), [(0.46, 0.18, 2.0), (0.46, 0.22, 2.0), (0.2, 0.18, 2.0)]),
    "critical": (fm.System(damping_ratios=1.0), [(0.4, 0.6, 1.0), (1.1, 0.2, 1.0)]),
    "heavy": (fm.System(damping_ratios=1.7), [(0.4, 0.6, 1.0), (1.4, 0.3, 1.2)]),
    "joined wall": (BASE, [(0.5, 0.2, 1.0), (0.52, 0.06, 1.5), (1.5, 0.75, 1.0), (1.2, 1.3, 1.0)]),
    "joined wall, dashpot": (
        fm.System("joined-base-wall", damping_ratios=0.1, damping_reference="base"),
        [(0.9, 0.5, 1.0), (1.2, 1.4, 1.0)],
    ),
    "shaken": (
        fm.System(excitation="base", damping_reference="base", damping_ratios=0.3),
        [(0.4, 0.3, 1.0), (0.8, 0.7, 1.0)],
    ),
    "two, joined wall": (
        fm.System("joined-base-wall", **TWO),
        [(1.0, 0.6, 1.0), (0.999999, 0.6, 1.0), (0.55, 0.2, 1.0), (1.6, 2.0, 1.3)],
    ),
    "two, wall on 2": (
        fm.System(contact_masses=[2], **TWO),
        [(1.3, 1.5, 1.0), (0.6, 0.9, 1.0), (0.206, 0.3, 1.0)],
    ),
    "between": (
        fm.System("between-masses", [1, 2], mass_ratios=[1.0, 0.5], stiffness_ratios=[1.0, 0.5]),
        [(0.6, 0.1, 1.0), (0.7, 0.3, 1.0), (1.2, 0.2, 1.4)],
    ),
    "three, heavy": (
        fm.System(
            contact_masses=[2],
            mass_ratios=[1.0, 0.8, 1.7],
            stiffness_ratios=[1.0, 2.0, 0.6],
            damping_ratios=[1.4, 0.02, 1.0],
        ),
        [(0.5, 0.3, 1.0), (1.3, 0.4, 1.0)],
    ),
    "five": (
        fm.System(contact_masses=[3], mass_ratios=[1.0] * 5, stiffness_ratios=[1.0] * 5, damping_ratios=0.01),
        [(0.6, 0.5, 1.0), (0.9, 0.2, 1.0), (0.4, 0.05, 1.0)],
    ),
}

#: The mu of the cells that are drawn at random of each of these systems; with those chosen more than 100.
DRAWN = (1.0, 1.0, 1.0, 1.0, 1.0, 1.15)

POINTS = 4000


def drawn_cells(system, seed):
    """Cells (r, beta, mu) below the boundary to sticking, of continuous motion and of stick-slip."""
    rng = np.random.default_rng(seed)
    cells = []
    for mu in DRAWN:
        r = rng.uniform(0.12, 2.4)
        stick = float(fm.boundaries(system, r, mu).beta_stick[0, 0])
        cells.append((r, rng.uniform(0.02, 0.95) * stick, mu))
    return cells


def sampled_harmonics(x, period):
    """(harmonics 0..7, error) of samples of a motion over its period, the last one the first again."""
    size = x.shape[-1] - 1
    found = np.fft.rfft(x[..., :-1])[..., : 8 * period : period] / size
    found[..., 1:] *= 2.0
    return found


def aliasing(v, period):
    """The FFT's own error: if x'' varies by V, |X_m| <= V/(pi m^3), and X_n takes in all X_{n + kN}.

    N samples a load period; sum over k of 1/(k N - n)^3, twice, is below 2.5/(N - 7)^3.
    """
    step = 2.0 * math.pi * period / (v.shape[-1] - 1)
    bends = np.diff(np.concatenate((v, v[..., 1:2]), axis=-1)) / step
    varies = np.abs(np.diff(bends)).sum(axis=-1)
    return 2.5 * varies / (math.pi * (POINTS - 7.0) ** 3)


@pytest.mark.parametrize("name", CELLS)
def test_harmonics_are_those_of_the_motion_in_time(name):
    system, chosen = CELLS[name]
    for r, beta, mu in chosen + drawn_cells(system, seed=list(CELLS).index(name)):
        motion = fm.response(system, r, beta, mu, points=POINTS)
        found = fm.curves(system, r, beta, mu, quantities=["harmonics"]).isel(mu=0, r=0, beta=0)
        period = int(motion.period)
        assert period == int(found.period) > 0
        exact = sampled_harmonics(motion.x.values, period)
        bound = aliasing(motion.v.values, period) + 1e-12 * np.abs(motion.x.values).max(axis=1)
        assert (np.abs(complex_of(found.displacement_harmonic) - exact) < bound[:, np.newaxis]).all(), (
            r,
            beta,
            mu,
        )
        np.testing.assert_array_equal(found.displacement_harmonic, motion.displacement_harmonic)


# Conventions


@pytest.mark.parametrize("name", CELLS)
def test_root_mean_square_and_distortion_are_those_of_all_harmonics(name):
    """Integrals over the motion against the sum over 400 harmonics, which leaves off what falls like n^-3."""
    system, cells = CELLS[name]
    compared = 0
    for r, beta, mu in cells:
        ds = fm.curves(system, [r], [beta], mu, quantities=["harmonics", "distortion"], harmonics=400)
        ds = ds.squeeze()
        if ds.period != 1 or ds.status != 0:
            continue  # subharmonics are no part of the sum
        sizes = np.abs(complex_of(ds.displacement_harmonic)).reshape(system.n, -1)
        first = sizes[:, 1]
        squares = 0.5 * (sizes[:, 2:] ** 2).sum(axis=1)
        beyond = 400.0 / 5.0 * (sizes[:, -40:] ** 2).max(axis=1)
        rest = np.sqrt(squares)
        close = beyond / np.maximum(rest, 1e-300) + 1e-12 * first
        assert np.all(np.abs(ds.distortion.values * first / math.sqrt(2.0) - rest) <= close)
        whole = np.sqrt(sizes[:, 0] ** 2 + 0.5 * first**2 + squares)
        assert np.all(np.abs(ds.rms.values - whole) <= beyond / whole + 1e-12 * whole)
        compared += 1
    assert compared > 0


def test_without_friction_all_is_the_linear_answer():
    system = fm.System(contact_masses=[2], damping_ratios=0.03, **TWO)
    r = np.array([0.0, 0.3, 0.7, 1.9])
    ds = fm.curves(system, r, 0.0, quantities=ALL).isel(mu=0, beta=0)
    modes = system.modes
    x = np.array(
        [
            np.linalg.solve(modes.stiffness - a * a * modes.mass + 1j * a * modes.damping, [1.0, 0.0])
            for a in r
        ]
    )
    np.testing.assert_allclose(ds.amplitude, np.abs(x), rtol=1e-13)
    np.testing.assert_allclose(ds.first_harmonic_amplitude, np.abs(x), rtol=1e-13)
    np.testing.assert_allclose(ds.phase_lag, -np.angle(x), atol=1e-13)
    np.testing.assert_allclose(ds.work_input, -math.pi * x[:, 0].imag, atol=1e-13)
    np.testing.assert_allclose(ds.work_damping, ds.work_input, atol=1e-13)
    np.testing.assert_allclose(ds.transmitted_force, np.abs(1.0 + r**2 * x.sum(axis=1)), rtol=1e-13)
    assert (ds.work_friction == 0.0).all()


def test_a_slow_load_takes_masses_as_far_as_friction_lets_it():
    """K x = p - beta c, T(6.5), with phases 0 and pi; what has no limit is NaN, and its status says so."""
    system = fm.System(contact_masses=[2], **TWO)
    ds = fm.curves(system, [0.0, 0.5], [0.0, 0.3, 2.0], quantities=ALL).isel(mu=0, r=0)
    x = np.linalg.solve(system.modes.stiffness, [1.0, -0.3])
    np.testing.assert_allclose(ds.amplitude[1], np.abs(x), rtol=1e-14)
    np.testing.assert_array_equal(ds.phase_lag[1], np.where(x > 0.0, 0.0, math.pi))
    assert float(ds.contact_amplitude[1]) == pytest.approx(abs(x[1]), rel=1e-14)
    assert math.isnan(ds.work_friction[1])
    assert int(ds.status[1]) == 4
    np.testing.assert_allclose(ds.amplitude[2], [0.5, 0.0], atol=1e-15)  # held at mass 2: k = 2


@pytest.mark.parametrize(
    ("contact", "masses"), [("fixed-wall", [2]), ("joined-base-wall", [2]), ("between-masses", [1, 2])]
)
def test_amplitudes_of_a_stuck_structure_leave_out_its_static_offset(contact, masses):
    """A contact that gets stuck away from z = 0: the same amplitude in maps, responses and curves, |X_k|."""
    system = fm.System(contact, contact_masses=masses, damping_ratios=0.05, **TWO)
    r, beta, mu = 0.45, 1.4, 1.5
    held = fm.curves(system, [r], [beta], mu, quantities=["amplitude"]).held_response.values[0]
    for outputs in (["regime"], ["regime", "amplitude"]):
        one = fm.response(system, r, beta, mu, start="moving", outputs=outputs)
        assert int(one.regime) == fm.regimes.PERMANENT_STICKING
        assert abs(one.z[0]) > 0.05
        np.testing.assert_allclose(one.amplitude, held, rtol=1e-14)
        np.testing.assert_allclose(one.x.max("tau") - one.x.min("tau"), 2.0 * held, rtol=1e-4)
    cell = fm.sweep(system, [r], [beta], mu, start="moving", outputs=["amplitude"])
    np.testing.assert_allclose(cell.amplitude[0, 0, 0], held, rtol=1e-14)
    curve = fm.curves(system, [r], [beta], mu, quantities=["amplitude"], start="moving")
    np.testing.assert_allclose(curve.amplitude[0, 0, 0], held, rtol=1e-14)


@pytest.mark.parametrize("beta", [0.0, 0.3])
def test_at_an_undamped_resonance_all_is_infinite_and_lags_by_a_quarter(beta):
    ds = fm.curves(fm.System(), [0.9, 1.0], beta, quantities=ALL).isel(mu=0, r=1, beta=0)
    for name in (
        "amplitude",
        "first_harmonic_amplitude",
        "contact_amplitude",
        "transmitted_force",
        "work_input",
    ):
        assert np.isinf(ds[name]).all(), name
    for name in ("phase_lag", "first_harmonic_phase", "contact_phase", "contact_first_harmonic_phase"):
        np.testing.assert_allclose(ds[name], 0.5 * math.pi, rtol=1e-15)
    assert float(ds.equivalent_damping) == 0.0
    np.testing.assert_array_equal(ds.displacement_harmonic[0, 1], [0.0, -np.inf])
    # the square wave is in step with z, which lags by a quarter: F_1 = (4 i beta/pi) e^{-i pi/2}
    np.testing.assert_allclose(ds.friction_harmonic[1], [4.0 * beta / math.pi, 0.0], atol=1e-15)


# How the work is cut


def same_bits(one, other):
    for name in one.variables:
        assert one[name].values.tobytes() == other[name].values.tobytes(), name


@pytest.mark.parametrize("system", [BASE, fm.System(contact_masses=[2], damping_ratios=0.01, **TWO)])
def test_threads_and_blocks_change_no_bit(system):
    r, beta = np.array([0.0, 0.11, 0.35, 0.5, 0.9, 1.3, 1.9]), np.linspace(0.0, 2.0, 40)
    whole = fm.curves(system, r, beta, [1.0, 1.4], quantities=ALL, threads=1)
    same_bits(fm.curves(system, r, beta, [1.0, 1.4], quantities=ALL, threads=2), whole)
    for first, last in ((0, 1), (1, 4), (4, 7), (2, 3)):
        part = fm.curves(system, r[first:last], beta, [1.0, 1.4], quantities=ALL)
        same_bits(part, whole.isel(r=slice(first, last)))
    same_bits(fm.curves(system, r, beta, 1.4, quantities=ALL), whole.isel(mu=slice(1, 2)))


def test_maps_hold_the_same_numbers():
    names = [
        "sliding_distance", "work_friction", "work_input", "work_damping", "equivalent_damping",
        "contact_first_harmonic_amplitude", "contact_first_harmonic_phase",
    ]  # fmt: skip
    r, beta = [0.0, 0.3, 0.8, 1.4], [0.0, 0.1, 0.5, 1.5]
    ds = fm.sweep(BASE, r, beta, outputs=names)
    curves = fm.curves(BASE, r, beta, quantities=["first_harmonic", "energy"])
    for name in names:
        np.testing.assert_array_equal(ds[name], curves[name], err_msg=name)
