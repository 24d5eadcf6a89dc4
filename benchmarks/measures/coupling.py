"""Errors of amplitudes and stops if the coupling of modes by damping is neglected.

This is why a damping matrix is not reduced to its diagonal. Random chains, whose springs have individual loss
factors or which have one dashpot, are marched with the whole C1 by `references/naive.py`. The package
computes them with the diagonal of C1 in modal coordinates, as damping ratios. Cells lie between 5 and 95 % of
the sticking boundary, mu = 1, at frequencies from low to above the highest mode.
"""

from pathlib import Path

import numpy as np
from scipy.linalg import eigh

import frictionmap as fm

from ..references.naive import chain_stiffness, naive_steady_state
from ..report.record import save

#: Mean damping ratio of the modes; the quick form has the last one, whose motions settle soon.
LEVELS = (0.002, 0.01, 0.03, 0.1)

#: Cells of every level and kind; of the quick form.
CELLS, QUICK_CELLS = 60, 3

#: Periods that are marched at most, and the change of the state that counts as none.
_CYCLES, _SETTLED = 4000, 1e-9

KINDS = (
    "springs with loss factors from 0 to twice the mean",
    "one dashpot",
    "springs with one loss factor: no coupling",  # says how far the two agree by themselves
)


def chain(rng: np.random.Generator, kind: str, level: float) -> tuple[dict, np.ndarray, np.ndarray]:
    """Mass and stiffness ratios, the matrix C1, and the damping ratios of its diagonal."""
    n = int(rng.integers(2, 6))
    gamma, kappa = rng.uniform(0.5, 2.0, (2, n))
    gamma[0] = kappa[0] = 1.0
    squares, phi = eigh(chain_stiffness(kappa), np.diag(gamma))
    losses = (kappa * rng.uniform(0.0, 2.0, n), np.eye(n)[rng.integers(n)], kappa)
    damping = chain_stiffness(losses[KINDS.index(kind)])
    zeta = np.diag(phi.T @ damping @ phi) / (2.0 * np.sqrt(squares))
    scale = level / zeta.mean()
    return {"mass_ratios": gamma, "stiffness_ratios": kappa}, scale * damping, scale * zeta


def compare(rng: np.random.Generator, kind: str, level: float) -> dict | None:
    """Compute one random cell in both ways; None if the march does not converge, or if one motion sticks
    permanently.
    """
    ratios, damping, zeta = chain(rng, kind, level)
    n = zeta.size
    contact, load = (int(mass) for mass in rng.integers(1, n + 1, 2))
    system = fm.System(contact_masses=[contact], load_mass=load, damping_ratios=zeta, **ratios)
    r = float(rng.uniform(0.15, 1.2) * system.modes.w[-1])
    stick = fm.boundaries(system, [r])["beta_stick"].item()
    beta = float(rng.uniform(0.05, 0.95) * stick)
    ds = fm.sweep(system, [r], [beta])
    slow = naive_steady_state(
        gamma=ratios["mass_ratios"], kappa=ratios["stiffness_ratios"], contact=("wall", contact), load=load,
        damping=damping, r=r, beta=beta, cycles=_CYCLES, tol=_SETTLED,
    )  # fmt: skip
    if slow.status != "ok" or ds["regime"].item() < 1:
        return None
    error = abs(ds["contact_amplitude"].item() / slow.Z - 1.0)
    return {"error": error, "other stops": bool(ds["stops_per_cycle"].item() != np.float32(slow.stops))}


def _summary(cells: list[dict]) -> dict:
    median, most = np.quantile([cell["error"] for cell in cells], (0.5, 0.9)).tolist()
    stops = sum(cell["other stops"] for cell in cells)
    error = {"median": median, "nine of ten below": most}
    return {"cells": len(cells), "error of Z": error, "cells with other stop counts": stops}


def _in_words(summary: dict) -> str:
    error = summary["error of Z"]
    return (
        f"{summary['cells']} cells, error of Z {error['median']:.1e} in the median, nine of ten below "
        f"{error['nine of ten below']:.1e}, {summary['cells with other stop counts']} other stop counts"
    )


def run(quick: bool, results: Path) -> dict:
    """Compare, print and save."""
    found: dict = {}
    for kind in KINDS:
        for level in LEVELS[-1:] if quick else LEVELS:
            rng = np.random.default_rng([KINDS.index(kind), LEVELS.index(level)])
            cells = [compare(rng, kind, level) for _ in range(QUICK_CELLS if quick else CELLS)]
            summary = _summary([cell for cell in cells if cell is not None])
            found.setdefault(kind, {})[str(level)] = summary
            print(f"{kind}, mean zeta {level}: {_in_words(summary)}", flush=True)
    content = {"neglected coupling": found}
    save("coupling", content, results)
    return content
