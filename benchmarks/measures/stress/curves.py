"""Groups of curves: singular frequencies, damping ratios and structures."""

from ...references.closed_forms import mp
from .bodies import chain, chains, close_modes, one_mass
from .check_curves import check_curves
from .group import Group
from .points import around, exponents


def curves_at_r(quick: bool) -> Group:
    """One mass at r = 1, 1/(2n), 1/(2n + 1)."""
    group = Group("curves, r around 1, 1/2, 1/3 ...")
    orders = (1, 3) if quick else (1, 2, 3, 4, 5, 6, 9, 10)
    for body in (one_mass(0.0), one_mass(1e-6), one_mass(0.05), one_mass(0.0, "joined-base-wall")):
        for n in orders:
            check_curves(group, body, around(mp.mpf(1) / n, exponents(quick)))
    return group


def curves_at_zeta(quick: bool) -> Group:
    """One mass with zeta around 0 and 1, and far above."""
    group = Group("curves, zeta around 0 and 1, to 100")
    distances = exponents(quick)
    dampings: list[tuple[int | None, float]] = [(k, 10.0**-k) for k in distances] + [
        p for p in around(mp.mpf(1), distances) if p[1] != 1.0
    ]
    dampings += [(None, zeta) for zeta in (1.0, 3.0, 30.0, 100.0)]
    for k, zeta in dampings:
        for r in (0.1, 1.0 / 3.0, 1.0, 30.0) if not quick else (1.0 / 3.0, 1.0):
            check_curves(group, one_mass(zeta), [(k, r)], 1.2)
    return group


def curves_far(quick: bool) -> Group:
    """One mass, r from 1e-6 to 1e6."""
    group = Group("curves, r = 1e-6 to 1e6")
    for zeta in (0.0, 0.02, 1.0, 30.0):
        for contact in ("fixed-wall", "joined-base-wall"):
            least = -2 if quick else (-6 if zeta == 0.0 and contact == "fixed-wall" else -4)
            check_curves(group, one_mass(zeta, contact), [(None, 10.0**e) for e in range(least, 7)])
    return group


def curves_at_modes(quick: bool) -> Group:
    """Chains at natural frequencies, their halves and thirds, and at held frequencies."""
    group = Group("curves of chains, around w_i, w_i/2, w_i/3, held w")
    distances = (3, 10) if quick else (1, 4, 7, 10, 13, 15)
    for body in chains(quick):
        centres = [w / n for n in ((1,) if quick else (1, 2, 3)) for w in body.own.w[:2]]
        centres += [mp.mpf(float(w)) for w in body.system.modes.held_frequencies()[:2]]
        for centre in centres:
            check_curves(group, body, around(centre, distances))
    return group


def curves_spread(quick: bool) -> Group:
    """Chains with masses and springs of very different size."""
    group = Group("curves of chains, masses or springs far apart")
    bodies = [chain((1.0, 1.0), (1.0, 1e8), 0.01, [1])]
    if not quick:
        bodies += [
            chain((1.0, 1e-8), (1.0, 1.0), 0.01, [1]),
            chain((1.0, 1.0, 1.0), (1.0, 1e10, 1.0), 0.01, [3]),
            chain((1.0, 1e-3, 1.0), (1.0, 1.0, 1e-3), 0.01, [1], 3),
            chain((1.0, 1e3, 1e6), (1.0, 1.0, 1.0), 0.01, [1]),
        ]
    for body in bodies:
        check_curves(group, body, [(None, r) for r in (0.3, 0.9, 2.0)])
    return group


def curves_close_modes(quick: bool) -> Group:
    """Fifty nearly equal oscillators."""
    group = Group("curves, 50 close modes")
    bodies = [close_modes(8, 1e-6, 0.01)] if quick else [
        close_modes(50, 1e-2, 0.01), close_modes(50, 1e-6, 0.01), close_modes(50, 1e-12, 0.01),
    ]  # fmt: skip
    for body in bodies:
        check_curves(group, body, [(None, r) for r in ((0.7, 1.3) if quick else (0.3, 0.7, 0.999, 1.3))])
    return group
