"""What is taken off the samples of a record: nothing, their mean, or a straight line."""

import numpy as np

BASELINES = ("none", "mean", "linear")


def corrected(
    values: np.ndarray, times: np.ndarray, baseline: str, unit: str | None
) -> tuple[np.ndarray, str]:
    """Samples without their mean or their line of least squares, and what was taken off in words.

    Parameters
    ----------
    values, times : (n,)
    baseline : one of `BASELINES`
    unit : of the values, for the words
    """
    word = f" {unit}" if unit else ""
    if baseline == "none":
        return values, ""
    mean = float(values.mean())
    if baseline == "mean":
        return values - mean, f"the mean, {mean:.6g}{word}, is taken off"
    middle = float(times.mean())
    away = times - middle
    slope = float(away @ (values - mean) / (away @ away))
    line = mean + slope * away
    return values - line, (
        f"a straight line of least squares, from {line[0]:.6g}{word} to {line[-1]:.6g}{word}, is taken off"
    )
