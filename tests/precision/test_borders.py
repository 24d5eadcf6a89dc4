"""Borders between numbers of stops: points by independent programs, cells beside them, whole maps."""

import functools

import numpy as np
import pytest
from general_systems import reference

import frictionmap as fm
from frictionmap.stop_counts.curves import _begun
from frictionmap.stop_counts.phases import Phases
from frictionmap.stop_counts.seeds import counts_at

WALL = fm.System()
BASE = fm.System(contact="joined-base-wall")
CHAIN = fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.02)
SYSTEMS = {"wall1_mu1": WALL, "base1_mu1": BASE, "chain2_mu1": CHAIN}

#: Kind, stops below and above, r and beta, of an independent program.
POINTS = (
    (WALL, "graze", 2, 4, 0.2, 0.297980448818770),
    (WALL, "slip-in-stop", 4, 2, 0.2, 0.426744014645851),
    (WALL, "graze", 4, 6, 0.0701894916925111, 0.114805444248116),
    (WALL, "slip-in-stop", 6, 4, 0.0618965708481883, 0.0898115472265558),
    (WALL, "turn/stop", 2, 4, 0.196809424724864, 0.0108447600376055),
    (WALL, "graze", 8, 10, 0.0594926607399166, 0.412271007829604),
    (BASE, "graze", 2, 4, 0.225238198204998, 0.0134258195791998),
    (CHAIN, "graze", 2, 4, 0.219483172160718, 0.0765308312841699),
    (CHAIN, "slip-in-stop", 4, 2, 0.126412655627937, 0.967272028558906),
    (CHAIN, "graze", 4, 6, 0.128947870111254, 0.315851090962654),
    (CHAIN, "graze", 6, 4, 0.13421144082015, 0.406965208518861),  # its stop ends in the sense of its slide
    (CHAIN, "graze", 4, 2, 0.288239051152019, 0.85643230350142),
)


def border_at(system, r, beta, width=1e-6):
    """The border next to a point, by the orbit on one side of it."""
    return _begun(system, Phases(system), r, beta * (1.0 - width), beta * (1.0 + width))


@pytest.mark.parametrize(("system", "kind", "below", "above", "r", "beta"), POINTS)
def test_points_of_borders(system, kind, below, above, r, beta):
    place = border_at(system, r, beta)
    assert place.condition.kind == kind
    assert place.unknowns[-1] == pytest.approx(beta, rel=1e-9)
    beside = place.unknowns[-1] * np.array([1.0 - 1e-6, 1.0 + 1e-6])
    np.testing.assert_array_equal(counts_at(system, np.array([r, r]), beside, 1.0), [below, above])


def test_reference_points_of_borders():
    """All points of mu = 1, to the digits of a bisection."""
    points = [row for row in reference("borders.json")["points"] if row["system"] in SYSTEMS]
    assert len(points) > 250
    missing = []
    for row in points:
        place = border_at(SYSTEMS[row["system"]], row["r"], row["beta"], 1e-5)
        if place is None or abs(place.unknowns[-1] / row["beta"] - 1.0) > 1e-9:
            missing.append(row)
    assert len(missing) <= 0.03 * len(points), missing[:5]  # next to points where two borders meet


WINDOWS = (
    (BASE, (0.15, 0.5), (4e-3, 0.1)),
    (CHAIN, (0.2, 0.5), (0.02, 1.5)),
    (WALL, (0.17, 0.5), (0.05, 1.0)),
)


@functools.cache
def borders_of(number):
    system, r, beta = WINDOWS[number]
    return fm.borders(system, r, beta)


@pytest.mark.parametrize("number", range(len(WINDOWS)))
def test_cells_beside_borders_have_the_counts(number):
    """Points evenly along the borders, away from their ends, where two borders are next to each other."""
    system, ds = WINDOWS[number][0], borders_of(number)
    assert ds.sizes["border"] > 1
    right = total = 0
    for k in range(ds.sizes["border"]):
        x, y = ds.border_r.values[k], ds.border_beta.values[k]
        x, y = x[~np.isnan(x)], y[~np.isnan(y)]
        assert (np.diff(x) > 0.0).all()
        length = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(np.log(x)), np.diff(np.log(y))))))
        inner = np.flatnonzero((length > 0.02) & (length < length[-1] - 0.02))
        if not inner.size:
            continue
        below, above = (counts_at(system, x[inner], y[inner] * (1.0 + s * 1e-6), 1.0) for s in (-1.0, 1.0))
        good = (below == ds.stops_below.values[k]) & (above == ds.stops_above.values[k])
        right, total = right + good.sum(), total + inner.size
    assert total > 40
    assert right >= 0.98 * total


def crossed(ds, r, low, high):
    """Whether a border crosses between two friction ratios at a frequency, to a third of a per cent."""
    for x, y in zip(ds.border_r.values, ds.border_beta.values, strict=True):
        known = ~np.isnan(x)
        x, y = x[known], y[known]
        if x[0] * 0.997 <= r <= x[-1] * 1.003 and low * 0.997 <= np.interp(r, x, y) <= high * 1.003:
            return True
    return False


@pytest.mark.parametrize("number", range(len(WINDOWS)))
def test_every_change_of_count_in_a_map_is_on_a_border(number):
    system, (r0, r1), (b0, b1) = WINDOWS[number]
    ds = borders_of(number)
    r, beta = np.linspace(r0, r1, 301)[1:-1], np.linspace(b0, b1, 300)
    cells = fm.sweep(system, r, beta, outputs=["stops_per_cycle", "status"])
    stops = np.where(cells.status == 0, cells.stops_per_cycle, np.nan)[0]
    changed = (stops[:, 1:] != stops[:, :-1]) & ~np.isnan(stops[:, 1:]) & ~np.isnan(stops[:, :-1])
    for name in ("beta_lim", "beta_stick"):
        limit = cells[name].values[0][:, np.newaxis]
        changed &= ~((beta[:-1] <= limit) & (limit <= beta[1:]))
    places = np.argwhere(changed)
    assert len(places) > 50
    missed = [(r[i], beta[j]) for i, j in places if not crossed(ds, r[i], beta[j], beta[j + 1])]
    assert len(missed) <= 0.01 * len(places), missed[:5]


def test_what_is_refused():
    with pytest.raises(fm.InputError, match="r must be two numbers > 0"):
        fm.borders(WALL, [0.0, 1.0], [0.1, 1.0])
    with pytest.raises(fm.InputError, match="cannot find borders between numbers of stops"):
        fm.borders(fm.System(contact_stiffness=2.0), [0.1, 1.0], [0.1, 1.0])
