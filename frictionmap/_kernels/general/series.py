"""Taylor series of a step: modes, contacts and friction forces, from the state and the pattern at its start.

Term k of the accelerations follows from the terms up to k + 1 of the modes, by the equation of motion; the
forces that hold contacts are those for which the accelerations in these contacts vanish.  No case is special:
not resonance, not critical damping, not a combination of held contacts.
"""

from typing import NamedTuple

import numpy as np

from ..compiler import inner_kernel, kernel
from ..compiler.vectors import LANES, filled, load, store, total
from .cholesky import factor, solve_factored
from .crossings import value_at
from .held_together import fill_hold, hold_term, holds_together
from .laws.coupled import couple_forces, displace_by_others, factor_springs, is_coupled
from .laws.kinds import holding_stiffness, is_constrained, is_spare, is_spring, keeps_force
from .laws.speed import constant_factor, law_forces, set_law_damping
from .problem import INVERSE, LONG, NEXT, TERMS, WIDTH, F, H, first_contact_row
from .row import set_channels


class Friction(NamedTuple):
    """Friction of every contact in one cell, over the load's unit."""

    kinetic: np.ndarray  # (N,) beta_i
    static: np.ndarray  # (N,) mu_i beta_i


@kernel
def factor_held(problem, row, motion):
    """List the contacts that constraints hold, and factor their mobility; False if singular.

    Where contacts are coupled there are none; then the flexibility of the springs is factored.
    """
    contacts = motion.sense.size
    count = 0
    for j in range(contacts):
        if is_constrained(problem, motion, j):
            motion.held[count] = j
            count += 1
    motion.held[contacts] = count
    if is_coupled(problem):
        return factor_springs(problem, motion)
    return factor(row.mobility, motion.held, count, motion.solve)


@inner_kernel
def solve_held(motion, right):
    """Solve for the forces that hold contacts; `right` holds their accelerations and then the forces."""
    solve_factored(motion.solve, motion.held[motion.sense.size], right)


@inner_kernel
def _normal_loads(problem, series, first):
    """Fill the series of the normal loads."""
    modes, channels = problem.push.shape
    contacts = problem.spring.size
    for j in range(contacts):
        nu = (first + 3 * contacts + j) * WIDTH
        for k in range(0, WIDTH, LANES):
            store(filled(0.0), series, nu + k)
        for d in range(channels):
            if problem.normal[j, d] != 0.0:
                for k in range(0, WIDTH, LANES):
                    part = load(series, (modes + d) * WIDTH + k) * problem.normal[j, d]
                    store(load(series, nu + k) + part, series, nu + k)
        series[first + 3 * contacts + j, 0] += 1.0


@inner_kernel
def _known_forces(problem, friction, motion, first):
    """Fill the forces of sliding contacts; those of held ones begin at 0, or at the force that they keep."""
    contacts = problem.spring.size
    series = motion.series
    for j in range(contacts):
        force, nu = (first + 2 * contacts + j) * WIDTH, (first + 3 * contacts + j) * WIDTH
        size = motion.sense[j] * friction.kinetic[j] * constant_factor(problem, motion, j)
        for k in range(0, WIDTH, LANES):
            store(load(series, nu + k) * size, series, force + k)
        if keeps_force(problem, motion, j) or is_spare(problem, motion, j):
            series[first + 2 * contacts + j, 0] = motion.state[F, j]


@inner_kernel
def _spring_forces(problem, row, k, motion, first):
    """Fill term k > 0 of the forces of contacts that act as springs, from that of the modes."""
    modes, channels = problem.push.shape
    contacts = problem.spring.size
    width = row.chi.shape[1]
    for j in range(contacts):
        if is_spring(problem, motion, j):
            z = 0.0
            for m in range(0, width, LANES):
                z += total(load(row.chi, j * width + m) * load(motion.moves, k * width + m))
            for d in range(channels):
                z -= problem.base[j, d] * motion.series[modes + d, k]
            if k == 1:
                z -= row.numbers[H] * problem.belt[j]
            motion.series[first + 2 * contacts + j, k] = holding_stiffness(problem, j) * z
    if is_coupled(problem):
        couple_forces(problem, motion, k, first)


@inner_kernel
def _free_terms(problem, row, motion, first):
    """Fill all terms of the modes where no contact is held and C does not couple modes: mode by mode."""
    modes, channels = problem.push.shape
    contacts = problem.spring.size
    width = row.chi.shape[1]
    for m in range(0, width, LANES):
        before = load(motion.moves, m)
        here = load(motion.moves, width + m)
        for k in range(TERMS):
            drive = filled(0.0)
            for d in range(channels):
                drive = drive + load(row.push, d * width + m) * (INVERSE[k] * motion.series[modes + d, k])
            for j in range(contacts):
                force = motion.series[first + 2 * contacts + j, k]
                if force != 0.0:
                    drive = drive - load(row.reaction, j * width + m) * (INVERSE[k] * force)
            at = k * width + m
            drive = drive + load(row.place_term, at) * before
            before = here
            here = drive + load(row.velocity_term, at) * here
            store(here, motion.moves, at + 2 * width)


@inner_kernel
def _free_term(problem, row, k, motion, first):
    """Fill term k + 2 of the modes under all known forces."""
    modes, channels = problem.push.shape
    contacts = problem.spring.size
    width = row.chi.shape[1]
    for m in range(0, width, LANES):
        at = k * width + m
        drive = filled(0.0)
        for d in range(channels):
            drive = drive + load(row.push, d * width + m) * (INVERSE[k] * motion.series[modes + d, k])
        for j in range(contacts):
            force = motion.series[first + 2 * contacts + j, k]
            if force != 0.0:
                drive = drive - load(row.reaction, j * width + m) * (INVERSE[k] * force)
        if problem.coupled:
            for other in range(modes):
                rate = (k + 1.0) * INVERSE[k] * motion.moves[k + 1, other]
                drive = drive - load(row.coupling, other * width + m) * rate
        drive = drive + load(row.place_term, at) * load(motion.moves, at)
        drive = drive + load(row.velocity_term, at) * load(motion.moves, at + width)
        store(drive, motion.moves, at + 2 * width)


@inner_kernel
def _hold_term(problem, row, k, motion, first):
    """Fill term k of the forces that hold contacts, and take them from term k + 2 of the modes."""
    modes, channels = problem.push.shape
    contacts = problem.spring.size
    width = row.chi.shape[1]
    count = motion.held[contacts]
    series, right = motion.series, motion.solve[contacts]
    for a in range(count):
        j = motion.held[a]
        moves = 0.0
        for m in range(0, width, LANES):
            moves += total(load(row.chi, j * width + m) * load(motion.moves, (k + 2) * width + m))
        for d in range(channels):
            if problem.base[j, d] != 0.0:
                moves -= problem.base[j, d] * series[modes + d, k + 2]
        right[a] = moves
    solve_held(motion, right)
    scale = (k + 1.0) * (k + 2.0)
    for a in range(count):
        j = motion.held[a]
        series[first + 2 * contacts + j, k] = scale * right[a]
        for m in range(0, width, LANES):
            at = (k + 2) * width + m
            store(load(motion.moves, at) - load(row.reaction, j * width + m) * right[a], motion.moves, at)


@inner_kernel
def _contact_motion(problem, row, motion, first, whole):
    """Fill the displacements in the contacts, and the velocities relative to their walls.

    whole : for all contacts; else for those that slide
    """
    modes, channels = problem.push.shape
    contacts = problem.spring.size
    series = motion.series
    for k in range(LONG):
        for m in range(modes):
            series[m, k] = motion.moves[k, m]
    for j in range(contacts):
        if motion.sense[j] == 0 and not whole:
            continue
        z, w = (first + j) * WIDTH, (first + contacts + j) * WIDTH
        for k in range(0, WIDTH, LANES):
            place = filled(0.0)
            for m in range(modes):
                place = place + load(series, m * WIDTH + k) * row.chi[j, m]
            for d in range(channels):
                if problem.base[j, d] != 0.0:
                    place = place - load(series, (modes + d) * WIDTH + k) * problem.base[j, d]
            store(place, series, z + k)
        if is_coupled(problem):
            displace_by_others(problem, motion, j, first)
        for k in range(0, WIDTH - LANES, LANES):
            store(load(series, z + k + 1) * load(NEXT, k), series, w + k)
        series[first + contacts + j, 0] -= row.numbers[H] * problem.belt[j]


@inner_kernel
def _all_slide(motion):
    """Whether no contact is held."""
    held = 0
    for j in range(motion.sense.size):
        held += motion.sense[j] == 0
    return held == 0


@kernel
def expand(problem, row, friction, tau, interval, motion, whole):
    """Fill the series of the step that begins at the phase tau with the state and pattern in `motion`.

    Parameters
    ----------
    problem, row, friction : Problem, Row, Friction
    tau, interval : see `set_channels`
    motion : Motion
    whole : whether the motion in contacts that are held is wanted, too
    """
    contacts = problem.spring.size
    width = row.chi.shape[1]
    first = first_contact_row(problem)
    set_channels(problem, row, tau, interval, motion)
    _normal_loads(problem, motion.series, first)
    _known_forces(problem, friction, motion, first)
    for m in range(0, width, LANES):
        store(load(motion.state, m), motion.moves, m)
        store(load(motion.state, motion.state.shape[1] + m), motion.moves, width + m)
    sloped = set_law_damping(problem, row, friction, motion)
    if _all_slide(motion) and not problem.coupled and not sloped:
        _free_terms(problem, row, motion, first)
    else:
        together = holds_together(problem, motion)
        units = fill_hold(problem, row, motion) if together else 0
        for k in range(TERMS):
            if k > 0:
                _spring_forces(problem, row, k, motion, first)
            if sloped:
                law_forces(problem, row, k, motion)
            _free_term(problem, row, k, motion, first)
            if together:
                hold_term(problem, row, k, motion, units)
            elif motion.held[contacts] > 0:
                _hold_term(problem, row, k, motion, first)
    _contact_motion(problem, row, motion, first, whole)


@kernel
def advance(problem, row, x, motion):
    """Move the state on by x <= 1 of the present step."""
    first = first_contact_row(problem)
    contacts = problem.spring.size
    width = row.chi.shape[1]
    y = x * x
    for m in range(0, width, LANES):  # even and odd terms apart: two short chains of operations
        even = filled(0.0)
        odd = filled(0.0)
        even_slope = filled(0.0)
        odd_slope = filled(0.0)
        for k in range(LONG - 2, -1, -2):
            even_slope = even_slope * y + even
            odd_slope = odd_slope * y + odd
            even = even * y + load(motion.moves, k * width + m)
            odd = odd * y + load(motion.moves, (k + 1) * width + m)
        velocity = odd + (even_slope * x + odd_slope * y) * 2.0
        store(even + odd * x, motion.state, m)
        store(velocity, motion.state, motion.state.shape[1] + m)
    for j in range(contacts):
        if keeps_force(problem, motion, j) or is_coupled(problem):
            motion.state[F, j] = value_at(motion.series, first + 2 * contacts + j, x)
