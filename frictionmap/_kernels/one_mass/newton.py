"""Periodic orbits as fixed points of the return map, by Newton's method with the exact derivative.

An orbit is followed from an anchor, the start of an upward slide, until it returns there.  If the anchor ends
a stop, its displacement z is the only unknown: the load phase at which the stop ends follows from z.  If it
is a turn without a stop, z and the load phase theta are the unknowns.

Derivatives are those of the state at a fixed phase: free motion between events, and at each event the shift
of its phase (saltation).
"""

import math

from ..closed_form import decay
from ..compiler import kernel
from ..event_codes import NO_END, REVERSE, STOP_THEN_BACK, STOP_THEN_ON
from ..newton_limits import LONGEST_SLIDE, MAX_NEWTON, NEAR_END, ROUNDING, next_step_negligible
from .events import after_slide, slide_within


@kernel
def stop_ends(mu_b, z):
    """Load phase (cos, sin) at which a stop at z ends and an upward slide begins."""
    c = z + mu_b
    return c, -math.sqrt(max(0.0, (1.0 - c) * (1.0 + c)))


@kernel
def first_contact_force(b, mu_b, z, c):
    """Compute r^2 z'' at an anchor; exact where a stop ends there, which is recognised by c = z + mu b."""
    return mu_b - b if c == z + mu_b else c - z - b


@kernel
def longest_slide(step, r):
    """Longest slide of an orbit, in scan steps."""
    return LONGEST_SLIDE * 2.0 * math.pi * max(1.0, r) / step.h


@kernel
def _return_map(step, oscillator, b, mu_b, z, c, s, after_stop, sequence, scratch):
    """Follow one recurrence through a sequence of events, with derivatives.

    Parameters
    ----------
    step : Step
    oscillator : Oscillator
    b, mu_b : kinetic and static friction over load amplitude
    z : displacement at the anchor
    c, s : cosine and sine of the load phase there
    after_stop : whether the anchor ends a stop
    sequence : EventSequence
    scratch : Scratch

    Returns
    -------
    (fits, z, c, s, z_z, z_t, t_z, t_t) : whether the events fit the sequence; the state at the end;
        derivatives of its displacement z and phase t with respect to those at the anchor, of which only z_z
        applies after a stop
    """
    a = 1.0 / oscillator.r
    events = sequence.events
    max_steps = longest_slide(step, oscillator.r)
    contact_force = mu_b - b if after_stop else c - z - b
    # deviation of a neighbouring motion that starts with another z (first) or another phase (second)
    z_z, t_z = 1.0, -1.0 / s if after_stop else 0.0
    z_t, t_t = 0.0, 0.0 if after_stop else 1.0
    for m in range(sequence.count):
        n, z, c, s = slide_within(
            step, b, z, 0.0, step.stiffness * contact_force, c, s, max_steps, scratch
        )  # fmt: skip
        if n == NO_END:
            return False, z, c, s, 0.0, 0.0, 0.0, 0.0
        q, e = decay(oscillator.zeta, a * n * step.h)
        d = e + 2.0 * oscillator.zeta * q
        # a later start appears as a lower velocity at a fixed phase
        lag_z = -contact_force * a * a * t_z
        lag_t = -contact_force * a * a * t_t
        v_z = e * lag_z - a * q * z_z
        v_t = e * lag_t - a * q * z_t
        z_z = d * z_z + oscillator.r * q * lag_z
        z_t = d * z_t + oscillator.r * q * lag_t
        pull = (z - c + b) * a * a  # -z'' at the end of the slide
        code, z, c, s, contact_force, _ = after_slide(b, mu_b, z, c, s)
        if code != int(events[(sequence.first + m) % events.size]):
            return False, z, c, s, 0.0, 0.0, 0.0, 0.0
        if code == REVERSE or code == STOP_THEN_BACK:
            z_z = -z_z
            z_t = -z_t
        if code == REVERSE:
            t_z = v_z / pull
            t_t = v_t / pull
        elif code == STOP_THEN_BACK or code == STOP_THEN_ON:
            t_z = -z_z / s
            t_t = -z_t / s
        else:
            return False, z, c, s, 0.0, 0.0, 0.0, 0.0
    return True, z, c, s, z_z, z_t, t_z, t_t


@kernel
def solve_orbit(step, oscillator, b, mu_b, z, c, s, after_stop, sequence, tolerance, scratch):
    """Solve the return map for its fixed point by Newton's method.

    Parameters
    ----------
    step : Step
    oscillator : Oscillator
    b, mu_b : kinetic and static friction over load amplitude
    z : first guess of the displacement at the anchor
    c, s : cosine and sine of the load phase there; not used after a stop
    after_stop : whether the anchor ends a stop
    sequence : EventSequence of one recurrence
    tolerance : largest Newton step, relative to z
    scratch : Scratch

    Returns
    -------
    (found, z, c, s, contraction) : `found` is True only for a stable orbit; `contraction` is the largest
        modulus of the multipliers of one recurrence
    """
    last = math.inf
    for _ in range(MAX_NEWTON):
        if after_stop:
            c, s = stop_ends(mu_b, z)
            if not s < 0.0:
                break
        fits, z1, c1, s1, z_z, z_t, t_z, t_t = _return_map(
            step, oscillator, b, mu_b, z, c, s, after_stop, sequence, scratch
        )
        if not fits:
            break
        miss = z1 - z
        if after_stop:
            contraction = abs(z_z)
            if not contraction < 1.0:
                break
            move = miss / (1.0 - z_z)
            turn = late = 0.0
        else:
            late = math.atan2(s1 * c - c1 * s, c1 * c + s1 * s)
            trace = z_z + t_t
            det = z_z * t_t - z_t * t_z
            root = trace * trace - 4.0 * det
            if root >= 0.0:
                contraction = 0.5 * (abs(trace) + math.sqrt(root))
            else:
                contraction = math.sqrt(det)
            if not contraction < 1.0:
                break
            whole = 1.0 - trace + det
            move = (miss * (1.0 - t_t) + late * z_t) / whole
            turn = (late * (1.0 - z_z) + miss * t_z) / whole
        size = abs(move) + abs(turn) * abs(z)
        if not size < math.inf:
            break
        if size <= tolerance * abs(z) and size >= 0.5 * last:
            return True, z, c, s, contraction  # converged to rounding
        if size > 0.25 * last and tolerance * abs(z) < size < NEAR_END * abs(z):
            break  # not quadratic: the map only touches the identity there (marginal continua, R = 1/(2n))
        z += move
        if turn != 0.0:
            cosine = math.cos(turn)
            sine = math.sin(turn)
            c, s = c * cosine - s * sine, s * cosine + c * sine
        off = abs(miss) + abs(late) * abs(z)
        if size <= ROUNDING * abs(z) or next_step_negligible(size, last, off, abs(z), tolerance):
            if after_stop:
                c, s = stop_ends(mu_b, z)
            return True, z, c, s, contraction
        last = size
    return False, z, c, s, 1.0
