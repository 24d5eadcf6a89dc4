"""Steady sliding of a structure: its place, its stability, and a proof that a motion ends there."""

import numpy as np
from scipy.linalg import null_space, solve_continuous_lyapunov

from ..model.system import System
from .belts import Belts
from .sliding import growth_of_sliding, vibrations

#: Vibration that is left of a motion that settles, over displacement and speed of steady sliding: from here
#: on nothing can be seen of it.
_SETTLED = 1e-9


class Sliding:
    """Steady sliding at one belt speed and friction; contacts without a belt rest.

    Parameters
    ----------
    system, belts : System, Belts
    speed : of the belt
    kinetic, static : (N,) friction just above speed 0, and at rest
    """

    def __init__(
        self, system: System, belts: Belts, speed: float, kinetic: np.ndarray, static: np.ndarray
    ) -> None:
        modes = system.modes
        self._mass, self._damping, self._stiffness = modes.mass, modes.damping, modes.stiffness
        self._vectors = np.array([group.vector for group in belts.groups])
        self._laws, self.static, self.kinetic = belts.laws, static, kinetic
        self.speeds = belts.share * speed
        self.moves = belts.share != 0.0
        self.holds = ~self.moves & (static > 0.0)
        self._free = null_space(self._vectors[self.holds]) if self.holds.any() else np.eye(len(self._mass))
        factor = np.array([float(law(abs(v))) for law, v in zip(self._laws, self.speeds, strict=True)])
        self.pull = self._vectors.T @ (np.sign(self.speeds) * kinetic * factor * self.moves)
        self.place = np.linalg.solve(self._stiffness, self.pull)
        self.growth, self.frequency = self._fastest(False)
        self.followed, _ = self._fastest(True)  # by the segments that motions are followed with

    def _slopes(self, segments: np.ndarray) -> np.ndarray:
        """Friction times slope of the law of every contact on a belt."""
        slopes = np.array([law.slopes[k] for law, k in zip(self._laws, segments, strict=True)])
        return np.asarray(slopes * self.kinetic * self.moves)

    def _reduced(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Mass, damping, stiffness and vectors with the contacts without a belt held."""
        z = self._free
        return z.T @ self._mass @ z, z.T @ self._damping @ z, z.T @ self._stiffness @ z, self._vectors @ z

    def _fastest(self, segments: bool) -> tuple[float, float]:
        """Rate and frequency of the fastest growing vibration; on break points the faster of both sides."""
        if not self._free.shape[1]:
            return -np.inf, 0.0
        speeds = np.abs(self.speeds)
        slopes = np.array([law.slopes_at(v, segments) for law, v in zip(self._laws, speeds, strict=True)])
        sides = (side * self.kinetic * self.moves for side in slopes.T)
        return max((growth_of_sliding(*self._reduced(), side) for side in sides), key=lambda one: one.growth)

    def place_of(self, x: np.ndarray) -> np.ndarray:
        """Place of steady sliding with the resting contacts where they are in x."""
        held = self._vectors[self.holds]
        if not len(held):
            return self.place
        count = len(held)
        matrix = np.block([[self._stiffness, held.T], [held, np.zeros((count, count))]])
        return np.linalg.solve(matrix, np.concatenate((self.pull, held @ x)))[: x.size]

    def is_reached(self, x: np.ndarray, velocity: np.ndarray) -> bool:
        """Whether a motion has settled, where steady sliding is stable."""
        size = np.abs(self.place).max() + np.abs(self.speeds).max()
        off = max(np.abs(x - self.place_of(x)).max(), np.abs(velocity).max())
        return bool(self.followed < 0.0 and off <= _SETTLED * size)

    def attracts(self, x: np.ndarray, velocity: np.ndarray, senses: np.ndarray, segments: np.ndarray) -> bool:
        """Whether a motion certainly ends in steady sliding.

        In the pattern of steady sliding the motion is linear: V = y^T P y with A^T P + P A = -I falls, and so
        bounds what ends the pattern: every |l.y| <= sqrt(V l^T P^-1 l).
        """
        wanted = np.where(self.moves, -np.sign(self.speeds), 0)
        if (senses[self.moves | self.holds] != wanted[self.moves | self.holds]).any():
            return False
        if not self._free.shape[1]:
            return True
        slopes = self._slopes(segments)
        matrix = vibrations(*self._reduced(), slopes)
        if np.linalg.eigvals(matrix).real.max() >= 0.0:
            return False
        form = solve_continuous_lyapunov(matrix.T, -np.eye(len(matrix)))
        z, place = self._free, self.place_of(x)
        y = np.concatenate((z.T @ (x - place), z.T @ velocity))
        rows, margins = self._limits(place, slopes, segments)
        reach = np.sqrt((y @ form @ y) * np.einsum("ij,ij->i", rows, np.linalg.solve(form, rows.T).T))
        return bool((reach < margins).all())

    def _limits(
        self, place: np.ndarray, slopes: np.ndarray, segments: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """What ends the pattern: functions of the state y, and how far they are from their limits."""
        z = self._free
        rows, margins = [], []
        for j in np.flatnonzero(self.moves):
            law, speed = self._laws[j], abs(self.speeds[j])
            bounds = [*law.speed, np.inf]
            k = segments[j]
            rows.append(np.concatenate((np.zeros(z.shape[1]), self._vectors[j] @ z)))
            margins.append(min(speed - bounds[k], bounds[k + 1] - speed))
        held = self._vectors[self.holds]
        if len(held):
            solved = np.linalg.solve(self._mass, held.T)
            grip = np.linalg.solve(held @ solved, solved.T)  # forces on the masses to holding forces
            steady = grip @ (self.pull - self._stiffness @ place)
            damping = self._damping + self._vectors.T @ (slopes[:, np.newaxis] * self._vectors)
            rows += list(-np.hstack((grip @ self._stiffness @ z, grip @ damping @ z)))
            margins += list(self.static[self.holds] - np.abs(steady))
        return np.array(rows), np.array(margins)
