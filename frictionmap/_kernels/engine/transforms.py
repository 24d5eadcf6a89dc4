"""Fourier integrals over a phase, in which oscillators under one load are sums of exponentials.

Undamped oscillators may be in step with the load or with one of its harmonics, and damping may be critical.
There exponentials meet whose coefficients have poles, so they are taken together as divided differences of
exp, which have none: exp[p, q] = (e^p - e^q)/(p - q).
"""

import cmath
import math
from typing import NamedTuple

from ..closed_form import decay
from ..jit import kernel

#: Relative distance from a harmonic below which an oscillator is integrated as divided differences: beyond
#: it the quotient of the plain form takes a digit or two from what rounding leaves.
NEAR = 0.05

_MOST_TERMS = 40


class Driven(NamedTuple):
    """y'' + d y' + k y = Re(force e^{i theta}) + constant from (y, v); theta is tau since the phase began."""

    k: float
    d: float
    force: complex
    constant: float
    y: float
    v: float


@kernel
def _expm1(z):
    """e^z - 1 to rounding, however small z is."""
    rise = math.expm1(z.real)
    half = math.sin(0.5 * z.imag)
    return complex(rise * math.cos(z.imag) - 2.0 * half * half, (1.0 + rise) * math.sin(z.imag))


@kernel
def first_difference(p, q):
    """exp[p, q], e^p where they are equal."""
    if p.real > q.real:
        p, q = q, p  # the larger one outside: nothing overflows that need not
    gap = p - q
    if gap == 0.0:
        return cmath.exp(q)
    return cmath.exp(q) * _expm1(gap) / gap


@kernel
def second_difference(z, w):
    """exp[0, z, w]: the difference of two first ones over the largest of the three distances."""
    far = max(max(abs(z), abs(w)), abs(z - w))
    if far <= 1.0:
        return _near_zero(z, w)
    zero = 0j
    if far == abs(z):
        return (first_difference(w, z) - first_difference(zero, w)) / z
    if far == abs(w):
        return (first_difference(z, w) - first_difference(zero, z)) / w
    return (first_difference(z, zero) - first_difference(zero, w)) / (z - w)


@kernel
def _near_zero(z, w):
    """The same by its series, sum of h_k(z, w)/(k + 2)!, h_k the sum of all z^j w^(k - j)."""
    sums, power, factor = complex(1.0, 0.0), complex(1.0, 0.0), 0.5
    total = factor * sums
    for k in range(1, _MOST_TERMS):
        power *= w
        sums = z * sums + power
        factor /= k + 2.0
        total += factor * sums
        if factor * (k + 1.0) < 1e-18:  # |h_k| <= k + 1
            break
    return total


@kernel
def integral(a, length):
    """int e^{a theta} over 0 < theta < length, E(a, l) of docs/theory.md."""
    return length * first_difference(a * length, 0j)


@kernel
def _root(o):
    """The root with the positive imaginary part, of an oscillator damped below the critical ratio."""
    return complex(-0.5 * o.d, math.sqrt(o.k - 0.25 * o.d * o.d))


@kernel
def _circling(y, v, s):
    """u = y' - conj(s) y, for which u' - s u is what drives the oscillator."""
    return complex(v - s.real * y, s.imag * y)


@kernel
def _light_end(o, length):
    """`end_of` where the damping is light; resonance is no case of its own."""
    s = _root(o)
    exponent = s * length
    turn = complex(0.0, length)
    drive = 0.5 * (
        o.force * first_difference(turn, exponent) + o.force.conjugate() * first_difference(-turn, exponent)
    )
    drive += o.constant * first_difference(0j, exponent)
    u = cmath.exp(exponent) * _circling(o.y, o.v, s) + length * drive
    y = u.imag / s.imag
    return y, u.real + s.real * y


@kernel
def _heavy_end(o, length):
    """`end_of` where the damping keeps resonance away; up to and beyond the critical ratio."""
    omega = math.sqrt(o.k)
    zeta = 0.5 * o.d / omega
    steady, static = o.force / complex(o.k - 1.0, o.d), o.constant / o.k
    q, e = decay(zeta, omega * length)
    displacement, speed = o.y - static - steady.real, (o.v + steady.imag) / omega
    turned = steady * cmath.exp(complex(0.0, length))
    return (
        static + turned.real + displacement * (e + 2.0 * zeta * q) + speed * q,
        -turned.imag + omega * (speed * e - displacement * q),
    )


@kernel
def end_of(o, length):
    """(y, y') of an oscillator at the end of a phase."""
    if o.d * o.d < o.k:  # half of the critical damping
        return _light_end(o, length)
    return _heavy_end(o, length)


@kernel
def near_harmonic(k, d, n):
    """Whether an oscillator is so near to the n-th harmonic that it answers nearly without bound."""
    return abs(complex(k - n * n, n * d)) < NEAR * (k + n * n)


@kernel
def transform(o, n, length, change, push, drive):
    """int y e^{-i n theta} over a phase.

    change, push : y e^{-i n theta} at the end less that at the start, and the same of y'
    drive : int (Re(force e^{i theta}) + constant) e^{-i n theta}

    Integrated by parts, the equation of motion gives it; near the n-th harmonic, where that is 0/0, the sum
    of exponentials does.
    """
    if not near_harmonic(o.k, o.d, n):
        return (drive - push - complex(o.d, n) * change) / complex(o.k - n * n, n * o.d)
    s = _root(o)
    exponent = (s - complex(0.0, n)) * length
    up, down = complex(0.0, (1.0 - n) * length), complex(0.0, -(1.0 + n) * length)
    drive = 0.5 * (
        o.force * second_difference(up, exponent) + o.force.conjugate() * second_difference(down, exponent)
    )
    drive += o.constant * second_difference(complex(0.0, -n * length), exponent)
    circling = _circling(o.y, o.v, s) * first_difference(exponent, 0j) + length * drive
    return (length * circling - change) / (complex(0.0, n) - s.conjugate())
