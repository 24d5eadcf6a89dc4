"""Design questions about contacts that open and piecewise linear springs: closed forms and limiting cases."""

import re

import numpy as np
import pytest

import frictionmap as fm
from frictionmap.design.responses import Response, Responses
from frictionmap.files.designs import describe_design
from frictionmap.general.normal_resting import resting_friction

K = np.array([[1.0, 0.2, 0.0], [0.2, 1.2, 0.1], [0.0, 0.1, 1.7]])
C = np.diag([0.04, 0.06, 0.05])
LOAD = np.array([1.0, 0.5 + 0.6j, 0.3])


def three(*contacts, offset=None, **keys):
    load = LOAD.tolist()
    return fm.System(
        matrices={"M": np.eye(3), "K": K, "C": C}, load=load, contacts=list(contacts), load_offset=offset,
        frequency_scale=1.0, stiffness_scale=1.0, **keys,
    )  # fmt: skip


def held(r, contacts, stiffness):
    """Forces and normal forces of contacts at rest, and how constant forces change the latter: dense."""
    size = len(contacts)
    closed = K + sum(kn * np.outer(d, d) for _, d, kn, _ in contacts)
    matrix = closed - r * r * np.eye(3) + 1j * r * C
    c = np.array([one[0] for one in contacts], dtype=float)
    rows = np.array([kn * np.array(d) for _, d, kn, _ in contacts])
    if stiffness:
        x = np.linalg.solve(matrix + stiffness * c.T @ c, LOAD)
        force = stiffness * c @ x
    else:
        whole = np.block([[matrix, c.T], [c, np.zeros((size, size))]])
        found = np.linalg.solve(whole, np.append(LOAD, np.zeros(size)))
        x, force = found[:3], found[3:]
    return force, rows @ x, -rows @ np.linalg.inv(closed) @ c.T, rows @ np.linalg.inv(closed)


@pytest.mark.parametrize("stiffness", [None, 3.0])
@pytest.mark.parametrize("count", [1, 2])
def test_friction_that_holds_is_the_least_with_any_constant_forces(stiffness, count):
    """Constants g are tried on a grid: |F + g| <= phi (N0 + N_s + N_1 + E g) over a period."""
    offset = np.array([0.1, 0.3, -0.2])
    parts = [
        (np.array([1.0, 0, 0]), np.array([0, 1.0, 0]), 1.0, 0.4),
        (np.array([0, 1.0, 0]), np.array([0, 0, 1.0]), 0.7, 0.6),
    ][:count]
    contacts = [
        {"masses": [k + 1], "ratio": 1.0 + k, "stiffness": stiffness,
         "normal": {"vector": d.tolist(), "stiffness": kn, "friction": phi}}
        for k, (_, d, kn, phi) in enumerate(parts)
    ]  # fmt: skip
    r = 0.8
    found = resting_friction(three(*contacts, offset=offset.tolist()), np.array([r]), 1.0)[0]
    force, normal, influence, static = held(r, parts, stiffness)
    wave = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 4000, endpoint=False))
    phi, ratio = np.array([one[3] for one in parts]), 1.0 + np.arange(count)
    needs = [
        (np.real((sign * force - phi * normal)[:, np.newaxis] * wave)).max(axis=1) for sign in (1.0, -1.0)
    ]
    g = np.stack(np.meshgrid(*[np.linspace(-2.0, 2.0, 801)] * count, indexing="ij"), axis=-1)
    change = phi * (g @ influence.T + static @ offset)
    beta = np.maximum(needs[0] + g - change, needs[1] - g - change) / ratio
    assert found == pytest.approx(beta.max(axis=-1).min(), abs=0.006)  # the grid is 0.005 apart
    assert found <= beta.max(axis=-1).min() + 1e-6


def test_a_fixed_preload_holds_or_not():
    normal = {"mass": 2, "stiffness": 1.0, "friction": 0.4}
    least = resting_friction(three({"masses": [1], "normal": normal}), np.array([0.8]), 1.0)[0]
    for factor, expected in ((1.001, 0.0), (0.999, np.inf)):
        fixed = three({"masses": [1], "normal": {**normal, "preload": factor * least / 0.4}})
        assert resting_friction(fixed, np.array([0.8]), 1.0)[0] == expected


def test_stuck_is_the_largest_boundary_of_the_band():
    system = three({"masses": [1], "normal": {"mass": 2, "stiffness": 1.0, "friction": 0.4}})
    found = fm.design.stuck(system, [0.5, 1.6], mu=1.3)
    r = np.linspace(0.5, 1.6, 2001)
    limits = fm.boundaries(system, r, mu=[1.0, 1.3]).beta_stick
    largest = {mu: float(limits.sel(mu=mu).max()) for mu in (1.0, 1.3)}
    assert float(found.beta) == pytest.approx(largest[1.0], rel=1e-5)
    assert float(found.beta) >= largest[1.0]
    assert float(found.beta_stuck_some_starts) == pytest.approx(largest[1.3], rel=1e-5)
    margin = fm.design.margin(system, 0.9, 1.2)
    at = fm.boundaries(system, [0.9, float(margin.nearest_r_on_beta_stick)]).beta_stick.isel(mu=0)
    assert float(margin.beta_stick) == pytest.approx(float(at[0]), rel=1e-12)
    assert float(at[1]) == pytest.approx(1.2, rel=1e-9)


def test_a_gap_that_is_never_closed_changes_no_response():
    """What a question evaluates: from both starts with the gap, from one without it."""
    keys = {"damping_ratios": 0.05, "contact": "fixed-wall"}
    far = fm.System(springs=[{"gap": 1e3, "stiffness": 4.0}], **keys)
    r, beta = np.array([0.6, 0.8, 1.0, 1.4]), np.array([0.1, 0.4, 0.7, 0.95])
    got, expected = (
        Responses(one, Response("amplitude"), 1.0, 1).on_grid(r, beta) for one in (far, fm.System(**keys))
    )
    np.testing.assert_allclose(got.size, expected.size, rtol=1e-9)
    np.testing.assert_array_equal(got.regime, expected.regime)


@pytest.mark.slow
def test_least_preload_of_a_contact_pressed_by_a_mass_of_its_own():
    """Mass 2 does not feel the friction: it loses k_n max abs(x_2), of k + k_n, at most."""
    matrices = {"M": np.eye(2), "K": np.eye(2), "C": np.diag([0.1, 0.6])}
    normal = {"mass": 2, "stiffness": 0.8, "friction": 0.5}
    system = fm.System(
        matrices=matrices, load=[1.0, 1.0], frequency_scale=1.0, stiffness_scale=1.0,
        contacts=[{"masses": [1], "stiffness": 2.0, "normal": normal}],
    )  # fmt: skip
    found = fm.design.no_separation(system, [0.9, 1.6], beta=[0.2, 1.0])
    squares = 1.8 - 0.5 * 0.6**2  # r^2 at the largest displacement
    preload = 0.8 / (0.6 * np.sqrt(1.8 - 0.25 * 0.6**2))
    assert float(found.preload[0]) == pytest.approx(preload, rel=2e-6)
    assert float(found.beta) == pytest.approx(0.5 * preload, rel=2e-6)
    assert float(found.at_r) == pytest.approx(np.sqrt(squares), rel=1e-3)
    assert float(found.peak[0]) == pytest.approx(1.0, rel=2e-6)
    said = float(re.search(r"^Press contact 1 with (\S+) P or more", describe_design(found)[0])[1])
    assert float(found.preload[0]) <= said < 1.001 * preload  # a bound is rounded up
    with pytest.raises(fm.InputError, match=r"must reach further: with beta = 0\.4, the most that"):
        fm.design.no_separation(system, [0.9, 1.6], beta=[0.2, 0.4])


def test_preloads_as_a_further_axis():
    normal = {"mass": 2, "stiffness": 1.0, "friction": 0.4}
    whole = fm.sweep(
        three({"masses": [1], "normal": normal}), [0.9], [0.3], outputs=["normal_force_max", "open_fraction"],
        axes={"contacts[1].normal.preload": [0.5, 2.0], "contacts[1].normal.stiffness": [0.5, 1.0]},
    )  # fmt: skip
    assert whole.normal_force_max.dims[:2] == ("contacts_1_normal_preload", "contacts_1_normal_stiffness")
    own = three({"masses": [1], "normal": {**normal, "preload": 2.0, "stiffness": 0.5}})
    one = fm.sweep(own, [0.9], [0.3], outputs=["normal_force_max"])
    assert float(whole.normal_force_max[1, 0].squeeze()) == float(one.normal_force_max.squeeze())
