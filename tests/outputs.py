"""Outputs that several tests ask for."""

from frictionmap.datasets.labels import GENERAL_VARIABLES
from frictionmap.model.settings import OUTPUTS as EVERY

OUTPUTS = EVERY[: EVERY.index("multiplier")]  # that of the masses would take the code for structures

#: All outputs of systems with one rigid contact under one harmonic load.
OF_ONE_CONTACT = tuple(name for name in EVERY if name not in GENERAL_VARIABLES)
