"""Steady states of many contacts from two starts: 500 random systems of 9 to 64 contacts, mu = 1.

The velocities of the steady state are proved not to depend on the start.  Each system is followed from rest
and from a large motion; ranges of all contacts must agree to 1e-12 of the largest.  Frames have rigid
dampers, elastic ones or both; rings of unequal blades have rigid ones between neighbours, which close a loop,
and half of them also to the ground.  System k is made with the seed [2026, k].
"""

from collections import Counter
from pathlib import Path

import numpy as np

import frictionmap as fm

from ..report.record import save, table

SYSTEMS = {False: 500, True: 6}
SEED = 2026

#: Numbers of contacts, by quick; a ring with dampers to the ground has two per blade.
_CONTACTS = {False: (9, 64), True: (9, 12)}

_NAMES = {status.value: status.name for status in fm.regimes.STATUSES}

#: Largest difference of two ranges over the largest range.
_SAME = 1e-12

KINDS = ("frame, rigid", "frame, elastic", "frame, both", "ring", "ring and ground")


def _frame(rng: np.random.Generator, count: int, kind: str, zeta: float) -> fm.System:
    """A frame with a damper in each storey, under a load at its top."""
    elastic = {"frame, rigid": 0.0, "frame, elastic": 1.0, "frame, both": 0.5}[kind]
    contacts = [
        fm.Contact(
            "between-masses" if j else "fixed-wall", (j, j + 1) if j else 1,
            ratio=float(rng.uniform(0.3, 1.0)),
            stiffness=float(rng.uniform(0.5, 2.0)) if rng.random() < elastic else None,
        )
        for j in range(count)
    ]  # fmt: skip
    ones = [1.0] * count
    return fm.System(
        contacts=contacts, mass_ratios=ones, stiffness_ratios=ones, damping_ratios=zeta, load_mass=count
    )


def _ring(rng: np.random.Generator, blades: int, grounds: bool, zeta: float) -> fm.System:
    """A ring of blades that differ by 3 %."""
    contacts: list[dict] = [{"kind": "between-masses", "masses": [1, "next.1"]}]
    contacts += (
        [{"kind": "fixed-wall", "masses": 1, "ratio": float(rng.uniform(0.1, 0.6))}] if grounds else []
    )
    sectors = {
        "count": blades, "mass": [[1.0]], "stiffness": [[0.6]], "engine_order": int(rng.integers(1, 5)),
        "coupling": [{"masses": [1, 1], "stiffness": 0.5}],
        "spread": {"standard_deviation": 0.03, "seed": int(rng.integers(1000))},
    }  # fmt: skip
    return fm.ring(sectors=sectors, contacts=contacts, load_mass=1, damping_ratios=zeta)


def random_cell(k: int, quick: bool) -> tuple[str, fm.System, float, float]:
    """Kind, system, r and beta of random system k."""
    rng = np.random.default_rng([SEED, k])
    kind = KINDS[k % len(KINDS)]
    least, most = _CONTACTS[quick]
    count, zeta = int(rng.integers(least, most + 1)), float(10.0 ** rng.uniform(-1.7, -1.0))
    grounds = kind == "ring and ground"
    ring = kind.startswith("ring")
    system = (
        _ring(rng, count // 2 if grounds else count, grounds, zeta)
        if ring
        else _frame(rng, count, kind, zeta)
    )
    r = float(system.modes.w[0]) * float(rng.uniform(0.8, 1.6) if ring else rng.uniform(0.5, 6.0))
    ends = fm.boundaries(system, [r])
    sticks = ends["beta_noslip" if "beta_noslip" in ends else "beta_stick"].item()
    return kind, system, r, sticks * float(rng.uniform(0.1, 0.7))


def check(k: int, quick: bool) -> tuple[str, str, float]:
    """Kind of system k; how its cell ended; the largest difference of ranges, over the largest range."""
    kind, system, r, beta = random_cell(k, quick)
    ranges = []
    for start in ("rest", "moving"):
        ds = fm.sweep(system, [r], [beta], outputs=("contact_peak_to_peak", "status"), start=start, threads=1)
        if ds.status.item() != fm.regimes.RESOLVED:
            return kind, _NAMES[ds.status.item()], 0.0
        ranges.append(ds.contact_peak_to_peak.values.ravel())
    off = float(np.abs(ranges[0] - ranges[1]).max() / max(ranges[0].max(), np.finfo(float).tiny))
    return kind, "same" if off <= _SAME else "different", off


def run(quick: bool, results: Path) -> dict:
    """Check, print and save."""
    found = [check(k, quick) for k in range(SYSTEMS[quick])]
    kinds: dict[str, dict] = {}
    for kind in KINDS:
        own = [one for one in found if one[0] == kind]
        ended = Counter(how for _, how, _ in own)
        kinds[kind] = {
            "systems": len(own),
            "ended": dict(ended),
            "largest difference": max((off for *_, off in own), default=0.0),
        }
    table(
        ("", "systems", "ended", "largest difference"),
        [(kind, *kinds[kind].values()) for kind in KINDS],
    )
    content = {
        "seed": SEED,
        "kinds": kinds,
        "not the same": [k for k, one in enumerate(found) if one[1] != "same"],
    }
    save("second_starts", content, results)
    return content
