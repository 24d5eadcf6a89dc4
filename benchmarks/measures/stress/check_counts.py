"""Checks of stops and amplitudes of one mass against 40-digit steady states."""

from collections.abc import Iterator
from functools import partial

from frictionmap import regimes

from ...references import closed_forms, steady_states
from ...references.closed_forms import Number, mp
from .group import Group
from .row import Row

#: Slides a 40-digit march may take, a millisecond or two each.
_MOST_SLIDES = 100
#: A stop that lasts t is missed where the velocity, which would fall below zero by about t^2/2, is rounded by
#: as much: t = sqrt(2 eps), docs/known-limits.md.
_SHORTEST = mp.sqrt(2 * mp.mpf(2) ** -52)
#: Relative change of beta that rounding makes of some ten operations.
_BESIDE = mp.mpf(10) ** -15


def _one_mass(row: Row, beta: Number, r: Number, mu: Number) -> tuple[steady_states.OneMass, Number, Number]:
    """Normalised oscillator, and amplitude and phase of the load in its contact."""
    load = mp.mpc(1)
    if row.own.base_motion:
        load = mp.mpc(mp.mpf(r) ** 2, -2 * mp.mpf(row.body.zeta) * mp.mpf(r))
    return (
        steady_states.OneMass(r, row.body.zeta, mp.mpf(beta) / abs(load), mu), abs(load), mp.arg(load),
    )  # fmt: skip


def _steady(row: Row, beta: Number) -> tuple[steady_states.Steady | None, Number]:
    """40-digit steady state, if one is found, and the amplitude of the load in the contact."""
    motion, load, phase = _one_mass(row, beta, row.r, row.mu)
    try:
        if row.mu == 1.0:
            guess = row.amplitude(min(mp.mpf(beta), row.lim)) / load
            return motion.unique(guess, phase, _MOST_SLIDES), load
        return motion.steady(phase, _MOST_SLIDES), load
    except ArithmeticError:
        return None, load


def check_count(group: Group, row: Row, k: int | None, beta: float, what: str, cell: dict) -> None:
    """Check stops and amplitude against the 40-digit steady state, if one is found."""
    found, load = _steady(row, beta)
    if found is None:
        return
    group.counted += 1
    if not _same_count(cell, found):
        beside = [_steady(row, mp.mpf(beta) * (1 + sign * _BESIDE))[0] for sign in (1, -1)]
        if cell["status"] != regimes.RESOLVED:
            group.flagged_miscounts += 1
        elif found.shortest < _SHORTEST or any(
            orbit is not None and _same_count(cell, orbit) for orbit in beside
        ):
            group.miscounts_at_rounding += 1
        else:
            stops = 2.0 * found.stops / found.halves
            group.miscounted.append(
                f"{what}: {cell['stops_per_cycle']:g} stops a cycle, are {stops:g} (the shortest takes "
                f"{mp.nstr(found.shortest, 3)})"
            )
    elif cell["status"] == regimes.RESOLVED:
        group.compare(
            f"amplitude: {what}", k, cell["contact_amplitude"], found.amplitude * load,
            partial(_orbit_condition, row, beta, found),
        )  # fmt: skip


def _same_count(cell: dict, found: steady_states.Steady) -> bool:
    stops = 2.0 * found.stops / found.halves
    return abs(cell["stops_per_cycle"] - stops) <= 1e-6 * stops


def _orbit_condition(row: Row, beta: float, found: steady_states.Steady) -> Iterator:
    """Condition number of the amplitude of the orbit with respect to beta, r and mu."""

    def amplitude(beta: Number, r: Number, mu: Number) -> Number:
        motion, load, _ = _one_mass(row, beta, r, mu)
        orbit = motion.solved(found.anchor, found.slides)
        return found.amplitude * load if orbit is None else orbit.amplitude * load

    yield closed_forms.condition(lambda b: amplitude(b, row.r, row.mu), beta)
    yield closed_forms.condition(lambda r: amplitude(beta, r, row.mu), row.r)
    if row.mu > 1.0:
        yield closed_forms.condition(lambda mu: amplitude(beta, row.r, mu), row.mu)
