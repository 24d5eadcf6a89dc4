"""Several contacts with a general-purpose solver: the common part of all such solvers.

Between events each contact slides in one direction, or is held by the constraint z' = 0.  Slides end as in
`chain`; a held contact is released where the force of its constraint reaches the friction.  Where a contact
comes to rest, the forces of all contacts at rest follow from the box law: z'' = 0 and |f| <= beta, or
f = beta sgn(z'').  It is solved by projected Gauss-Seidel iteration.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .body import SHORTEST_STOP, TWO_PI
from .contacts import ContactBody, ContactCell, ContactOutcome, ContactPeer, load_function
from .peer import MAX_PHASES

#: Iterations of the box law at most, and the change of the forces, over the friction, that ends it.
_MOST_ITERATIONS = 10_000
_SETTLED = 1e-15


class Event(NamedTuple):
    """A contact whose slide has ended (direction 0), or that is released in a direction."""

    contact: int
    direction: int


class _Track:
    """Stops that begin, and ranges, in the last period."""

    def __init__(self, contacts: int, first: float, began: Sequence[float]) -> None:
        self.first = first  # phase at which the period begins
        self.began = list(began)  # of the last stop of each contact
        self.stops = [0] * contacts
        self.low, self.high = np.full(contacts, np.inf), np.full(contacts, -np.inf)

    def include(self, z: np.ndarray) -> None:
        """Include displacements; their extremes are at events."""
        np.minimum(self.low, z, out=self.low)
        np.maximum(self.high, z, out=self.high)

    def change(self, theta: float, before: Sequence[int], after: Sequence[int]) -> None:
        """Count the stops that end, and note where others begin."""
        for j, (old, new) in enumerate(zip(before, after, strict=True)):
            if new == 0 and old != 0:
                self.began[j] = theta
            elif new != 0 and old == 0 and theta - self.began[j] > SHORTEST_STOP:
                self.stops[j] += self.began[j] >= self.first

    def outcome(self, senses: Sequence[int]) -> ContactOutcome:
        """Results, with the stops that last at the end."""
        lasting = [not sense and began >= self.first for sense, began in zip(senses, self.began, strict=True)]
        stops = tuple(float(a + b) for a, b in zip(self.stops, lasting, strict=True))
        return ContactOutcome(stops, tuple((self.high - self.low).tolist()))


class SwitchingPeer(ContactPeer):
    """Solver for several contacts.  A subclass integrates one phase.

    `advance(theta, end)` integrates `self.state` (x, then x'), while the contacts slide in the directions
    `self.senses` (0: held), to the next event or to `end`.  It returns the phase and the event; None if
    `end` came first.
    """

    def __init__(self, body: ContactBody) -> None:
        super().__init__(body)
        self.n, self.count = body.masses, len(body.contacts)
        self.stiffness, self.damping = body.structure
        self.w = body.vectors
        self.load = load_function(body.load)

    def run(self, cell: ContactCell, cycles: int) -> ContactOutcome:
        """Integrate one cell from rest."""
        self.prepare(cell)
        self.state = np.zeros(2 * self.n)
        self.senses = self._after_rest(0.0, [0] * self.count, list(range(self.count)))
        track = _Track(self.count, 0.0, [0.0] * self.count)
        theta = self._march(0.0, TWO_PI * (cycles - 1), track)
        track = _Track(self.count, TWO_PI * (cycles - 1), track.began)
        self._march(theta, TWO_PI * cycles, track)
        return track.outcome(self.senses)

    def prepare(self, cell: ContactCell) -> None:
        """Take the numbers of one cell."""
        self.r, self.beta = cell.r, np.array(cell.beta)

    def advance(self, theta: float, end: float) -> tuple[float, Event | None]:
        """Integrate one phase."""
        raise NotImplementedError

    def _march(self, theta: float, end: float, track: _Track) -> float:
        """Go from phase to phase up to `end`."""
        track.include(self.state[: self.n] @ self.w)
        for _ in range(MAX_PHASES):
            theta, event = self.advance(theta, end)
            track.include(self.state[: self.n] @ self.w)
            if event is None:
                return theta
            before = self.senses
            self.senses = self._after(theta, event)
            track.change(theta, before, self.senses)
        raise RuntimeError(f"{MAX_PHASES} phases without reaching the end of the run")

    def _after(self, theta: float, event: Event) -> list[int]:
        """Directions after an event."""
        senses = list(self.senses)
        senses[event.contact] = event.direction
        if event.direction:
            return senses
        together = [j for j, sense in enumerate(senses) if sense == 0]
        self._stop_exactly(together)
        return self._after_rest(theta, senses, together)

    def _stop_exactly(self, together: list[int]) -> None:
        """Make the velocities in some contacts zero: they are so except for the offset of the event."""
        w = self.w[:, together]
        velocity = self.state[self.n :]
        velocity -= w @ np.linalg.solve(w.T @ w, w.T @ velocity)

    def _after_rest(self, theta: float, senses: list[int], together: list[int]) -> list[int]:
        """Directions after contacts came to rest together with others that are held."""
        x, v = self.state[: self.n], self.state[self.n :]
        pull = -(self.stiffness @ x) - self.r * (self.damping @ v) - self.w @ (self.beta * senses)
        pull[0] += self.load(theta)
        w = self.w[:, together]
        forces = _box_law(w.T @ pull, w.T @ w, self.beta[together])
        after = list(senses)
        for j, force in zip(together, forces, strict=True):
            after[j] = 0 if abs(force) < self.beta[j] else (1 if force > 0.0 else -1)
        return after


def _box_law(push: np.ndarray, mobility: np.ndarray, limits: np.ndarray) -> list[float]:
    """Forces of the box law: push - mobility f is zero, or f is at its limit and it is not against f."""
    forces = [0.0] * len(limits)
    rows, free, most = mobility.tolist(), push.tolist(), limits.tolist()
    for _ in range(_MOST_ITERATIONS):
        change = 0.0
        for i, row in enumerate(rows):
            rest = free[i] - sum([a * f for a, f in zip(row, forces, strict=True)])
            new = max(-most[i], min(most[i], forces[i] + rest / row[i]))
            change = max(change, abs(new - forces[i]) / most[i])
            forces[i] = new
        if change <= _SETTLED:
            break
    return forces


def held_projections(w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(P, R) for contacts w (n, held) at rest: accelerations P a, forces R a; a is that without them."""
    forces = np.linalg.solve(w.T @ w, w.T) if w.shape[1] else w.T
    return np.eye(len(w)) - w @ forces, forces
