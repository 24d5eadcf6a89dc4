"""Response functions of one mass, and damping functions of several modes, over many frequencies."""

import math

from ..closed_form import damping_functions
from ..compiler import entry
from .one_mass import largest_bracket


@entry
def response_functions(r, zeta, u, g, v_abs, v_arg, h, s):
    """Fill the functions of theory 2 and 3 for one mode with w = chi = lambda = 1.

    Parameters
    ----------
    r : (n,) frequency ratios >= 0
    zeta : damping ratio
    u, g, h, s : (n,) outputs U, G, H, S
    v_abs, v_arg : (n,) outputs, V = 1/(1 - r^2 + 2 i zeta r)

    Notes
    -----
    At r = 0 (limits): V = 1, S infinite; U has no limit without damping (nan) and is 0 with it.  At an
    undamped resonance V and U are infinite.
    """
    for i in range(r.size):
        x = r[i]
        if x == 0.0:
            v_abs[i] = 1.0
            v_arg[i] = 0.0
            u[i] = math.nan if zeta == 0.0 else 0.0
            g[i] = 0.0 if zeta == 0.0 else 1.0
            h[i] = 0.0 if zeta == 0.0 else math.inf
            s[i] = math.inf
            continue
        real = (1.0 - x) * (1.0 + x)
        imaginary = 2.0 * zeta * x
        size = math.hypot(real, imaginary)
        v_abs[i] = 1.0 / size if size > 0.0 else math.inf
        v_arg[i] = -math.atan2(imaginary, real)
        u[i], g[i] = damping_functions(1.0, zeta, x)
        inverse = 1.0 / (x * x)
        h[i] = 0.0 if zeta == 0.0 else inverse * (g[i] + 2.0 * zeta * x * u[i])
        s[i] = largest_bracket(1.0 / x, zeta, u[i], g[i], h[i] + inverse)


@entry
def fill_damping_functions(r, w, zeta, u, g):
    """Fill u and g, (n_r, n), of T(7.11), (7.12) for frequencies r > 0, (n_r,), and modes w, zeta, (n,)."""
    for j in range(r.size):
        for i in range(w.size):
            u[j, i], g[j, i] = damping_functions(w[i], zeta[i], r[j])
