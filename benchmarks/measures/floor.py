"""Lower bound of the run time: nanoseconds per segment (a slide or a stop) against the closed forms alone.

The kernel follows some motions and records its findings: the number of scan steps of each slide, where the
slide ended in the next step, and what followed. Two probes then repeat the motions with this information, so
that nothing is searched, bounded or decided:

- `walk` evaluates what the kernel evaluates: the affine scan steps, the Taylor series of the last one, one
  polishing step of fourth order at the event, and the release of a stop;
- `jump` takes each slide at once, with sine, cosine and exponential of its whole length: the minimum cost
  of the state at the end of a segment if its time is known.

All three must arrive at the same displacement.
"""

import math
from typing import NamedTuple

import numpy as np

from frictionmap._kernels.one_mass.events import _sum_at, after_slide, slide
from frictionmap._kernels.one_mass.scan_step import expand, step_constants
from frictionmap._kernels.taylor_series import MAX_TERMS

from ..report.record import pinned, spread, table, timed
from .own_entry import own_entry

#: r, zeta, b, mu of the normalised oscillator: short and long slides, with and without stops.
MOTIONS = (
    (1.2, 0.0, 0.9, 1.0),
    (0.7, 0.0, 0.9, 1.0),
    (0.3, 0.0, 0.5, 1.0),
    (0.3, 0.05, 0.5, 1.0),
    (2.0, 0.0, 0.3, 1.5),
    (0.05, 0.0, 0.5, 1.0),
)
DEFAULT_STEPS = 24
SLIDES = 2000

#: Displacements of kernel and probes at the end may differ by rounding, many slides long; by more, and they
#: did not go the same way.
_SAME_WAY = 1e-6


class Track(NamedTuple):
    """Findings of the kernel about each slide of a motion; arrays of shape (slides,)."""

    whole: np.ndarray  # scan steps passed
    rest: np.ndarray  # where in the next one the slide ended, 0 to 1
    length: np.ndarray  # of the slide, in tau
    turn: np.ndarray  # -1 where the motion went back after it, 1 where it went on
    stopped: np.ndarray  # bool: a stop came between


@own_entry
def follow(step, b, mu_b, slides, work):
    """Follow a motion from rest with the kernel: (displacement at the end, stops)."""
    _, z, c, s, force, _ = after_slide(b, mu_b, 0.0, 1.0, 0.0)
    stops = 0
    for _ in range(slides):
        _, z, c, s = slide(step, b, z, 0.0, step.stiffness * force, c, s, 1e6, work)
        _, z, c, s, force, wait = after_slide(b, mu_b, z, c, s)
        stops += wait > 0.0
    return z, stops


@own_entry
def write_down(step, b, mu_b, slides, work):
    """Track of a motion from rest, in the order of `Track`."""
    whole = np.empty(slides, dtype=np.int64)
    rest, length, turn = np.empty(slides), np.empty(slides), np.empty(slides)
    stopped = np.empty(slides, dtype=np.bool_)
    _, z, c, s, force, _ = after_slide(b, mu_b, 0.0, 1.0, 0.0)
    for k in range(slides):
        n, before, c, s = slide(step, b, z, 0.0, step.stiffness * force, c, s, 1e6, work)
        whole[k] = int(n)
        rest[k] = n - whole[k]
        length[k] = n * step.h
        _, z, c, s, force, wait = after_slide(b, mu_b, before, c, s)
        turn[k] = 1.0 if z == before else -1.0
        stopped[k] = wait > 0.0
    return whole, rest, length, turn, stopped


@own_entry
def _restart(b, mu_b, z, c, s, turn, stopped):
    """State, force and wait at the start of the next slide, with known events."""
    if not stopped:
        return turn * z, turn * c, turn * s, turn * (c - z) - b, 0.0
    c_end = z + turn * mu_b
    s_end = -turn * math.sqrt(max(0.0, (1.0 - c_end) * (1.0 + c_end)))
    wait = math.atan2(s_end * c - c_end * s, c_end * c + s_end * s)
    return turn * z, turn * c_end, turn * s_end, mu_b - b, wait


@own_entry
def walk(step, b, mu_b, track, work):
    """Follow the scan steps, series, polishing and releases of a track: (displacement at the end, time
    stuck).
    """
    _, z, c, s, force, _ = after_slide(b, mu_b, 0.0, 1.0, 0.0)
    stuck = 0.0
    for k in range(track.whole.size):
        w = 0.0
        acceleration = step.stiffness * force
        for _ in range(track.whole[k]):
            z1 = (step.z_cos * c + step.z_sin * s - step.z_one * b) + (step.zz * z + step.zw * w)
            w = (step.w_cos * c + step.w_sin * s - step.w_one * b) + (step.wz * z + step.ww * w)
            z = z1
            c, s = step.cos * c - step.sin * s, step.cos * s + step.sin * c
            acceleration = step.stiffness * (c - b - z) - step.damping * w
        expand(step, b, z, w, acceleration, c, s, work)
        z, c, s = _polish(step, b, z, c, s, track.rest[k], work)
        z, c, s, force, wait = _restart(b, mu_b, z, c, s, track.turn[k], track.stopped[k])
        stuck += wait
    return z, stuck


@own_entry
def _polish(step, b, z, c, s, x, work):
    """Compute (z, cos, sin) at the event next to x: the formulas of one polishing step, as in `events`."""
    velocity, rise = _sum_at(work, step.terms, x)
    place = z + rise
    cosine, sine = math.cos(step.h * x), math.sin(step.h * x)
    c1 = cosine * c - sine * s
    s1 = cosine * s + sine * c
    acceleration = step.stiffness * (c1 - b - place) - step.damping * velocity
    jerk = -step.stiffness * (s1 * step.h + velocity) - step.damping * acceleration
    snap = -step.stiffness * (c1 * step.h * step.h + acceleration) - step.damping * jerk
    inverse = 1.0 / acceleration
    first = -velocity * inverse
    second = 0.5 * jerk * inverse
    third = snap * inverse * (1.0 / 6.0)
    move = first * (1.0 - first * (second - first * (2.0 * second * second - third)))
    place += move * (
        velocity + move * (0.5 * acceleration + move * (jerk * (1.0 / 6.0) + move * snap * (1.0 / 24.0)))
    )
    angle = step.h * move
    less = 0.5 * angle * angle
    more = angle - angle * less * (1.0 / 3.0)
    c2 = c1 - more * s1 - less * c1
    s2 = s1 + more * c1 - less * s1
    norm = 1.5 - 0.5 * (c2 * c2 + s2 * s2)
    return place, norm * c2, norm * s2


@own_entry
def jump(r, zeta, b, mu_b, track):
    """Follow each slide of a track at once, by the closed form over its length (r != 1, zeta < 1).

    Returns (displacement at the end, time stuck).
    """
    decay = zeta / r
    rate = math.sqrt(1.0 - zeta * zeta) / r
    size = 1.0 / ((1.0 - r * r) ** 2 + (2.0 * zeta * r) ** 2)
    in_phase, behind = (1.0 - r * r) * size, 2.0 * zeta * r * size  # forced motion: of cos, of sin
    _, z, c, s, _, _ = after_slide(b, mu_b, 0.0, 1.0, 0.0)
    stuck = 0.0
    for k in range(track.length.size):
        tau = track.length[k]
        free = z + b - in_phase * c - behind * s
        free_rate = (in_phase * s - behind * c + decay * free) / rate
        cosine, sine = math.cos(tau), math.sin(tau)
        c, s = cosine * c - sine * s, cosine * s + sine * c
        z = (
            in_phase * c + behind * s - b
            + math.exp(-decay * tau) * (free * math.cos(rate * tau) + free_rate * math.sin(rate * tau))
        )  # fmt: skip
        z, c, s, _, wait = _restart(b, mu_b, z, c, s, track.turn[k], track.stopped[k])
        stuck += wait
    return z, stuck


def one_motion(r: float, zeta: float, b: float, mu: float, repeats: int) -> dict:
    """Kernel and probes on one motion, alternating."""
    work = np.empty(MAX_TERMS)
    step = step_constants(r, zeta, float(DEFAULT_STEPS))
    track = Track(*write_down(step, b, mu * b, SLIDES, work))
    ways = {
        "kernel": lambda: follow(step, b, mu * b, SLIDES, work),
        "closed forms of the kernel, no logic": lambda: walk(step, b, mu * b, track, work),
        "closed form of each slide at once": lambda: jump(r, zeta, b, mu * b, track),
    }
    place, stops = follow(step, b, mu * b, SLIDES, work)
    phases = SLIDES + stops
    times: dict[str, list[float]] = {name: [] for name in ways}
    off = 0.0
    for run in range(repeats + 1):
        for name, way in ways.items():
            seconds, answer = timed(way)
            off = max(off, abs(answer[0] - place))
            if run:  # the first one compiles
                times[name].append(1e9 * seconds / phases)
    if not off < _SAME_WAY * max(1.0, abs(place)):
        raise RuntimeError(f"r = {r}, b = {b}, mu = {mu}: a probe ended {off:.2g} from the kernel")
    entry: dict = {name: spread(taken) for name, taken in times.items()}
    floor = entry["closed forms of the kernel, no logic"]["median"]
    return entry | {
        "scan steps a slide": float(np.mean(track.whole + track.rest)),
        "stops a slide": stops / SLIDES,
        "kernel over its closed forms": entry["kernel"]["median"] / floor,
        "displacements differ by": off,
    }


def phase_floor(quick: bool) -> dict:
    """Measure and print nanoseconds per segment, of the kernel and of the closed forms alone."""
    repeats = 5 if quick else 200
    with pinned():
        found = {
            f"r = {r:g}, zeta = {zeta:g}, b = {b:g}, mu = {mu:g}": one_motion(r, zeta, b, mu, repeats)
            for r, zeta, b, mu in MOTIONS
        }
    table(
        ("ns a phase", "kernel", "no logic", "at once", "ratio", "scan steps", "stops a slide"),
        [
            (
                name,
                entry["kernel"]["median"],
                entry["closed forms of the kernel, no logic"]["median"],
                entry["closed form of each slide at once"]["median"],
                entry["kernel over its closed forms"],
                entry["scan steps a slide"],
                entry["stops a slide"],
            )
            for name, entry in found.items()
        ],
    )
    return found
