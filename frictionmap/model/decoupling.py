"""Error of replacing a damping matrix that couples the modes by its diagonal, measured by linear responses.

With the contact free, or held, the structure is linear with either damping matrix, and motions with friction
alternate between the two states.  For three masses with one dashpot the error of motions with friction was up
to 2.5 times that of linear responses where the latter was below 2 %, and up to 5 times beyond.
"""

from dataclasses import dataclass, field

import numpy as np

from ..errors import InputError
from ..structures.accuracy import Ranges, largest_error
from .modes import ModalModel

#: Number of evenly spaced frequencies, and largest number of resonances, at which responses are compared.
_EVEN = 60


@dataclass(frozen=True, eq=False)
class Decoupling:
    """A damping matrix that is replaced by its diagonal in modal coordinates."""

    damping: np.ndarray  # (n, n) the full matrix C1
    allowed: float  # largest relative change of linear responses
    _found: Ranges[float] = field(default_factory=Ranges)

    def error(self, modes: ModalModel, r: np.ndarray) -> float:
        """Largest relative change of the compliances of contact and load in a range of r, resonances
        included.

        Raises
        ------
        InputError
            The change exceeds the allowed one.
        """
        ends = float(r[0]), float(r[-1])
        return self._found.lookup(*ends, lambda: self._checked(self._error(modes, *ends)))

    def _checked(self, error: float) -> float:
        if not error <= self.allowed:
            raise InputError(
                "decouple",
                f"must be at least {error:.2g}, the change of linear responses in the range of r "
                f"when C is replaced by its diagonal; got {self.allowed:g}",
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
        return largest_error(pairs, units, np.array([[1.0], [0.0]]))


def _frequencies(modes: ModalModel, low: float, high: float) -> np.ndarray:
    """Frequencies at which responses are compared."""
    resonances = np.concatenate((modes.w, modes.held_frequencies()))
    inside = np.sort(resonances[(resonances >= low) & (resonances <= high)])
    some = inside[:: max(1, -(-inside.size // _EVEN))]
    return np.concatenate((np.linspace(low, high, _EVEN), some))
