"""A steady state in time: its slides and stops, and samples of the motion along them."""

import math

from .continuous import continuous_amplitude, orbit_phase
from .events import NO_END, REVERSE, STOP_THEN_BACK, after_slide, slide
from .jit import entry, kernel
from .orbits import first_push, longest_slide
from .phases import expand

#: Columns of a table of slides, each followed by the stop (or the turn) that ends it.
LENGTH = 0  # of the slide, in tau
Z = 1  # state at its start, mirrored where SIGN = -1
COS = 2
SIN = 3
PUSH = 4  # r^2 z'' there
SIGN = 5
WAIT = 6  # duration of the stop
Z_END = 7
COLUMNS = 8


@kernel
def _record(step, r, b, mu_b, z, c, s, push, sign, rows, work):
    max_steps = longest_slide(step, r)
    for k in range(rows.shape[0]):
        rows[k, Z] = z
        rows[k, COS] = c
        rows[k, SIN] = s
        rows[k, PUSH] = push
        rows[k, SIGN] = sign
        n, z, c, s = slide(step, b, z, 0.0, step.stiffness * push, c, s, max_steps, work)
        if n == NO_END:
            return False
        rows[k, LENGTH] = n * step.h
        rows[k, Z_END] = z
        code, z, c, s, push, wait = after_slide(b, mu_b, z, c, s)
        rows[k, WAIT] = wait
        if code == REVERSE or code == STOP_THEN_BACK:
            sign = -sign
    return True


@entry
def continuous_slides(step, oscillator, b, rows, work):
    """The slides of the continuous orbit, from its minimum on; `rows` has shape (2, COLUMNS)."""
    z = -continuous_amplitude(oscillator.v_abs, oscillator.u, oscillator.g, b)
    phase = orbit_phase(oscillator.v_abs, oscillator.v_arg, oscillator.u, b)
    c = -math.cos(phase)
    return _record(step, oscillator.r, b, b, z, c, -math.sin(phase), c - z - b, 1.0, rows, work)


@entry
def orbit_slides(step, r, b, mu_b, z, c, s, sign, rows, work):
    """The slides of a steady state from its anchor on; `rows` has shape (events, COLUMNS)."""
    return _record(step, r, b, mu_b, z, c, s, first_push(b, mu_b, z, c), sign, rows, work)


@entry
def sample_slides(step, b, rows, tau, z, v, friction, phase, work):
    """z, z', friction and sense of motion at times `tau` >= 0, increasing, from the start of `rows`.

    In units of the normalised oscillator; `phase` is -1, 0 or 1.  Times past the end are left alone.
    """
    begin = 0.0
    k = 0
    for row in range(rows.shape[0]):
        sign = rows[row, SIGN]
        position = rows[row, Z]
        w = 0.0
        c = rows[row, COS]
        s = rows[row, SIN]
        acceleration = step.stiffness * rows[row, PUSH]
        expand(step, b, position, w, acceleration, c, s, work)
        node = begin
        end = begin + rows[row, LENGTH]
        while k < tau.size and tau[k] < end:
            while tau[k] > node + step.h:
                forced_z = step.z_cos * c + step.z_sin * s - step.z_one * b
                forced_w = step.w_cos * c + step.w_sin * s - step.w_one * b
                new = forced_z + step.zz * position + step.zw * w
                w = forced_w + step.wz * position + step.ww * w
                position = new
                new = step.cos * c - step.sin * s
                s = step.cos * s + step.sin * c
                c = new
                node += step.h
                acceleration = step.stiffness * (c - b - position) - step.damping * w
                expand(step, b, position, w, acceleration, c, s, work)
            x = (tau[k] - node) / step.h
            rise = 0.0
            velocity = 0.0
            for m in range(step.terms - 1, -1, -1):
                velocity = velocity * x + work[m]
                rise = rise * x + work[m] / (m + 1.0)
            z[k] = sign * (position + rise * x)
            v[k] = sign * velocity / step.h
            friction[k] = sign * b
            phase[k] = int(sign)
            k += 1
        # the load's phase at the end of the slide, from its start: no error of the steps
        angle = math.atan2(rows[row, SIN], rows[row, COS])
        begin = end
        end = begin + rows[row, WAIT]
        while k < tau.size and tau[k] < end:
            theta = angle + rows[row, LENGTH] + (tau[k] - begin)
            z[k] = sign * rows[row, Z_END]
            v[k] = 0.0
            friction[k] = sign * (math.cos(theta) - rows[row, Z_END])
            phase[k] = 0
            k += 1
        begin = end
