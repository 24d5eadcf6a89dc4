"""Elastic contacts that residual flexibility couples: equations, friction law, another integration."""

from itertools import product

import numpy as np
import pytest
from coupled_structures import Given, March, load_at_last

import frictionmap as fm

TWO_PI = 2.0 * np.pi


def phasors(table):
    return table.values[..., 0] + 1j * table.values[..., 1]


def near_events(found, contacts):
    """Whether something happens to a contact in an interval of tau or beside it, (N, T - 1)."""
    tau = found.tau.values
    near = np.zeros((contacts, tau.size - 1), dtype=bool)
    near[:, [0, -1]] = True
    for at, j in zip(found.event_tau.values, found.event_contact.values.astype(int), strict=True):
        k = int(np.searchsorted(tau, at))
        near[j - 1, max(k - 2, 0) : k + 1] = True
    return near


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
@pytest.mark.parametrize("kind", ["still", "very flexible", "normal load", "belt", "free"])
def test_the_equations_and_the_friction_law(seed, kind):
    given = Given(seed)
    if kind == "very flexible":  # where one begins to slip, a quarter of the others at their limits hold
        given.residual = 6.0 * given.residual
    elif kind == "normal load":
        given.more[0] = {"normal_load": {1: 0.4j}}
        given.more[1] = {"normal_load": {2: 0.3}}
    elif kind == "belt":
        given.more[1] = {"wall_velocity": 0.25}
    elif kind == "free":
        given.free()
    found = fm.response(given.system(), r=given.r, beta=1.0)
    x, f = phasors(found.displacement_harmonic), phasors(found.friction_harmonic)
    size = np.abs(x).max()
    for n in range(1, x.shape[1]):
        np.testing.assert_allclose(given.displacements(n, f[:, n]), x[:, n], rtol=0.0, atol=1e-12 * size)
    tau, force, sense = found.tau.values, found.friction.values, found.direction.values
    nu = [1.0 + 0.0 * tau for _ in given.kt]
    if kind == "normal load":
        nu[:2] = 1.0 - 0.4 * np.sin(tau), 1.0 + 0.3 * np.cos(2.0 * tau)
    limit = given.force[:, np.newaxis] * np.array(nu)
    belt = np.array([one.get("wall_velocity", 0.0) for one in given.more])
    slider = found.z.values - force / given.kt[:, np.newaxis] - belt[:, np.newaxis] * tau
    assert (np.abs(force) <= limit + 1e-13 * size).all()
    np.testing.assert_allclose(force[sense != 0], (sense * limit)[sense != 0], atol=1e-13 * size)
    step, away = np.diff(slider, axis=1), ~near_events(found, given.count)
    rests, slips = (sense[:, 1:] == 0) & away, (sense[:, 1:] != 0) & away
    assert np.abs(step[rests]).max(initial=0.0) <= 1e-13 * size
    assert (sense[:, 1:] * step)[slips].min() > 0.0
    assert slips.any()
    given_work = float(found.work_input + (found.work_wall.sum() if "work_wall" in found else 0.0))
    taken = float(found.work_damping + found.work_friction.sum())
    assert given_work == pytest.approx(taken, abs=1e-12 * size)


def path_of(given, cycles, steps):
    """Displacements of the points over the last cycle under the first harmonic, from rest, (steps, p)."""
    load = load_at_last(given, [[0.0, -1.0], [1.0, 0.0]])
    march, path = March(given, load, [1.0, 0.0], given.r), []
    for _ in range(cycles * steps):
        march.advance(TWO_PI / steps)
        path.append(march.displacements())
    return np.array(path[-steps:])


@pytest.mark.parametrize(("seed", "forces", "rest"), [(5, (0.02, 0.05, 0.1), 0), (6, (0.02, 0.25, 0.9), 2)])
def test_another_integration(seed, forces, rest):
    """Also the places to which the start leads where contacts rest, as in the second case."""
    given = Given(seed, contacts=3)
    given.load, given.force, given.r = {1: 1.0 + 0.0j}, np.array(forces), 0.7
    path = path_of(given, 40, 120)
    found = fm.response(given.system(), r=0.7, beta=1.0)
    assert (found.contact_regime == 0).sum() == rest
    x = np.array([np.interp(np.arange(1, 121) * TWO_PI / 120, found.tau, one) for one in found.x.values]).T
    np.testing.assert_allclose(path, x, atol=2e-5 * np.abs(path).max())  # samples of the response


def test_two_equal_contacts_are_one():
    """They reach their limits together, as one contact of twice their stiffness and friction."""
    given = Given(7, contacts=1)
    keys = {"load_mass": "load", "load_harmonics": given.load}
    modes = fm.Modes(given.w, given.zeta, given.shapes, ["tip", "load"], given.residual)
    one = fm.Contact(masses=["tip"], stiffness=5.0)
    twice = fm.Contact(masses=["tip"], stiffness=10.0, ratio=2.0)
    both, single = (fm.System(modes=modes, contacts=list(c), **keys) for c in ((one, one), (twice,)))
    outputs = ("peak_to_peak", "contact_peak_to_peak", "sliding_distance", "slips_per_cycle", "work_friction")
    grid = {"r": [0.6, 0.9, 1.3], "beta": [0.02, 0.1, 0.3, 5.0]}
    found, expected = (fm.sweep(s, **grid, solver=fm.Solver(outputs=outputs)) for s in (both, single))
    np.testing.assert_allclose(found.beta_noslip, expected.beta_noslip, rtol=1e-12)
    np.testing.assert_allclose(found.peak_to_peak, expected.peak_to_peak, rtol=1e-11)
    for j in range(2):
        for name in outputs[1:]:
            share = 0.5 if name == "work_friction" else 1.0
            np.testing.assert_allclose(found[name][..., j], share * expected[name], rtol=1e-10, atol=1e-12)


def test_two_structures_in_one():
    """Contacts of two structures that nothing couples do what each does alone."""
    parts = [Given(seed, contacts=2) for seed in (8, 9)]
    sizes = [one.w.size for one in parts]
    shapes = np.zeros((6, sum(sizes)))
    residual = np.zeros((6, 6))
    for k, one in enumerate(parts):
        shapes[3 * k : 3 * k + 3, k * sizes[0] : k * sizes[0] + sizes[k]] = one.shapes
        residual[3 * k : 3 * k + 3, 3 * k : 3 * k + 3] = one.residual
    w = np.concatenate([one.w * (1.0 + 0.1 * k) for k, one in enumerate(parts)])
    parts[1].w = 1.1 * parts[1].w
    order, names = np.argsort(w), ["a0", "a1", "la", "b0", "b1", "lb"]
    modes = fm.Modes(
        w[order], np.concatenate([one.zeta for one in parts])[order], shapes[:, order], names, residual
    )
    contacts = [
        fm.Contact(masses=[names[3 * k + j]], stiffness=one.kt[j], force=one.force[j])
        for k, one in enumerate(parts)
        for j in range(2)
    ]
    load = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 1.0])
    whole = fm.System(modes=modes, contacts=contacts, load_harmonics={1: load, 2: 0.3j * load})
    found = fm.response(whole, r=0.8, beta=1.0)
    for k, one in enumerate(parts):
        one.load = {1: 1.0, 2: 0.3j}
        own = fm.System(
            modes=fm.Modes(one.w, one.zeta, one.shapes, names[3 * k : 3 * k + 3], one.residual),
            frequency_scale=1.0, contacts=contacts[2 * k : 2 * k + 2], load_mass=names[3 * k + 2],
            load_harmonics=one.load,
        )  # fmt: skip
        alone = fm.response(own, r=0.8, beta=1.0)
        np.testing.assert_allclose(found.peak_to_peak[3 * k : 3 * k + 3], alone.peak_to_peak, rtol=1e-11)
        for name in ("sliding_distance", "slips_per_cycle", "contact_peak_to_peak"):
            np.testing.assert_allclose(found[name][2 * k : 2 * k + 2], alone[name], rtol=1e-11)


def test_the_order_of_points_and_the_start_do_not_matter():
    given = Given(10, contacts=4)
    found = fm.response(given.system(), r=given.r, beta=1.0)
    order = [3, 4, 0, 2, 1]
    other = fm.response(given.system(given.modes(order)), r=given.r, beta=1.0)
    moving = fm.response(given.system(), r=given.r, beta=1.0, solver=fm.Solver(start="moving"))
    size = float(found.peak_to_peak.max())
    for name in ("contact_peak_to_peak", "sliding_distance", "slips_per_cycle"):
        np.testing.assert_allclose(other[name], found[name], rtol=0.0, atol=1e-12 * size)
        np.testing.assert_allclose(moving[name], found[name], rtol=0.0, atol=1e-12 * size)
    np.testing.assert_allclose(other.peak_to_peak, found.peak_to_peak[order], atol=1e-12 * size)
    np.testing.assert_allclose(moving.peak_to_peak, found.peak_to_peak, atol=1e-12 * size)


def test_friction_from_which_none_slips():
    """Half the range of the forces of springs of the flexibility F, from the receptances at the contacts."""
    given = Given(11, contacts=3)
    given.load = {1: 1.0 + 0.0j}
    contacts = [fm.Contact(masses=[f"c{j}"], stiffness=given.kt[j], ratio=1.0 + 0.3 * j) for j in range(3)]
    modes = fm.Modes(given.w, given.zeta, given.shapes, ["c0", "c1", "c2", "load"], given.residual)
    system = fm.System(modes=modes, contacts=contacts, load_mass="load")
    o = given.r
    receptance = (given.shapes / (given.w**2 - o**2 + 2j * given.zeta * given.w * o)) @ given.shapes.T
    receptance = receptance + given.residual
    flexibility = receptance[:3, :3] + np.diag(1.0 / given.kt)
    force = np.abs(np.linalg.solve(flexibility, receptance[:3, 3]))
    expected = (force / (1.0 + 0.3 * np.arange(3))).max()
    outputs = ("regime", "contact_regime", "peak_to_peak", "slips_per_cycle")
    solver = fm.Solver(outputs=outputs, skip="none")
    found = fm.sweep(system, r=[o], beta=expected * np.array([0.999, 1.001]), solver=solver)
    assert found.beta_noslip.item() == pytest.approx(expected, rel=1e-12)
    assert found.regime.values.ravel().tolist() == [1, 0]
    assert found.slips_per_cycle.sum("contact").values.ravel().tolist() == [2.0, 0.0]


@pytest.mark.parametrize("count", [1, 3])
def test_maps_curves_and_responses_agree(count):
    """Also where nothing slips: the load displaces the sliders before they begin to hold."""
    given = Given(12, contacts=3)
    modes = fm.Modes(given.w, given.zeta, given.shapes, ["c0", "c1", "c2", "load"], given.residual)
    contacts = [fm.Contact(masses=[f"c{j}"], stiffness=given.kt[j], ratio=1.0 + j) for j in range(count)]
    system = fm.System(modes=modes, contacts=contacts, load_mass="load", load_harmonics=given.load)
    r, beta = [0.5, 0.9], [0.01, 0.1, 0.4, 20.0]
    names = ("midpoint", "contact_midpoint", "peak_to_peak", "contact_peak_to_peak", "sliding_distance",
             "work_friction", "elastic_fraction")  # fmt: skip
    whole = fm.sweep(system, r, beta, solver=fm.Solver(outputs=("regime", "status", *names)))
    curves = fm.curves(system, r, beta)
    assert (whole.status == 0).all()
    for i, b in product(range(2), range(4)):
        one = fm.response(system, r=r[i], beta=beta[b])
        size = float(one.peak_to_peak.max())
        for name in names:
            within = 1e-7 if name == "elastic_fraction" else 1e-10 * size  # stored as float32
            np.testing.assert_allclose(whole[name][0, i, b], one[name], rtol=0.0, atol=within)
        for name in ("amplitude", "contact_amplitude", "contact_peak_to_peak", "work_input"):
            if beta[b] < 1.0 or name != "work_input":
                np.testing.assert_allclose(curves[name][0, i, b], one[name], rtol=0.0, atol=1e-10 * size)


def test_a_cantilever_with_two_contacts_converges():
    def ranges(modes, residual):
        beam = fm.Beam("clamped-free", length=1.0, bending_stiffness=1.0, mass_per_length=1.0, modes=modes,
                       points={"tip": 1.0, "mid": 0.7, "load": 0.6}, with_residual=residual)  # fmt: skip
        contacts = [fm.Contact(masses=[name], stiffness=3.0) for name in ("tip", "mid")]
        system = fm.System(modes=beam, damping_ratios=0.02, contacts=contacts, load_mass="load")
        return fm.response(system, r=0.8, beta=0.2).contact_peak_to_peak.values

    expected = ranges(24, True)
    errors = [np.abs(ranges(n, True) / expected - 1.0).max() for n in (4, 8)]
    without = [np.abs(ranges(n, False) / expected - 1.0).max() for n in (4, 8)]
    assert errors[0] < 0.1 * without[0]
    assert errors[1] < 2e-6 < 1e-5 < without[1]


def test_reference_rows(reference_table):
    rows = [row for row in reference_table("continuous.json")["rows"] if row["kind"] == "modal-residual"]
    assert rows
    for row in rows:
        given, expected, within = row["given"], row["expect"], row["tolerance"]
        count = len(given["kt"])
        names = [*(f"c{j}" for j in range(count)), "load"]
        shapes = np.vstack((given["chi"], given["phi_load"]))
        contacts = [
            fm.Contact(masses=[names[j]], stiffness=given["kt"][j], force=given["beta"][j])
            for j in range(count)
        ]
        system = fm.System(
            modes=fm.Modes(given["w"], given["zeta"], shapes, names, given["residual"]), contacts=contacts,
            load_mass="load",
            load_harmonics={int(n): complex(*value) for n, value in given["harmonics"].items()},
        )  # fmt: skip
        found = fm.response(system, r=given["r"], beta=1.0)
        size = max(expected["output_peak_to_peak"] + expected["contact_peak_to_peak"])
        assert (
            abs(float(found.peak_to_peak[-1]) - expected["output_peak_to_peak"][0]) <= within["ranges"] * size
        )
        for name in ("contact_peak_to_peak", "sliding_distance"):
            np.testing.assert_allclose(found[name], expected[name], rtol=0.0, atol=within["ranges"] * size)
        np.testing.assert_allclose(found.elastic_fraction, expected["elastic_fraction"], rtol=0.0, atol=1e-7)
        assert found.slips_per_cycle.values.tolist() == expected["slips_per_cycle"]
        for name in ("work_input", "work_damping"):
            assert float(found[name]) == pytest.approx(expected[name], rel=1e-10)
