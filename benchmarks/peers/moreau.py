"""Moreau-Jean time stepping for several contacts, compiled.

The scheme is that of `fixed_step`: theta = 1/2, velocities and impulses are the unknowns, and friction is
implicit.  The impulses of a step, each in [-h beta_j, h beta_j], follow from projected Gauss-Seidel
iteration, which starts from those of the step before.  A stop is a run of at least two sticking steps,
because a turn takes one.
"""

import numpy as np
from numba import njit

from .body import TWO_PI
from .contacts import ContactBody, ContactCell, ContactOutcome, ContactPeer, load_samples

#: Iterations of a step at most, and the change of an impulse, over its limit, that ends them.
_MOST_ITERATIONS = 500
_SETTLED = 1e-14


@njit(cache=True, error_model="numpy")
def _impulses(free, mobility, limits, found):
    """Impulses for which each contact velocity free - mobility P is 0, or P is at its limit."""
    for _ in range(_MOST_ITERATIONS):
        change = 0.0
        for i in range(free.size):
            rest = free[i]
            for j in range(free.size):
                rest -= mobility[i, j] * found[j]
            new = max(-limits[i], min(limits[i], found[i] + rest / mobility[i, i]))
            change = max(change, abs(new - found[i]) / limits[i])
            found[i] = new
        if change <= _SETTLED:
            return


@njit(cache=True, error_model="numpy")
def _free_velocity(scheme, x, v, load, h, pull, new):
    """Velocity at the end of a step without friction; `pull` is scratch."""
    stiffness, damping, inverse = scheme
    n = x.size
    for i in range(n):
        pull[i] = load if i == 0 else 0.0
        for m in range(n):
            pull[i] -= stiffness[i, m] * (x[m] + 0.5 * h * v[m]) + damping[i, m] * v[m]
    for i in range(n):
        new[i] = v[i]
        for m in range(n):
            new[i] += h * inverse[i, m] * pull[m]


@njit(cache=True, error_model="numpy")
def _count_step(limits, impulses, sticking, begins, last, stops):
    """Count the stops that end with a step; runs of sticking steps, and whether they began in the period."""
    for j in range(limits.size):
        if abs(impulses[j]) < limits[j]:
            if sticking[j] == 0:
                begins[j] = last
            sticking[j] += 1
        else:
            if sticking[j] > 1 and begins[j]:
                stops[j] += 1
            sticking[j] = 0


@njit(cache=True, error_model="numpy")
def _include(w, x, ranges):
    """Include the displacements in the contacts in their ranges (2, contacts)."""
    for j in range(w.shape[1]):
        z = 0.0
        for i in range(x.size):
            z += w[i, j] * x[i]
        ranges[0, j] = min(ranges[0, j], z)
        ranges[1, j] = max(ranges[1, j], z)


@njit(cache=True, error_model="numpy")
def march(scheme, w, share, mobility, limits, loads, cycles):
    """March from rest; stops that begin in the last period (contacts,), and ranges (2, contacts) in it.

    Parameters
    ----------
    scheme : K, r C1, and the inverse of r^2 + h r C1/2 + h^2 K/4
    w : (n, contacts) contact vectors
    share : (n, contacts) change of the velocities per impulse
    mobility : (contacts, contacts) change of the contact velocities per impulse
    limits : (contacts,) largest impulses of a step
    loads : (steps,) mean load over each step of a period
    cycles : periods to march
    """
    n, count = w.shape
    h = TWO_PI / loads.size
    x, v, new, pull = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    free, impulses = np.zeros(count), np.zeros(count)
    sticking, begins = np.zeros(count, np.int64), np.zeros(count, np.bool_)
    stops, ranges = np.zeros(count), np.zeros((2, count))
    for cycle in range(cycles):
        last = cycle == cycles - 1
        if last:
            ranges[0, :] = np.inf
            ranges[1, :] = -np.inf
            _include(w, x, ranges)
        for k in range(loads.size):
            _free_velocity(scheme, x, v, loads[k], h, pull, new)
            for j in range(count):
                free[j] = 0.0
                for i in range(n):
                    free[j] += w[i, j] * new[i]
            _impulses(free, mobility, limits, impulses)
            for i in range(n):
                for j in range(count):
                    new[i] -= share[i, j] * impulses[j]
                x[i] += 0.5 * h * (v[i] + new[i])
                v[i] = new[i]
            _count_step(limits, impulses, sticking, begins, last, stops)
            if last:
                _include(w, x, ranges)
    for j in range(count):
        if sticking[j] > 1 and begins[j]:
            stops[j] += 1
    return stops, ranges


class ContactsMoreau(ContactPeer):
    """Moreau-Jean time stepping with `steps` steps per period of the load."""

    name = "Moreau-Jean"
    package = "numba"

    def __init__(self, body: ContactBody, steps: int = 1024) -> None:
        super().__init__(body)
        self.stiffness, self.damping = body.structure
        self.w = body.vectors
        nodes = load_samples(body.load, TWO_PI / steps * np.arange(steps + 1))
        self.loads = 0.5 * (nodes[1:] + nodes[:-1])

    def run(self, cell: ContactCell, cycles: int) -> ContactOutcome:
        """March one cell from rest."""
        h = TWO_PI / self.loads.size
        damping = cell.r * self.damping
        inertia = cell.r**2 * np.eye(self.body.masses)
        inverse = np.linalg.inv(inertia + 0.5 * h * damping + 0.25 * h * h * self.stiffness)
        share = inverse @ self.w
        scheme = self.stiffness, damping, inverse
        limits = h * np.array(cell.beta)
        stops, ranges = march(scheme, self.w, share, self.w.T @ share, limits, self.loads, cycles)
        return ContactOutcome(tuple(stops.tolist()), tuple((ranges[1] - ranges[0]).tolist()))
