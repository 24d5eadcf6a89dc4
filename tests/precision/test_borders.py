"""Borders between numbers of stops: points by independent programs, cells beside them, whole maps."""

import functools

import numpy as np
import pytest

import frictionmap as fm
from frictionmap.stop_counts.beginnings import HALVES, begun, orbits_beside
from frictionmap.stop_counts.conditions import FOLD, SLIDE_END, TURN
from frictionmap.stop_counts.margins import violation
from frictionmap.stop_counts.phases import Phases
from frictionmap.stop_counts.seeds import Source, counts_at
from frictionmap.stop_counts.tracing import ends_with_stop, orbit_unknowns, solve

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


def border_at(source, r, beta, width=1e-6, halves=HALVES):
    """The border next to a point, by the orbit on one side of it."""
    phases, low, high = Phases(source.system), beta * (1.0 - width), beta * (1.0 + width)
    return begun(phases, orbits_beside(source, phases, (r, low, high), halves), low, high)


@pytest.mark.parametrize(("system", "kind", "below", "above", "r", "beta"), POINTS)
def test_points_of_borders(system, kind, below, above, r, beta):
    place = border_at(Source(system, 1.0), r, beta)
    assert place.condition.kind == kind
    assert place.unknowns[-1] == pytest.approx(beta, rel=1e-9)
    beside = place.unknowns[-1] * np.array([1.0 - 1e-6, 1.0 + 1e-6])
    np.testing.assert_array_equal(counts_at(Source(system, 1.0), np.array([r, r]), beside), [below, above])


def test_reference_points_of_borders(reference_table):
    """All points of mu = 1, to the digits of a bisection."""
    points = [row for row in reference_table("borders.json")["points"] if row["system"] in SYSTEMS]
    assert len(points) > 250
    missing = []
    for row in points:
        place = border_at(Source(SYSTEMS[row["system"]], 1.0), row["r"], row["beta"], 1e-5)
        if place is None or abs(place.unknowns[-1] / row["beta"] - 1.0) > 1e-9:
            missing.append(row)
    assert len(missing) <= 0.03 * len(points), missing[:5]  # next to points where two borders meet


WINDOWS = (
    (BASE, (0.15, 0.5), (4e-3, 0.1)),
    (CHAIN, (0.2, 0.5), (0.02, 1.5)),
    (WALL, (0.17, 0.5), (0.05, 1.0)),
)


#: The chain's many borders take several seconds.
NUMBERS = [0, pytest.param(1, marks=pytest.mark.slow), 2]


@functools.cache
def borders_in(system, r, beta, mu):
    return fm.borders(system, r, beta, mu)


def borders_of(number):
    return borders_in(*WINDOWS[number], 1.0)


@pytest.mark.parametrize("number", NUMBERS)
def test_cells_next_to_borders_have_the_counts(number):
    """Points evenly along the borders, away from their ends, where two borders are next to each other."""
    system, ds = WINDOWS[number][0], borders_of(number)
    assert ds.sizes["border"] > 1
    assert not np.isnan(ds.stops_below).any()
    assert not np.isnan(ds.stops_above).any()
    right = total = known = 0
    for k in range(ds.sizes["border"]):
        x, y = ds.border_r.values[k], ds.border_beta.values[k]
        x, y = x[~np.isnan(x)], y[~np.isnan(y)]
        assert (np.diff(x) > 0.0).all()
        length = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(np.log(x)), np.diff(np.log(y))))))
        inner = np.flatnonzero((length > 0.02) & (length < length[-1] - 0.02))
        if not inner.size:
            continue
        sides = [counts_at(Source(system, 1.0), x[inner], y[inner] * (1.0 + s * 1e-6)) for s in (-1.0, 1.0)]
        settled = ~np.isnan(sides).any(axis=0)  # close to the marginal motion of an undamped mass few settle
        good = (sides[0] == ds.stops_below.values[k]) & (sides[1] == ds.stops_above.values[k])
        right, total, known = right + good.sum(), total + inner.size, known + settled.sum()
    assert known > 40
    assert known >= 0.9 * total
    assert right == known


def crossed(ds, r, low, high):
    """Whether a border crosses between two friction ratios at a frequency, to a third of a per cent."""
    for x, y in zip(ds.border_r.values, ds.border_beta.values, strict=True):
        known = ~np.isnan(x)
        x, y = x[known], y[known]
        if x[0] * 0.997 <= r <= x[-1] * 1.003 and low * 0.997 <= np.interp(r, x, y) <= high * 1.003:
            return True
    return False


@pytest.mark.parametrize("number", NUMBERS)
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
    assert not missed


#: Points for mu = 1.5 of an independent program: kind, r, beta.
EXISTENCE = (
    (WALL, "graze-of-slide-end", 0.163929391354774, 0.1857454642965),
    (WALL, "graze-of-slide-end", 0.2, 0.2258487550077654),
    (WALL, "graze", 0.259833164599926, 0.18890433623969866),
    (WALL, "graze", 0.30742515353881694, 0.06584940852953376),
    (WALL, "slip-in-stop", 0.3349274306554769, 0.01625944391737481),
    (WALL, "turn/stop", 0.3226018807389212, 0.03091862514423076),
    (WALL, "turn/stop", 0.5979616001438556, 0.4231382589638756),
    (WALL, "fold", 0.210459700515762, 0.31986004903610915),
    (WALL, "fold", 0.1337490713750174, 0.19958154185781618),
    (BASE, "graze", 0.1594828497040927, 0.005310672323586146),
    (BASE, "turn/stop", 0.6054814325154799, 0.15740697807150328),
    (CHAIN, "slip-in-stop", 0.24853984549341182, 0.49583255833571804),
    (CHAIN, "graze", 0.1960009561756171, 0.04607486537185642),
    (CHAIN, "turn/stop", 0.6258627089388987, 0.6163112350442012),  # its stop has a length to the end
)


@pytest.mark.parametrize(("system", "kind", "r", "beta"), EXISTENCE)
def test_points_of_existence(system, kind, r, beta):
    place = border_at(Source(system, 1.5), r, beta)
    assert place.condition.kind == kind
    assert place.unknowns[-1] == pytest.approx(beta, rel=1e-9)


def test_reference_points_of_existence(reference_table):
    """All points of mu > 1.

    Missing are orbits that follow each other within 1e-6 of a border, one with every period, and some that
    neither start reaches.
    """
    points = [row for row in reference_table("borders.json")["points"] if row["mu"] > 1.0]
    assert len(points) > 80
    missing = []
    for row in points:
        system = SYSTEMS[row["system"].split("_")[0] + "_mu1"]
        tried = (  # one by one: the first that is the border is enough
            border_at(Source(system, row["mu"], start), row["r"], row["beta"], width, 20)
            for start in ("rest", "moving")
            for width in (1e-6, 1e-5, 1e-4)
        )
        if all(place is None or abs(place.unknowns[-1] / row["beta"] - 1.0) > 1e-9 for place in tried):
            missing.append(row)
    assert len(missing) <= 0.16 * len(points), missing[:5]


#: Where borders of mu = 1.5 end the existence of an orbit.
EXISTING = (WALL, (0.305, 0.336), (0.014, 0.07), 1.5)


@pytest.mark.slow
def test_an_orbit_lives_on_the_stated_side():
    """Solved next to points of its border it is physical on one side only, where stops are stated."""
    ds, checked = borders_in(*EXISTING), set()
    for row in EXISTENCE:
        system, kind, r, beta = row
        place = border_at(Source(system, 1.5), r, beta)
        if kind in (FOLD, SLIDE_END):
            continue  # two orbits meet there: Newton's method may find the other one
        phases, unknowns = Phases(system), orbit_unknowns(place.condition, place.unknowns)
        fixed = np.zeros((2, unknowns.size))
        fixed[0, -2] = fixed[1, -1] = 1.0
        lives = []
        for sign in (-1.0, 1.0):
            moved = unknowns.copy()
            moved[-1] *= 1.0 + sign * 1e-5
            orbit = solve(phases, place.sequence, None, moved, fixed)
            lives.append(orbit is not None and violation(phases, place.sequence, orbit) <= 1e-10)
        assert sum(lives) == 1
        if system is not WALL:
            continue
        stops = place.sequence.stops_per_cycle
        one_sided = kind != TURN or ends_with_stop(place.sequence, place.condition)
        for k in range(ds.sizes["border"]):
            x, y = ds.border_r.values[k], ds.border_beta.values[k]
            known = ~np.isnan(x)
            at = np.interp(r, x[known], y[known], left=np.nan, right=np.nan)
            if ds.border_kind.values[k] == kind and abs(at / beta - 1.0) < 1e-4:
                stated = [ds.stops_below.item(k), ds.stops_above.item(k)]
                assert stated[lives[1]] == stops
                assert np.isnan(stated[lives[0]]) == one_sided
                checked.add(kind)
    assert checked == {"graze", "slip-in-stop", "turn/stop"}


def test_existence_is_not_the_basin_of_a_start():
    """A start from rest changes at beta = 0.140397; the orbit with one stop lives down to 0.140259."""
    r, source = 0.42655658, Source(WALL, 1.5)
    beside = counts_at(source, np.full(2, r), np.array([0.14039, 0.14040]))
    np.testing.assert_array_equal(beside, [0.0, 1.0])
    ds = fm.borders(WALL, [0.42, 0.43], [0.13, 0.15], 1.5)
    ends = [
        np.interp(r, x[~np.isnan(x)], y[~np.isnan(x)], left=np.nan, right=np.nan)
        for x, y in zip(ds.border_r.values, ds.border_beta.values, strict=True)
    ]
    assert np.nanmin(np.abs(np.array(ends) - 0.140259)) < 1e-5  # chords of steps of 2 %
    assert np.nanmin(np.abs(np.array(ends) - 0.140397)) > 1e-4


def test_a_slip_curve_ends_where_its_event_meets_the_beginning_of_the_stop():
    """Slip in a stop meets turn/stop at (0.337328, 0.020175), fixed wall: it does not go on beyond."""
    ds = fm.borders(WALL, [0.31, 0.36], [0.012, 0.08])
    slips = ds.border_r.values[ds.border_kind.values == "slip-in-stop"]
    assert np.nanmax(slips) == pytest.approx(0.337328, abs=2e-6)


def test_what_is_refused():
    with pytest.raises(fm.InputError, match="r must be two numbers > 0"):
        fm.borders(WALL, [0.0, 1.0], [0.1, 1.0])
    with pytest.raises(fm.InputError, match="mu must be"):
        fm.borders(WALL, [0.1, 1.0], [0.1, 1.0], 0.5)
    with pytest.raises(fm.InputError, match="cannot find borders between numbers of stops"):
        fm.borders(fm.System(contact_stiffness=2.0), [0.1, 1.0], [0.1, 1.0])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("window", "kinds"),
    [
        ((*WINDOWS[2], 1.0), {"graze", "slip-in-stop"}),
        (
            (WALL, (0.55, 0.6), (0.3, 0.5), 1.3),
            {"turn/stop", "fold"},
        ),  # continuous to turn/stop, where a fold begins
        (EXISTING, {"turn/stop", "fold"}),  # as do stops of no length
    ],
)
def test_boundaries_are_not_among_the_borders(window, kinds):
    ds, mu = borders_in(*window), window[-1]
    for x, y in zip(ds.border_r.values, ds.border_beta.values, strict=True):
        known = ~np.isnan(x)
        ends = fm.boundaries(WALL, x[known], mu=mu)
        for name in ("beta_lim", "beta_stick"):
            away = np.abs(y[known] / ends[name].values[0] - 1.0)
            assert np.median(away) > 1e-6  # they may share an end
    assert kinds <= set(ds.border_kind.values.tolist())
