"""The two general-purpose ODE solvers of `peers` on a chain of masses with one Coulomb contact.

    r^2 M x'' + r C1 x' + K x + c f = e_l cos(theta),        f = beta sgn(z') in a slide,  z = c.x

The end of a stop has no closed form here, as the other masses swing on: the linear equations with the mass
in contact held are integrated too, to the event |f| = mu beta.  The peers are told how many periods to march,
and how long the steady period is.  The velocity in the contact is made exactly zero where a slide ends; the
offset of that event, -1e-13, is explained in `peers.HeyokaPeer`.
"""

import math
from importlib import import_module
from typing import NamedTuple

import numpy as np

from .one_mass import MAX_PHASES, SLIDE_END, TWO_PI, Installed, Outcome

#: A stop shorter than this is not counted: what is left of one that rounding makes.
SHORTEST_STOP = 1e-9


class Chain(NamedTuple):
    """Equal masses and springs; contact of one mass with a wall, load on one mass, modal damping."""

    masses: int
    contact: int
    load: int
    zeta: float


def matrices(chain: Chain) -> tuple[np.ndarray, np.ndarray]:
    """K and C1 of a chain with M = 1, by numpy alone."""
    n = chain.masses
    stiffness = 2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    stiffness[-1, -1] = 1.0
    squares, phi = np.linalg.eigh(stiffness)
    return stiffness, (phi * (2.0 * chain.zeta * np.sqrt(squares))) @ phi.T


class StructurePeer(Installed):
    """A solver under test.  A subclass integrates one slide and one stop.

    `slide(theta, sign, end)` and `stop(theta, end)` change `self.state`; they return the phase of the load
    and True, or the sign of the next slide, if it ended by itself; False, or 0, if `end` came first.
    """

    def __init__(self, chain):
        self.n, self.contact, self.load = chain.masses, chain.contact - 1, chain.load - 1
        self.rate = self.n + self.contact  # place of z' in the state
        self.stiffness, self.damping = matrices(chain)
        self.contact_drive = float(self.contact == self.load)

    def run(self, r, beta, mu, cycles, periods):
        """March `cycles` excitation periods from rest; stops a cycle and max |z| of the last `periods`."""
        self.prepare(r, beta, mu)
        limit = mu * beta
        theta, sign = 0.0, 0
        push = self.force(0.0)
        if abs(push) > limit:
            sign = 1 if push > 0.0 else -1
        began = 0.0  # of the stop that lasts; one that began before the window is not counted
        stops, peak = 0, 0.0
        for first, end in (
            (0.0, TWO_PI * (cycles - periods)),
            (TWO_PI * (cycles - periods), TWO_PI * cycles),
        ):
            stops, peak = 0, abs(self.place())
            for _ in range(MAX_PHASES):
                if theta >= end:
                    break
                if sign:
                    theta, ended = self.slide(theta, sign, end)
                    peak = max(peak, abs(self.place()))
                    if ended:
                        push = self.force(theta)
                        if abs(push) > limit:
                            sign = 1 if push > 0.0 else -1
                        else:
                            sign, began = 0, theta
                else:
                    theta, sign = self.stop(theta, end)
                    stops += sign != 0 and began >= first and theta - began > SHORTEST_STOP
            else:
                raise RuntimeError(f"{MAX_PHASES} phases without reaching the end of the run")
            stops += sign == 0 and began >= first
        return Outcome(stops / periods, peak)

    def prepare(self, r, beta, mu):
        """Take the numbers of one cell, and start from rest."""
        self.state = np.zeros(2 * self.n)
        self.row = -np.concatenate((self.stiffness[self.contact], r * self.damping[self.contact]))

    def place(self):
        """Return z."""
        return self.state[self.contact].item()

    def force(self, theta):
        """Return the force f that keeps z' = 0."""
        return float(self.row @ self.state) + self.contact_drive * math.cos(theta)


# ---------------------------------------------------------------- scipy


class SolveIvpPeer(StructurePeer):
    """scipy.integrate.solve_ivp with terminal events, in displacements and velocities of the masses.

    DOP853: of the explicit pairs the faster one (RK45 takes three times as long at the same tolerance).
    """

    name = "solve_ivp DOP853"
    package = "scipy"
    rtol = 1e-9
    atol = 1e-12

    def __init__(self, chain, method="DOP853"):
        super().__init__(chain)
        self.method = method
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
        self.slide_ends = {sign: self.slide_end(self.rate, sign) for sign in (1, -1)}
        self.releases = [self.release(sign, mu * beta) for sign in (1, -1)]

    @staticmethod
    def slide_end(row, sign):
        """Return the terminal event that ends a slide of this sign."""

        def velocity(_theta, y):
            return sign * y[row] - SLIDE_END

        velocity.terminal = True
        velocity.direction = -1
        return velocity

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


# ---------------------------------------------------------------- heyoka


class HeyokaPeer(StructurePeer):
    """heyoka's Taylor integrator: one program for slides, one for stops, compiled once a chain.

    A slide is integrated as sign times the motion, so that one event serves both directions.  Of what was
    tried the fastest is kept: tolerance 1e-10 (machine precision takes 1.04 times as long), displacements of
    the masses (modes: 1.1), fast_math (without: 1.02).  A phase takes some 10 us.
    """

    name = "heyoka"
    package = "heyoka"

    def __init__(self, chain, **options):
        super().__init__(chain)
        heyoka = import_module("heyoka")
        n, j = self.n, self.contact
        q = heyoka.make_vars(*(f"q{i}" for i in range(n)))
        v = heyoka.make_vars(*(f"v{i}" for i in range(n)))
        square, r, drive, limit = (heyoka.par[i] for i in range(4))  # limit of the friction force
        cosine = drive * heyoka.cos(heyoka.time)

        def pull(i):
            """Force on mass i but for friction."""
            terms = [-self.stiffness[i, k] * q[k] for k in range(n) if self.stiffness[i, k]]
            if chain.zeta:
                terms.append(-(r * heyoka.sum([self.damping[i, k] * v[k] for k in range(n)])))
            return heyoka.sum([*terms, cosine] if i == self.load else terms)

        held = pull(j)
        positions = list(zip(q, v, strict=True))
        sliding = [(v[i], square * (pull(i) - limit if i == j else pull(i))) for i in range(n)]
        sticking = [(v[i], heyoka.expression(0.0) if i == j else square * pull(i)) for i in range(n)]
        down, up = heyoka.event_direction.negative, heyoka.event_direction.positive
        slide_end = heyoka.t_event(v[j] - SLIDE_END, direction=down, cooldown=0.0)
        releases = [
            heyoka.t_event(held - limit, direction=up, cooldown=0.0),
            heyoka.t_event(held + limit, direction=down, cooldown=0.0),
        ]
        options = {"tol": 1e-10, "fast_math": True, **options}
        zero = [0.0] * (2 * n)
        self.slider = heyoka.taylor_adaptive(positions + sliding, zero, t_events=[slide_end], **options)
        self.sticker = heyoka.taylor_adaptive(positions + sticking, zero, t_events=releases, **options)
        self.time_limit = heyoka.taylor_outcome.time_limit
        self.slider_state, self.sticker_state = self.slider.state, self.sticker.state

    def prepare(self, r, beta, mu):
        """Take the numbers of one cell, and start from rest."""
        super().prepare(r, beta, mu)
        self.slider.pars[:] = 1.0 / r**2, r, 1.0, beta
        self.sticker.pars[:] = 1.0 / r**2, r, 1.0, mu * beta

    def slide(self, theta, sign, end):
        """Integrate one slide."""
        integrator, motion = self.slider, self.slider_state
        np.multiply(self.state, sign, out=motion)
        integrator.pars[2] = sign
        integrator.time = theta
        ended = integrator.propagate_until(end)[0] != self.time_limit
        np.multiply(motion, sign, out=self.state)
        if ended:
            self.state[self.rate] = 0.0
        return integrator.time, ended

    def stop(self, theta, end):
        """Integrate one stop."""
        integrator, motion = self.sticker, self.sticker_state
        motion[:] = self.state
        integrator.time = theta
        outcome = integrator.propagate_until(end)[0]
        self.state[:] = motion
        if outcome == self.time_limit:
            return integrator.time, 0
        return integrator.time, (1 if int(outcome) == -1 else -1)


PEERS = (SolveIvpPeer, HeyokaPeer)
