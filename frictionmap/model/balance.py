"""Linear response of a structure, free or held at its contact, at many frequencies.

A sum over modes is accurate to the rounding error of its largest term, but a mass far from the load may move
by less than that.  The residual of the force balance on each mass reveals this; the modal response to the
residual corrects the motion, until every mass is in balance to rounding.

Arrays are (masses or modes, frequencies) or (frequencies,).  All sums run over masses or modes one by one in
a fixed order, so that the result at one frequency does not depend on the other frequencies.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from .phasors import Phasors

_EPS = float(np.finfo(np.float64).eps)

#: Decimal digits of a double.
_DIGITS = 16

#: A mass is in balance if the forces on it add up to zero within this many eps of the sum of their moduli.
_BALANCE = 4.0


class Polynomial(NamedTuple):
    """Phasors constant + i r rate + r^2 square; complex (n,) each."""

    constant: np.ndarray
    rate: np.ndarray
    square: np.ndarray

    def at(self, r: np.ndarray) -> Phasors:
        """Evaluate at frequencies r; shape (n, n_r)."""
        constant, rate, square = (part[:, np.newaxis] for part in self)
        return Phasors(
            constant.real - r * rate.imag + r * r * square.real,
            constant.imag + r * rate.real + r * r * square.imag,
        )


class Body(NamedTuple):
    """A structure as arrays, and its load."""

    w: np.ndarray  # (n,)
    zeta: np.ndarray
    phi: np.ndarray  # (n, n), modes in columns
    chi: np.ndarray  # (n,)
    contact: np.ndarray  # (n,)
    mass: np.ndarray  # (n, n)
    stiffness: np.ndarray
    springs: np.ndarray | None  # (n,) of a chain
    mass_phi: np.ndarray  # (n, n) M phi
    load: Polynomial
    participation: Polynomial  # participation of the load
    rounding: float  # a sum below this share of its terms, times their number, is zero


class _LoadCase(NamedTuple):
    """Frequencies to solve for, with dynamic stiffness and load there."""

    r: np.ndarray
    stiffness: Phasors  # dynamic stiffness of every mode
    load: Phasors

    def at(self, which: np.ndarray) -> "_LoadCase":
        return _LoadCase(self.r[which], self.stiffness[:, which], self.load[:, which])


class _Motion(NamedTuple):
    """Present approximation of the motion at these frequencies."""

    x: Phasors
    tail: Phasors  # digits of x below its rounding, needed for the stretch of a stiff spring
    residual: Phasors  # force that is not yet in balance
    z: Phasors
    force: Phasors
    previous: Phasors  # z or F of the previous approximation

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
    """Response function V of theory.md 2, complex (n_r,); infinite at a loaded undamped resonance.

    Where the sum over modes cancels, the force balance is solved instead, which keeps the digits lost in the
    sum.
    """
    with np.errstate(all="ignore"):
        stiffness = dynamic_stiffness(body.w, body.zeta, r)
        found, cancels = _modal_sum(body, r, stiffness)
        at = np.flatnonzero(cancels)
        if at.size:
            found[at] = _balanced(body, _LoadCase(r[at], stiffness[:, at], body.load.at(r[at])), False)[1]
        return found.complex()


def held_motions(r: np.ndarray, body: Body) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Motion with the contact held: displacements relative to the base, or modal coordinates, and the force
    F.

    Returns
    -------
    (motion, force, singular) : complex (n_r, n), displacements if all modes participate, else the coordinates
        of the participating modes; complex (n_r,); bool (n_r,), where neither is found
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
    """Compute columns @ parts, column by column."""
    shape = (columns.shape[0], parts.re.shape[1])
    return _total((parts[i].times(column[:, np.newaxis]) for i, column in enumerate(columns.T)), shape)


def _modal_sum(body: Body, r: np.ndarray, stiffness: Phasors) -> tuple[Phasors, np.ndarray]:
    """V as the sum over modes, and whether the sum cancels by more than the accuracy of the frequencies
    explains.
    """
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
    """Solve stiffness_i q_i + chi_i F = parts_i, chi.q = displacement for the modes q and the force F.

    The mode that is softest at the contact is solved for together with F, because it may resonate.  The other
    modes are eliminated; modes with chi = 0 are excluded.  Returns q, F, and whether the equations are
    singular except for rounding.
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
    """Forces (K - r^2 M)(x + tail) on the masses of a chain, and the sum of the moduli of the single forces.

    Each spring force follows from its stretch, so that a stiff spring does not cost the digits of the others.
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
    """Forces (K - r^2 M) x on the masses of any structure, and the sum of the moduli of the single forces."""
    square = r * r
    size, weight = np.zeros(x.re.shape), np.zeros(x.re.shape)
    for j in range(body.w.size):
        size += np.abs(body.stiffness[:, j, np.newaxis]) * x[j].size
        weight += np.abs(body.mass[:, j, np.newaxis]) * x[j].size
    pull, inertia = _weighted(body.stiffness, x), _weighted(body.mass, x)
    return pull - inertia.times(square), size + square * weight


def _residual_force(body: Body, case: _LoadCase, x: Phasors, tail: Phasors, force: Phasors) -> Phasors:
    """Residual of the force balance on the masses, zero where it is rounding error."""
    if body.springs is not None:
        forces, size = _chain_forces(body, case.r, x, tail)
    else:
        forces, size = _matrix_forces(body, case.r, x)
    if body.zeta.any():
        # damping force of each mode, from the motion of the masses
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
    """Add the motion of the modes q to x and its tail; also return z = c.x."""
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
    """Add the modal response to the residual; return the motion, where to continue, and where there is no
    solution.
    """
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
    """Motion x, z, F and singular, corrected until every mass is in balance.

    With `held` the force F holds the contact at z = 0; otherwise F = 0.
    """
    n, count = body.w.size, case.r.size
    x, z, force, singular = (
        Phasors.zeros(n, count),
        Phasors.zeros(count),
        Phasors.zeros(count),
        np.zeros(count, bool),
    )
    no_response = Phasors(
        np.full(count, np.inf), np.zeros(count)
    )  # unlike any first approximation, also zero
    motion = _Motion(x, Phasors.zeros(n, count), case.load, z, force, no_response)
    places = np.arange(count)
    # one iteration per link between load and mass; near a resonance each gains at least one digit
    for _ in range(n + _DIGITS):
        motion, going, singular[places] = _corrected(body, case, motion, held)
        x[:, places], z[places], force[places] = motion.x, motion.z, motion.force
        if not going.any():
            break
        which = np.flatnonzero(going)
        places, case, motion = places[which], case.at(which), motion.at(which)
    return x, z, force, singular
