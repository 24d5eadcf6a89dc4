"""The engine of a system."""

from ..errors import InputError
from ..model.general import refuse_banks, refuse_law, refuse_phases
from ..model.settings import OUTPUTS, RECORDED
from ..model.system import System
from .interface import Engine


def has_closed_forms(system: System) -> bool:
    """Whether boundaries, thresholds of peaks and invariant points of a system are closed forms.

    They are for one rigid contact under one harmonic load.
    """
    return system.general is None


def valid_outputs(system: System) -> tuple[str, ...]:
    """The outputs of maps of a system."""
    general = system.contact_system
    if general.has_banks:
        from ..banks.dataset import TABLE as OF_BANKS
        from ..banks.dataset import has_output as is_of_banks

        return tuple(name for name in OF_BANKS if is_of_banks(name, general))
    if general.has_phases:
        from ..phases.dataset import TABLE as OF_PHASES
        from ..phases.dataset import has_output as is_of_phases

        return tuple(name for name in OF_PHASES if is_of_phases(name, general))
    if has_closed_forms(system):
        return (*OUTPUTS, *RECORDED)
    from ..general.outputs import TABLE, is_wanted

    return tuple(name for name in TABLE if is_wanted(name, general))


def engine_of(system: System) -> Engine:
    """The engine that answers for a system.

    On one rigid contact under one harmonic load both would, with the same numbers; its own takes a sixth to a
    twelfth of the time.
    """
    if any(group.first.normal_record is not None for group in system.contact_system.groups):
        raise InputError(
            "cannot use",
            "normal_record",
            "under a periodic load: it is for motions in time; use history, or give normal_load",
        )
    shaken = system.contact_system.shaken_points
    if shaken is not None:
        _ = shaken.sag  # refused if it is not known
        refuse_banks(system, "compute steady states of a structure given by modes on a moving base")
    if system.contact_system.has_law and system.rigid_modes:
        refuse_law(system, "compute steady states of a free structure")
    if system.contact_system.has_banks:
        from .banks import BanksEngine

        if system.rigid_modes:
            refuse_banks(system, "compute steady states of a free structure")
        return BanksEngine(system)
    if system.contact_system.has_phases:
        from .phases import PhasesEngine

        if system.rigid_modes:
            refuse_phases(
                system,
                "compute steady states of a free structure",
                "springs must hold it; add a spring to the ground, such as 1e-6 of the others",
            )
        return PhasesEngine(system)
    if has_closed_forms(system):
        from .single import SingleEngine

        return SingleEngine(system)
    if system.varies:
        from .varying import VaryingEngine

        return VaryingEngine(system)
    from .general import GeneralEngine

    return GeneralEngine(system)
