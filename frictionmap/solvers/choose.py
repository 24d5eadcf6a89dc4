"""The engine of a system."""

from ..model.system import System
from .interface import Engine


def engine_of(system: System) -> Engine:
    """The engine that answers for a system.

    On one rigid contact under one harmonic load both would, with the same numbers; its own takes a sixth to a
    twelfth of the time.
    """
    if system.general is None:
        from .single import SingleEngine

        return SingleEngine(system)
    from .general import GeneralEngine

    return GeneralEngine(system)
