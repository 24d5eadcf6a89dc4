"""A free decay and a record of one rig, with friction forces of their own, identified together by `joint`."""

from functools import partial

import numpy as np

import frictionmap as fm

from ...references.shaken import Rig
from .case import Case, Made
from .decays import Decay, half_cycles, places
from .records import STATIC, STICK_SLIP, measured, settled

#: How the decay is measured: deviation of the noise [mm], samples per second, length [s].
_DECAY_NOISE, _RATE, _LENGTH = 0.02, 200.0, 4.0


def _made(rng: np.random.Generator, rig: Rig) -> Made:
    """Noise on both; the wall is pressed less in the decay."""
    decay = Decay(
        rig.f_n, rig.zeta, rng.uniform(0.1, 0.3), rng.uniform(7.0, 11.0), -0.03, 0.1, rig.mu, _DECAY_NOISE,
        _RATE, _LENGTH,
    )  # fmt: skip
    time = np.arange(int(_RATE * _LENGTH)) / _RATE
    x = places(decay, half_cycles(decay), time) + rng.normal(0.0, _DECAY_NOISE, time.size)
    record = measured(rng, settled(rig))
    truth = {"f_n": rig.f_n, "zeta": rig.zeta, "mu": rig.mu, "x_F_1": decay.x_F, "x_F_2": rig.x_F}
    return Made(truth, lambda: fm.identify.joint([(time, x), record], damping_reference="base"))


CASES = (
    Case("a decay and a record, mu = 1", partial(_made, rig=STICK_SLIP), 100),
    Case("a decay and a record, mu = 1.25", partial(_made, rig=STATIC), 100),
)
