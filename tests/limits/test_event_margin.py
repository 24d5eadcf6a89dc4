"""Orbits that a motion only passes by, and how near it must be to an orbit to keep its events."""

from functools import partial

import numpy as np
import pytest
from kernels import callable_kernel
from structures import random_chain
from test_stability import first_of, next_events, set_moving

import frictionmap as fm
from frictionmap._kernels.structure import event_margin as margins
from frictionmap._kernels.structure import events, newton, state

event_margin = callable_kernel(margins.event_margin)
energy = callable_kernel(state.energy)
return_map = callable_kernel(newton.return_map)
slide_on = callable_kernel(events.slide_on)

#: Masses, springs, contact, loaded mass, damping ratio, mu, r, beta.  In each the motion from rest comes
#: within a thousandth of an orbit, and goes on to another one.
PASSED_BY = [
    ([1, 0.552], [1, 0.656], 2, 2, 0.0108, 1.087, 0.21226494341472932, 0.08878979168459572),
    (
        [1, 0.552, 2.092, 2.129, 1.276, 1.044], [1, 1.04, 0.658, 0.473, 0.475, 1.826], 2, 6, 0.0076, 1.057,
        0.15799346990513768, 1.5038443899125422,
    ),
    (
        [1, 0.977, 1.074, 0.918, 1.422], [1, 1.814, 0.422, 0.99, 0.588], 2, 1, 0.009, 1.186,
        0.05959727972381561, 0.1595915041174301,
    ),
    ([1, 1.353], [1, 1.279], 2, 2, 0.0069, 1.314, 0.05022645406232983, 0.3027353161129125),
    (
        [1, 1.075, 2.668, 1.555, 0.493, 1.113], [1, 0.398, 2.429, 0.723, 0.537, 0.451], 3, 5, 0.0199, 1.056,
        1.2687589561943788, 0.510066792882715,
    ),
]  # fmt: skip


@pytest.mark.parametrize("case", PASSED_BY, ids=range(len(PASSED_BY)))
def test_an_orbit_that_is_passed_by_is_not_taken(case):
    masses, springs, contact, load, zeta, mu, r, beta = case
    system = fm.System(
        mass_ratios=masses, stiffness_ratios=springs, contact_masses=[contact], load_mass=load,
        damping_ratios=zeta,
    )  # fmt: skip
    names = ("stops_per_cycle", "period", "contact_amplitude")
    solved = fm.sweep(system, [r], [beta], [mu], outputs=names)
    marched = fm.sweep(system, [r], [beta], [mu], outputs=names, solver=fm.Solver(steady="marched"))
    assert solved.period.item() == marched.period.item() > 0
    assert solved.stops_per_cycle.item() == marched.stops_per_cycle.item()
    assert solved.contact_amplitude.item() == pytest.approx(marched.contact_amplitude.item(), rel=1e-7)


def _has_events(contact, phase, sequence, tools, moved):
    """Whether a motion has a sequence of events, and then slides in the same direction."""
    return any(
        return_map(*contact, moved.copy(), *phase, sequence, halves, False, *tools) for halves in range(1, 9)
    )


def test_motions_well_within_the_margin_have_the_events():
    """Random motions and random deviations from them, over one to three slides."""
    rng = np.random.default_rng(8)
    kept, lost = [], []
    for _ in range(80):
        system, _ = random_chain(rng, float(rng.choice([0.01, 0.2, 1.0])))
        r, mu = float(rng.uniform(0.2, 1.8)), float(rng.choice([1.1, 1.3, 2.0]))
        beta = float(rng.uniform(0.1, 0.8)) * fm.boundaries(system, [r]).beta_stick.item()
        n, st, start, c, s, work, scratch = set_moving(system, r, beta, mu)
        ahead = start.copy()
        steps, *_ = slide_on(st, beta, -1.0, ahead, c, s, 1e6, scratch)
        _, _, c, s, _ = slide_on(st, beta, -1.0, start, c, s, 0.5 * steps, scratch)
        count = int(rng.integers(1, 4))
        codes = next_events(st, beta, mu * beta, start, c, s, count, work, scratch)
        sequence = first_of(codes, count)

        same_events = partial(_has_events, (st, beta, mu * beta), (c, s), sequence, (work, scratch))
        if not same_events(start):
            continue
        margin = event_margin(st, beta, mu * beta, start.copy(), c, s, count, work, scratch)
        if margin == 0.0:  # the contact grazes or sticks permanently before the slides are over
            continue
        for _ in range(20):
            away = np.zeros_like(start)
            away[:, :n] = rng.standard_normal((2, n))
            away *= margin / energy(st, away)
            kept.append(same_events(start + 0.3 * away))
            lost.append(not same_events(start + 30.0 * away))
    assert len(kept) > 300
    assert all(kept)
    assert np.mean(lost) > 0.5  # it is a margin, not a bound for every case


@pytest.mark.parametrize("mu", [1.1, 2.0])
def test_no_margin_where_the_contact_sticks_permanently(mu):
    """A moving start slides a few times and then stays stuck: there is no orbit to follow to its end."""
    system = fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1], contact_masses=[2], damping_ratios=0.05)
    beta = 0.99 * fm.boundaries(system, [0.5]).beta_stick.item()
    _, st, start, c, s, work, scratch = set_moving(system, 0.5, beta, mu)
    assert event_margin(st, beta, mu * beta, start, c, s, 1000, work, scratch) == 0.0
