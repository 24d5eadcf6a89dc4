"""First damping functions of several modes over many frequencies, for searches of zeros of their sums."""

from ..closed_form import damping_functions
from ..jit import entry


@entry
def first_damping_functions(r, w, zeta, u):
    """Fill u, shape (n_r, n), of T(7.11) for frequencies r > 0, (n_r,), and modes w, zeta, (n,)."""
    for j in range(r.size):
        for i in range(w.size):
            u[j, i], _ = damping_functions(w[i], zeta[i], r[j])
