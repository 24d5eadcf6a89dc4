"""Slow and plain reference for the steady state of a structure with one Coulomb contact.

The equations of motion, with tau = omega t, ' = d/dtau, r the frequency ratio, G = diag(gamma), are

    r^2 G x'' + r C1 x' + K x + c f = p cos(tau),        z = c.x - b cos(tau),

f = beta sgn(z') while the contact slides, |f| <= mu beta while it sticks (z' = 0), and b = 1 for a
joined base-wall contact, 0 otherwise. Damping is modal, or any, and relative to the ground.

Each phase (slide up, slide down, stick) is an autonomous linear equation y' = A y for
y = (x, x', cos tau, sin tau, f), f being the sliding friction force and 0 in a stop. Powers of the
matrix exponential of one small step give z' (or, in a stop, the load) on a dense uniform grid by
one matrix product; the first change of sign is sought there, turning points inside a step included,
and is polished on the Taylor series of the exponential inside its step, which is exact to rounding
as a step is a small part of the fastest period. The only rules are

    a slide ends at the first zero of z'; there  |load| <= mu beta: stick,  else slide on with the
    sign of -load;  a stop ends when |load| first exceeds mu beta;

    load = m_eff (c.G^-1 (K x + r C1 x' - p cos tau) - r^2 b cos tau),   1/m_eff = c.G^-1 c,

which is minus the force that keeps z' = 0. Nothing else is assumed: no closed form of a motion, no
boundary curve, no symmetry. The motion is marched until its state repeats.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from math import ceil, cos, inf, log2, nan, pi, sin
from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh, expm, null_space
from scipy.optimize import brentq

PERIOD = 2.0 * pi
TERMS = 14  # terms of the Taylor series inside one step
EXPONENTS = np.arange(TERMS)
LONGEST_BLOCK = 1024  # grid steps that are tabulated; longer phases take several blocks
FIRST_SEARCH = 256  # grid steps looked at first; then four times as many, and so on
LONGEST_PERIOD = 8  # a steady state may repeat after so many excitation periods
SHORTEST_STOP = 1e-9  # a stop counts only if it lasts longer than this (in tau)
ROUNDING = 5e-14  # added to mu beta: a tie is not to be broken by rounding of the load


class NaiveResult(NamedTuple):
    """Steady state; see `naive_steady_state`."""

    status: str
    period: int
    stops: float
    Z: float
    stuck_fraction: float
    X: tuple[float, ...]
    residual: float
    cycles: int
    margin: float


class Segment(NamedTuple):
    """A slide or a stop, or the part of it inside one excitation period."""

    mode: int  # sign of z'; 0 in a stop
    start: np.ndarray
    end: np.ndarray
    length: float
    closed: bool  # ended by an event, not by the end of the excitation period


class Structure:
    """Matrices of the structure, its contact and its load at one frequency ratio."""

    def __init__(self, gamma, kappa, contact, load, zeta, r, damping=None):
        n = len(gamma)
        self.n, self.r = n, r
        self.mass = np.asarray(gamma, float)
        self.K = chain_stiffness(kappa)
        w2, phi = eigh(self.K, np.diag(self.mass))
        self.w = np.sqrt(w2)
        self.zeta = np.broadcast_to(np.asarray(zeta, float), (n,))
        momenta = self.mass[:, None] * phi
        modal = momenta @ np.diag(2.0 * self.zeta * self.w) @ momenta.T
        self.C1 = modal if damping is None else np.asarray(damping, float)
        self.c, self.base, load = contact_vector(contact, n, load)
        self.p = np.eye(n)[load - 1]
        self.m_eff = 1.0 / np.sum(self.c**2 / self.mass)

        size = 2 * n + 3
        x, v = slice(0, n), slice(n, 2 * n)
        ic, si, force = 2 * n, 2 * n + 1, 2 * n + 2  # cos tau, sin tau, friction
        slide = np.zeros((size, size))
        slide[x, v] = np.eye(n)
        slide[v, x] = -self.K / self.mass[:, None] / r**2
        slide[v, v] = -self.C1 / self.mass[:, None] / r
        slide[v, ic] = self.p / self.mass / r**2
        slide[v, force] = -self.c / self.mass / r**2
        slide[ic, si], slide[si, ic] = -1.0, 1.0

        self.z_row = np.zeros(size)
        self.z_row[x], self.z_row[ic] = self.c, -self.base
        self.velocity_row = np.zeros(size)
        self.velocity_row[v], self.velocity_row[si] = self.c, self.base
        free = self.velocity_row @ slide  # z'' = free.y
        free[force] = 0.0
        self.load_row = -self.m_eff * r**2 * free

        self.to_contact = self.c / self.mass * self.m_eff  # velocities that change z' by one
        stick = slide.copy()
        stick[v] -= np.outer(self.to_contact, free)
        stick[v, force] = 0.0
        self.slide, self.stick = slide, stick


def chain_stiffness(kappa: Sequence[float]) -> np.ndarray:
    """Stiffness matrix of a chain; spring i joins masses i - 1 and i, spring 1 the ground."""
    n = len(kappa)
    K = np.zeros((n, n))
    for i, k in enumerate(kappa):
        K[i, i] += k
        if i > 0:
            K[i - 1, i - 1] += k
            K[i - 1, i] -= k
            K[i, i - 1] -= k
    return K


def contact_vector(contact: Sequence, n: int, load: int) -> tuple[np.ndarray, float, int]:
    """Return c, the base motion in the contact, and the mass that the load acts on."""
    kind, *masses = contact
    unit = np.eye(n)
    if kind == "wall":
        return unit[masses[0] - 1], 0.0, load
    if kind == "masses":
        return unit[masses[1] - 1] - unit[masses[0] - 1], 0.0, load
    if kind == "base":
        return unit[masses[0] - 1], 1.0, 1
    raise ValueError(f"unknown contact {kind!r}")


class Flow:
    """y' = A y on a uniform grid of step h, and one watched quantity q = watch.y on it.

    Times inside a step are in units of h.
    """

    def __init__(self, A: np.ndarray, watch: np.ndarray, h: float, block: int):
        size = len(A)
        doublings = round(log2(block))
        leaps = expm(A * (h * 2.0 ** np.arange(doublings + 1))[:, None, None])
        self.h, self.block = h, block
        self.power = np.empty((block + 1, size, size))
        self.power[0] = np.eye(size)
        for j in range(doublings):
            m = 2**j
            self.power[m : 2 * m] = self.power[:m] @ leaps[j]
        self.power[block] = leaps[-1]
        self.taylor = np.empty((TERMS, size, size))
        self.taylor[0] = np.eye(size)
        for j in range(1, TERMS):
            self.taylor[j] = self.taylor[j - 1] @ A * (h / j)
        self.watch = watch
        self.watch_value = watch @ self.power
        self.watch_slope = watch @ self.taylor[1] @ self.power
        self.watch_taylor = watch @ self.taylor

    def at(self, y: np.ndarray, k: int, theta: float) -> np.ndarray:
        """State k + theta steps after y."""
        y = self.power[k] @ y
        return theta**EXPONENTS @ (self.taylor @ y) if theta else y

    def first_zero(
        self,
        y: np.ndarray,
        steps: int,
        sides: tuple[int, ...],
        offset: float,
        fresh: bool,
        slope: float | None = None,
    ) -> tuple[int, float, int] | None:
        """First zero of offset + side q, for any of the sides, within the given number of steps of y.

        fresh: it is zero at the start by construction; slope: its slope there (a step) if known.
        Returns (k, theta, side): the zero is k + theta steps after y.
        """
        q = self.watch_value[: steps + 1] @ y
        g = offset + sides[0] * q if len(sides) == 1 else offset - np.abs(q)
        last = int(np.argmax(g[1:] <= 0.0)) + 1
        crossed = g[last] <= 0.0
        last = last if crossed else steps
        suspects = self.dips(y, g[: last + 1])
        if fresh or g[0] <= 0.0:
            suspects.append(0)
        if crossed:
            suspects.append(last - 1)
        for k in sorted(set(suspects)):
            series = self.watch_taylor @ (self.power[k] @ y)
            found = []
            for side in sides:
                a = (side * series).tolist()
                a[0] += offset
                if k == 0:
                    a[0] = 0.0 if fresh else max(a[0], 0.0)
                    a[1] = a[1] if slope is None else slope
                theta = zero_in_step(a)
                if theta is None and crossed and k == last - 1 and offset + side * q[last] <= 0.0:
                    theta = 1.0  # within rounding of the node
                if theta is not None:
                    found.append((k, theta, side))
            if found:
                return min(found)
        return None

    def dips(self, y: np.ndarray, g: np.ndarray) -> list[int]:
        """Steps in which g = offset -+ q, positive at both ends, may fall to zero and return."""
        rate = self.watch_slope[: len(g)] @ y
        turns = np.flatnonzero(rate[:-1] * rate[1:] < 0.0).tolist()
        depth = [2.0 * max(abs(rate[k]), abs(rate[k + 1])) for k in turns]
        return [k for k, deep in zip(turns, depth, strict=True) if min(g[k], g[k + 1]) <= deep]

    def turning_points(self, y: np.ndarray, row: np.ndarray, end: float) -> Iterator[float]:
        """Values of row.y where it is stationary, strictly inside `end` steps."""
        steps = ceil(end)
        slope_row = row @ self.taylor[1]
        rate = np.empty(steps + 1)
        if row is self.watch:
            rate[:-1] = self.watch_slope[:steps] @ y
        else:
            rate[:-1] = self.power[:steps] @ y @ slope_row
        rate[-1] = slope_row @ self.at(y, steps - 1, end - (steps - 1))
        rate[np.abs(rate) <= 1e-12 * np.max(np.abs(rate))] = 0.0  # zero by construction
        for k in np.flatnonzero(rate[:-1] * rate[1:] < 0.0):
            a = (row @ (self.taylor @ (self.power[k] @ y)).T).tolist()
            slope, last = polynomial(derivative(a)), min(1.0, end - k)
            # the series may round to no change of sign where the turn is at a node
            turn = brentq(slope, 0.0, last) if slope(0.0) * slope(last) < 0.0 else 0.0
            yield polynomial(a)(turn)
        for k in np.flatnonzero(rate[1:-1] == 0.0):
            yield float(row @ (self.power[k + 1] @ y))


def derivative(a: Sequence[float]) -> list[float]:
    """Coefficients of the derivative of sum a_j t^j."""
    return [j * coefficient for j, coefficient in enumerate(a)][1:]


def polynomial(a: Sequence[float]) -> Callable[[float], float]:
    """Return the function sum a_j t^j."""
    falling = a[::-1]

    def value(t: float) -> float:
        total = 0.0
        for coefficient in falling:
            total = total * t + coefficient
        return total

    return value


def zero_in_step(a: list[float]) -> float | None:
    """First t in [0, 1] where g = sum a_j t^j, not negative at 0, falls to zero; None if nowhere.

    A zero at t = 0 counts only if g falls from there.
    """
    size = [abs(coefficient) for coefficient in a]
    leading = next((j for j, coefficient in enumerate(size) if coefficient > 0.0), 0)
    if a[leading] > sum(size[leading + 1 :]):
        return None  # g > 0 for 0 < t <= 1
    g, slope, steepness = polynomial(a), derivative(a), derivative(size)
    if a[0] > 0.0 and -slope[0] > sum(steepness[1:]):  # g' < 0 throughout
        return brentq(g, 0.0, 1.0, xtol=1e-15) if g(1.0) <= 0.0 else None
    while slope and abs(slope[-1]) <= 1e-20 * max(size):
        slope.pop()
    roots = np.roots(slope[::-1])
    turns = roots.real[(np.abs(roots.imag) < 1e-6) & (roots.real > 0.0) & (roots.real < 1.0)]
    left = 0.0
    for t in [*np.sort(turns).tolist(), 1.0]:
        if g(t) <= 0.0:
            return brentq(g, left, t, xtol=1e-15) if g(left) > 0.0 else left
        left = t
    return None


class Motion:
    """March of one cell, one excitation period at a time."""

    def __init__(self, structure: Structure, beta: float, mu: float, points: int):
        self.s, self.beta = structure, beta
        self.hold = mu * beta + ROUNDING
        fastest = max(
            1.0, *(np.max(np.abs(np.linalg.eigvals(A))) for A in (structure.slide, structure.stick))
        )
        h = float(PERIOD / (points * fastest))
        block = 2 ** ceil(log2(min(ceil(PERIOD / h) + 1, LONGEST_BLOCK)))
        self.sliding = Flow(structure.slide, structure.velocity_row, h, block)
        self.sticking = Flow(structure.stick, structure.load_row, h, block)
        self.release_slope = (mu - 1.0) * beta * h / (structure.m_eff * structure.r**2)
        self.most_events = 1000 + ceil(20 * fastest)

    def begin(self, x: np.ndarray, v: np.ndarray) -> None:
        """Set the state at tau = 0."""
        self.y = np.concatenate([x, v, [1.0, 0.0, 0.0]])
        self.tau = 0.0
        velocity = float(self.s.velocity_row @ self.y)
        self.fresh, self.slope = velocity == 0.0, None
        self.enter(self.decide() if self.fresh else int(np.sign(velocity)))

    def decide(self) -> int:
        """Mode that follows a zero of z'."""
        load = float(self.s.load_row @ self.y)
        return 0 if abs(load) <= self.hold else -int(np.sign(load))

    def enter(self, mode: int) -> None:
        """Start a phase; z' is made exactly zero if it begins from there."""
        self.mode = mode
        if self.fresh:
            n = self.s.n
            self.y[n : 2 * n] -= self.s.to_contact * (self.s.velocity_row @ self.y)
        self.y[-1] = self.beta * mode

    def period(self) -> list[Segment] | None:
        """March from tau = 0 to 2 pi; None if the events do not come to an end."""
        self.tau = 0.0
        self.y[-3:-1] = 1.0, 0.0
        segments: list[Segment] = []
        while len(segments) < self.most_events:
            segment = self.phase()
            segments.append(segment)
            if not segment.closed:
                return segments
        return None

    def phase(self) -> Segment:
        """March to the end of the present phase, or of the period if that comes first."""
        mode, start, since = self.mode, self.y.copy(), self.tau
        flow = self.sliding if mode else self.sticking
        reach = min(FIRST_SEARCH, flow.block)
        while True:
            left = (PERIOD - self.tau) / flow.h
            steps = min(ceil(left), reach)
            event = self.first_event(flow, steps) if steps else None
            self.fresh, self.slope = False, None
            if event is not None and event[0] + event[1] < left:
                break
            if left <= reach:  # the period ends first
                self.y = flow.at(self.y, int(left), left - int(left)) if left > 0.0 else self.y
                self.tau = PERIOD
                return Segment(mode, start, self.y.copy(), self.tau - since, False)
            self.move(flow, reach, 0.0)
            reach = min(4 * reach, flow.block)
        k, theta, side = event
        self.move(flow, k, theta)
        end = self.y.copy()
        self.fresh = True
        if mode:
            self.enter(self.decide())
        else:  # hold + side load reached zero: the load has the sign of -side
            self.slope = self.release_slope
            self.enter(side)
        return Segment(mode, start, end, self.tau - since, True)

    def first_event(self, flow: Flow, steps: int) -> tuple[int, float, int] | None:
        """First zero of z' in a slide; first time that |load| exceeds mu beta in a stop."""
        if self.mode:
            return flow.first_zero(self.y, steps, (self.mode,), 0.0, self.fresh, self.slope)
        return flow.first_zero(self.y, steps, (1, -1), self.hold, False)

    def move(self, flow: Flow, k: int, theta: float) -> None:
        """Let k + theta steps pass."""
        self.y = flow.at(self.y, k, theta)
        self.tau += (k + theta) * flow.h
        self.y[-3:-1] = cos(self.tau), sin(self.tau)

    def state(self) -> np.ndarray:
        """Displacements and velocities."""
        return self.y[:-3].copy()


class Held:
    """The structure with z' = 0 held permanently: the largest load that it will ever have."""

    def __init__(self, s: Structure):
        n = s.n
        self.s = s
        kkt = np.zeros((n + 1, n + 1), complex)
        kkt[:n, :n] = s.K - s.r**2 * np.diag(s.mass) + 1j * s.r * s.C1
        kkt[:n, n] = kkt[n, :n] = s.c
        try:
            self.steady = np.linalg.solve(kkt, np.append(s.p, s.base))
        except np.linalg.LinAlgError:
            self.steady = np.full(n + 1, inf, complex)
        kkt[:n, :n] = s.K
        self.offset = np.linalg.solve(kkt.real, np.append(np.zeros(n), 1.0))
        across = null_space(s.c[None])
        w2, modes = eigh(across.T @ s.K @ across, across.T @ (s.mass[:, None] * across))
        self.w, self.modes = np.sqrt(w2), across @ modes
        load = s.m_eff * s.c / s.mass
        self.spring, self.damper = load @ s.K @ self.modes, load @ s.C1 @ self.modes
        self.undamped = not np.any(s.C1)

    def largest_load(self, y: np.ndarray) -> float:
        """Bound of |load| for the motion held from y, a state at tau = 0 in a stop.

        A constant, a harmonic, and the free vibration of the held modes: undamped, their amplitudes
        add up in the end; damped, the energy does not grow.
        """
        n = self.s.n
        if not np.all(np.isfinite(self.steady)):
            return inf
        z = float(self.s.z_row @ y)
        x = y[:n] - self.steady[:n].real - z * self.offset[:n]
        v = y[n : 2 * n] + self.steady[:n].imag
        shape = self.modes.T * self.s.mass
        q, dq = self.w * (shape @ x), self.s.r * (shape @ v)
        if self.undamped:
            free = np.abs(self.spring / self.w) @ np.hypot(q, dq)
        else:
            per_energy = np.sum((self.spring / self.w) ** 2 + self.damper**2)
            free = np.sqrt(per_energy * np.sum(q**2 + dq**2))
        return float(abs(self.steady[n]) + abs(z * self.offset[n]) + free)


class History:
    """States at tau = 0 mod 2 pi, and the test whether they repeat."""

    def __init__(self, tol: float):
        self.tol = tol
        self.states: deque[np.ndarray] = deque(maxlen=LONGEST_PERIOD + 1)
        self.residuals: deque[np.ndarray] = deque(maxlen=LONGEST_PERIOD + 1)

    def add(self, state: np.ndarray) -> None:
        self.states.append(state)
        changes = np.full(LONGEST_PERIOD, inf)
        before = np.array(self.states)[-2::-1]
        changes[: len(before)] = np.max(np.abs(before - state), axis=1, initial=0.0)
        self.residuals.append(changes)

    def residual(self, q: int) -> float:
        """Largest change of the state over the last q periods."""
        return float(self.residuals[-1][q - 1])

    def settled(self, q: int) -> bool:
        """Whether the remainder of a geometric approach to period q is within bounds."""
        now = self.residual(q)
        if now > self.tol:
            return False
        if now <= 1e-14 * max(1.0, np.max(np.abs(self.states[-1]))):
            return True  # rounding
        past = [res[q - 1] for res in self.residuals if np.isfinite(res[q - 1])]
        window = len(past) - 1
        if window < 1:
            return False
        rho = (now / past[0]) ** (q / window)
        return rho < 1.0 and now * rho / (1.0 - rho) <= self.tol

    def period(self) -> int:
        """Smallest period the states repeat with, 0 if none.

        A period above one is believed only if the states clearly do not repeat any sooner.
        """
        for q in range(1, LONGEST_PERIOD + 1):
            if self.settled(q):
                return q
            if self.residual(q) <= 1e3 * self.tol:
                return 0
        return 0


def phase_durations(segments: list[Segment]) -> list[tuple[int, float]]:
    """(mode, duration) of the segments of a closed cycle, with the parts of one segment joined."""
    phases: list[list] = []
    open_end = False
    for segment in segments:
        if open_end and segment.mode == phases[-1][0]:
            phases[-1][1] += segment.length
        else:
            phases.append([segment.mode, segment.length])
        open_end = not segment.closed
    if open_end and len(phases) > 1 and phases[0][0] == phases[-1][0]:
        phases[0][1] += phases.pop()[1]
    return [(mode, duration) for mode, duration in phases]


def blocks(flow: Flow, segment: Segment) -> Iterator[tuple[np.ndarray, float]]:
    """Cut a segment into intervals that the table covers: (state, length in steps)."""
    y, left = segment.start, segment.length / flow.h
    while left > 0.0:
        yield y, min(left, flow.block)
        y, left = flow.power[flow.block] @ y, left - flow.block


def turning_points(motion: Motion, segment: Segment, row: np.ndarray) -> list[float]:
    """Stationary values of row.y inside a segment."""
    flow = motion.sliding if segment.mode else motion.sticking
    return [value for y, end in blocks(flow, segment) for value in flow.turning_points(y, row, end)]


def tie_distance(motion: Motion, segments: list[Segment]) -> float:
    """The `margin` of `naive_steady_state`."""
    s = motion.s
    distances = [duration for mode, duration in phase_durations(segments) if mode == 0]
    speeds: list[float] = []
    for segment in segments:
        if segment.mode:
            speeds += turning_points(motion, segment, s.velocity_row)
            if segment.closed:
                distances.append(abs(abs(float(s.load_row @ segment.end)) - motion.hold))
        else:
            loads = turning_points(motion, segment, s.load_row)
            distances += [abs(abs(load) - motion.hold) for load in loads]
            if segment.length == PERIOD:
                distances.append(abs(abs(float(s.load_row @ segment.end)) - motion.hold))
    if speeds:
        distances.append(min(map(abs, speeds)) / max(map(abs, speeds)))
    return min(distances, default=inf)


def measure(motion: Motion, segments: list[Segment], periods: int) -> dict:
    """Results of the given number of excitation periods."""
    s = motion.s
    ends = np.array([y for segment in segments for y in (segment.start, segment.end)])
    X = []
    for k, row in enumerate(np.eye(ends.shape[1])[: s.n]):
        turns = [value for seg in segments for value in turning_points(motion, seg, row)]
        X.append(float(np.max(np.abs([*turns, *ends[:, k]]))))
    phases = phase_durations(segments)
    stops = [duration for mode, duration in phases if mode == 0]
    begun = sum(duration > SHORTEST_STOP for duration in stops) if len(phases) > 1 else 0
    return {
        "stops": begun / periods,
        "Z": float(np.max(np.abs(ends @ s.z_row))),
        "stuck_fraction": sum(stops) / (PERIOD * periods),
        "X": tuple(X),
    }


def starting_state(s: Structure, start) -> tuple[np.ndarray, np.ndarray]:
    """Displacements and velocities at tau = 0; "rest" is z = z' = 0, every mass at rest."""
    if isinstance(start, str):
        if start != "rest":
            raise ValueError(f"unknown start {start!r}")
        return s.base * s.c, np.zeros(s.n)
    x, v = (np.array(part, float) for part in start)
    if x.shape != (s.n,) or v.shape != (s.n,):
        raise ValueError("start needs one displacement and one velocity per mass")
    return x, v


def naive_steady_state(
    *,
    gamma: Sequence[float] = (1.0,),
    kappa: Sequence[float] = (1.0,),
    contact: Sequence = ("wall", 1),
    load: int = 1,
    zeta: float | Sequence[float] = 0.0,
    damping: np.ndarray | None = None,
    r: float,
    beta: float,
    mu: float = 1.0,
    start="rest",
    cycles: int = 400,
    tol: float = 1e-11,
    points: int = 400,
) -> NaiveResult:
    """Steady state of a chain of masses with one contact.

    contact: ("wall", j), ("masses", A, B) or ("base", j), masses counted from 1; zeta: of every
    mode, or one for each mode by ascending frequency; damping: in its place any matrix C1; start:
    "rest" or (x, x') at tau = 0; points: grid steps per period of the fastest part of the motion.

    status   "ok"; "stuck" (it never moves again; Z is then the offset of z); "unconverged"
             (after `cycles` periods; the rest is that of the last one; period is 0)
    period   in excitation periods
    stops    stops that begin per excitation period; one that is not longer than 1e-9 is not counted
    residual largest change of the state (x, x') after one period of the motion
    margin   distance to a tie, the smallest of: ||load| - mu beta| at the zeros of z' that end a
             slide; the same at the turning points of the load in a stop; the smallest turning
             value of |z'| in a slide over the largest; the shortest stop. It is that of the steady
             motion for mu = 1, where the way there does not matter, and of the whole march,
             its start included, for mu > 1 and where the contact ends up stuck
    """
    if not (r > 0.0 and beta >= 0.0 and mu >= 1.0 and points >= 24):
        raise ValueError("needs r > 0, beta >= 0, mu >= 1, points >= 24")
    s = Structure(gamma, kappa, contact, load, zeta, r, damping)
    motion = Motion(s, beta, mu, points)
    motion.begin(*starting_state(s, start))
    held = Held(s)
    certain = motion.mode == 0 and held.largest_load(motion.y) <= motion.hold
    first_tie = abs(abs(float(s.load_row @ motion.y)) - motion.hold) if motion.fresh else inf
    history = History(tol)
    history.add(motion.state())
    march: list[list[Segment]] = []

    def result(status: str, period: int) -> NaiveResult:
        periods = max(period, 1)
        window = [segment for part in march[-periods:] for segment in part]
        if mu > 1.0 or status == "stuck":
            margin = min(first_tie, tie_distance(motion, [seg for part in march for seg in part]))
        else:
            margin = tie_distance(motion, window)
        return NaiveResult(
            status,
            period,
            residual=history.residual(periods),
            cycles=len(march),
            margin=margin,
            **measure(motion, window, periods),
        )

    for _ in range(cycles):
        segments = motion.period()
        if segments is None:
            lost = (nan,) * s.n
            return NaiveResult("unconverged", 0, nan, nan, nan, lost, nan, len(march), 0.0)
        march.append(segments)
        history.add(motion.state())
        period = history.period()
        if all(segment.mode == 0 for segment in segments):
            if certain or period == 1 or held.largest_load(motion.y) <= motion.hold:
                return result("stuck", 1)
        elif period:
            return result("ok", period)
    return result("unconverged", 0)
