"""The largest modulus of the eigenvalues of a matrix, from its powers."""

import math

from .compiler import kernel

#: Squarings at most, and the relative error that is allowed: that of the root of the norm of the last power.
_SQUARINGS = 40
_EXACT = 2.0**-_SQUARINGS

_EPS = 2.0**-52


@kernel
def _frobenius(matrix, n):
    """Root of the sum of the squares of the entries of a matrix."""
    total = 0.0
    for i in range(n):
        for j in range(n):
            total += matrix[i, j] * matrix[i, j]
    return math.sqrt(total)


@kernel
def _square(a, n, matrix):
    """Set `matrix` to the square of a."""
    for i in range(n):
        for j in range(n):
            matrix[i, j] = 0.0
        for k in range(n):
            for j in range(n):
                matrix[i, j] += a[i, k] * a[k, j]


@kernel
def _symmetric_functions(a, square, n):
    """Sums of the products of one, two and three eigenvalues of a, by Newton's identities."""
    first = second = third = 0.0
    for i in range(n):
        first += a[i, i]
        second += square[i, i]
        for j in range(n):
            third += a[i, j] * square[j, i]
    return (
        first,
        0.5 * (first * first - second),
        (first * (first * first - 3.0 * second) + 2.0 * third) / 6.0,
    )


@kernel
def _miss(a, square, n, sum_, product):
    """Norm of a^3 - sum a^2 + product a: zero if all but two eigenvalues are zero."""
    total = 0.0
    for i in range(n):
        for j in range(n):
            entry = product * a[i, j] - sum_ * square[i, j]
            for k in range(n):
                entry += a[i, k] * square[k, j]
            total += entry * entry
    return math.sqrt(total)


@kernel
def _rank_two_radius(a, square, n, power):
    """Spectral radius of a matrix of norm 1 if all but two eigenvalues are negligible, else -1.

    Every eigenvalue x is such that |x (x - x1) (x - x2)| is at most `_miss`, with x1 and x2 the roots of
    x^2 - sum x + product.  The radius is that of x1 and x2 where its root of order `power` is exact.

    Parameters
    ----------
    a, square : (n, n) the matrix and its square
    n : its size
    power : the matrix is this power of another, whose spectral radius is wanted
    """
    sum_, product, three = _symmetric_functions(a, square, n)
    square_gap = sum_ * sum_ - 4.0 * product
    gap = math.sqrt(abs(square_gap))
    radius = 0.5 * (abs(sum_) + gap) if square_gap >= 0.0 else math.sqrt(product)
    move = _EXACT * power * radius  # allowed of the larger root; of a double one it is the square root
    allowed = radius * move * max(gap, move)
    # a sum of n products has this rounding error, so that less cannot be shown
    if not max(abs(three), n * _EPS) <= allowed:
        return -1.0
    return radius if _miss(a, square, n, sum_, product) <= allowed else -1.0


@kernel
def spectral_radius(matrix, n, a, precision):
    """Largest modulus of the eigenvalues, from a high power: its own where two eigenvalues are left, else
    the root of its norm.

    The root of the norm never increases from one squaring to the next, and never falls below the radius.  A
    double eigenvalue of a defective matrix is exact to 1e-6 only, as the squarings amplify rounding errors.

    Parameters
    ----------
    matrix : (n, n), overwritten
    n : its size
    a : (n, n) scratch
    precision : error allowed, relative to the distance of the radius from 1, if it is below 1; 0 for rounding
    """
    log = 0.0
    power = 1.0
    last = math.inf
    for squarings in range(_SQUARINGS + 1):
        norm = _frobenius(matrix, n)
        if norm == 0.0:
            return 0.0
        log += math.log(norm)
        radius = math.exp(log / power)
        # the error halves with every squaring
        if squarings == _SQUARINGS or (radius < 1.0 and last - radius <= precision * (1.0 - radius)):
            return radius
        last = radius
        for i in range(n):
            for j in range(n):
                a[i, j] = matrix[i, j] / norm
        _square(a, n, matrix)
        if precision == 0.0:
            radius = _rank_two_radius(a, matrix, n, power)
            if radius > 0.0:
                return math.exp((log + math.log(radius)) / power)
        log *= 2.0
        power *= 2.0
    return last


@kernel
def contracts(matrix, n, a):
    """Whether all eigenvalues of a matrix lie inside the unit circle.

    Parameters
    ----------
    matrix : (n, n), overwritten
    n : its size
    a : (n, n) scratch
    """
    return spectral_radius(matrix, n, a, math.inf) < 1.0
