"""Two general-purpose ODE solvers doing the job of a specialised one, as peers for benchmarks.

The problem is the oscillator with one Coulomb contact, in the relative displacement z of the
contact, with tau the phase of the load and the prime d/dtau:

    r^2 z'' + 2 zeta r z' + z + beta sgn(z') = Re(F e^{i tau})

    F = 1                       contact with a fixed wall
    F = r^2 - 2 i zeta r        contact with a wall that moves with the base

`SolveIvpPeer` is the explicit Runge-Kutta pair of orders 4 and 5 with events, at the tolerances
that are usual for this problem. `HeyokaPeer` is a compiled Taylor integrator at machine
precision. Both only integrate the slides. Everything else is closed form and shared, which
favours the peers: the sticking test at z' = 0, the release time of a stop (an arccos), and the
return at once from a contact that can never slip again. A run starts from rest, z = z' = 0 at
tau = 0, and what is reported is the last of its excitation periods.

Set-up (imports, compilation) is done in `__init__`, so that a caller can time it apart from `run`.

    python benchmarks/peers.py steady_states.json

checks every peer that is installed against a table of known steady states, and times it.
"""

import argparse
import json
import math
import statistics
import time
from importlib import import_module
from importlib.metadata import version as installed_version
from typing import NamedTuple

TWO_PI = 2 * math.pi
MAX_PHASES = 1_000_000  # slides in one window: far above any honest run, so that nothing hangs
SLIDE_END = -1e-13  # velocity along the slide at which it has ended, see `HeyokaPeer`
LATE = TWO_PI - 1e-9  # a wait longer than this is a release that rounding put in the past


class Cell(NamedTuple):
    """One point of a map; `contact` is "fixed-wall" or "joined-base-wall"."""

    contact: str
    r: float
    beta: float
    mu: float = 1.0
    zeta: float = 0.0


class Outcome(NamedTuple):
    """What a run reports of its last period; `stops` is nan where the contact sticks for good."""

    stops: float
    Z: float


STUCK = Outcome(math.nan, 0.0)


class State(NamedTuple):
    """A slide about to go on: phase of the load in the contact, motion, and sign of z'."""

    theta: float
    z: float
    v: float
    sign: int


# ---------------------------------------------------------------- what both peers share


def load_in_contact(contact, r, zeta):
    """Return the amplitude and the phase of the load F that the contact feels."""
    if not r > 0:
        raise ValueError(f"r must be positive, not {r!r}")
    if contact == "fixed-wall":
        return 1.0, 0.0
    if contact == "joined-base-wall":
        return math.hypot(r * r, 2 * zeta * r), math.atan2(-2 * zeta * r, r * r)
    raise ValueError(f"contact must be 'fixed-wall' or 'joined-base-wall', not {contact!r}")


def release(amplitude, limit, theta, z):
    """Return the wait until a stop at z ends and the sign of the slide after it; sign 0: never."""
    wait, sign = math.inf, 0
    if z + limit < amplitude:
        wait = (-math.acos(max((z + limit) / amplitude, -1.0)) - theta) % TWO_PI
        wait, sign = (0.0 if wait > LATE else wait), 1
    if z - limit > -amplitude:
        back = (math.acos(min((z - limit) / amplitude, 1.0)) - theta) % TWO_PI
        back = 0.0 if back > LATE else back
        if back < wait:
            wait, sign = back, -1
    return wait, sign


def restart(amplitude, limit, theta, z):
    """Return phase and sign of the slide that follows z' = 0, and the length of the stop between.

    The contact sticks while the load less the spring's force is within the static limit.
    """
    push = amplitude * math.cos(theta) - z
    if abs(push) > limit:
        return theta, (1 if push > 0 else -1), 0.0
    wait, sign = release(amplitude, limit, theta, z)
    return theta + wait, sign, wait


def march(slide, amplitude, limit, state, end, begins=None):
    """Go from slide to slide up to phase `end`; return state, stops that began, and max |z|.

    The phases at which they began are added to the list `begins`, if there is one.

    `slide(theta, z, v, sign, end)` integrates one slide and returns theta, z, v: at its end with
    v = 0, or at phase `end` with v as it is there. A sign of 0 in the state: stuck for good.
    """
    theta, z, v, sign = state
    stops, peak = 0, abs(z)
    for _ in range(MAX_PHASES):
        if theta >= end:
            break
        theta, z, v = slide(theta, z, v, sign, end)
        peak = max(peak, abs(z))
        if v:
            break
        began = theta
        theta, sign, wait = restart(amplitude, limit, theta, z)
        stops += wait > 0
        if begins is not None and wait > 0:
            begins.append(began)
        if not sign:
            break
    else:
        raise RuntimeError(f"{MAX_PHASES} slides without reaching the end of the run")
    return State(theta, z, v, sign), stops, peak


def from_rest(slide, amplitude, phase, limit, cycles, begins=None):
    """March `cycles` periods from z = z' = 0 at tau = 0; the outcome of the last one.

    `begins` is filled with the phases of the load at which its stops began.
    """
    theta, sign, _ = restart(amplitude, limit, phase, 0.0)
    state = State(theta, 0.0, 0.0, sign)
    stops, peak = 0, 0.0
    for end in (phase + TWO_PI * (cycles - 1), phase + TWO_PI * cycles):
        if not state.sign:
            return STUCK
        if begins is not None:
            begins.clear()
        state, stops, peak = march(slide, amplitude, limit, state, end, begins)
    return Outcome(stops, peak) if state.sign else STUCK


class Installed:
    """What is installed of a solver under test. A subclass names it and its package."""

    name = ""
    package = ""
    distribution = ""  # where that has another name than the package

    @classmethod
    def why_missing(cls):
        """Return why this peer cannot run here, or "" if it can."""
        try:
            import_module(cls.package)
        except ImportError as error:
            return f"{cls.package} cannot be imported ({error})"
        return ""

    @classmethod
    def available(cls):
        """Whether this peer can run here."""
        return not cls.why_missing()

    @property
    def version(self):
        """Version of the package behind this peer."""
        return installed_version(self.distribution or self.package)


class Peer(Installed):
    """A solver under test. A subclass integrates one slide."""

    def run(self, contact, r, beta, mu=1.0, zeta=0.0, cycles=200, begins=None):
        """Integrate one cell from rest; the stops and max |z| of its last excitation period.

        `begins`, a list, is filled with the phases of the load in the contact at which its stops began.
        """
        amplitude, phase = load_in_contact(contact, r, zeta)
        if amplitude <= mu * beta:
            return STUCK
        self.prepare(amplitude, r, beta, zeta)
        return from_rest(self.slide, amplitude, phase, mu * beta, cycles, begins)

    def prepare(self, amplitude, r, beta, zeta):
        """Take the numbers of one cell."""
        raise NotImplementedError

    def slide(self, theta, z, v, sign, end):
        """Integrate one slide, as `march` wants it."""
        raise NotImplementedError


# ---------------------------------------------------------------- scipy


class SolveIvpPeer(Peer):
    """scipy.integrate.solve_ivp, RK45: a slide ends at the terminal event z' = 0 with direction.

    Its event search sees sign changes between step ends only. An event at exactly z' = 0 would
    hold at the start too, and a first step that rounding sends the wrong way would end the slide
    where it began, for ever: hence the same offset of 1e-13 as below.
    """

    name = "solve_ivp RK45"
    package = "scipy"
    rtol = 1e-6
    atol = 1e-12

    def __init__(self, method="RK45", rtol=rtol, atol=atol):
        self.method, self.rtol, self.atol = method, rtol, atol
        self.solve = import_module("scipy.integrate").solve_ivp
        self.events = {1: self.slide_end(1), -1: self.slide_end(-1)}

    @staticmethod
    def slide_end(sign):
        """Return the terminal event that ends a slide of this sign."""

        def velocity(_theta, y):
            return sign * y[1] - SLIDE_END

        velocity.terminal = True
        velocity.direction = -1
        return velocity

    def prepare(self, amplitude, r, beta, zeta):
        """Take the numbers of one cell, divided by the inertia."""
        self.drive = amplitude / r**2
        self.stiffness = 1 / r**2
        self.damping = 2 * zeta / r
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


# ---------------------------------------------------------------- heyoka


class HeyokaPeer(Peer):
    """heyoka's Taylor integrator: one compiled program for all cells, their numbers parameters.

    The integrated motion is sign times z, so that the velocity of every slide is positive and
    one event serves both directions. That event is v = -1e-13 downwards, not v = 0: a slide that
    begins where a stop of mu = 1 ends has v = v' = 0, a double root at its own start. Of 600
    random cells, half with mu = 1, an event at v = 0 answered one wrongly with the default
    cooldown, beside thousands of warnings of failed root searches; without a cooldown, four
    wrongly, and 178 did not end. At -1e-13 no root can lie at the start, none has to be kept away
    by a cooldown, and the sign of v tells the event from the end of the run. The overshoot moves z
    by 1e-26/z'', or by some 1e-20 where z'' = 0.

    Tried over the 65 moving cells of the reference table, single thread, against the settings
    kept (run time 1): without fast_math 1.11; tolerance 1e-12 0.98 and 1e-10 0.98, so machine
    precision stays; high_accuracy 1.01; slp_vectorize 1.05; compact_mode 1.5; stepping from
    Python instead of propagate_until 1.6; cos and sin carried as states 1.1; friction removed by
    a shift of z 1.02. Some 40 % of what is left is numerical work, about 2 steps a slide; the rest
    is calls and the logic of stops. A callback of the event saves none of them, as it may not move
    the time over a stop.

    Many cells at a time gain next to nothing, because the lanes of a batch stop at different
    times and each stop must be handled outside. Speed of taylor_adaptive_batch against one cell
    at a time, single thread: 0.35 with 4 lanes (one SIMD register) restarted one by one; with the
    sticking logic on whole arrays and every lane refilled when its cell is done, 0.6 with 64
    lanes, 1.13 with 256, and nothing more seen with 512 to 2048. An ensemble copies the
    integrator for each propagation, which is each slide here: 1.3 ms a slide, against 5 us.
    """

    name = "heyoka"
    package = "heyoka"

    def __init__(self, fast_math=True, **options):
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

    def prepare(self, amplitude, r, beta, zeta):
        """Take the numbers of one cell, divided by the inertia."""
        self.drive = amplitude / r**2
        self.numbers[:3] = 1 / r**2, 2 * zeta / r, beta / r**2

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


PEERS = (SolveIvpPeer, HeyokaPeer)


def available_peers(report=print):
    """Return the classes of the peers that can run here; report each of the others by name."""
    present = []
    for peer in PEERS:
        reason = peer.why_missing()
        if reason:
            report(f"{peer.name}: skipped, {reason}")
        else:
            present.append(peer)
    return present


# ---------------------------------------------------------------- check against known states

CONTACTS = {"sdof-wall": "fixed-wall", "sdof-base": "joined-base-wall"}


def reference_rows(path):
    """Return the rows of the table that a peer can run, as (Cell, row)."""
    with open(path, encoding="utf-8") as file:
        rows = json.load(file)["rows"]
    return [
        (Cell(CONTACTS[row["system"]], *(float(row[key]) for key in Cell._fields[1:])), row)
        for row in rows
        if row["system"] in CONTACTS
    ]


def check(peer, rows, cycles):
    """Run the rows; return (wrong cells, worst error of Z where settled, times, their number).

    Where the reference itself needs more than `cycles` periods, or never settles, Z is not judged.
    """
    wrong, errors, times = [], [], []
    for cell, row in rows:
        begin = time.perf_counter()
        outcome = peer.run(*cell, cycles=cycles)
        elapsed = time.perf_counter() - begin
        if row["status"] == "stuck":
            wrong += [] if math.isnan(outcome.stops) else [cell]
            continue
        times.append(elapsed)
        wrong += [] if outcome.stops == row["stops"] else [cell]
        if row["status"] == "ok" and row["cycles"] <= cycles:
            errors.append(abs(outcome.Z - float(row["Z"])))
    return wrong, errors, times


def main():
    """Check and time the peers."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("reference", help="JSON table of steady states")
    parser.add_argument("--rows", type=int, help="run the first so many rows only")
    parser.add_argument("--cycles", type=int, default=200, help="periods a run (default 200)")
    arguments = parser.parse_args()
    rows = reference_rows(arguments.reference)[: arguments.rows]
    for kind in available_peers():
        begin = time.perf_counter()
        peer = kind()
        ready = time.perf_counter() - begin
        wrong, errors, times = check(peer, rows, arguments.cycles)
        print(
            f"{peer.name} ({peer.package} {peer.version}): set-up {ready:.3f} s; {len(rows)} cells,"
            f" {len(wrong)} with the wrong number of stops; error of Z: median"
            f" {statistics.median(errors):.1e}, worst {max(errors):.1e} ({len(errors)} settled);"
            f" a moving cell takes {1e3 * statistics.median(times):.3g} ms (median),"
            f" {1e3 * statistics.fmean(times):.3g} ms (mean)"
        )
        for cell in wrong:
            print(f"    wrong: {cell}")


if __name__ == "__main__":
    main()
