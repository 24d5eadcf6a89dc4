"""Nanoseconds per phase (a slide or a stop) of motions that are followed without looking for an end."""

import statistics
from pathlib import Path

import numpy as np
from numba import njit

from frictionmap._kernels.events import after_slide, slide
from frictionmap._kernels.phases import MAX_TERMS, step_constants

from .record import save, spread, timed

#: r, b, mu of the normalised oscillator: short and long slides, with and without stops.
MOTIONS = ((1.2, 0.9, 1.0), (0.7, 0.9, 1.0), (0.3, 0.5, 1.0), (2.0, 0.3, 1.5), (0.05, 0.5, 1.0))


@njit
def follow(step, b, mu_b, slides, work):
    """Follow a motion from rest; the number of stops, and the displacement at its end."""
    _, z, c, s, push, _ = after_slide(b, mu_b, 0.0, 1.0, 0.0)
    stops = 0
    for _ in range(slides):
        _, z, c, s = slide(step, b, z, 0.0, step.stiffness * push, c, s, 1e6, work)
        _, z, c, s, push, wait = after_slide(b, mu_b, z, c, s)
        if wait > 0.0:
            stops += 1
    return stops, z


def run(quick: bool, results: Path) -> dict:
    """Measure, print and save."""
    slides = 2000
    work = np.empty(MAX_TERMS)
    content = {}
    for r, b, mu in MOTIONS:
        for steps in (8, 12, 16, 24, 48):
            step = step_constants(r, 0.0, float(steps))
            stops, _ = follow(step, b, mu * b, slides, work)
            seconds = [
                timed(lambda s=step, b=b, m=mu: follow(s, b, m * b, slides, work))[0]
                for _ in range(20 if quick else 200)
            ]
            nanoseconds = [1e9 * t / (slides + stops) for t in seconds]
            content[f"r = {r}, b = {b}, mu = {mu}, steps = {steps}"] = spread(nanoseconds)
            print(
                f"r = {r:<4} b = {b} mu = {mu} steps = {steps:<2}: "
                f"{statistics.median(nanoseconds):6.1f} ns a phase ({min(nanoseconds):.1f} at best)"
            )
    save("phases", {"nanoseconds a phase": content}, results)
    return content
