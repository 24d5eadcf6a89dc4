"""Several contacts at mu > 1: long periods, irregular motion and the order of release, against a marcher that
shares no code with the package.

The marcher moves in physical coordinates by matrix exponentials on a fine grid, finds events on Taylor
polynomials, and decides what follows an event by trying every pattern.  It knows no return map, and marches
on until it has returned often enough, or for a given time.
"""

import itertools
import math
from typing import NamedTuple

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

import frictionmap as fm
from frictionmap import regimes

#: Steps of the grid per period of the load, those that are looked at together, and terms of the polynomials.
GRID, AHEAD, TERMS = 512, 64, 16

OUTPUTS = (
    "regime", "status", "period", "stops_per_cycle", "turns_per_cycle", "stuck_fraction", "contact_amplitude",
    "contact_peak_to_peak", "peak_to_peak", "work_friction", "sliding_distance", "cycles", "release_order",
    "stops_per_cycle_error", "stuck_fraction_error",
)  # fmt: skip


class Chain(NamedTuple):
    """Two equal masses; contacts of the first with a wall, and between both; load on the first."""

    r: float
    beta: float
    mu: float
    ratios: tuple = (1.0, 0.6)
    zeta: float = 0.02

    def system(self):
        return fm.System(
            contacts=[
                fm.Contact("fixed-wall", 1, ratio=self.ratios[0]),
                fm.Contact("between-masses", (1, 2), ratio=self.ratios[1]),
            ],
            mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0], damping_ratios=self.zeta,
        )  # fmt: skip

    def cell(self, **settings):
        ds = fm.sweep(self.system(), [self.r], [self.beta], [self.mu], outputs=OUTPUTS, **settings)
        return ds.isel(mu=0, r=0, beta=0)


class Pattern(NamedTuple):
    """The motion with given contacts held: y' = flow y, over steps, and the forces in all contacts."""

    flow: np.ndarray
    ahead: np.ndarray  # (AHEAD, 7, 7), over 1, 2, ... steps
    forces: np.ndarray
    contacts: list  # of the margins
    rows: np.ndarray  # of margins, which are positive until an event


class Marcher:
    """Motion of a `Chain` from rest, y = (x, v, cos tau, sin tau, 1)."""

    def __init__(self, chain):
        k = np.array([[2.0, -1.0], [-1.0, 1.0]])
        squares, phi = np.linalg.eigh(k)
        c = (phi * (2.0 * chain.zeta * np.sqrt(squares))) @ phi.T
        self.w = np.array([[1.0, -1.0], [0.0, 1.0]])
        self.kinetic = chain.beta * np.array(chain.ratios)
        self.static = chain.mu * self.kinetic
        self.r = chain.r
        self.free = np.zeros((2, 7))  # accelerations of the masses without friction
        self.free[:, :2], self.free[:, 2:4] = -k / chain.r**2, -c / chain.r
        self.free[0, 4] = 1.0 / chain.r**2
        self.mobility = self.w.T @ self.w / chain.r**2
        self.patterns = {}
        self.h = 2.0 * math.pi / GRID
        self.y = np.array([0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0])
        self.sense = np.zeros(2, int)
        self.clear()
        self.settle([0, 1])
        self.clear()

    def clear(self):
        """Begin to count."""
        self.stops, self.turns, self.stuck = np.zeros(2), np.zeros(2), np.zeros(2)
        self.lowest = self.highest = self.w.T @ self.y[:2]
        self.order = False
        self.way = np.zeros(2)

    def pattern(self):
        """Flow and forces of the present pattern."""
        key = tuple(self.sense)
        if key not in self.patterns:
            forces = np.zeros((2, 7))
            forces[:, 6] = self.sense * self.kinetic
            held = np.flatnonzero(self.sense == 0)
            if held.size:
                rest = self.w.T @ self.free - self.mobility @ forces
                forces[held] += np.linalg.solve(self.mobility[np.ix_(held, held)], rest[held])
            flow = np.zeros((7, 7))
            flow[:2, 2:4] = np.eye(2)
            flow[2:4] = self.free - self.w @ forces / self.r**2
            flow[4, 5], flow[5, 4] = -1.0, 1.0
            ahead = np.array([expm(k * self.h * flow) for k in range(1, AHEAD + 1)])
            contacts, rows = zip(*self.margins(forces), strict=True)
            self.patterns[key] = Pattern(flow, ahead, forces, list(contacts), np.array(rows))
        return self.patterns[key]

    def margins(self, forces):
        """Rows that are positive until an event: (contact, row)."""
        for j in range(2):
            if self.sense[j]:
                row = np.zeros(7)
                row[2:4] = self.sense[j] * self.w[:, j]
                yield j, row
            else:
                for side in (1.0, -1.0):
                    row = -side * forces[j]
                    row[6] += self.static[j]
                    yield j, row

    def chosen(self, senses, open_, sliding):
        """Forces and accelerations of the contacts in `open_` for a choice of their senses."""
        forces = np.array([senses[j] * self.kinetic[j] for j in range(2)])
        held = [j for j in open_ if senses[j] == 0]
        rest = self.w.T @ self.free @ self.y - self.mobility @ forces
        if held:
            forces[held] = np.linalg.solve(self.mobility[np.ix_(held, held)], rest[held])
        return forces, self.w.T @ self.free @ self.y - self.mobility @ forces

    def boxed(self, senses, open_, loose):
        """The choice in which loose contacts have |f| <= beta where held, else slide as they accelerate."""
        for choice in itertools.product((0, 1, -1), repeat=len(loose)):
            tried = senses.copy()
            tried[loose] = choice
            forces, rates = self.chosen(tried, open_, loose)
            fits = [
                abs(forces[j]) <= self.kinetic[j] if tried[j] == 0 else tried[j] * rates[j] >= 0.0
                for j in loose
            ]
            if all(fits):
                return tried, forces
        raise AssertionError("the box law has a solution")

    def released(self, open_, first, at_once):
        """The pattern when the contacts in `open_`, held at first, let go one by one, or all at once."""
        senses = self.sense.copy()
        senses[open_] = 0
        loose = list(first)
        while True:
            senses[[j for j in open_ if j not in loose]] = 0
            senses, forces = self.boxed(senses, open_, loose)
            share = {j: abs(forces[j]) / self.static[j] for j in open_ if j not in loose}
            over = [j for j in share if share[j] > 1.0]
            if not over:
                return senses
            loose += over if at_once else [max(over, key=share.__getitem__)]

    def settle(self, open_, first=()):
        """What follows an event in which these contacts are held or arrive, and `first` is released."""
        before = self.sense.copy()
        held = np.flatnonzero(np.isin(np.arange(2), open_))
        speeds = self.w.T @ self.y[2:4]
        self.y[2:4] -= (
            self.w[:, held] / self.r**2 @ np.linalg.solve(self.mobility[np.ix_(held, held)], speeds[held])
        )
        self.sense = self.released(open_, first, False)
        saved, self.sense = self.sense, before
        self.order |= bool((self.released(open_, first, True) != saved).any())
        self.sense = saved
        self.stops += (before != 0) & (saved == 0)
        self.turns += before * saved < 0

    def crossing(self, pattern, rest):
        """First event within a part of a step: time, contact; else (rest, None)."""
        powers = [self.y]
        for n in range(1, TERMS):
            powers.append(pattern.flow @ powers[-1] / n)
        best, which = rest, None
        for j, row in zip(pattern.contacts, pattern.rows, strict=True):
            terms = np.array([row @ power for power in powers])
            fresh = self.sense[j] != 0 and abs(terms[0]) < 1e-9
            series = np.polynomial.Polynomial(terms[1:] if fresh else terms)
            if series(best) < 0.0 <= series(0.0):
                best, which = brentq(series, 0.0, best, xtol=1e-15, rtol=1e-15), j
        scale = best ** np.arange(TERMS)
        return best, which, scale @ np.array(powers)

    def move(self, time, states):
        """Go through some states, (k, 7), the last of them `time` later."""
        self.stuck += time * (self.sense == 0)
        z = np.vstack((self.y[:2], states[:, :2])) @ self.w
        self.way += np.abs(np.diff(z, axis=0)).sum(axis=0)
        self.y = states[-1].copy()
        self.lowest, self.highest = (
            np.minimum(self.lowest, z.min(axis=0)),
            np.maximum(self.highest, z.max(axis=0)),
        )

    def advance(self, most):
        """Some steps of the grid up to the first one with events in it, but no more than `most`; how many."""
        pattern = self.pattern()
        states = pattern.ahead[:most] @ self.y
        over = np.flatnonzero((states @ pattern.rows.T <= 0.0).any(axis=1))
        free = int(over[0]) if over.size else len(states)
        if free:
            self.move(free * self.h, states[:free])
        if not over.size:
            return free
        self.events()
        return free + 1

    def events(self):
        """One step of the grid, with the events in it."""
        rest = self.h
        while rest > 0.0:
            pattern = self.pattern()
            time, which, y = self.crossing(pattern, rest)
            self.move(time, y[np.newaxis])
            rest -= time
            if which is None:
                return
            open_ = [j for j in range(2) if self.sense[j] == 0 or j == which]
            self.settle(open_, [which] if self.sense[which] == 0 else [])

    def march(self, cycles):
        left = GRID * cycles
        while left:
            left -= self.advance(left)
        self.y[4:6] = 1.0, 0.0


def locked(marcher, most):
    """March until the last states have come back three times in a row; the smallest period."""
    states = np.empty((0, 7))
    while len(states) < most:
        marcher.march(1)
        states = np.vstack((states, marcher.y))
        back = states[::-1]
        for p in 1 + np.flatnonzero(np.abs(back[1 : len(back) // 2] - back[0]).max(axis=1) < 1e-9):
            if np.abs(back[:3] - back[p : p + 3]).max() < 1e-9:
                return p
    raise AssertionError("no period")


#: Cells with one motion that returns, after a few periods or many.
PERIODIC = [
    Chain(0.8, 0.55, 1.5), Chain(0.88, 0.5, 1.5), Chain(0.36, 0.05, 1.5), Chain(0.92, 0.25, 2.0),
    Chain(0.88, 0.35, 2.0), Chain(0.28, 0.05, 1.5), Chain(0.5, 0.3, 1.5),
]  # fmt: skip


@pytest.mark.parametrize("chain", PERIODIC)
def test_periods(chain):
    """Period, stops, turns, shares stuck, ranges, and whether the order of release matters."""
    found = chain.cell()
    assert found.status == regimes.RESOLVED
    marcher = Marcher(chain)
    period = locked(marcher, 800)
    assert found.period == period
    marcher.clear()
    marcher.march(period)
    assert found.stops_per_cycle.values == pytest.approx(marcher.stops / period, rel=1e-6)
    assert found.turns_per_cycle.values == pytest.approx(marcher.turns / period, rel=1e-6)
    assert found.stuck_fraction.values == pytest.approx(marcher.stuck / (2.0 * math.pi * period), abs=1e-7)
    ranges = marcher.highest - marcher.lowest
    assert found.contact_peak_to_peak.values == pytest.approx(ranges, abs=1e-8)
    assert found.sliding_distance.values == pytest.approx(marcher.way / period, abs=1e-8)
    assert found.release_order == marcher.order
    assert (found.stops_per_cycle_error == 0.0).all()
    assert (found.stuck_fraction_error == 0.0).all()


def test_the_order_of_release_matters_in_some_of_them():
    assert {int(chain.cell().release_order) for chain in PERIODIC} == {0, 1}


#: Cells whose motion does not return within 512 cycles, and about how many more the marcher is given.
IRREGULAR = [Chain(0.8, 0.35, 2.0), Chain(0.52, 0.35, 2.0)]
TRANSIENT, MARCHED = 100, 1000


def batch_means(values):
    """Means over the cycles, and their standard errors from ten batches."""
    means = np.array([np.mean(batch, axis=0) for batch in np.array_split(np.array(values), 10)])
    return means.mean(axis=0), means.std(axis=0, ddof=1) / math.sqrt(10.0)


@pytest.mark.slow
@pytest.mark.parametrize("chain", IRREGULAR)
def test_averages(chain):
    """Means over 341 cycles, against those of another motion over 1000: within five errors."""
    found = chain.cell()
    assert (found.status, found.regime, found.period) == (regimes.IRREGULAR, regimes.STICK_SLIP, 0)
    assert found.cycles <= 1024
    marcher = Marcher(chain)
    marcher.march(TRANSIENT)
    rows, lowest, highest = [], math.inf, -math.inf
    for _ in range(MARCHED):
        marcher.clear()
        marcher.march(1)
        rows.append((marcher.stops, marcher.stuck / (2.0 * math.pi), marcher.turns, marcher.way))
        lowest, highest = np.minimum(lowest, marcher.lowest), np.maximum(highest, marcher.highest)
    (stops, stuck, turns, way), (stops_error, stuck_error, turns_error, way_error) = batch_means(rows)
    own = found.stops_per_cycle_error.values, found.stuck_fraction_error.values
    assert (np.array(own) > 0.0).all()
    assert (np.array(own) < 0.1).all()
    assert (np.abs(found.stops_per_cycle.values - stops) <= 5.0 * np.hypot(stops_error, own[0])).all()
    assert (np.abs(found.stuck_fraction.values - stuck) <= 5.0 * np.hypot(stuck_error, own[1])).all()
    shorter = math.sqrt(1000 / 341)  # errors of 341 cycles are this much larger
    for name, mean, error, edge in (
        ("turns_per_cycle", turns, turns_error, 0.01), ("sliding_distance", way, way_error, 0.0),
    ):  # fmt: skip
        off = np.abs(found[name].values - mean)
        assert (off <= 5.0 * error * math.hypot(shorter, 1.0) + edge).all(), name
    ranges = found.contact_peak_to_peak.values / (highest - lowest)
    assert ((ranges > 0.7) & (ranges < 1.1)).all()
    friction = chain.beta * np.array(chain.ratios)
    assert found.work_friction.values == pytest.approx(friction * found.sliding_distance.values, rel=1e-12)


def test_an_irregular_motion_in_time():
    """The last 8 periods of those followed, which obey both laws; averages are those of the map."""
    chain = IRREGULAR[0]
    found = chain.cell()
    ds = fm.response(chain.system(), chain.r, chain.beta, chain.mu)
    assert (ds.status, ds.period) == (regimes.IRREGULAR, 0)
    assert f"the last 8 of the {found.cycles.item()} periods" in ds.attrs["comment"]
    for name in OUTPUTS:
        assert ds[name].values == pytest.approx(found[name].values, rel=1e-12), name
    assert ds.tau[-1] == pytest.approx(16.0 * math.pi)
    z, direction = ds.z.values, ds.direction.values
    moved = np.diff(z, axis=1)
    for sense in (-1, 1):
        during = (direction[:, 1:] == sense) & (direction[:, :-1] == sense)
        assert (sense * moved[during] > 0.0).all()
    held = (direction[:, 1:] == 0) & (direction[:, :-1] == 0)
    assert np.abs(moved[held]).max() < 1e-12
    static = chain.mu * chain.beta * np.array(chain.ratios)[:, np.newaxis]
    assert (np.abs(ds.friction.values) <= static * (1.0 + 1e-12)).all()
    slides = direction != 0
    kinetic = np.broadcast_to(static / chain.mu, slides.shape)
    assert np.allclose((ds.friction.values * direction)[slides], kinetic[slides], rtol=1e-12)
    # momentum: the integral of the equation of motion over the window
    system, tau = chain.system(), ds.tau.values
    stiffness, w = np.array([[2.0, -1.0], [-1.0, 1.0]]), np.array([[1.0, -1.0], [0.0, 1.0]])
    forces = stiffness @ ds.x.values + w @ ds.friction.values - np.outer([1.0, 0.0], np.cos(tau))
    change = chain.r**2 * np.diff(ds.v.values[:, [0, -1]])[:, 0]
    change += chain.r * system.modes.damping @ np.diff(ds.x.values[:, [0, -1]])[:, 0]
    assert np.abs(change + np.trapezoid(forces, tau)).max() < 1e-3 * np.trapezoid(np.abs(forces), tau).max()
    assert np.isnan(ds.displacement_harmonic).all()
    assert np.isnan(ds.work_input)
    counted = [int(((ds.event_contact == k) & (ds.event_direction == 0)).sum()) for k in (1, 2)]
    stopped = [int(((direction[k, 1:] == 0) & (direction[k, :-1] != 0)).sum()) for k in (0, 1)]
    assert counted == stopped
    assert "irregular" in fm.plot_response(ds)[0].figure.get_suptitle()


def test_response_curves_of_an_irregular_motion():
    """Averages and ranges where the motion does not return; harmonics and phases are unknown there."""
    chain = IRREGULAR[0]
    found = chain.cell()
    ds = fm.curves(chain.system(), [0.3, chain.r], [chain.beta], [chain.mu]).isel(mu=0, beta=0)
    assert ds.status.values.tolist() == [regimes.RESOLVED, regimes.IRREGULAR]
    cell = ds.isel(r=1)
    known = ("contact_peak_to_peak", "peak_to_peak", "stops_per_cycle", "sliding_distance", "work_friction")
    for name in known:
        assert cell[name].values == pytest.approx(found[name].values, rel=1e-12), name
    unknown = ("first_harmonic_amplitude", "contact_harmonic", "work_input", "equivalent_damping")
    for name in unknown:
        assert np.isnan(cell[name]).all(), name
    assert np.isfinite(ds.isel(r=0).first_harmonic_amplitude).all()


def test_few_cycles_are_averaged_all_the_same():
    found = IRREGULAR[0].cell(cycles=60)
    assert (found.status, found.cycles) == (regimes.IRREGULAR, 60)
    assert (found.stops_per_cycle > 0.5).all()
    assert (found.stops_per_cycle_error > 0.0).all()


@pytest.mark.parametrize(("mu", "system"), [(1.0, IRREGULAR[0].system()), (2.0, None)])
def test_the_order_of_release_may_not_matter(mu, system):
    """mu = 1: one answer; walls of different masses: no force changes the load of another contact."""
    if system is None:
        walls = [fm.Contact("fixed-wall", k, ratio=ratio) for k, ratio in ((1, 1.0), (2, 0.6), (3, 0.4))]
        system = fm.System(
            contacts=walls, mass_ratios=[1.0] * 3, stiffness_ratios=[1.0] * 3, damping_ratios=0.02
        )
    r, beta = np.linspace(0.3, 1.4, 8), np.linspace(0.1, 0.58, 7)
    ds = fm.sweep(system, r, beta, [mu], outputs=["regime", "release_order"])
    assert (ds.regime == regimes.STICK_SLIP).sum() > 20
    assert (ds.release_order == 0).all()


def random_chain(rng):
    """A chain with two to four contacts, each mass with the wall or with the mass before it."""
    n = int(rng.integers(2, 6))
    every = [
        ("fixed-wall", (k,)) if k == 1 or rng.random() < 0.5 else ("between-masses", (k - 1, k))
        for k in range(1, n + 1)
    ]
    some = rng.permutation(n)[: int(rng.integers(2, min(n, 4) + 1))]
    return fm.System(
        contacts=[fm.Contact(*every[k], ratio=rng.uniform(0.2, 1.0)) for k in some],
        mass_ratios=[1.0, *rng.uniform(0.5, 2.0, n - 1)], load_mass=int(rng.integers(1, n + 1)),
        stiffness_ratios=[1.0, *rng.uniform(0.5, 2.0, n - 1)], damping_ratios=10.0 ** rng.uniform(-2.0, -1.0),
    )  # fmt: skip


def test_no_damped_cell_is_left_without_a_regime():
    rng = np.random.default_rng(3)
    seen = set()
    for _ in range(25):
        system, mu = random_chain(rng), float(rng.uniform(1.05, 2.0))
        r, beta = np.sort(rng.uniform(0.2, 2.5, 4)), np.sort(rng.uniform(0.05, 1.5, 4))
        ds = fm.sweep(system, r, beta, [mu], outputs=OUTPUTS)
        assert regimes.UNRESOLVED not in ds.regime
        assert ((ds.period > 0) == (ds.status == regimes.RESOLVED)).all()
        rests = ds.contact_regime == regimes.PERMANENT_STICKING
        assert (np.isnan(ds.stops_per_cycle) == rests).all()
        assert np.isfinite(ds.contact_peak_to_peak).all()
        assert (ds.cycles <= 1500).all()
        seen |= set(np.unique(ds.period).tolist())
    assert len(seen) > 3
