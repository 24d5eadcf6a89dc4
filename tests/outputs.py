"""Outputs that several tests ask for."""

from frictionmap.model.settings import OUTPUTS as EVERY

OUTPUTS = EVERY[: EVERY.index("multiplier")]  # that of the masses would take the code for structures
