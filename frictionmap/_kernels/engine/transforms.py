"""Fourier integrals over one segment, in which oscillators under a harmonic load are sums of exponentials.

Undamped oscillators may resonate with the load or with one of its harmonics, and damping may be critical.
There two exponentials coincide and their coefficients have poles; both are combined into divided differences
of exp, which have none: exp[p, q] = (e^p - e^q)/(p - q).
"""

import cmath
import math
from typing import NamedTuple

from ..closed_form import decay
from ..compiler import kernel

#: Relative distance from a harmonic below which an oscillator is integrated by divided differences; at larger
#: distances the quotient of the plain form loses at most one or two digits.
NEAR = 0.05

_MOST_TERMS = 40


class Driven(NamedTuple):
    """Oscillator y'' + d y' + k y = Re(force e^{i theta}) + constant from (y, v); theta is tau since the
    segment began.
    """

    k: float
    d: float
    force: complex
    constant: float
    y: float
    v: float


@kernel
def _expm1(z):
    """Compute e^z - 1 to rounding for every z, however small."""
    rise = math.expm1(z.real)
    half = math.sin(0.5 * z.imag)
    return complex(rise * math.cos(z.imag) - 2.0 * half * half, (1.0 + rise) * math.sin(z.imag))


@kernel
def first_difference(p, q):
    """Compute exp[p, q], which is e^p where p = q."""
    if p.real > q.real:
        p, q = q, p  # factor out the larger exponential, which avoids overflow
    gap = p - q
    if gap == 0.0:
        return cmath.exp(q)
    return cmath.exp(q) * _expm1(gap) / gap


@kernel
def second_difference(z, w):
    """Compute exp[0, z, w], dividing by the largest of the three distances."""
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
    """Compute exp[0, z, w] by its series: the sum of h_k(z, w)/(k + 2)!, h_k being the sum of all z^j w^(k -
    j).
    """
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
    """Integral of e^{a theta} over 0 < theta < length, E(a, l) of docs/theory.md."""
    return length * first_difference(a * length, 0j)


@kernel
def _root(o):
    """Characteristic root with positive imaginary part of an under-damped oscillator."""
    return complex(-0.5 * o.d, math.sqrt(o.k - 0.25 * o.d * o.d))


@kernel
def _circling(y, v, s):
    """Compute u = y' - conj(s) y, for which u' - s u equals the load on the oscillator."""
    return complex(v - s.real * y, s.imag * y)


@kernel
def _light_end(o, length):
    """Compute `end_of` for light damping; resonance needs no special case."""
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
    """Compute `end_of` for damping that excludes resonance, up to and beyond the critical ratio."""
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
    """Compute (y, y') of an oscillator at the end of a segment."""
    if o.d * o.d < o.k:  # below half of the critical damping
        return _light_end(o, length)
    return _heavy_end(o, length)


@kernel
def near_harmonic(k, d, n):
    """Whether an oscillator is close to resonance with the n-th harmonic."""
    return abs(complex(k - n * n, n * d)) < NEAR * (k + n * n)


@kernel
def transform(o, n, length, change, push, drive):
    """Integral of y e^{-i n theta} over a segment.

    Integrating the equation of motion by parts gives it, except close to resonance with the n-th harmonic,
    where that form is 0/0; there it is the sum of exponentials.

    Parameters
    ----------
    o : Driven
    n : number of the harmonic
    length : duration of the segment in tau
    change, push : differences between end and start of y e^{-i n theta} and of y' e^{-i n theta}
    drive : integral of (Re(force e^{i theta}) + constant) e^{-i n theta}
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
