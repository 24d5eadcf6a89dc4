"""Times that a logger has written with too few decimals, so that rows repeat them."""

import numpy as np

#: Rows that repeat the time of the row before: so many, and this share of all, come from rounding.
_REPEATS, _SHARE = 5, 0.1

#: The band of times around a line is found, and so compared with the resolution, up to this share.
_SLACK = 1e-6


def evened(name: str, times: np.ndarray) -> tuple[np.ndarray, str]:
    """Equidistant times in place of rounded ones that repeat, and a remark; else the times, and nothing.

    They are taken for rounded where a tenth repeats, none goes back, and one step between rows explains all
    of them: t_k = t_0 + k dt, rounded to the least step that the file has.

    Parameters
    ----------
    name : of the column
    times : (n,)
    """
    steps = np.diff(times)
    repeats = int((steps == 0.0).sum())
    if repeats < max(_REPEATS, _SHARE * times.size) or (steps < 0.0).any() or times[-1] <= times[0]:
        return times, ""
    resolution = float(steps[steps > 0.0].min())
    rows = np.arange(times.size)
    dt = _step(times - times[0], rows, resolution)
    rest = times - dt * rows
    if np.ptp(rest) > resolution * (1.0 + _SLACK):
        return times, ""
    remark = (
        f"times in {name} repeat, as they are rounded to {resolution:.6g}: they are read as equidistant, "
        f"{dt:.6g} apart"
    )
    return 0.5 * (rest.max() + rest.min()) + dt * rows, remark


def _step(times: np.ndarray, rows: np.ndarray, resolution: float) -> float:
    """The step with the narrowest band of times around a line, a convex function of it."""
    from scipy.optimize import minimize_scalar

    mean, off = times[-1] / rows[-1], 2.0 * resolution / rows[-1]
    found = minimize_scalar(
        lambda dt: np.ptp(times - dt * rows), bounds=(mean - off, mean + off), method="bounded",
        options={"xatol": 0.01 * _SLACK * resolution / rows[-1]},
    )  # fmt: skip
    return float(found.x)
