"""A structure under its harmonic load without friction, free or held at its contact, at many frequencies.

The modes' answers are right to the rounding of the largest of them, and a mass far from the load may move by
less.  What is left of the balance of its own forces tells; the modes' answer to that corrects it, and masses
in balance to rounding are left alone.

Arrays are (masses or modes, frequencies) or (frequencies,).  All sums run over masses or modes one by one,
in their order: what is answered at one frequency does not depend on which others are asked for.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from .phasors import Phasors

_EPS = float(np.finfo(np.float64).eps)

#: Decimal digits of a double.
_DIGITS = 16

#: The forces on a mass add up to zero within so many eps of their sizes: it is in balance.
_BALANCE = 4.0


class Polynomial(NamedTuple):
    """Phasors constant + i r rate + r^2 square; complex (n,) each."""

    constant: np.ndarray
    rate: np.ndarray
    square: np.ndarray

    def at(self, r: np.ndarray) -> Phasors:
        """Shape (n, n_r)."""
        constant, rate, square = (part[:, np.newaxis] for part in self)
        return Phasors(
            constant.real - r * rate.imag + r * r * square.real,
            constant.imag + r * rate.real + r * r * square.imag,
        )


class Body(NamedTuple):
    """A structure in numbers, and its load."""

    w: np.ndarray  # (n,)
    zeta: np.ndarray
    phi: np.ndarray  # (n, n), one mode a column
    chi: np.ndarray  # (n,)
    contact: np.ndarray  # (n,)
    mass: np.ndarray  # (n, n)
    stiffness: np.ndarray
    springs: np.ndarray | None  # (n,) of a chain
    mass_phi: np.ndarray  # (n, n) M phi
    load: Polynomial
    participation: Polynomial  # participation of the load
    rounding: float  # what cancels but for this share of its terms, for each of them, is zero


class _LoadCase(NamedTuple):
    """Frequencies that are solved for."""

    r: np.ndarray
    stiffness: Phasors  # dynamic, of every mode
    load: Phasors

    def at(self, which: np.ndarray) -> "_LoadCase":
        return _LoadCase(self.r[which], self.stiffness[:, which], self.load[:, which])


class _Motion(NamedTuple):
    """What is known of the motion there."""

    x: Phasors
    tail: Phasors  # of x, below its rounding: the stretch of a stiff spring may be
    residual: Phasors  # of the load, not in balance yet
    z: Phasors
    force: Phasors
    previous: Phasors  # the answer before

    def at(self, which: np.ndarray) -> "_Motion":
        x, tail, residual, *numbers = self
        return _Motion(
            x[:, which], tail[:, which], residual[:, which], *(number[which] for number in numbers)
        )


def dynamic_stiffness(w: np.ndarray, zeta: np.ndarray, r: np.ndarray) -> Phasors:
    """w_i^2 - r^2 + 2 i zeta_i w_i r, shape (n, n_r), without cancellation at resonance."""
    w, zeta = w[:, np.newaxis], zeta[:, np.newaxis]
    return Phasors((w - r) * (w + r), 2.0 * zeta * w * r)


def contact_responses(r: np.ndarray, body: Body) -> np.ndarray:
    """V of theory.md 2, complex (n_r,); infinite at a loaded undamped resonance.

    Where the sum over modes cancels, the balance of forces has the digits that the sum has not.
    """
    with np.errstate(all="ignore"):
        stiffness = dynamic_stiffness(body.w, body.zeta, r)
        found, cancels = _modal_sum(body, r, stiffness)
        at = np.flatnonzero(cancels)
        if at.size:
            found[at] = _balanced(body, _LoadCase(r[at], stiffness[:, at], body.load.at(r[at])), False)[1]
        return found.complex()


def held_motions(r: np.ndarray, body: Body) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """With the contact held: displacements relative to the base, or modal coordinates, and the force F.

    Complex (n_r, n), displacements if all modes participate, else the coordinates of those that do;
    complex (n_r,) F; bool (n_r,), where neither is found.
    """
    with np.errstate(all="ignore"):
        stiffness = dynamic_stiffness(body.w, body.zeta, r)
        if body.chi.all():
            found, _, force, singular = _balanced(body, _LoadCase(r, stiffness, body.load.at(r)), True)
        else:
            nothing = Phasors.zeros(r.size)
            found, force, singular = _solve_arrow(body, stiffness, body.participation.at(r), nothing)
        return found.rows(), force.complex(), singular


def _total(terms: Iterable[Phasors], shape: tuple[int, ...]) -> Phasors:
    total = Phasors.zeros(*shape)
    for term in terms:
        total = total + term
    return total


def _weighted(columns: np.ndarray, parts: Phasors) -> Phasors:
    """columns @ parts, column by column."""
    shape = (columns.shape[0], parts.re.shape[1])
    return _total((parts[i].times(column[:, np.newaxis]) for i, column in enumerate(columns.T)), shape)


def _modal_sum(body: Body, r: np.ndarray, stiffness: Phasors) -> tuple[Phasors, np.ndarray]:
    """V as the sum over modes, and whether that cancels by more than their frequencies leave uncertain."""
    parts = body.participation.at(r).times(body.chi[:, np.newaxis])
    resonant = ~stiffness.nonzero
    infinite = (resonant & parts.nonzero).any(axis=0)
    responses = (parts / stiffness).where(~resonant, Phasors.zeros(*resonant.shape))
    near = np.where(resonant, np.inf, (body.w[:, np.newaxis] ** 2 + r * r) / stiffness.size).max(axis=0)
    total, size = Phasors.zeros(r.size), np.zeros(r.size)
    for one in (responses[i] for i in range(body.w.size)):
        total, size = total + one, size + one.size
    total = total.where(~infinite, Phasors(np.full(r.size, np.inf), np.zeros(r.size)))
    return total, (size > near * total.size) & ~infinite


def _solve_arrow(
    body: Body, stiffness: Phasors, parts: Phasors, displacement: Phasors
) -> tuple[Phasors, Phasors, np.ndarray]:
    """Modes q and force F of stiffness_i q_i + chi_i F = parts_i, chi.q = gap: q, F and singular.

    One mode, the softest as the contact feels it, is solved for together with F: it may resonate.  The others
    are eliminated; those with chi = 0 stay out of it.  `singular`: whether rounding alone keeps the equations
    from being so.
    """
    seen = np.flatnonzero(body.chi)
    columns = np.arange(displacement.re.size)
    chi, stiffness, parts = body.chi[seen][:, np.newaxis], stiffness[seen], parts[seen]
    last = np.argmin(stiffness.size / (chi * chi), axis=0)
    pulled = parts.times(chi)
    compliances, responses = Phasors(chi * chi, np.zeros_like(chi)) / stiffness, pulled / stiffness
    compliance, response, size = (
        Phasors.zeros(displacement.re.size),
        displacement.times(-1.0),
        np.zeros(displacement.re.size),
    )
    for i in range(seen.size):
        other = last != i
        compliance = (compliance + compliances[i]).where(other, compliance)
        response = (response + responses[i]).where(other, response)
        size = np.where(other, size + compliances[i].size, size)
    soft, part, weight = stiffness[last, columns], parts[last, columns], chi[last, 0]
    square = weight * weight
    below = soft * compliance
    below.re += square
    singular = below.size <= body.rounding * seen.size * (square + soft.size * size)
    force = (part.times(weight) + soft * response) / below
    q = Phasors.zeros(body.chi.size, displacement.re.size)
    found = (parts - force.times(chi)) / stiffness
    found[last, columns] = (part * compliance - response.times(weight)) / below
    q[seen] = found
    return (
        q.where(~singular, Phasors.zeros(*q.re.shape)),
        force.where(~singular, displacement.times(0.0)),
        singular,
    )


def _chain_forces(body: Body, r: np.ndarray, x: Phasors, tail: Phasors) -> tuple[Phasors, np.ndarray]:
    """(K - r^2 M)(x + tail) on the masses of a chain, and the sizes of the single forces, added.

    Springs pull by their stretch: a stiff one leaves the digits of the others alone.
    """
    assert body.springs is not None
    stretch = (x[1:] - x[:-1]) + (tail[1:] - tail[:-1])
    pull, back = Phasors.zeros(*x.re.shape), Phasors.zeros(*x.re.shape)
    pull[0] = (x[0] + tail[0]).times(body.springs[0])
    pull[1:] = stretch.times(body.springs[1:, np.newaxis])
    back[:-1] = pull[1:]
    inertia = x.times(r * r * np.diagonal(body.mass)[:, np.newaxis])
    return pull - back - inertia, pull.size + back.size + inertia.size


def _matrix_forces(body: Body, r: np.ndarray, x: Phasors) -> tuple[Phasors, np.ndarray]:
    """The same of any structure."""
    square = r * r
    size, weight = np.zeros(x.re.shape), np.zeros(x.re.shape)
    for j in range(body.w.size):
        size += np.abs(body.stiffness[:, j, np.newaxis]) * x[j].size
        weight += np.abs(body.mass[:, j, np.newaxis]) * x[j].size
    pull, inertia = _weighted(body.stiffness, x), _weighted(body.mass, x)
    return pull - inertia.times(square), size + square * weight


def _residual_force(body: Body, case: _LoadCase, x: Phasors, tail: Phasors, force: Phasors) -> Phasors:
    """What of the load the forces on the masses leave, rounding apart."""
    if body.springs is not None:
        forces, size = _chain_forces(body, case.r, x, tail)
    else:
        forces, size = _matrix_forces(body, case.r, x)
    if body.zeta.any():
        # each mode's damping, by the masses' own motion
        rates = _weighted(body.mass_phi.T, x)
        rates = rates.times(2.0 * case.r * body.zeta[:, np.newaxis] * body.w[:, np.newaxis])
        for i in range(body.w.size):
            shape = body.mass_phi[:, i, np.newaxis]
            forces = forces + rates[i].turned().times(shape)
            size = size + np.abs(shape) * rates[i].size
    friction = force.times(body.contact[:, np.newaxis])
    residual = case.load - forces - friction
    rounding = _BALANCE * _EPS * (size + case.load.size + friction.size)
    return residual.where(residual.size > rounding, Phasors.zeros(*rounding.shape))


def _superposed(body: Body, motion: _Motion, q: Phasors) -> tuple[Phasors, Phasors, Phasors]:
    """x and its tail with the motion of the modes q added; z = c.x."""
    part = motion.tail
    for i in range(body.w.size):
        part = part + q[i].times(body.phi[:, i, np.newaxis])
    x = motion.x + part
    tail = part - (x - motion.x)
    terms = [array[k].times(body.contact[k]) for array in (x, tail) for k in range(body.w.size)]
    return x, tail, _total(terms, (q.re.shape[1],))


def _corrected(
    body: Body, case: _LoadCase, motion: _Motion, held: bool
) -> tuple[_Motion, np.ndarray, np.ndarray]:
    """The motion with the modes' answer to what is left, where to go on, and where it cannot be had."""
    parts = _weighted(np.ascontiguousarray(body.phi.T), motion.residual)
    if held:
        q, more, singular = _solve_arrow(body, case.stiffness, parts, motion.z.times(-1.0))
        force = motion.force + more
    else:
        q, force, singular = parts / case.stiffness, motion.force, np.zeros(case.r.size, dtype=bool)
    x, tail, z = _superposed(body, motion, q)
    found = force if held else z
    moved = (found - motion.previous).size > _EPS * found.size
    residual = _residual_force(body, case, x, tail, force)
    unbalanced = residual.nonzero.any(axis=0) | (held & z.nonzero)
    return _Motion(x, tail, residual, z, force, found), moved & unbalanced & ~singular, singular


def _balanced(body: Body, case: _LoadCase, held: bool) -> tuple[Phasors, Phasors, Phasors, np.ndarray]:
    """x, z, F and singular, corrected until every mass is in balance.

    With `held` the contact holds z = 0 by the force F; else F = 0.
    """
    n, count = body.w.size, case.r.size
    x, z, force, singular = (
        Phasors.zeros(n, count),
        Phasors.zeros(count),
        Phasors.zeros(count),
        np.zeros(count, bool),
    )
    no_response = Phasors(np.full(count, np.inf), np.zeros(count))  # the first one may be zero, as no other
    motion = _Motion(x, Phasors.zeros(n, count), case.load, z, force, no_response)
    places = np.arange(count)
    # one for every link that the load has to pass; beside a resonance each gains a digit at least
    for _ in range(n + _DIGITS):
        motion, going, singular[places] = _corrected(body, case, motion, held)
        x[:, places], z[places], force[places] = motion.x, motion.z, motion.force
        if not going.any():
            break
        which = np.flatnonzero(going)
        places, case, motion = places[which], case.at(which), motion.at(which)
    return x, z, force, singular
