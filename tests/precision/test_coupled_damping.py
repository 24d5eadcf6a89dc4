"""A damping matrix that couples the modes, against marching with it, sums of many harmonics, and balances."""

import numpy as np
import pytest
from scipy.linalg import expm
from structures import CHAIN, chain_matrices

import frictionmap as fm
from benchmarks.references.naive import naive_steady_state
from frictionmap import regimes
from frictionmap.model.coupled_modes import CoupledModel, coupled_model
from frictionmap.single import kernel_data
from frictionmap.steady.points import steady_states
from frictionmap.theory.boundary_curves import find_curves

KINDS = {"wall": "fixed-wall", "base": "joined-base-wall", "masses": "between-masses"}


def dashpots(n, *given):
    """C of dashpots (from mass, to mass, c); mass 0 is the ground."""
    C = np.zeros((n, n))
    for a, b, c in given:
        row = np.zeros(n)
        row[b - 1] = 1.0
        if a:
            row[a - 1] = -1.0
        C += c * np.outer(row, row)
    return C


#: contact, load, gamma, kappa, C, mu; one lightly damped, one over-damped, two over-damped dashpots.
CASES = {
    "wall": (("wall", 2), 1, (1.0, 0.8, 1.3), (1.0, 0.7, 0.9), dashpots(3, (0, 3, 0.2), (1, 2, 0.1)), 1.0),
    "masses": (
        ("masses", 1, 3), 2, (1.0, 0.8, 1.3), (1.0, 0.7, 0.9), dashpots(3, (0, 3, 0.2), (1, 2, 0.1)), 1.5,
    ),
    "base": (("base", 2), 1, (1.0, 0.8, 1.3), (1.0, 0.7, 0.9), dashpots(3, (0, 3, 0.2), (1, 2, 0.1)), 1.0),
    "over-damped": (("wall", 1), 1, (1.0, 0.8), (1.0, 0.7), dashpots(2, (0, 2, 4.0)), 1.5),
    "over-damped twice": (
        ("wall", 2), 1, (1.0, 0.8, 1.2, 0.7), (1.0, 0.7, 1.1, 0.6),
        dashpots(4, (0, 4, 3.0), (0, 1, 2.5), (2, 3, 0.2)), 1.0,
    ),
}  # fmt: skip
CELLS = ((0.25, 0.1), (0.45, 0.25), (0.7, 0.1), (1.1, 0.2), (1.7, 0.03))
OUTPUTS = ("regime", "stops_per_cycle", "contact_amplitude", "stuck_fraction", "amplitude")


def system(case, **further):
    contact, load, gamma, kappa, C, _ = CASES[case]
    loaded = {} if contact[0] == "base" else {"load_mass": load}
    return fm.System(
        contact=KINDS[contact[0]], contact_masses=list(contact[1:]), frequency_scale=1.0,
        matrices={**chain_matrices(gamma, kappa), "C": C}, **loaded, **further,
    )  # fmt: skip


def marched(case, r, beta):
    contact, load, gamma, kappa, C, mu = CASES[case]
    return naive_steady_state(
        gamma=gamma, kappa=kappa, contact=contact, load=load, damping=C, r=r, beta=beta, mu=mu, points=100
    )


@pytest.mark.parametrize("case", CASES)
def test_steady_states(case):
    """Against marching in small steps, which knows nothing of modes."""
    taken = 0
    for r, beta in CELLS:
        cell = fm.sweep(system(case), r, beta, CASES[case][5], outputs=OUTPUTS).squeeze()
        found = marched(case, r, beta)
        if found.status == "stuck":
            assert cell.regime == regimes.PERMANENT_STICKING
            continue
        assert found.status == "ok"
        taken += 1
        assert cell.stops_per_cycle == np.float32(found.stops)
        np.testing.assert_allclose(cell.contact_amplitude, found.Z, rtol=1e-8)
        np.testing.assert_allclose(cell.amplitude, found.X, rtol=1e-8)
        np.testing.assert_allclose(cell.stuck_fraction, found.stuck_fraction, atol=1e-7)
    assert taken >= 2


def test_a_mode_without_damping_with_coupled_ones():
    """Two equal masses on a third: against each other they move undamped; held they do not matter."""
    M = np.diag([1.0, 0.5, 0.5])
    K = np.array([[3.0, -1.0, -1.0], [-1.0, 1.5, 0.0], [-1.0, 0.0, 1.5]])
    C = dashpots(3, (0, 1, 0.3))
    given = {"matrices": {"M": M, "K": K, "C": C}, "load_mass": 2, "frequency_scale": 1.0}
    whole = fm.System(contact_masses=[1], **given)
    w = np.sqrt(3.0)
    assert np.sum(~whole.modes.participating) == 1
    # the load feeds it, and the contact cannot hold it
    ds = fm.curves(whole, [0.9 * w, w], [0.1], quantities=["amplitude"]).squeeze()
    assert np.isinf(ds.amplitude[1, 1:]).all()
    assert np.isfinite(ds.amplitude[0]).all()
    # what is left is two masses: 1, and both others
    one = np.diag([1.0, 1.0]), np.array([[3.0, -2.0], [-2.0, 3.0]])
    pair = {"M": one[0], "K": one[1], "C": dashpots(2, (0, 1, 0.3))}
    less = fm.System(contact_masses=[1], matrices=pair, load=[0.0, 1.0], frequency_scale=1.0)
    r, beta = np.linspace(0.3, 2.5, 12), np.linspace(0.02, 0.6, 8)
    maps = [fm.sweep(one, r, beta, threads=1) for one in (whole, less)]
    np.testing.assert_allclose(maps[0].contact_amplitude, maps[1].contact_amplitude, rtol=1e-10, atol=1e-14)
    np.testing.assert_array_equal(maps[0].regime, maps[1].regime)


def square_wave(case, r, order=20001):
    """Harmonics n of the square wave, and what they make of z in place of a mass 1/c^T M^-1 c alone.

    Of a square wave that is 1 from tau = 0 to pi, reversed after it; phasors of e^{i n tau}.
    """
    matrices, c = system(case).matrices, system(case).contact_vector
    M, K, C = matrices.mass, matrices.stiffness, matrices.damping
    n = np.arange(1, order, 2)
    dynamic = K - (n * r)[:, None, None] ** 2 * M + 1j * (n * r)[:, None, None] * C
    compliance = np.linalg.solve(dynamic, np.broadcast_to(c[:, None], (n.size, c.size, 1)))[..., 0] @ c
    alone = -(c @ np.linalg.solve(M, c)) / (n * r) ** 2
    return n, 4.0 / (np.pi * n) / 1j * (compliance - alone)


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("r", [0.31, 0.8, 1.7])
def test_response_functions_and_boundaries(case, r):
    """Against a sum of 10^4 harmonics; of the mass alone it is known, and its acceleration is the step's."""
    ds = fm.boundaries(system(case), [r], [1.0, 1.4]).squeeze()
    n, wave = square_wave(case, r)
    step = system(case).modes.inverse_mass / r**2

    def velocity(tau):
        """h', the answer's; of the mass alone a triangle wave."""
        return np.real((1j * n * wave) @ np.exp(1j * np.outer(n, tau))) + step * (tau - 0.5 * np.pi)

    np.testing.assert_allclose(ds.G, -wave.sum().real, atol=1e-11)
    np.testing.assert_allclose(ds.U, -velocity(np.zeros(1))[0], atol=1e-8)
    bends = np.real(-(n**2) * wave)
    np.testing.assert_allclose(ds.H, bends.sum() + bends[-1] * n[-1] / 2.0, rtol=1e-7, atol=1e-7)
    tau = np.linspace(0.0, np.pi, 1501)[5:-5]
    bracket = (float(ds.U) * np.cos(tau) + velocity(tau)) / np.sin(tau)
    largest = max(bracket.max(), float(ds.H) + step)
    assert largest * (1.0 - 1e-6) < float(ds.S) < largest + 1e-4 * abs(largest)
    # V and the load in the held contact, by the matrices as they are
    matrices, c = system(case).matrices, system(case).contact_vector
    base = system(case).base_motion
    dynamic = matrices.stiffness - r * r * matrices.mass + 1j * r * matrices.damping
    load = system(case).modes.load
    v = c @ np.linalg.solve(dynamic, load) - base
    np.testing.assert_allclose(complex(ds.V, ds.V_imag), v, rtol=1e-12)
    bordered = np.block([[dynamic, c[:, None]], [c[None], np.zeros((1, 1))]])
    held = np.linalg.solve(bordered, np.append(load, base))
    np.testing.assert_allclose(ds.beta_stick, abs(held[-1]) / ds.mu, rtol=1e-12)
    largest = np.maximum(ds.S, ds.H + ds.mu * step)
    np.testing.assert_allclose(ds.beta_lim, abs(v) / np.hypot(ds.U, largest), rtol=1e-12)
    assert np.isnan(ds.beta_lim_modal).all()


@pytest.mark.parametrize("case", CASES)
def test_motions_in_time(case):
    """Equations of motion, works and velocities of a response, and the map's multiplier."""
    matrices, mu = system(case).matrices, CASES[case][5]
    for r, beta in ((0.45, 0.1), (0.7, 0.15)):
        ds = fm.response(system(case), r, beta, mu, points=4000)
        if ds.regime == regimes.PERMANENT_STICKING:
            continue
        tau, x, v = ds.tau.values, ds.x.values, ds.v.values
        np.testing.assert_allclose(
            np.gradient(x, tau, axis=1)[:, 1:-1], v[:, 1:-1], atol=5e-4 * np.abs(v).max()
        )
        base = system(case).base_motion
        np.testing.assert_allclose(system(case).contact_vector @ x - base * np.cos(tau), ds.z, atol=1e-12)
        lost = r * np.trapezoid(np.einsum("it,ij,jt->t", v, matrices.damping, v), tau) / int(ds.period)
        assert float(ds.work_damping) == pytest.approx(lost, rel=1e-6)
        balance = float(ds.work_input - ds.work_friction - ds.work_damping)
        assert abs(balance) < 1e-12 * float(ds.work_input)
        assert (
            0.0
            < float(fm.sweep(system(case), r, beta, mu, outputs=["multiplier"]).multiplier.squeeze())
            < 1.0
        )


def random_system(rng):
    """A chain of 2 to 5 masses, dashpots from 10^-5 to heavily over-damped, any contact, load or base."""
    n = int(rng.integers(2, 6))
    contact = str(rng.choice(list(KINDS.values())))
    masses = rng.choice(np.arange(1, n + 1), 2 if contact == "between-masses" else 1, replace=False)
    ends = [np.sort(rng.choice(n + 1, 2, replace=False)) for _ in range(rng.integers(2, n + 2))]
    rates = 10.0 ** rng.uniform(-5.0, 0.7) * rng.uniform(0.1, 1.0, len(ends))
    C = dashpots(n, *((a, b, rate) for (a, b), rate in zip(ends, rates, strict=True)))
    if contact == "joined-base-wall" or rng.random() < 0.3:
        load = {"excitation": "base", "damping_reference": str(rng.choice(["ground", "base"]))}
    else:
        load = {"load": list(rng.normal(size=n) + 1j * rng.normal(size=n))}
    ratios = (np.append(1.0, rng.uniform(0.3, 3.0, n - 1)) for _ in range(2))
    matrices = {**chain_matrices(*ratios), "C": C}
    return fm.System(
        contact=contact, contact_masses=sorted(map(int, masses)), matrices=matrices, frequency_scale=1.0,
        **load,
    )  # fmt: skip


def half_period(system, r, beta, phase, tau):
    """x and x' at phase <= tau <= phase + pi of a motion with friction +beta there, its next half reversed.

    By the matrices and their exponential.
    """
    matrices, load = system.matrices, system.modes.load + 1j * r * system.modes.load_rate
    dynamic = matrices.stiffness - r * r * matrices.mass + 1j * r * matrices.damping
    turning = np.outer(np.linalg.solve(dynamic, load), np.exp(1j * tau))
    answer = beta * friction_answer(system, r, tau - phase)
    return turning.real + answer[: system.n], -turning.imag + answer[system.n :]


def friction_answer(system, r, t):
    """x and x' (2n, t) in friction +1 alone, reversed after t = pi: w(pi) = -w(0)."""
    matrices, n = system.matrices, system.n
    M, K, C = r * r * matrices.mass, matrices.stiffness, r * matrices.damping
    flow = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
    rest = np.append(np.linalg.solve(K, system.contact_vector), np.zeros(n))
    half, one = expm(np.pi * flow), np.eye(2 * n)
    start = np.linalg.solve(one + half, (half - one) @ rest)
    return np.array([rest + expm(flow * at) @ (start - rest) for at in t]).T


def continuous_motions(rng, count):
    """Systems that the damping couples, each with a motion below its boundary."""
    while count:
        system = random_system(rng)
        r = float(rng.uniform(0.25, 3.0))
        beta = float(rng.uniform(0.05, 0.99)) * fm.boundaries(system, [r]).beta_lim.item()
        if system.modes.free.coupled and beta > 0.0:
            count -= 1
            yield system, fm.continuous_motion(system, r, beta)


def test_continuous_motion():
    """Against exponentials of the matrices, quadrature, and steady states of the same cells."""
    nodes, weights = np.polynomial.legendre.leggauss(100)
    for system, motion in continuous_motions(np.random.default_rng(41), 14):
        r, beta, start = motion.r, motion.beta, motion.contact_phase
        tau, weight = start + 0.5 * np.pi * (1.0 + nodes), 0.5 * np.pi * weights
        size = motion.amplitude.max()
        x, v = half_period(system, r, beta, start, tau)
        speed = np.abs(v).max()
        np.testing.assert_allclose(motion.displacement(tau), x, rtol=0.0, atol=5e-12 * size)
        np.testing.assert_allclose(motion.velocity(tau), v, rtol=0.0, atol=5e-12 * speed)
        place, swing = half_period(system, r, beta, start, np.array([start]))
        c, base = system.contact_vector, system.base_motion
        z = c @ place - base * np.cos(start)
        np.testing.assert_allclose(motion.contact_amplitude, z, rtol=0.0, atol=5e-12 * size)
        mono = np.hypot(place, swing)[:, 0]
        np.testing.assert_allclose(motion.monoharmonic_amplitude, mono, rtol=0.0, atol=5e-12 * (size + speed))
        np.testing.assert_allclose(c @ swing + base * np.sin(start), 0.0, atol=5e-12 * speed)
        np.testing.assert_allclose(motion.contact(tau), c @ x - base * np.cos(tau), atol=5e-12 * size)
        np.testing.assert_allclose(
            motion.contact_velocity(tau), c @ v + base * np.sin(tau), atol=5e-12 * speed
        )
        for k in (1, 3, 5):
            part = 2.0 / np.pi * (x * np.exp(-1j * k * tau)) @ weight
            np.testing.assert_allclose(motion.harmonics(k)[:, k], part, rtol=0.0, atol=5e-12 * size)
        across = v + (system.damping_reference == "base") * np.sin(tau)
        lost = 2.0 * r * np.einsum("it,ij,jt,t", across, system.matrices.damping, across, weight)
        np.testing.assert_allclose(motion.work_damping, lost, rtol=0.0, atol=1e-10 * abs(motion.work_input))
        balance = motion.work_input - motion.work_friction - motion.work_damping
        assert abs(balance) < 1e-11 * abs(motion.work_input)
        cell = fm.curves(system, [r], [beta], quantities=["amplitude", "phase", "first_harmonic"]).squeeze()
        np.testing.assert_allclose(motion.amplitude, cell.amplitude, rtol=0.0, atol=1e-11 * size)
        np.testing.assert_allclose(np.exp(1j * motion.phase), np.exp(1j * cell.phase_lag), atol=1e-8)
        first = cell.first_harmonic_amplitude * np.exp(-1j * cell.first_harmonic_phase)
        np.testing.assert_allclose(motion.first_harmonic, first, rtol=0.0, atol=1e-11 * size)


def limits(system, r, mu):
    """`limit_` variables over (mu, r, dof): amplitudes, and phases as numbers on the unit circle."""
    ds = fm.curves(system, r, [0.1], mu, quantities=["amplitude"], threads=1)
    found = {name.removeprefix("limit_"): ds[name].values for name in ds if name.startswith("limit_")}
    return {name: np.exp(1j * v) if name.endswith("phase") else v for name, v in found.items()}


def test_motions_on_the_boundary():
    """As continuous motions at beta_lim, also where S decides."""
    rng = np.random.default_rng(42)
    for system, motion in continuous_motions(rng, 10):
        r, mu = motion.r, (1.0, 1.4)
        if np.min(np.abs(system.modes.free.omega / r - 1.0)) < 0.01:
            continue  # the rounding of beta_lim costs digits of the motion at it
        found = limits(system, [r], mu)
        for m, beta in enumerate(fm.boundaries(system, [r], mu).beta_lim.values[:, 0]):
            motion = fm.continuous_motion(system, r, beta)
            size = motion.amplitude.max()
            np.testing.assert_allclose(found["amplitude"][m, 0], motion.amplitude, rtol=0, atol=1e-10 * size)
            first = found["first_harmonic_amplitude"][m, 0] / found["first_harmonic_phase"][m, 0]
            np.testing.assert_allclose(first, motion.first_harmonic, rtol=0, atol=1e-10 * size)
            np.testing.assert_allclose(found["phase"][m, 0], np.exp(1j * motion.phase), rtol=0, atol=1e-8)


def test_on_the_boundary_at_an_undamped_resonance_with_coupled_modes():
    """Ends of a chain against each other do not move its middle, where the dashpot is: mean of both sides."""
    matrices = {**chain_matrices([1.0] * 3, [1.0] * 3), "C": dashpots(3, (0, 2, 0.3))}
    matrices["K"][2, 2] += 1.0
    system = fm.System(contact_masses=[1], load=[1.0, 0.3, 0.2], matrices=matrices, frequency_scale=1.0)
    w = system.modes.w[1]
    assert system.modes.zeta[1] == 0.0 < abs(system.modes.chi[1])
    assert system.modes.free.coupled
    assert np.isinf(fm.boundaries(system, [w]).V[0])
    for value in limits(system, [w * (1.0 - 1e-6), w, w * (1.0 + 1e-6)], (1.0, 3.0)).values():
        np.testing.assert_allclose(0.5 * (value[:, 0] + value[:, 2]), value[:, 1], rtol=0.0, atol=1e-9)


def test_modal_damping_is_a_case(monkeypatch):
    """The way of coupled damping with a matrix that couples by 1e-13 only."""
    damping = 0.04 * CHAIN["M"] + 0.03 * CHAIN["K"]
    given = {"contact_masses": [2], "load_mass": 3, "frequency_scale": 1.0}
    modal = fm.System(matrices={**CHAIN, "C": damping}, **given)
    general = fm.System(matrices={**CHAIN, "C": damping}, **given)
    m = modal.modes
    parts = {name: getattr(m, name) for name in ("contact", "load", "base_motion", "mass", "stiffness")}
    model = coupled_model(m.w, m.phi, damping, False, parts)
    tiny = np.full((3, 3), 1e-13) - np.diag(np.full(3, 1e-13))
    model = CoupledModel(
        **{**{f: getattr(model, f) for f in model.__dataclass_fields__}, "coupling": model.coupling + tiny}
    )
    monkeypatch.setitem(general.__dict__, "modes", model)
    assert model.free.coupled
    assert not modal.modes.free.coupled
    r, beta = np.linspace(0.3, 2.2, 9), np.linspace(0.05, 0.8, 7)
    one, other = (fm.sweep(s, r, beta, 1.5, outputs=OUTPUTS) for s in (modal, general))
    for name in OUTPUTS:
        np.testing.assert_allclose(one[name], other[name], rtol=2e-11, atol=1e-12, err_msg=name)
    one, other = (fm.boundaries(s, r) for s in (modal, general))
    for name in ("beta_lim", "beta_stick", "U", "G", "H", "S", "V", "V_imag"):
        np.testing.assert_allclose(one[name], other[name], rtol=1e-11, atol=1e-12, err_msg=name)
    one, other = (fm.continuous_motion(s, 0.8, 0.05) for s in (modal, general))
    for name in ("amplitude", "phase", "monoharmonic_amplitude", "first_harmonic", "work_damping"):
        np.testing.assert_allclose(getattr(one, name), getattr(other, name), rtol=1e-11, err_msg=name)
    one, other = (limits(s, r, (1.0, 1.5)) for s in (modal, general))
    for name in one:
        np.testing.assert_allclose(one[name], other[name], rtol=1e-10, err_msg=name)


def test_points_as_cells():
    """Continuous, stuck and with stops: first harmonics as those of response curves, each cell by itself."""
    r, beta, seen = [0.25, 0.45, 0.7, 1.1, 1.7], [0.1, 0.25, 0.05, 0.9, 0.7], set()
    for case, mu, starts in (("wall", 1.0, {0: "rest"}), ("over-damped", 1.5, {1: "rest", 2: "moving"})):
        found = steady_states(system(case), np.array(r), np.array(beta), mu)
        for column, start in starts.items():
            for k in range(len(r)):
                point = r[k : k + 1], beta[k : k + 1], mu
                cell = fm.curves(system(case), *point, quantities=["first_harmonic"], start=start).squeeze()
                size = cell.first_harmonic_amplitude.values
                expected = size * np.exp(-1j * np.where(size > 0.0, cell.first_harmonic_phase, 0.0))
                np.testing.assert_allclose(found[column].phasors[k], expected, rtol=1e-10, atol=1e-13)
                assert found[column].regime[k] == cell.regime
                seen.add(int(cell.regime))
    assert seen == {regimes.CONTINUOUS, regimes.STICK_SLIP, regimes.PERMANENT_STICKING}
    # of several motions the continuous one is by its closed form
    assert found[0].regime[2] == regimes.CONTINUOUS
    motion = fm.continuous_motion(system("over-damped"), r[2], beta[2])
    np.testing.assert_allclose(found[0].phasors[2], motion.first_harmonic, rtol=1e-13)


def first_harmonics(system, r, beta):
    """Those of continuous motion, complex (n,), by exponentials of the matrices."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    phase = fm.continuous_motion(system, r, beta).contact_phase
    tau = phase + 0.5 * np.pi * (1.0 + nodes)
    return (half_period(system, r, beta, phase, tau)[0] * np.exp(-1j * tau)) @ weights


def test_fits():
    """Friction and f_n from lags and amplitudes; friction from one lag."""
    structure, beta, f_n = system("wall"), 0.05, 3.0
    r = np.linspace(0.6, 1.3, 8)
    assert (fm.boundaries(structure, r).beta_lim > beta).all()
    first = np.array([first_harmonics(structure, one, beta) for one in r]).T
    lag = np.degrees(-np.angle(first))
    columns = [{k: row[k - 1] for k in (1, 3)} for row in (lag, np.abs(first))]
    fit = fm.identify.forced(f_n * r, *columns, system=structure, known={"mu": 1.0})
    np.testing.assert_allclose(fit.estimate[:2], [beta, f_n], rtol=1e-9)
    (found,) = fm.identify.friction_ratio(r[1], lag[0, 1], system=structure)
    assert found.beta == pytest.approx([beta], abs=1e-9)


def test_a_row_of_a_map_alone_is_the_same_to_the_bit():
    """No product of matrices may round a row by its place among the others."""
    rng = np.random.default_rng(43)
    outputs = ("regime", "cycles", "contact_amplitude")
    r, beta = np.linspace(0.3, 2.2, 7), np.linspace(0.05, 0.6, 4)
    for _ in range(3):
        structure = random_system(rng)
        whole = fm.sweep(structure, r, beta, 1.5, outputs=outputs, start="moving")
        for k in range(r.size):
            alone = fm.sweep(structure, r[k : k + 1], beta, 1.5, outputs=outputs, start="moving")
            for name in outputs:
                np.testing.assert_array_equal(alone[name][:, 0], whole[name][:, k])


def test_no_kernel_is_compiled_for_it_alone():
    """A memory layout of its own would be one more type to the kernels."""
    structure, r = system("wall"), np.array([0.4, 0.7])
    found = kernel_data.structure_arrays(structure, r, find_curves(structure, r, np.ones(1)))
    for part in (found.rest, found.moving, found.loads, found.model, found.orbit, found.outputs):
        assert all(array.flags.c_contiguous for array in part if isinstance(array, np.ndarray))


@pytest.mark.parametrize("case", ["wall", "over-damped twice"])
def test_invariant_points(case):
    """U = -z'(0) of the answer to friction is zero there, and changes its sign nowhere else."""
    structure, low, high = system(case), 0.3, 2.5

    def u(r):
        return -structure.contact_vector @ friction_answer(structure, r, [0.0])[structure.n :, 0]

    points = fm.features.invariant_points(structure, low, high)
    assert points.size >= 2
    off = np.array([[u(r * (1.0 - 1e-6)), u(r), u(r * (1.0 + 1e-6))] for r in points])
    assert (off[:, 0] * off[:, 2] < 0.0).all()
    assert (np.abs(off[:, 1]) < 1e-5 * np.abs(off[:, 2] - off[:, 0])).all()
    r = np.linspace(low, high, 400)
    values = np.array([u(one) for one in r])
    changes = np.flatnonzero(values[1:] * values[:-1] < 0.0)
    np.testing.assert_array_equal(np.isin(changes, np.searchsorted(r, points) - 1), True)
    found = fm.boundaries(structure, r).invariant_point
    np.testing.assert_allclose(found, points, rtol=1e-12)


def test_what_is_not_known_of_coupled_damping():
    assert np.isnan(fm.features.peak_thresholds(system("wall"))).all()
    assert "damping that couples modes" in system("wall").describe()
