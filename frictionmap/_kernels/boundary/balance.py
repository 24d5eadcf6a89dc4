"""A structure under its harmonic load without friction, free or held at its contact, frequency by frequency.

The modes' answers are right to the rounding of the largest of them, and a mass far from the load may move by
less.  What is left of the balance of its own forces tells; the modes' answer to that corrects it, and masses
in balance to rounding are left alone.

Each frequency has scalar arithmetic of its own: operations on whole arrays round by the place in them, and
an answer must not depend on which other frequencies are asked for.
"""

import math
from typing import NamedTuple

import numpy as np

from ..jit import entry, kernel

_EPS = float(np.finfo(np.float64).eps)

#: Decimal digits of a double.
_DIGITS = 16

#: The forces on a mass add up to zero within so many eps of their sizes: it is in balance.
_BALANCE = 4.0


class Body(NamedTuple):
    """A structure in numbers, and its load p(r) = load + i r load_rate + r^2 load_square."""

    w: np.ndarray  # (n,)
    zeta: np.ndarray
    phi: np.ndarray  # (n, n), one mode a column
    chi: np.ndarray  # (n,)
    contact: np.ndarray  # (n,)
    mass: np.ndarray  # (n, n)
    stiffness: np.ndarray
    springs: np.ndarray  # (n,) of a chain, else (0,)
    shapes: np.ndarray  # (n, n) M phi
    load: np.ndarray  # (n,) complex
    load_rate: np.ndarray
    load_square: np.ndarray
    share: np.ndarray  # (n,) complex: the participation of these three
    share_rate: np.ndarray
    share_square: np.ndarray
    rounding: float  # what cancels but for this share of its terms, for each of them, is zero


class Motion(NamedTuple):
    """Arrays that kernels write into, complex (n,)."""

    stiffness: np.ndarray  # dynamic stiffness of every mode
    load: np.ndarray
    x: np.ndarray
    tail: np.ndarray  # of x, below its rounding: the stretch of a stiff spring may be
    left: np.ndarray  # of the load, not in balance yet
    parts: np.ndarray  # participation of what is left
    q: np.ndarray  # modal coordinates
    spread: np.ndarray


@entry
def make_motion(n):
    """Arrays for n masses."""
    one = np.zeros((8, n), dtype=np.complex128)
    return Motion(one[0], one[1], one[2], one[3], one[4], one[5], one[6], one[7])


@kernel
def _damped(body):
    """Whether any mode is."""
    damped = False
    for zeta in body.zeta:
        damped = damped or zeta != 0.0
    return damped


@kernel
def _times(factor, number):
    """A complex number times a real one."""
    return complex(factor * number.real, factor * number.imag)


@kernel
def _fill_phasors(r, constant, rate, square, out):
    """constant + i r rate + r^2 square."""
    for i in range(out.size):
        out[i] = complex(
            constant[i].real - r * rate[i].imag + r * r * square[i].real,
            constant[i].imag + r * rate[i].real + r * r * square[i].imag,
        )


@kernel
def _fill_stiffness(body, r, out):
    """w_i^2 - r^2 + 2 i zeta_i w_i r, without cancellation at resonance."""
    for i in range(out.size):
        w = body.w[i]
        out[i] = complex((w - r) * (w + r), 2.0 * body.zeta[i] * w * r)


@kernel
def _softest(stiffness, chi):
    """The mode with the least stiffness as the contact feels it."""
    last = -1
    least = math.inf
    for i in range(chi.size):
        if chi[i] != 0.0 and (last < 0 or abs(stiffness[i]) / (chi[i] * chi[i]) < least):
            last = i
            least = abs(stiffness[i]) / (chi[i] * chi[i])
    return last


@kernel
def _solve_arrow(body, stiffness, parts, gap, q):
    """Modes q and force F of stiffness_i q_i + chi_i F = parts_i, chi.q = gap: (F, singular).

    One mode, the softest, is solved for together with F: it may resonate.  The others are eliminated; those
    with chi = 0 stay out of it.  `singular`: whether rounding alone keeps the equations from being so.
    """
    chi = body.chi
    last = _softest(stiffness, chi)
    compliance = 0j
    response = -gap
    size = 0.0
    count = 1
    for i in range(chi.size):
        q[i] = 0j
        if chi[i] != 0.0 and i != last:
            one = chi[i] * chi[i] / stiffness[i]
            compliance += one
            size += abs(one)
            response += _times(chi[i], parts[i]) / stiffness[i]
            count += 1
    square = chi[last] * chi[last]
    below = square + stiffness[last] * compliance
    if abs(below) <= body.rounding * count * (square + abs(stiffness[last]) * size):
        return 0j, True
    force = (_times(chi[last], parts[last]) + stiffness[last] * response) / below
    for i in range(chi.size):
        if chi[i] != 0.0 and i != last:
            q[i] = (parts[i] - _times(chi[i], force)) / stiffness[i]
    q[last] = (parts[last] * compliance - _times(chi[last], response)) / below
    return force, False


@kernel
def _chain_forces(body, r, motion, k):
    """(K - r^2 M)(x + tail) on mass k of a chain, and the sizes of its single forces, added.

    Springs pull by their stretch: a stiff one leaves the digits of the others alone.
    """
    x, tail = motion.x, motion.tail
    stretch = x[k] + tail[k] if k == 0 else (x[k] - x[k - 1]) + (tail[k] - tail[k - 1])
    pull = _times(body.springs[k], stretch)
    back = 0j
    if k + 1 < x.size:
        back = _times(body.springs[k + 1], (x[k + 1] - x[k]) + (tail[k + 1] - tail[k]))
    inertia = _times(r * r * body.mass[k, k], x[k])
    return pull - back - inertia, abs(pull) + abs(back) + abs(inertia)


@kernel
def _matrix_forces(body, r, motion, k):
    """The same of any structure."""
    pull = inertia = 0j
    size = weight = 0.0
    for j in range(motion.x.size):
        x = motion.x[j]
        pull += _times(body.stiffness[k, j], x)
        inertia += _times(body.mass[k, j], x)
        size += abs(body.stiffness[k, j]) * abs(x)
        weight += abs(body.mass[k, j]) * abs(x)
    return pull - _times(r * r, inertia), size + r * r * weight


@kernel
def _fill_left(body, r, force, damped, motion):
    """What of the load the forces on the masses leave, rounding apart, into motion.left; whether any is."""
    n = body.w.size
    rates = motion.spread
    for i in range(n if damped else 0):
        rates[i] = 0j
        for k in range(n):
            rates[i] += _times(body.shapes[k, i], motion.x[k])
        rates[i] = _times(2.0 * r * body.zeta[i] * body.w[i], rates[i])
    any_left = False
    for k in range(n):
        if body.springs.size > 0:
            forces, size = _chain_forces(body, r, motion, k)
        else:
            forces, size = _matrix_forces(body, r, motion, k)
        for i in range(n if damped else 0):
            forces += _times(body.shapes[k, i], complex(-rates[i].imag, rates[i].real))
            size += abs(body.shapes[k, i]) * abs(rates[i])
        friction = _times(body.contact[k], force)
        left = motion.load[k] - forces - friction
        rounding = _BALANCE * _EPS * (size + abs(motion.load[k]) + abs(friction))
        motion.left[k] = 0j if abs(left) <= rounding else left
        any_left = any_left or motion.left[k] != 0j
    return any_left


@kernel
def _add_answer(body, motion):
    """Add the motion of the modes q to x and its tail; z = c.x."""
    z = 0j
    for k in range(motion.x.size):
        part = motion.tail[k]
        for i in range(motion.x.size):
            part += _times(body.phi[k, i], motion.q[i])
        whole = motion.x[k] + part
        motion.tail[k] = part - (whole - motion.x[k])
        motion.x[k] = whole
    for k in range(motion.x.size):
        z += _times(body.contact[k], motion.x[k])
    for k in range(motion.x.size):
        z += _times(body.contact[k], motion.tail[k])
    return z


@kernel
def _balanced(body, r, held, damped, motion):
    """x into motion.x, and (z, F, singular), corrected until every mass is in balance.

    With `held` the contact holds z = 0 by the force F; else F = 0.  motion.stiffness and load are given.
    """
    n = body.w.size
    for k in range(n):
        motion.x[k] = motion.tail[k] = 0j
        motion.left[k] = motion.load[k]
    z = force = 0j
    last = complex(math.inf, 0.0)  # the first answer may be zero, as no other
    # one for every link that the load has to pass; beside a resonance each gains a digit at least
    for _ in range(n + _DIGITS):
        for i in range(n):
            motion.parts[i] = 0j
            for k in range(n):
                motion.parts[i] += _times(body.phi[k, i], motion.left[k])
        if held:
            more, singular = _solve_arrow(body, motion.stiffness, motion.parts, -z, motion.q)
            if singular:
                return z, force, True
            force += more
        else:
            for i in range(n):
                motion.q[i] = motion.parts[i] / motion.stiffness[i]
        z = _add_answer(body, motion)
        found = force if held else z
        if not abs(found - last) > _EPS * abs(found):
            break
        last = found
        if not _fill_left(body, r, force, damped, motion) and not (held and z != 0j):
            break
    return z, force, False


@kernel
def _modal_sum(body, r, motion):
    """V as the sum over modes, and whether that cancels by more than their frequencies leave uncertain."""
    total = 0j
    size = near = 0.0
    for i in range(body.w.size):
        w = body.w[i]
        stiffness = motion.stiffness[i]
        part = _times(body.chi[i], motion.parts[i])
        if stiffness == 0j:
            if part != 0j:
                return complex(math.inf, 0.0), False
            near = math.inf
            continue
        near = max(near, (w * w + r * r) / abs(stiffness))
        total += part / stiffness
        size += abs(part / stiffness)
    return total, size > near * abs(total)


@entry
def contact_responses(r, body, out):
    """V of theory.md 2 at frequencies r, complex (n_r,); infinite at a loaded undamped resonance.

    Where the sum over modes cancels, the balance of forces has the digits that the sum has not.
    """
    motion = make_motion(body.w.size)
    damped = _damped(body)
    for j in range(r.size):
        _fill_stiffness(body, r[j], motion.stiffness)
        _fill_phasors(r[j], body.share, body.share_rate, body.share_square, motion.parts)
        out[j], cancels = _modal_sum(body, r[j], motion)
        if cancels:
            _fill_phasors(r[j], body.load, body.load_rate, body.load_square, motion.load)
            out[j], _, _ = _balanced(body, r[j], False, damped, motion)


@entry
def held_motions(r, body, all_participate, out, force, singular):
    """With the contact held: displacements relative to the base, or modal coordinates, and the force F.

    `out` (n_r, n), complex, has displacements if all modes participate, else the coordinates of those that
    do.  `force` (n_r,), complex; `singular` (n_r,) bool, where neither is found.
    """
    motion = make_motion(body.w.size)
    damped = _damped(body)
    for j in range(r.size):
        _fill_stiffness(body, r[j], motion.stiffness)
        if all_participate:
            _fill_phasors(r[j], body.load, body.load_rate, body.load_square, motion.load)
            _, force[j], singular[j] = _balanced(body, r[j], True, damped, motion)
            found = motion.x
        else:
            _fill_phasors(r[j], body.share, body.share_rate, body.share_square, motion.parts)
            force[j], singular[j] = _solve_arrow(body, motion.stiffness, motion.parts, 0j, motion.q)
            found = motion.q
        for k in range(found.size):
            out[j, k] = found[k]
