"""Fourier integrals over a phase against their closed form in 150 digits, next to its poles."""

import cmath
import math

import mpmath as mp
import numpy as np
import pytest
from kernels import callable_kernel

from frictionmap._kernels.engine import transforms

#: Half of them: what two roots that meet leave of the digits of the closed form.
DIGITS, APART = 150, mp.mpf(10) ** -60

end_of, transform, integral = map(
    callable_kernel, (transforms.end_of, transforms.transform, transforms.integral)
)


def oscillators(number):
    """Frequencies in step with harmonics, next to it and elsewhere; light, critical and heavy damping."""
    rng = np.random.default_rng(12)
    for _ in range(number):
        beside = rng.choice([1.0, 3.0]) * (1.0 + rng.uniform(-1.0, 1.0) * 10.0 ** rng.uniform(-12.0, -1.0))
        w = rng.choice([1.0, 3.0, 5.0, beside, rng.uniform(0.3, 12.0)])
        zeta = rng.choice([0.0, 0.0, 10.0 ** rng.uniform(-10.0, -1.0), 0.499, 1.0, 1.0 + 1e-9, 30.0])
        force, constant, y, v = complex(*rng.normal(size=2)), *rng.normal(size=3)
        length = rng.choice([math.pi, rng.uniform(0.0, 6.3), 10.0 ** rng.uniform(-9.0, 0.0)])
        yield transforms.Driven(w * w, 2.0 * zeta * w, force, constant, y, v), float(length)


def exact_sum(o):
    """Coefficients and exponents of y; poles are kept apart by less than can be seen."""
    k, d = mp.mpf(o.k), mp.mpf(o.d)
    k += APART if k == 1 and d == 0 else 0
    root = mp.sqrt(d * d / 4 - k) or mp.sqrt(APART)
    s, t = -d / 2 + root, -d / 2 - root
    steady, rest = mp.mpc(o.force) / mp.mpc(k - 1, d), mp.mpf(o.constant) / k
    place, speed = o.y - rest - steady.real, o.v + steady.imag
    first = (speed - t * place) / (s - t)
    return [
        (steady / 2, mp.mpc(0, 1)), (mp.conj(steady) / 2, mp.mpc(0, -1)), (rest, mp.mpf(0)), (first, s),
        (place - first, t),
    ]  # fmt: skip


def exact_integral(a, length):
    return mp.expm1(a * length) / a if a else mp.mpf(length)


@pytest.mark.parametrize(("o", "length"), list(oscillators(60)))
def test_integrals_over_a_phase(o, length):
    with mp.workdps(DIGITS):
        terms = exact_sum(o)
        end = [float(mp.re(sum(c * s**j * mp.exp(s * length) for c, s in terms))) for j in range(2)]
        exact = [
            complex(sum(c * exact_integral(s - mp.mpc(0, n), length) for c, s in terms)) for n in range(8)
        ]
    w = math.sqrt(o.k)
    # the sum of the parts rounds, at most as many times over as the damping outweighs what is looked for
    size = abs(o.y) + abs(o.v) / w + (abs(o.force) + abs(o.constant)) / min(1.0, o.k) + abs(o.v)
    rounding = 1e-14 * size * (1.0 + o.d / o.k)
    y, v = end_of(o, length)
    assert y == pytest.approx(end[0], abs=rounding)
    assert v == pytest.approx(end[1], abs=rounding * (1.0 + w))
    for n in range(8):
        turn = cmath.exp(complex(0.0, -n * length))
        up, down, flat = (integral(complex(0.0, m), length) for m in (1.0 - n, -1.0 - n, -float(n)))
        drive = 0.5 * (o.force * up + o.force.conjugate() * down) + o.constant * flat
        found = transform(o, float(n), length, y * turn - o.y, v * turn - o.v, drive)
        assert abs(found - exact[n]) < 10.0 * rounding * (1.0 + o.d)
