"""One mass on a slider with any force law, by `solve_ivp` with events.

Used for contacts that open and for belts without a load:

    z'' = push(t, z, z') - s limit(z, abs(w)),   w = z' - V,   s = sgn(w)

`push` is every other force.  A stop lasts while abs(push) <= limit at w = 0.
"""

from collections.abc import Callable
from importlib import import_module
from typing import NamedTuple

import numpy as np

from .body import SLIDE_END
from .peer import MAX_PHASES, Peer

#: Step that shows on which side of a bend a motion goes on.
_AHEAD = 1e-7


class Slider(NamedTuple):
    """Forces of one mass in the units of its spring and natural frequency, and the speed V of its wall."""

    push: Callable[[float, float, float], float]
    limit: Callable[[float, float], float]  # of z and abs(w)
    wall: float = 0.0
    bends: tuple[Callable[[float, float], float], ...] = ()  # of z and abs(w): zero where a force has a kink


class SliderSolveIvp(Peer):
    """scipy.integrate.solve_ivp, from event to event."""

    name = "solve_ivp DOP853"
    package = "scipy"

    def __init__(self, slider: Slider, rtol: float = 1e-9) -> None:
        self.slider, self.solve = slider, import_module("scipy.integrate").solve_ivp
        self.settings = {"method": "DOP853", "rtol": rtol, "atol": max(1e-3 * rtol, 1e-14)}

    def _slide(self, t: float, y: tuple, sign: int, end: float) -> tuple[float, tuple, list]:
        """Integrate a slide, or a part of it up to a bend: time, state, and z at its ends and turns."""
        push, limit, wall, bends = self.slider

        def rate(t, y):
            z, v = y.tolist()
            return v, push(t, z, v) - sign * limit(z, abs(v - wall))

        def over(_t, y):
            return sign * (y[1] - wall) - SLIDE_END

        def turns(_t, y):
            return y[1]

        kinks = [lambda _t, y, bend=bend: bend(y[0], abs(y[1] - wall)) for bend in bends]
        ahead = np.array(y) + _AHEAD * np.array(rate(t, np.array(y)))
        for kink in kinks:  # one that has just been passed is not seen again
            kink.direction = -np.sign(kink(t, ahead))
        for event in (over, *kinks):
            event.terminal = True
        over.direction = -1
        events = [over, turns, *kinks]
        answer = self.solve(rate, (t, end), y, events=events, **self.settings)
        if answer.status < 0:
            raise RuntimeError(f"solve_ivp: {answer.message}")
        z, v = answer.y[:, -1].tolist()
        if answer.t_events[0].size:
            v = wall
        found = [y[0], z, *(one[0] for one in answer.y_events[1])]
        return answer.t[-1].item(), (z, v), found

    def _stop(self, t: float, z: float, end: float) -> tuple[float, float]:
        """Time and place at which a stop ends."""
        push, limit, wall, _ = self.slider

        def spare(now, y):
            return limit(y[0], 0.0) - abs(push(now, y[0], wall))

        spare.terminal, spare.direction = True, -1
        step = 0.01 * (end - t) if wall == 0.0 else np.inf  # push may rise and fall within a step
        answer = self.solve(
            lambda _t, _y: (wall,), (t, end), (z,), events=[spare], max_step=step, **self.settings
        )
        return answer.t[-1].item(), answer.y[0, -1].item()

    def range(self, z: float, period: float, count: int) -> float:
        """Range max z - min z in the last of `count` periods, from rest relative to the wall at z."""
        push, limit, wall, _ = self.slider
        t, y, found = 0.0, (z, wall), []
        for k in range(1, count + 1):
            found = []
            for _ in range(MAX_PHASES):
                if t >= period * k:
                    break
                if y[1] == wall and abs(push(t, y[0], wall)) <= limit(y[0], 0.0):
                    t, place = self._stop(t, y[0], period * k)
                    found += [y[0], place]
                    y = (place, wall)
                    if t >= period * k:
                        break
                w = y[1] - wall
                sign = int(np.sign(w)) or (1 if push(t, y[0], wall) > 0.0 else -1)
                t, y, some = self._slide(t, y, sign, period * k)
                found += some
        return max(found) - min(found)
