"""Reduced matrices as a file that takes the place of those of the whole structure."""

from pathlib import Path

import numpy as np

from ..errors import InputError
from ..model.matrices import Matrices
from ..model.system import System
from ..structures.arrays import write_npz
from .refinement import boundary_check

#: Degrees of freedom that are listed.
_LISTED = 40


def refuse_unreduced(system: System) -> None:
    """Refuse a system whose structure is not reduced.

    Raises
    ------
    InputError
        It has no reduction.
    """
    if system.reduction is None:
        raise InputError(
            "cannot reduce: the key reduce is missing; write reduce = { modes = 16 } below [system], or give "
            "--set system.reduce.modes=16"
        )


def write_reduced(system: System, path: Path) -> None:
    """Write the reduced matrices, and what their rows are called."""
    assert isinstance(system.matrices, Matrices)
    write_npz(system.matrices.named_arrays, path)


def describe_reduced(system: System, r: np.ndarray, mu: np.ndarray, path: Path) -> list[str]:
    """What a reduction keeps, what it costs in the range of r, and how the file is used, in lines."""
    assert system.reduction is not None
    dofs = system.dofs
    names = [dofs.word(number) for number in dofs.numbers]
    more = f", ... ({len(names)} in all)" if len(names) > _LISTED else ""
    whole = system.reduction.structure.n
    return [
        f"{whole} degrees of freedom reduced to {system.n}, with {system.reduction.asked.modes} modes",
        f"degrees of freedom: {', '.join(names[:_LISTED])}{more}",
        *system.costs(r).values(),
        *boundary_check(system, r, mu).values(),
        f'in [system]: matrices = "{path.name}", frequency_scale = {system.omega_1!r}, and no reduce',
    ]
