"""heyoka's batch mode: many cells of one mass at a time, with the logic of stops on whole arrays.

The offset of the event and the closed forms are as in `one_mass`. Each cell has its events at its own times.
The lanes of a batch therefore advance one Taylor step at a time, each with its own time. Lanes whose slide
has ended are restarted together, and a lane whose run is complete takes the next cell. `propagate_until`
would stop all lanes at the first event of any.
"""

from collections.abc import Iterator, Sequence
from importlib import import_module
from typing import NamedTuple

import numpy as np

from .body import SLIDE_END, STUCK, TWO_PI, Body, Cell, Outcome, load_in_contact
from .one_mass import LATE
from .peer import Peer

#: Lanes of the batch.  Of 64, 128, 256, 512 and 1024 tried, 256 was the fastest together with 512, which
#: takes twice as long to compile.  `compact_mode` compiles in half the time; what it gains is lost in a run.
LANES = 256
FEW_LANES = 64  # compiled in a second


class Runs(NamedTuple):
    """State of each lane; arrays of shape (lanes,)."""

    cell: np.ndarray  # its index; -1: none, the lane idles
    amplitude: np.ndarray
    limit: np.ndarray
    sign: np.ndarray  # of the slide
    window: np.ndarray  # 0: before the last period, 1: in it
    ends: np.ndarray  # (2, lanes) of the windows, in phase of the load
    stops: np.ndarray
    peak: np.ndarray


def release(
    amplitude: np.ndarray, limit: np.ndarray, theta: np.ndarray, z: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """`one_mass.release` on arrays: wait until stops at z end, and sign of the slide after; 0: never."""
    on = -np.arccos(np.clip((z + limit) / amplitude, -1.0, 1.0)) - theta
    back = np.arccos(np.clip((z - limit) / amplitude, -1.0, 1.0)) - theta
    on, back = (np.where(wait % TWO_PI > LATE, 0.0, wait % TWO_PI) for wait in (on, back))
    on = np.where(z + limit < amplitude, on, np.inf)
    back = np.where(z - limit > -amplitude, back, np.inf)
    return np.minimum(on, back), np.where(back < on, -1.0, np.where(np.isinf(on), 0.0, 1.0))


def restart(
    amplitude: np.ndarray, limit: np.ndarray, theta: np.ndarray, z: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """`one_mass.restart` on arrays: phase and sign of the slides after z' = 0, and the stops between."""
    push = amplitude * np.cos(theta) - z
    wait, sign = release(amplitude, limit, theta, z)
    slides = np.abs(push) > limit
    wait = np.where(slides | (sign == 0.0), 0.0, wait)
    return theta + wait, np.where(slides, np.sign(push), sign), wait


class HeyokaBatch(Peer):
    """heyoka's taylor_adaptive_batch, stepped; settings as in `heyoka.OneMassHeyoka`."""

    name = "heyoka, batch"
    package = "heyoka"

    def __init__(self, body: Body, lanes: int = LANES, **options: object) -> None:
        super().__init__(body)
        heyoka = import_module("heyoka")
        z, v = heyoka.make_vars("z", "v")
        stiffness, damping, friction, drive = (heyoka.par[i] for i in range(4))
        push = drive * heyoka.cos(heyoka.time) - damping * v - stiffness * z - friction
        slide_end = heyoka.t_event_batch(
            v - SLIDE_END, direction=heyoka.event_direction.negative, cooldown=0.0
        )
        self.integrator = heyoka.taylor_adaptive_batch(
            sys=[(z, v), (v, push)], state=np.zeros((2, lanes)), pars=np.zeros((4, lanes)),
            t_events=[slide_end], **{"fast_math": True, **options},
        )  # fmt: skip
        self.motion, self.numbers = self.integrator.state, self.integrator.pars
        self.lanes = lanes

    def run_all(self, cells: Sequence[Cell], cycles: int) -> list[Outcome]:
        """Integrate cells from rest; stops and max |z| of the last `periods`, cell by cell."""
        lanes = self.lanes
        empty = np.zeros(lanes)
        runs = Runs(
            np.full(lanes, -1), np.ones(lanes), empty.copy(), np.ones(lanes), np.zeros(lanes, dtype=int),
            np.full((2, lanes), np.inf), empty.copy(), empty.copy(),
        )  # fmt: skip
        self.theta = empty.copy()
        self.motion[:] = 0.0
        self.numbers[:] = 0.0
        self.found: list[Outcome] = [STUCK] * len(cells)
        waiting = iter(enumerate(cells))
        idle = np.arange(lanes)
        while True:
            for lane in idle.tolist():
                self._take(lane, waiting, cycles, runs)
            if (runs.cell < 0).all():
                return self.found
            idle = np.empty(0, dtype=int)
            while not idle.size:
                idle = self._advance(runs)

    def _take(self, lane: int, waiting: Iterator[tuple[int, Cell]], cycles: int, runs: Runs) -> None:
        """Start the next cell that moves at all in a lane; none is left: the lane idles."""
        runs.cell[lane] = -1
        runs.ends[:, lane] = np.inf
        self.motion[:, lane] = 0.0
        self.numbers[:, lane] = 0.0
        for index, cell in waiting:
            amplitude, phase = load_in_contact(self.body.wall, cell.r, self.body.zeta)
            limit = cell.mu * cell.beta
            if amplitude <= limit:
                continue
            runs.cell[lane] = index
            runs.amplitude[lane], runs.limit[lane] = amplitude, limit
            runs.ends[:, lane] = phase + TWO_PI * (cycles - 1), phase + TWO_PI * cycles
            runs.window[lane], runs.stops[lane], runs.peak[lane] = 0, 0.0, 0.0
            self.theta[lane] = phase
            self.numbers[:3, lane] = 1 / cell.r**2, 2 * self.body.zeta / cell.r, cell.beta / cell.r**2
            self._slide_on(np.array([lane]), np.zeros(1), runs)
            return

    def _slide_on(self, where: np.ndarray, z: np.ndarray, runs: Runs) -> None:
        """Start the slides that follow z' = 0 at z in some lanes; sign 0: the contact sticks permanently."""
        theta, sign, wait = restart(runs.amplitude[where], runs.limit[where], self.theta[where], z)
        self.theta[where] = theta
        runs.sign[where] = sign
        runs.stops[where] += wait > 0.0
        self.motion[0, where] = sign * z
        self.motion[1, where] = 0.0
        self.numbers[3, where] = sign * runs.amplitude[where] * self.numbers[0, where]

    def _advance(self, runs: Runs) -> np.ndarray:
        """One step of every lane and what follows it; the lanes whose runs are over."""
        integrator, every = self.integrator, np.arange(self.lanes)
        end = runs.ends[runs.window, every]
        integrator.set_time(self.theta)
        integrator.step(np.where(runs.cell >= 0, end - self.theta, 1.0))
        self.theta = np.array(integrator.time)
        ended = np.flatnonzero(self.motion[1] <= 0.0)
        z = runs.sign[ended] * self.motion[0, ended]
        runs.peak[ended] = np.maximum(runs.peak[ended], np.abs(z))
        at_end = self.theta >= end
        at_end[ended] = False
        peak = np.abs(self.motion[0])
        runs.peak[at_end] = np.maximum(runs.peak, peak)[at_end]
        self._slide_on(ended, z, runs)
        passed = (self.theta >= end) & (runs.window == 0)
        over = (runs.sign == 0.0) | ((self.theta >= runs.ends[1]) & (runs.window == 1))
        over &= runs.cell >= 0
        runs.window[passed] = 1
        runs.stops[passed] = 0.0
        runs.peak[passed] = peak[passed]
        lanes = np.flatnonzero(over)
        for lane in lanes:
            stops, z_most = float(runs.stops[lane]), float(runs.peak[lane])
            self.found[runs.cell[lane]] = Outcome(stops, z_most) if runs.sign[lane] else STUCK
        return lanes
