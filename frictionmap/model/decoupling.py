"""What it changes to take a damping matrix that couples the modes by its diagonal: linear responses tell.

Free and with the contact held the structure is linear, with either damping, and motions with friction go from
one to the other.  Of three masses with a dashpot these differed by up to 2.5 times as much where linear
responses differed by less than 2 %, and by up to 5 times as much beyond.
"""

from dataclasses import dataclass, field

import numpy as np

from ..errors import InputError
from ..structures.accuracy import Ranges, largest_error
from .modes import ModalModel

#: Frequencies, evenly spaced, beside the resonances, and as many of these at most.
_EVEN = 60


@dataclass(frozen=True, eq=False)
class Decoupling:
    """A damping matrix whose diagonal in the modes is taken for it."""

    damping: np.ndarray  # C1 (n, n), the whole of it
    allowed: float  # relative change of linear responses
    _found: Ranges[float] = field(default_factory=Ranges)

    def error(self, modes: ModalModel, r: np.ndarray) -> float:
        """Largest relative change of compliances of contact and load in a range of r, resonances included.

        Raises
        ------
        InputError
            It is larger than allowed.
        """
        ends = float(r[0]), float(r[-1])
        return self._found.told(*ends, lambda: self._checked(self._error(modes, *ends)))

    def _checked(self, error: float) -> float:
        if not error <= self.allowed:
            raise InputError(
                f"decouple must be at least {error:.2g}, by which linear responses change in the range of r "
                f"if C is taken by its diagonal; got {self.allowed:g}"
            )
        return error

    def _error(self, modes: ModalModel, low: float, high: float) -> float:
        load = modes.relative_load(np.ones(1))[0].real
        forces = np.column_stack((modes.contact, load if load.any() else modes.contact))
        static = np.linalg.solve(modes.stiffness, forces)
        units = np.sqrt(np.einsum("ij,ij->j", forces, static))

        def compliances(at: float, damping: np.ndarray) -> np.ndarray:
            dynamic = modes.stiffness - at * at * modes.mass + 1j * at * damping
            return forces.T @ np.linalg.solve(dynamic, forces)

        frequencies = _frequencies(modes, low, high)
        pairs = ((compliances(at, modes.damping), compliances(at, self.damping)) for at in frequencies)
        return largest_error(pairs, units, np.array([1.0, 0.0]))


def _frequencies(modes: ModalModel, low: float, high: float) -> np.ndarray:
    """Where responses are compared."""
    resonances = np.concatenate((modes.w, modes.held_frequencies()))
    inside = np.sort(resonances[(resonances >= low) & (resonances <= high)])
    some = inside[:: max(1, -(-inside.size // _EVEN))]
    return np.concatenate((np.linspace(low, high, _EVEN), some))
