"""heyoka: a compiled Taylor integrator with events."""

from importlib import import_module

import numpy as np

from .body import SLIDE_END, Body
from .chain import ChainPeer
from .contacts import ContactBody, ContactCell, ContactPeer
from .one_mass import OneMassPeer
from .peer import Peer
from .periodic_load import HarmonicsPeer
from .switching import Event, SwitchingPeer, held_projections


def peer(body: Body, **settings) -> Peer:
    """Solver for a body."""
    return (OneMassHeyoka if body.masses == 1 else ChainHeyoka)(body, **settings)


def contact_peer(body: ContactBody, **settings) -> ContactPeer:
    """Solver for a body under a periodic load: one mass, or any number of masses and contacts."""
    return (HarmonicsHeyoka if body.masses == 1 else ContactsHeyoka)(body, **settings)


class OneMassHeyoka(OneMassPeer):
    """heyoka's Taylor integrator: one compiled program for all cells, their numbers parameters.

    The integrated motion is sign times z, so that the velocity of every slide is positive and
    one event serves both directions. That event is v = -1e-13 downwards, not v = 0: a slide that
    begins where a stop of mu = 1 ends has v = v' = 0, a double root at its own start. Of 600
    random cells, half with mu = 1, an event at v = 0 answered one wrongly with the default
    cooldown, beside thousands of warnings of failed root searches; without a cooldown, four
    wrongly, and 178 did not end. At -1e-13 no root can lie at the start, none has to be kept away
    by a cooldown, and the sign of v distinguishes the event from the end of the run. The overshoot moves z
    by 1e-26/z'', or by some 1e-20 where z'' = 0.

    Tried over the 65 moving cells of the reference table, single thread, against the settings
    kept (run time 1): without fast_math 1.11; tolerance 1e-12 0.98 and 1e-10 0.98, so machine
    precision stays; high_accuracy 1.01; slp_vectorize 1.05; compact_mode 1.5; stepping from
    Python instead of propagate_until 1.6; cos and sin carried as states 1.1; friction removed by
    a shift of z 1.02. Some 40 % of the remaining time is numerical work, about 2 steps per slide; the
    rest is calls and the logic of stops. A callback of the event saves none of them, because it may not
    move the time over a stop.

    Many cells at a time gain next to nothing, because the lanes of a batch stop at different
    times and each stop must be handled outside. Speed of taylor_adaptive_batch against one cell
    at a time, single thread: 0.35 with 4 lanes (one SIMD register) restarted one by one; with the
    sticking logic on whole arrays and every lane refilled when its cell is done, 0.6 with 64
    lanes, 1.13 with 256, and nothing more seen with 512 to 2048. An ensemble copies the
    integrator for each propagation, which is each slide here: 1.3 ms a slide, against 5 us.
    """

    name = "heyoka"
    package = "heyoka"

    def __init__(self, body: Body, fast_math=True, **options):
        super().__init__(body)
        heyoka = import_module("heyoka")
        z, v = heyoka.make_vars("z", "v")
        stiffness, damping, friction, drive = (heyoka.par[i] for i in range(4))
        push = drive * heyoka.cos(heyoka.time) - damping * v - stiffness * z - friction
        slide_end = heyoka.t_event(v - SLIDE_END, direction=heyoka.event_direction.negative, cooldown=0.0)
        self.integrator = heyoka.taylor_adaptive(
            sys=[(z, v), (v, push)], state=[0.0, 0.0], t_events=[slide_end],
            fast_math=fast_math, **options,
        )  # fmt: skip
        self.motion = self.integrator.state
        self.numbers = self.integrator.pars
        self.drive = 0.0

    def prepare(self, amplitude, r, beta):
        """Take the numbers of one cell, divided by the inertia."""
        self.drive = amplitude / r**2
        self.numbers[:3] = 1 / r**2, 2 * self.body.zeta / r, beta / r**2

    def slide(self, theta, z, v, sign, end):
        """Integrate one slide."""
        integrator, motion = self.integrator, self.motion
        motion[0] = sign * z
        motion[1] = sign * v
        self.numbers[3] = sign * self.drive
        integrator.time = theta
        integrator.propagate_until(end)
        z, v = motion.tolist()
        return integrator.time, sign * z, (sign * v if v > 0 else 0.0)


class ChainHeyoka(ChainPeer):
    """heyoka's Taylor integrator: one program for slides, one for stops, compiled once a chain.

    A slide is integrated as sign times the motion, so that one event serves both directions.  The fastest
    settings are used: tolerance 1e-10 (machine precision takes 1.04 times as long), displacements of
    the masses (modes: 1.1), fast_math (without: 1.02).  A segment takes some 10 us.
    """

    name = "heyoka"
    package = "heyoka"

    def __init__(self, body: Body, **options):
        super().__init__(body)
        heyoka = import_module("heyoka")
        n, j = self.n, self.contact
        q = heyoka.make_vars(*(f"q{i}" for i in range(n)))
        v = heyoka.make_vars(*(f"v{i}" for i in range(n)))
        square, r, drive, limit = (heyoka.par[i] for i in range(4))  # limit of the friction force
        cosine = drive * heyoka.cos(heyoka.time)

        def pull(i):
            """Force on mass i without friction."""
            terms = [-self.stiffness[i, k] * q[k] for k in range(n) if self.stiffness[i, k]]
            if body.zeta:
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


def load_expression(heyoka, load):
    """Load as a function of time."""
    terms = []
    for n, value in load.items():
        if value.real:
            terms.append(value.real * heyoka.cos(float(n) * heyoka.time))
        if value.imag:
            terms.append(-value.imag * heyoka.sin(float(n) * heyoka.time))
    return heyoka.sum(terms)


class HarmonicsHeyoka(HarmonicsPeer):
    """heyoka's Taylor integrator for one mass under several harmonics, with the settings of `OneMassHeyoka`.

    The load is part of the compiled program: the same for all cells of a body.
    """

    name = "heyoka"
    package = "heyoka"

    def __init__(self, body: ContactBody, fast_math=True, **options):
        super().__init__(body)
        heyoka = import_module("heyoka")
        z, v = heyoka.make_vars("z", "v")
        stiffness, damping, friction, drive = (heyoka.par[i] for i in range(4))
        push = drive * load_expression(heyoka, body.load) - damping * v - stiffness * z - friction
        slide_end = heyoka.t_event(v - SLIDE_END, direction=heyoka.event_direction.negative, cooldown=0.0)
        self.integrator = heyoka.taylor_adaptive(
            sys=[(z, v), (v, push)], state=[0.0, 0.0], t_events=[slide_end],
            fast_math=fast_math, **options,
        )  # fmt: skip
        self.motion = self.integrator.state
        self.numbers = self.integrator.pars
        self.drive = 0.0

    def prepare(self, r, beta):
        """Take the numbers of one cell, divided by the inertia."""
        self.drive = 1 / r**2
        self.numbers[:3] = 1 / r**2, 2 * self.body.zeta / r, beta / r**2

    slide = OneMassHeyoka.slide


class ContactsHeyoka(SwitchingPeer):
    """heyoka's Taylor integrator for several contacts: one program per set of held contacts.

    A program is compiled when a motion first visits its set.  Directions and friction forces are parameters.
    """

    name = "heyoka"
    package = "heyoka"

    def __init__(self, body: ContactBody, **options):
        super().__init__(body)
        self.heyoka = import_module("heyoka")
        self.options = {"fast_math": True, **options}
        self.time_limit = self.heyoka.taylor_outcome.time_limit
        self.programs: dict = {}

    def prepare(self, cell: ContactCell):
        """Take the numbers of one cell; its r and 1/r^2 are parameters of every program."""
        super().prepare(cell)
        self.numbers = np.concatenate(([1.0 / cell.r**2, cell.r], self.beta))

    def make_program(self, held):
        """Integrator of the phases in which these contacts are held, and the contacts of its events."""
        heyoka, n, count = self.heyoka, self.n, self.count
        x = heyoka.make_vars(*(f"x{i}" for i in range(n)))
        v = heyoka.make_vars(*(f"v{i}" for i in range(n)))
        x, v = (x, v) if n > 1 else ([x], [v])
        par = heyoka.par
        square, r = par[0], par[1]
        beta = [par[2 + j] for j in range(count)]
        sense = [par[2 + count + j] for j in range(count)]
        load = load_expression(heyoka, self.body.load)
        pulls = []
        for i in range(n):
            terms = [load] if i == 0 else []
            terms += [-self.stiffness[i, k] * x[k] for k in range(n) if self.stiffness[i, k]]
            terms += [-self.damping[i, k] * (r * v[k]) for k in range(n) if self.damping[i, k]]
            terms += [
                -self.w[i, j] * (beta[j] * sense[j]) for j in range(count) if j not in held and self.w[i, j]
            ]
            pulls.append(heyoka.sum(terms))
        projection, forces = held_projections(self.w[:, list(held)])

        def combined(row, values):
            return heyoka.sum([a * value for a, value in zip(row, values, strict=True) if abs(a) > 1e-14])

        moved = [
            (v[i], square * combined(projection[i], pulls) if np.abs(projection[i]).max() > 1e-14
             else heyoka.expression(0.0))
            for i in range(n)
        ]  # fmt: skip
        events, meanings = [], []
        for j in range(count):
            if j in held:
                force = combined(forces[held.index(j)], pulls)
                pairs = [(beta[j] - force, 1), (beta[j] + force, -1)]
            else:
                pairs = [(sense[j] * combined(self.w[:, j], v) - SLIDE_END, 0)]
            for expression, direction in pairs:
                down = heyoka.event_direction.negative
                events.append(heyoka.t_event(expression, direction=down, cooldown=0.0))
                meanings.append(Event(j, direction))
        system = [*zip(x, v, strict=True), *moved]
        return heyoka.taylor_adaptive(system, [0.0] * (2 * n), t_events=events, **self.options), meanings

    def advance(self, theta, end):
        """Integrate one phase."""
        held = tuple(j for j, sense in enumerate(self.senses) if sense == 0)
        if held not in self.programs:
            self.programs[held] = self.make_program(held)
        integrator, meanings = self.programs[held]
        integrator.pars[:] = np.concatenate((self.numbers, self.senses))[: len(integrator.pars)]
        integrator.state[:] = self.state
        integrator.time = theta
        outcome = integrator.propagate_until(end)[0]
        self.state = np.array(integrator.state)
        if outcome == self.time_limit:
            return integrator.time, None
        return integrator.time, meanings[-int(outcome) - 1]
