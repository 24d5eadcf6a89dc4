"""The scan of oscillators one step after the other, which `block.scan` is compared with."""

from frictionmap._kernels.compiler import kernel
from frictionmap._kernels.structure.oscillators import (
    AT_LIMIT,
    FAILED,
    STARTS_INSIDE,
    TERMS,
    TURN_COS,
    TURN_SIN,
    YC,
    YS,
    H,
    advance,
    bounds,
    expand,
    leave_range,
    step_on,
    turned,
    value,
)


@kernel
def scan(table, friction, low, high, rise, state, c, s, limit, scratch):
    """Follow the motion until y leaves [low, high], or for `limit` steps.

    Arguments and result as of `block.scan`, without its block.

    Notes
    -----
    A step is passed where y cannot reach an end of the range inside it by the bound on y''.  Any other step
        is examined by `leave_range`.
    """
    n = table.shape[0] - 1
    turn_c, turn_s, yc, ys = table[n, TURN_COS], table[n, TURN_SIN], table[n, YC], table[n, YS]
    start = (c, s)
    second, third, fourth, second_growth, third_growth, fourth_growth = bounds(table, friction, state, c, s)
    y = low if rise >= 0.0 else value(table, state, c, s)
    done = 0.0
    left = scratch.left[0]
    while y == y and done < left:  # a number
        c1 = turn_c * c - turn_s * s
        s1 = turn_c * s + turn_s * c
        y1 = step_on(table, n, friction, state, scratch.next, c, s) + (yc * c1 + ys * s1)
        margin = 0.125 * second
        sure = min(y, y1) - margin > low and max(y, y1) + margin < high
        whole = done + 1.0 <= limit
        if not (sure and whole):
            x, end, slope = 2.0, AT_LIMIT, 0.0
            if not sure:
                x, end, slope = leave_range(
                    table, friction, low, high, rise if done == 0.0 else STARTS_INSIDE, done, start, (c, s),
                    state, scratch,
                )  # fmt: skip
            remaining = 1.0 if whole else limit - done
            if x > remaining and not whole:
                x, end = remaining, AT_LIMIT
                terms = int(table[n, TERMS])
                expand(table, n, friction, scratch.next, c, s, table[n, H], terms, scratch.series)
                advance(scratch.series, n, terms, x, state)
            if x <= remaining:
                c, s = turned(start[0], start[1], (done + x) * table[n, H])
                scratch.left[0] = left - done - 1.0
                return done + x, end, c, s, slope
        done += 1.0
        second += second_growth
        third += third_growth
        fourth += fourth_growth
        y, c, s = y1, c1, s1
    scratch.left[0] = left - done - 1.0
    return done, FAILED, c, s, 0.0
