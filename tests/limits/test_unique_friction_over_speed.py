"""Friction over speed: where the steady state is unique, and the share of time in each segment."""

import itertools
import math

import numpy as np
import pytest

import frictionmap as fm
from frictionmap._kernels.general.problem import H
from frictionmap._kernels.general.row import make_motion, make_row, set_row
from frictionmap._kernels.general.tangent import pattern_slot
from frictionmap.general.certificate import certified_beta, certified_friction
from frictionmap.general.problem import problem_of
from frictionmap.stores.run import fill_store, in_this_process
from frictionmap.stores.study import study_of
from tests.kernels import callable_kernel

GENTLE = {"speed": [0.0, 0.4, 1.0], "factor": [1.0, 0.9, 0.85], "slope": 0.0}
RISING = {"speed": [0.0, 0.2, 0.6], "factor": [1.0, 1.1, 1.15], "slope": 0.1}
FALLING = {"speed": [0.0, 0.5], "factor": [1.0, 0.7], "slope": 0.1}


def structure(contacts, damping, n=3, harmonics=None):
    """A chain of masses; its damping is not proportional."""
    k = 2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    loads = harmonics or {1: [1.0, *([0.3j] * (n - 1))]}
    return fm.System(
        matrices={"M": np.eye(n), "K": k, "C": damping}, contacts=contacts, load_harmonics=loads,
        frequency_scale=1.0, stiffness_scale=1.0,
    )  # fmt: skip


def pair(first, second, damping=0.1, **more):
    k = np.array([[2.0, -1.0], [-1.0, 2.0]])
    return structure([first, second], damping * k, 2, **more)


def test_the_certificate_of_one_mass_is_its_damping():
    """C1 + beta a = 2 zeta - beta/4 >= 0."""
    system = fm.System(damping_ratios=0.1, contacts=[fm.Contact(law=GENTLE)])
    assert certified_beta(system) == pytest.approx(0.8, rel=1e-9)
    assert certified_friction(system) == pytest.approx([0.8], rel=1e-9)
    beta = [0.1, 0.79, 0.81]
    ds = fm.sweep(system, [0.5], beta, mu=[1.0, 1.2], outputs=["regime", "unique"])
    assert ds.unique.values[:, 0].tolist() == [[1, 1, 0], [0, 0, 0]]
    assert float(fm.response(system, 0.5, 0.79).unique) == 1.0
    assert float(fm.response(system, 0.5, 0.81).unique) == 0.0


@pytest.mark.parametrize("seed", range(6))
def test_the_certificate_is_where_damping_less_the_fall_becomes_singular(seed):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(3, 3))
    damping = 0.1 * root @ root.T + 0.02 * np.eye(3)
    contacts = [
        fm.Contact(masses=1, law=GENTLE, ratio=0.5),
        fm.Contact("between-masses", [2, 3], law=FALLING, force=0.01),
        fm.Contact(masses=2, law=RISING),
    ]
    system = structure(contacts, damping)
    beta = certified_beta(system)
    first, second = np.array([1.0, 0.0, 0.0]), np.array([0.0, -1.0, 1.0])

    def least(beta):
        fall = 0.25 * 0.5 * beta * np.outer(first, first) + 0.6 * 0.01 * np.outer(second, second)
        return np.linalg.eigvalsh(damping - fall)[0]

    assert least(beta * (1.0 - 1e-6)) > 0.0 > least(beta * (1.0 + 1e-6))
    assert certified_friction(system)[:2] == pytest.approx([0.5 * beta, 0.01], rel=1e-9)
    assert math.isinf(certified_friction(system)[2])


def test_a_rising_law_is_certified_and_an_undamped_fall_is_not():
    one = fm.Contact(masses=1, law=RISING)
    assert certified_beta(structure([one], np.zeros((3, 3)))) == math.inf
    falls = fm.Contact(masses=1, law=FALLING, force=0.2)
    assert certified_beta(structure([falls], np.zeros((3, 3)))) == -1.0
    assert certified_beta(structure([falls], np.diag([0.13, 0.0, 0.0]))) == math.inf
    assert certified_beta(structure([falls], np.diag([0.11, 0.0, 0.0]))) == -1.0
    assert certified_beta(structure([fm.Contact(masses=1, law=FALLING)], np.zeros((3, 3)))) == 0.0


OUTPUTS = ["regime", "peak_to_peak", "midpoint", "stops_per_cycle", "segment_crossings", "segment_fraction",
           "stuck_fraction", "multiplier", "period", "unique"]  # fmt: skip


@pytest.mark.parametrize("harmonics", [None, {1: [1.0, 0.3j], 2: [0.2, 0.1]}])
def test_cells_that_begin_from_their_neighbours_are_those_of_a_motion_alone(harmonics):
    """To the bit, for any cut of the axes and any threads; and those of a motion from its start, marched."""
    system = pair(
        fm.Contact(masses=1, law=RISING), fm.Contact("between-masses", [1, 2], ratio=0.6, law=GENTLE),
        0.1, harmonics=harmonics,
    )  # fmt: skip
    r, beta = np.array([0.4, 0.9, 1.5]), np.linspace(0.05, 0.45, 9)
    assert certified_beta(system) > beta[-1]
    whole = fm.sweep(system, r, beta, outputs=OUTPUTS, threads=2)
    assert (whole.unique == 1).all()
    for k in range(beta.size):
        alone = fm.sweep(system, r, beta[k : k + 1], outputs=OUTPUTS, threads=1)
        for name in OUTPUTS:
            assert np.array_equal(
                alone[name].values, whole[name].isel(beta=slice(k, k + 1)).values, equal_nan=True
            )


@pytest.mark.parametrize("start", ["rest", "moving"])
def test_a_unique_motion_comes_to_rest_where_its_start_leads(start):
    """Two contacts hold, the third slides.  Without certificate the motion itself leads there."""
    contacts = [
        fm.Contact(masses=1, law=GENTLE, ratio=0.2), fm.Contact(masses=2, law=RISING, ratio=2.0),
        fm.Contact("between-masses", [2, 3], ratio=1.5, law=RISING),
    ]  # fmt: skip
    k = 2.0 * np.eye(3) - np.eye(3, k=1) - np.eye(3, k=-1)
    own = structure(contacts, 0.12 * k)
    # the same friction over these speeds, and a fall that is never reached: no certificate
    far = {"speed": [0.0, 0.4, 1.0, 90.0, 90.1], "factor": [1.0, 0.9, 0.85, 0.85, 0.0], "slope": 0.0}
    contacts[0] = fm.Contact(masses=1, law=far, ratio=0.2)
    marched = structure(contacts, 0.12 * k)
    beta = 0.3
    assert certified_beta(own) > beta > certified_beta(marched)
    for r in (0.5, 0.8, 1.3):
        one, other = (fm.response(it, r, beta, solver=fm.Solver(start=start)) for it in (own, marched))
        assert (one.contact_regime.values == other.contact_regime.values).all()
        for name in ("midpoint", "peak_to_peak"):
            assert one[name].values == pytest.approx(other[name].values, abs=1e-9)
        for name in ("stops_per_cycle", "segment_crossings", "stuck_fraction"):
            assert one[name].values == pytest.approx(other[name].values, abs=1e-6, nan_ok=True)


def test_sticking_from_beta_stick_is_proved_where_the_steady_state_is_unique():
    system = pair(fm.Contact(masses=1, law=RISING), fm.Contact(masses=2, law=RISING))
    stick = fm.boundaries(system, [0.7]).beta_stick.item()
    beta = stick * np.array([0.9, 1.0 + 1e-9, 1.5])
    ds = fm.sweep(system, [0.7], beta, outputs=["regime", "origin", "segment_fraction", "contact_amplitude"])
    assert ds.origin.values[0, 0].tolist() == [2, 0, 0]
    assert (ds.regime.values[0, 0, 1:] == fm.regimes.PERMANENT_STICKING).all()
    assert (ds.segment_fraction.values[0, 0, 1:] == 0.0).all()


@pytest.mark.parametrize("wall", [0.0, 0.25])
def test_the_shares_of_the_segments_are_those_of_the_speed(wall):
    """The velocity over the period, at many phases."""
    system = fm.System(damping_ratios=0.1, contacts=[fm.Contact(law=RISING, wall_speed=wall)])
    r, beta = 0.45, 0.4
    cell = fm.response(system, r, beta, points=20000)
    speed = r * np.abs(cell.v.values[0, :-1] - wall / r)
    slides = cell.direction.values[:-1] != 0
    edges = [0.0, 0.2, 0.6, np.inf]
    shares = [((speed >= low) & (speed < high) & slides).mean() for low, high in itertools.pairwise(edges)]
    assert cell.segment_fraction.dims == ("segment",)
    assert cell.segment_fraction.values == pytest.approx(shares, abs=2e-3)  # a few points at every crossing
    assert float(cell.segment_fraction.sum() + cell.stuck_fraction) == pytest.approx(1.0, abs=1e-6)
    ds = fm.sweep(system, [r], [beta], outputs=["segment_fraction"])
    assert ds.segment_fraction.dims == ("mu", "r", "beta", "segment")
    assert ds.segment_fraction.values[0, 0, 0] == pytest.approx(cell.segment_fraction.values, abs=1e-6)


def test_segments_that_a_contact_has_not_are_nan():
    system = pair(
        fm.Contact(masses=1, law=FALLING), fm.Contact("between-masses", [1, 2], ratio=0.3, law=RISING), 0.1
    )
    ds = fm.sweep(system, [0.9], [0.3, 9.0], outputs=["segment_fraction"])
    assert ds.segment_fraction.dims == ("mu", "r", "beta", "contact", "segment")
    assert np.isnan(ds.segment_fraction.values[0, 0, :, 0]).tolist() == [[False, False, True]] * 2
    assert not np.isnan(ds.segment_fraction.values[0, 0, :, 1]).any()


def test_break_points_of_an_irregular_motion_are_counted_over_the_cycles_averaged():
    """A mass on a belt under a slow load.  The velocity over the last cycles, which `response` shows, passes
    the break point about as often as over all cycles averaged.
    """
    law = {"speed": [0.0, 0.3], "factor": [1.0, 0.5], "slope": 0.1}
    system = fm.System(damping_ratios=0.02, contacts=[fm.Contact(law=law, wall_speed=0.4)])
    r, beta = 0.2, 0.3
    cell = fm.response(system, r, beta, points=2000)
    assert float(cell.status) == fm.regimes.IRREGULAR
    above = r * np.abs(cell.v.values[0] - 0.4 / r) > 0.3
    cycles = (cell.tau.values[-1] - cell.tau.values[0]) / (2.0 * math.pi)
    passed = np.count_nonzero(above[1:] != above[:-1]) / cycles
    assert float(cell.segment_crossings) == pytest.approx(passed, rel=0.1)
    assert float(cell.segment_fraction[1]) == pytest.approx(above.mean(), rel=0.1)
    shares = float(cell.segment_fraction.sum() + cell.stuck_fraction)
    assert shares == pytest.approx(1.0, abs=1e-6)


def test_patterns_of_many_contacts_and_segments_are_not_confused(monkeypatch):
    """15 contacts with 24 segments have 25^15 > 2^64 patterns: one whose number is 2^64, which is 0 in 64
    bits, is not that of all contacts at rest.
    """
    for module in ("contact", "general"):
        monkeypatch.setattr(f"frictionmap.model.{module}.MOST_CONTACTS", 15)
    speed = np.linspace(0.0, 2.3, 24)
    law = {"speed": speed.tolist(), "factor": np.linspace(1.0, 0.5, 24).tolist(), "slope": 0.1}
    contacts = [fm.Contact(masses=j + 1, law=law, ratio=0.1 * (j + 1)) for j in range(15)]
    system = structure(contacts, 0.1 * np.eye(15), 15, {1: np.ones(15)})
    problem, _ = problem_of(system, np.array([0.7]), 0.5)
    row, motion = make_row(problem), make_motion(problem)
    callable_kernel(set_row)(problem, 0, row)
    digits, rest = [], 2**64
    for _ in range(15):
        digits.append(rest % 25)
        rest //= 25
    tables = []
    for pattern in ([0] * 15, digits[::-1]):
        for j, digit in enumerate(pattern):
            motion.sense[j], motion.segment[j] = int(digit > 0), max(0, digit - 1)
            slope = problem.law.slope[j, motion.segment[j]] if digit else 0.0
            motion.law_damping[j] = 0.05 * (j + 1) * slope * 0.7 / row.numbers[H]
        motion.held[15] = 0
        held = [j for j in range(15) if motion.sense[j] == 0]
        motion.held[: len(held)], motion.held[15] = held, len(held)
        motion.solve[:15] = np.diag(np.sqrt(np.diag(row.mobility)))
        slot = callable_kernel(pattern_slot)(problem, row, motion)
        tables.append(row.onward[slot].copy())
    modes = problem.squares.size
    moved = problem.chi @ tables[1][modes : 2 * modes, :modes]  # velocities in contacts by displacements
    slides = np.abs(moved).max(axis=1) > 1e-9
    assert slides.tolist() == [digit > 0 for digit in digits[::-1]]
    assert np.abs(problem.chi @ tables[0][modes : 2 * modes, :modes]).max() < 1e-12


def test_files_and_stores_have_the_shares_of_segments(tmp_path):
    pytest.importorskip("zarr")
    system = fm.System(damping_ratios=0.1, contacts=[fm.Contact(law=RISING)])
    axes = {"mu": np.array([1.0]), "r": np.array([0.5, 0.9, 1.3]), "beta": np.array([0.1, 0.3])}
    solver = fm.Solver(outputs=["segment_fraction", "unique"])
    ds = fm.sweep(system, axes["r"], axes["beta"], solver=solver)
    ds.to_netcdf(tmp_path / "map.nc")
    fill_store(tmp_path / "map.zarr", study_of(system, None, axes, solver), "map", in_this_process(1))
    for name in ("map.nc", "map.zarr"):
        with fm.open(tmp_path / name) as found:
            assert found.segment_fraction.dims == ("mu", "r", "beta", "segment")
            assert found.segment.values.tolist() == [1, 2, 3]
            for output in solver.outputs:
                assert np.array_equal(found[output].values, ds[output].values, equal_nan=True)
