"""Bounds on motions with other friction hold, and are close where they can be."""

import numpy as np
import pytest
from random_chains import random_chain

import frictionmap as fm
from frictionmap.motions.bounds import friction_bounds, interpolation_bounds, record_bounds


def _system(seed):
    """A chain with one to three contacts."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 4))
    elastic = 3.0 if seed % 3 == 2 else None
    belt = 0.3 if seed % 4 == 3 else 0.0
    contacts = [fm.Contact("fixed-wall", int(rng.integers(1, n + 1)), stiffness=elastic, wall_speed=belt)]
    if n > 1:
        contacts.append(fm.Contact("between-masses", [1, n], ratio=0.5))
    return fm.System(
        mass_ratios=np.concatenate(([1.0], rng.uniform(0.5, 2.0, n - 1))),
        stiffness_ratios=np.concatenate(([1.0], rng.uniform(0.4, 2.0, n - 1))),
        damping_ratios=0.05, contacts=contacts,
    ), fm.Record(rng.normal(size=150), 0.3, quantity="force")  # fmt: skip


@pytest.mark.parametrize("seed", range(8))
def test_motions_with_more_friction_keep_within_the_bound(seed):
    """Histories at the same times, and peaks and places of rest, over gaps of very different widths."""
    system, record = _system(seed)
    until = {"after": 30.0}
    for step in (1e-6, 0.1, 1.0):
        for low in (0.0, 0.3):
            beta = [low, low + 0.37 * step, low + step]
            runs = [fm.history(system, record, beta=b, **until) for b in beta]
            bound = friction_bounds(system, runs[0], step).isel(record=0, scale=0, mu=0, beta=0)
            common = np.intersect1d(np.intersect1d(*(one.time for one in runs[:2])), runs[2].time)
            first, *others = (one.drop_duplicates("time").sel(time=common) for one in runs)
            for other in others:
                apart = np.abs(first.x.values - other.x.values).max(axis=-1).ravel()
                assert (apart <= bound.amplitude.values * (1.0 + 1e-9) + 1e-13).all()
            z = np.abs(first.z.values - others[-1].z.values).max(axis=-1).ravel()
            assert (z <= bound.contact_amplitude.values * (1.0 + 1e-9) + 1e-13).all()


def test_the_bound_of_a_block_on_a_spring_is_nearly_reached():
    """A short push: while the mass has hardly moved, only friction tells the two motions apart."""
    push = fm.Record([1.0, 1.0, 0.0], 0.05, quantity="force", interpolation="hold")
    system = fm.System(contacts=[fm.Contact("fixed-wall", 1)])
    low, high = (fm.history(system, push, beta=beta, samples="none") for beta in (0.1, 0.1 + 1e-4))
    bound = friction_bounds(system, low, 1e-4).amplitude.item()
    apart = low.amplitude.item() - high.amplitude.item()
    assert 0.3 * bound < apart <= bound


def test_what_has_no_bound():
    system, record = (
        fm.System(contacts=[fm.Contact("fixed-wall", 1)]),
        fm.Record([0.0, 1.0, 0.0], 1.0, quantity="force"),
    )
    assert np.isnan(
        friction_bounds(system, fm.history(system, record, beta=0.2, mu=1.5), 0.1).amplitude
    ).all()
    free = fm.System(
        matrices={"M": [[1.0]], "K": [[0.0]]}, frequency_scale=1.0, contacts=[fm.Contact("fixed-wall", 1)]
    )
    assert np.isinf(friction_bounds(free, fm.history(free, record, beta=0.2), 0.1).amplitude).all()


@pytest.mark.parametrize("quantity", ["amplitude", "contact_amplitude", "residual"])
def test_a_design_bounds_between_its_grid(quantity):
    """Nowhere on a grid ten times as fine is the median below its bound."""
    records = fm.Record.generate("white", 20.0, 0.2, rms=0.5, seed=4, count=5, quantity="force")
    system = fm.System(damping_ratios=0.05, contacts=[fm.Contact("fixed-wall", 1)])
    ds = fm.design.least_median(system, records, (0.02, 0.5), quantity=quantity)
    fine = np.linspace(0.02, 0.5, 49 * 10 + 1)
    over = np.median(
        abs(fm.history(system, records, beta=fine, samples="none")[quantity].values.reshape(5, -1)), axis=0
    )
    gap = np.minimum(np.searchsorted(ds.beta_search.values, fine, side="right") - 1, 48)
    assert (over >= ds.least_between.values[gap] - 1e-12).all()
    assert over.min() >= ds.peak.item() - ds.missed_at_most.item() - 1e-12
    assert 0.0 < ds.missed_at_most.item() <= ds.peak.item()


def test_accelerations_have_no_bound():
    records = fm.Record.generate("white", 5.0, 0.2, rms=0.5, seed=4, count=2, quantity="force")
    ds = fm.design.least_median(fm.System(contacts=[fm.Contact("fixed-wall", 1)]), records, (0.02, 0.5))
    assert np.isnan(ds.missed_at_most)


def _furthest(system, records, friction, name, **options):
    """Largest difference of a variable of two motions at their common times, (rows,)."""
    runs = [fm.history(system, one, beta=friction, beta_hold=False, **options) for one in records]
    _, *places = np.intersect1d(runs[0].time.values, runs[1].time.values, return_indices=True)
    rows = [
        one[name].values.reshape(-1, one.time.size)[:, place] for one, place in zip(runs, places, strict=True)
    ]
    return np.abs(rows[0] - rows[1]).max(axis=1)


@pytest.mark.parametrize("seed", range(30))
def test_interpolations_keep_within_their_bound(seed):
    """Random chains on belts, rigid and elastic, under forces and accelerations of the base."""
    rng = np.random.default_rng(seed)
    system = random_chain(rng)
    values, dt = rng.normal(size=60), rng.choice([0.1, 0.7])
    lines = fm.Record(values, dt, quantity="force", mass=int(rng.integers(1, system.n + 1)))
    spline = fm.Record(values, dt, quantity="force", mass=lines.mass, interpolation="cubic")
    bound = interpolation_bounds(system, lines)
    assert interpolation_bounds(system, spline).equals(bound)
    for friction in (0.0, 0.3):
        for name, most in (("x", bound.amplitude), ("z", bound.contact_amplitude)):
            apart = _furthest(system, (lines, spline), friction, name, after=10.0)
            assert (apart <= most.values * (1.0 + 1e-12)).all()


def test_a_resampled_record_of_the_base_keeps_within_its_bound():
    """Every third sample of a base acceleration, with a contact that the base carries."""
    system = fm.System(
        mass_ratios=[1.0, 0.6], stiffness_ratios=[1.0, 0.8], damping_ratios=0.03, excitation="base",
        damping_reference="base", contacts=[fm.Contact("joined-base-wall", 1)],
    )  # fmt: skip
    values = np.cumsum(np.random.default_rng(5).normal(size=91)) / 10.0
    records = fm.Record(values, 0.1), fm.Record(values[::3], time=0.3 * np.arange(31))
    bound = record_bounds(system, *records).amplitude.values
    apart = _furthest(system, records, 0.2, "x", after=10.0)
    assert (apart <= bound).all()
    assert (apart > 0.02 * bound).all()


def test_the_bound_of_an_interpolation_is_nearly_reached():
    """A short triangle without friction: the difference of its impulses is the velocity at its end.

    Of the shares s of a half, the spline is 1.5 s - 0.5 s^3, so that the impulse is 5/8 instead of 1/2.
    """
    push = fm.Record([0.0, 1.0, 0.0], 0.01, quantity="force")
    smooth = fm.Record([0.0, 1.0, 0.0], 0.01, quantity="force", interpolation="cubic")
    lines, spline = (fm.history(fm.System(), one, beta=0.0, after=3.0) for one in (push, smooth))
    bound = interpolation_bounds(fm.System(), push).amplitude.item()
    apart = spline.amplitude.item() - lines.amplitude.item()
    assert apart == pytest.approx(0.25 * 0.01, rel=1e-3)
    assert 0.9 * bound < apart <= bound


def test_what_has_no_bound_of_its_interpolation():
    system = fm.System(contacts=[fm.Contact("fixed-wall", 1)], excitation="base", damping_reference="base")
    quake = fm.Record([0.0, 1.0, 0.0], 1.0)
    assert np.isnan(
        interpolation_bounds(system, quake).amplitude
    ).all()  # the wall sees the place of the base
    hold = fm.Record([0.0, 1.0], 1.0, quantity="force", interpolation="hold")
    assert np.isnan(interpolation_bounds(fm.System(), hold).amplitude).all()
    assert np.isnan(
        interpolation_bounds(fm.System(), fm.Record.pulse("ricker", 1.0, 2.0, quantity="force")).amplitude
    ).all()
    two = fm.System(mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0])
    with pytest.raises(fm.InputError, match="other must act as force"):
        record_bounds(two, hold, fm.Record([0.0, 1.0], 1.0, quantity="force", mass=2))
