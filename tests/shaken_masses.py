"""One mass under a base or force of any shape for tests: its equation of motion integrated."""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

STEP = 0.0125
TURN = 2.0 * np.pi


def base_motion(time):
    """A base without a period [mm]."""
    parts = ((1.3, 1.7, 0.3), (0.9, 2.61, 1.1), (0.7, 3.37, 2.0), (0.4, 4.93, 0.7))
    return sum(size * np.cos(TURN * f * time + phase) for size, f, phase in parts)


def marched(time, drive, f_n, zeta, friction, mu, start, by_base=True):
    """u'' + 2 zeta w u' + w^2 u + w^2 x_F sgn(u') = w^2 y (+ 2 zeta w y'), between events by DOP853."""
    w, spline = TURN * f_n, CubicSpline(time, drive)
    rate = spline.derivative()

    def load(t):
        return spline(t) + (2.0 * zeta / w * rate(t) if by_base else 0.0)

    t, (u, v), side = time[0], start, np.sign(start[1])
    found = np.empty(time.size)
    while t < time[-1]:
        if side == 0.0:
            fine = np.linspace(t, time[-1], 200 * int((time[-1] - t) / STEP + 1))
            over = np.abs(load(fine) - u) - mu * friction
            at = np.flatnonzero(over[1:] > 0.0)
            inside = (time >= t) & (time <= (fine[at[0] + 1] if at.size else time[-1]))
            found[inside] = u
            if not at.size:
                break
            low, high = fine[at[0]], fine[at[0] + 1]
            for _ in range(60):
                middle = 0.5 * (low + high)
                low, high = (low, middle) if abs(load(middle) - u) > mu * friction else (middle, high)
            t, v, side = high, 0.0, np.sign(load(high) - u)
            continue

        def equation(t, y, side=side):
            return [y[1], w * w * (load(t) - y[0] - side * friction) - 2.0 * zeta * w * y[1]]

        def turned(t, y, side=side):
            return side * y[1]

        turned.terminal, turned.direction = True, -1
        run = solve_ivp(
            equation, (t, time[-1]), [u, v], "DOP853", rtol=1e-11, atol=1e-12, events=turned,
            dense_output=True, max_step=STEP,
        )  # fmt: skip
        inside = (time >= t) & (time <= run.t[-1])
        found[inside] = run.sol(time[inside])[0]
        t, u, v = run.t[-1], run.y[0, -1], 0.0
        pull = load(t) - u
        side = 0.0 if abs(pull) <= mu * friction else np.sign(pull)
    return found
