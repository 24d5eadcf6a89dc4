"""Damping functions of several modes over many frequencies, for searches of the zeros of their sums."""

from ..closed_form import damping_functions
from ..compiler import entry


@entry
def fill_damping_functions(r, w, zeta, u, g):
    """Fill u and g, (n_r, n), of T(7.11), (7.12) for frequencies r > 0, (n_r,), and modes w, zeta, (n,)."""
    for j in range(r.size):
        for i in range(w.size):
            u[j, i], g[j, i] = damping_functions(w[i], zeta[i], r[j])
