"""The same bits whatever vector instructions the processor has."""

import os
import platform
import subprocess
import sys

import pytest
from conftest import ROOT

#: Follows random slides and stops of structures and of one mass, and prints what they end in.
TRACE = """
import math, sys
import numpy as np
from numba.core.config import CPU_NAME
sys.path[:0] = [{tests!r}, {root!r}]
from kernels import callable_kernel
from internals.test_block import both, structure_at
from structures import random_chain
from frictionmap._kernels.one_mass import events
from frictionmap._kernels.one_mass.scan_step import step_constants
from frictionmap._kernels.structure.oscillators import STARTS_INSIDE
from frictionmap._kernels.taylor_series import MAX_TERMS

rng = np.random.default_rng(0)
print(CPU_NAME)
for _ in range(30):
    system, _ = random_chain(rng, 0.02)
    st = structure_at(system, float(rng.uniform(0.2, 3.0)))
    state = rng.normal(size=(2, st.n)) * [[1.0], [st.h]]
    low, high = sorted(rng.normal(size=2) * st.h)
    result, state = both(st.free, st.free_block, st.n, 0.3, low, high, STARTS_INSIDE, state, 0.4, 300.7)[0]
    print(result, state.tolist())
slide = callable_kernel(events.slide)
for r in (0.2, 0.5, 0.9, 1.7):
    step = step_constants(r, 0.03, 24.0)
    print(slide(step, 0.2, -0.9, 0.0, step.stiffness * 1.2, 0.9, -0.1, 1e5, np.empty(MAX_TERMS)))
"""


def trace(name):
    """What a process prints that compiles for a processor, or for this one."""
    environment = {key: value for key, value in os.environ.items() if not key.startswith("NUMBA_CPU")}
    if name:
        environment |= {"NUMBA_CPU_NAME": name, "NUMBA_CPU_FEATURES": ""}
    code = TRACE.format(tests=str(ROOT / "tests"), root=str(ROOT))
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, timeout=600, check=True
    )
    return done.stdout.splitlines()


@pytest.mark.skipif(platform.machine() != "x86_64", reason="processors of x86-64")
@pytest.mark.slow
def test_bits_do_not_depend_on_the_instructions():
    """SSE2 only, against all that this processor has."""
    own, oldest = trace(""), trace("x86-64")
    assert oldest[0] == "x86-64"
    assert own[0] != oldest[0]
    assert len(own) == 35
    assert own[1:] == oldest[1:]
