"""From measured data to friction, damping and frequencies, with their errors.

============  ==========================================================================
module        what is in it
============  ==========================================================================
tables        files of measured data, and their columns with units
statistics    least squares, outliers, correlated residuals; estimates with their errors
parameters    names of parameters to fit, and of those to hold
spring        the spring in a contact: fitted as a compliance, reported as a stiffness
explanations  what explains data that a model does not
part          a measurement as a part of a joint fit
signals       records: samples, turning points, harmonics, noise, displacements
decay         `free_decay`: the free decay of one mass
response      `forced`, `friction_ratio`: amplitudes and lags of steady states
time_series   `record`: steady motion of one mass in time, on a measured base
joint_fit     `joint`: several decays and records at once
chain         `sweep`: chains of masses without friction, base shaken
loop          `loop`: force of a damper over a given motion
history       `history`: motion of one mass under a base or force of any shape
likelihood    `log_likelihood`: the likelihood of the data of a fit, for samplers
rigs          configurations of rigs, for the command `identify`
============  ==========================================================================
"""

from .chain.sweep import sweep
from .decay.free_decay import free_decay
from .history.history import history
from .joint_fit.joint import joint
from .likelihood import log_likelihood
from .loop.loop import loop
from .response.forced import forced
from .response.phase_inversion import friction_ratio
from .signals.integration import displacements
from .time_series.record import record

__all__ = [
    "displacements",
    "forced",
    "free_decay",
    "friction_ratio",
    "history",
    "joint",
    "log_likelihood",
    "loop",
    "record",
    "sweep",
]


def __dir__() -> list[str]:
    return sorted(__all__)
