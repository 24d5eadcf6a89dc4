"""scipy.integrate.solve_ivp: explicit Runge-Kutta pairs with events, at tolerances usual for this problem."""

import math
from importlib import import_module

import numpy as np

from .body import SLIDE_END, Body
from .chain import ChainPeer
from .contacts import ContactBody, ContactCell, ContactPeer
from .one_mass import OneMassPeer
from .peer import Peer
from .periodic_load import HarmonicsPeer
from .switching import Event, SwitchingPeer, held_projections

#: Longest step while nothing moves, in phases of the highest harmonic [rad].
REST_STEP = 0.2


def peer(body: Body, **settings) -> Peer:
    """Solver for a body."""
    return (OneMassSolveIvp if body.masses == 1 else ChainSolveIvp)(body, **settings)


def contact_peer(body: ContactBody, **settings) -> ContactPeer:
    """Solver for a body under a periodic load: one mass, or any number of masses and contacts."""
    return (HarmonicsSolveIvp if body.masses == 1 else ContactsSolveIvp)(body, **settings)


def slide_end(row, sign):
    """Return the terminal event that ends a slide of this sign; `row`: position of z' in the state."""

    def velocity(_theta, y):
        return sign * y[row] - SLIDE_END

    velocity.terminal = True
    velocity.direction = -1
    return velocity


class OneMassSolveIvp(OneMassPeer):
    """scipy.integrate.solve_ivp, RK45: a slide ends at the terminal event z' = 0 with direction.

    Its event search only sees sign changes between the ends of steps. An event at exactly z' = 0 would also
    be true at the start. If rounding sends the first step in the wrong direction, the slide would then end
    where it began, in an infinite loop. The event therefore has the same offset of 1e-13 as below.
    """

    name = "solve_ivp RK45"
    package = "scipy"
    rtol = 1e-6
    atol = 1e-12

    def __init__(self, body: Body, method="RK45", rtol=rtol, atol=atol):
        super().__init__(body)
        self.method, self.rtol, self.atol = method, rtol, atol
        self.solve = import_module("scipy.integrate").solve_ivp
        self.events = {sign: slide_end(1, sign) for sign in (1, -1)}

    def prepare(self, amplitude, r, beta):
        """Take the numbers of one cell, divided by the inertia."""
        self.drive = amplitude / r**2
        self.stiffness = 1 / r**2
        self.damping = 2 * self.body.zeta / r
        self.friction = beta / r**2

    def motion(self, sign):
        """Return the right-hand side for a slide of this sign."""
        drive, stiffness, damping = self.drive, self.stiffness, self.damping
        friction, cos = sign * self.friction, math.cos

        def rate(theta, y):
            z, v = y.tolist()
            return v, drive * cos(theta) - damping * v - stiffness * z - friction

        return rate

    def slide(self, theta, z, v, sign, end):
        """Integrate one slide."""
        answer = self.solve(
            self.motion(sign), (theta, end), (z, v), method=self.method,
            rtol=self.rtol, atol=self.atol, events=self.events[sign],
        )  # fmt: skip
        if answer.status < 0:
            raise RuntimeError(f"solve_ivp: {answer.message}")
        theta, z, v = answer.t[-1].item(), answer.y[0, -1].item(), answer.y[1, -1].item()
        return theta, z, (0.0 if answer.status == 1 else v)


class ChainSolveIvp(ChainPeer):
    """scipy.integrate.solve_ivp with terminal events, in displacements and velocities of the masses.

    DOP853 is the faster of the explicit pairs (RK45 takes three times as long at the same tolerance).
    """

    name = "solve_ivp DOP853"
    package = "scipy"
    rtol = 1e-9
    atol = 1e-12

    def __init__(self, body: Body, method="DOP853", rtol=rtol, atol=atol):
        super().__init__(body)
        self.method, self.rtol, self.atol = method, rtol, atol
        self.solve = import_module("scipy.integrate").solve_ivp

    def prepare(self, r, beta, mu):
        """Take the numbers of one cell, divided by the inertia, and start from rest."""
        super().prepare(r, beta, mu)
        n = self.n
        self.friction = beta / r**2
        self.drive = np.zeros(2 * n)
        self.drive[n + self.load] = 1.0 / r**2
        self.flow = np.zeros((2 * n, 2 * n))
        self.flow[:n, n:] = np.eye(n)
        self.flow[n:, :n] = -self.stiffness / r**2
        self.flow[n:, n:] = -self.damping / r
        # in a stop the mass in contact has no acceleration
        self.held, self.held_drive = self.flow.copy(), self.drive.copy()
        self.held[self.rate] = 0.0
        self.held_drive[self.rate] = 0.0
        self.slide_ends = {sign: slide_end(self.rate, sign) for sign in (1, -1)}
        self.releases = [self.release(sign, mu * beta) for sign in (1, -1)]

    def release(self, sign, limit):
        """Return the terminal event that ends a stop and starts a slide of this sign."""
        row, drive, cos = self.row, self.contact_drive, math.cos

        def excess(theta, y):
            return sign * (row @ y + drive * cos(theta)) - limit

        excess.terminal = True
        excess.direction = 1
        return excess

    def motion(self, flow, drive, constant):
        """Return the right-hand side flow y + drive cos(theta) + constant."""
        cos, row = math.cos, self.rate

        def rate(theta, y):
            answer = flow @ y
            answer += drive * cos(theta)
            answer[row] += constant
            return answer

        return rate

    def integrate(self, theta, end, motion, events):
        """Integrate to an event or to `end`; phase, and index of the event or None."""
        answer = self.solve(
            motion,
            (theta, end),
            self.state,
            method=self.method,
            rtol=self.rtol,
            atol=self.atol,
            events=events,
        )
        if answer.status < 0:
            raise RuntimeError(f"solve_ivp: {answer.message}")
        self.state = answer.y[:, -1].copy()
        found = [k for k, times in enumerate(answer.t_events) if times.size] if answer.status == 1 else [None]
        return answer.t[-1].item(), found[0]

    def slide(self, theta, sign, end):
        """Integrate one slide."""
        motion = self.motion(self.flow, self.drive, -sign * self.friction)
        theta, event = self.integrate(theta, end, motion, [self.slide_ends[sign]])
        if event is not None:
            self.state[self.rate] = 0.0
        return theta, event is not None

    def stop(self, theta, end):
        """Integrate one stop."""
        motion = self.motion(self.held, self.held_drive, 0.0)
        theta, event = self.integrate(theta, end, motion, self.releases)
        return theta, (0 if event is None else (1, -1)[event])


class HarmonicsSolveIvp(HarmonicsPeer):
    """scipy.integrate.solve_ivp for one mass under several harmonics, with the event of `OneMassSolveIvp`."""

    name = "solve_ivp DOP853"
    package = "scipy"

    def __init__(self, body: ContactBody, method="DOP853", rtol=1e-9, atol=1e-12):
        super().__init__(body)
        self.settings = {"method": method, "rtol": rtol, "atol": atol}
        self.solve = import_module("scipy.integrate").solve_ivp
        self.events = {sign: slide_end(1, sign) for sign in (1, -1)}

    def prepare(self, r, beta):
        """Take the numbers of one cell, divided by the inertia."""
        self.stiffness = 1 / r**2
        self.damping = 2 * self.body.zeta / r
        self.friction = beta / r**2

    def slide(self, theta, z, v, sign, end):
        """Integrate one slide."""
        stiffness, damping, friction, load = self.stiffness, self.damping, sign * self.friction, self.load

        def rate(theta, y):
            z, v = y.tolist()
            return v, stiffness * (load(theta) - z) - damping * v - friction

        answer = self.solve(rate, (theta, end), (z, v), events=self.events[sign], **self.settings)
        if answer.status < 0:
            raise RuntimeError(f"solve_ivp: {answer.message}")
        theta, z, v = answer.t[-1].item(), answer.y[0, -1].item(), answer.y[1, -1].item()
        return theta, z, (0.0 if answer.status == 1 else v)


class ContactsSolveIvp(SwitchingPeer):
    """scipy.integrate.solve_ivp for several contacts: a phase ends at the first of its terminal events.

    The events of a phase are the ends of its slides, and two limits of every held contact.  Where held
    contacts leave nothing to move, the solver would step over whole periods of the load: its steps are
    limited there.
    """

    name = "solve_ivp DOP853"
    package = "scipy"

    def __init__(self, body: ContactBody, method="DOP853", rtol=1e-9, atol=1e-12):
        super().__init__(body)
        self.settings = {"method": method, "rtol": rtol, "atol": atol}
        self.solve = import_module("scipy.integrate").solve_ivp

    def prepare(self, cell: ContactCell):
        """Take the numbers of one cell; phases are made when a motion first visits them."""
        super().prepare(cell)
        self.phases: dict = {}

    def make_phase(self, senses):
        """Right-hand side, its terminal events, their meanings, and the longest step."""
        n, r, load = self.n, self.r, self.load
        held = [j for j, sense in enumerate(senses) if sense == 0]
        projection, forces = held_projections(self.w[:, held])
        pull = np.hstack((-self.stiffness, -r * self.damping))  # forces without those of held contacts
        drive = np.eye(n)[0]
        constant = -(self.w @ (self.beta * senses))
        flow = np.zeros((2 * n, 2 * n))
        flow[:n, n:] = np.eye(n)
        flow[n:] = projection @ pull / r**2
        driven, pushed = np.zeros(2 * n), np.zeros(2 * n)
        driven[n:], pushed[n:] = projection @ drive / r**2, projection @ constant / r**2

        def rate(theta, y):
            return flow @ y + driven * load(theta) + pushed

        events, meanings = [], []
        for j, sense in enumerate(senses):
            if sense:
                events.append(self.end_of_slide(j, sense))
                meanings.append(Event(j, 0))
        rows = zip(forces @ pull, forces @ drive, forces @ constant, strict=True)
        for j, (row, by_load, offset) in zip(held, rows, strict=True):
            for sign in (1, -1):
                events.append(self.release(j, sign, row, float(by_load), float(offset)))
                meanings.append(Event(j, sign))
        longest = REST_STEP / max(self.body.load) if len(held) == n else math.inf
        return rate, events, meanings, longest

    def end_of_slide(self, j, sense):
        """Terminal event that ends the slide of contact j."""
        n, w = self.n, self.w[:, j]

        def velocity(_theta, y):
            return sense * (w @ y[n:]) - SLIDE_END

        velocity.terminal = True
        velocity.direction = -1
        return velocity

    def release(self, j, sign, row, by_load, offset):
        """Terminal event that releases contact j in a direction; its force is linear in the state."""
        limit, load = self.beta[j], self.load

        def excess(theta, y):
            return sign * (row @ y + by_load * load(theta) + offset) - limit

        excess.terminal = True
        excess.direction = 1
        return excess

    def advance(self, theta, end):
        """Integrate one phase."""
        key = tuple(self.senses)
        if key not in self.phases:
            self.phases[key] = self.make_phase(key)
        rate, events, meanings, longest = self.phases[key]
        answer = self.solve(rate, (theta, end), self.state, events=events, max_step=longest, **self.settings)
        if answer.status < 0:
            raise RuntimeError(f"solve_ivp: {answer.message}")
        self.state = answer.y[:, -1].copy()
        found = [k for k, times in enumerate(answer.t_events) if times.size] if answer.status == 1 else []
        return answer.t[-1].item(), (meanings[found[0]] if found else None)
