"""Kernels compiled before the tests that need them, each by one of two processes.

Otherwise every worker compiles what it meets, and two workers that meet the same kernel both compile it.

python tests/precompile.py PART
"""

import subprocess
import sys
from collections.abc import Callable

import frictionmap as fm

#: Axes of maps with cells of every regime, also at rest and at a resonance.
R = [0.0, 0.31, 0.55, 1.0]
BETA = [0.0, 0.05, 0.4, 0.9]
MU = [1.0, 1.4]

#: Outputs of one rigid contact by the kernels that they need.
CELL = ("regime", "also_reachable")
MOTION = ("amplitude", "lyapunov_exponent")
CYCLE = ("work_friction", "contact_first_harmonic_phase")

CHAIN = {"mass_ratios": [1.0, 0.8], "stiffness_ratios": [1.0, 1.2], "damping_ratios": 0.03}
ONE = fm.System(damping_ratios=0.03)
STRUCTURE = fm.System(**CHAIN)
ELASTIC = fm.System(damping_ratios=0.03, contact_stiffness=3.0)
CONTACTS = fm.System(contacts=[fm.Contact("fixed-wall", (1,)), fm.Contact("between-masses", (1, 2))], **CHAIN)


def maps(system: fm.System, *requested: tuple[str, ...]) -> None:
    """Compile the kernels of maps of one rigid contact with some outputs."""
    for outputs in requested:
        fm.sweep(system, R, BETA, MU, outputs=outputs)


def first() -> None:
    """Compile the kernels of one mass; the further ones of structures, when `second` has begun with them."""
    maps(ONE, CELL, (*CELL, *MOTION), CYCLE, (*MOTION, *CYCLE))
    maps(STRUCTURE, (*CELL, *MOTION), CYCLE, (*MOTION, *CYCLE))
    for system in (ONE, STRUCTURE):
        fm.curves(system, R[1:3], BETA[1:3])
        for beta in (0.05, 0.4):
            fm.response(system, 0.31, beta)


def second() -> None:
    """Compile the first kernels of structures, and those of several contacts and springs in contacts."""
    maps(STRUCTURE, CELL)
    for system in (ELASTIC, CONTACTS):
        fm.sweep(system, R[1:], BETA)
        fm.boundaries(system, R[1:])
        fm.curves(system, R[1:3], BETA[1:3])
        fm.response(system, 0.55, 0.2)
        fm.design.stuck(system, R[1:3])
    fm.design.no_stop(CONTACTS, R[1:3])
    fm.borders(ONE, [0.3, 0.32], [0.1, 0.2])


PARTS: dict[str, Callable[[], None]] = {"first": first, "second": second}


def all_parts() -> None:
    """Compile everything, each part in a process of its own; what fails here a test reports better."""
    begun = [subprocess.Popen([sys.executable, __file__, name], stderr=subprocess.DEVNULL) for name in PARTS]
    for process in begun:
        process.wait()


if __name__ == "__main__":
    PARTS[sys.argv[1]]()
