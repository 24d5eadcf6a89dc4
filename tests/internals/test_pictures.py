"""What pictures are made of: colours that stay apart, cells that no pixel loses, labels that lie apart."""

from itertools import combinations, product

import numpy as np
import pytest
import xarray as xr
from colours import SIMULATIONS, ciede2000, difference, lab, linear, seen_by
from matplotlib.colors import to_rgb

import frictionmap as fm
from frictionmap import regimes
from frictionmap.pictures import classes, features, grids, marks, palette, words
from frictionmap.pictures.maps import raster

LABELS = [look.label for look in palette.CLASSES]
COLOURS = {look.label: to_rgb(look.colour) for look in palette.CLASSES}

# Colours

#: Sharma, Wu, Dalal (2005), table 1.
PUBLISHED = """
50.0000 2.6772 -79.7751 50.0000 0.0000 -82.7485 2.0425
50.0000 3.1571 -77.2803 50.0000 0.0000 -82.7485 2.8615
50.0000 2.8361 -74.0200 50.0000 0.0000 -82.7485 3.4412
50.0000 -1.3802 -84.2814 50.0000 0.0000 -82.7485 1.0000
50.0000 -1.1848 -84.8006 50.0000 0.0000 -82.7485 1.0000
50.0000 -0.9009 -85.5211 50.0000 0.0000 -82.7485 1.0000
50.0000 0.0000 0.0000 50.0000 -1.0000 2.0000 2.3669
50.0000 -1.0000 2.0000 50.0000 0.0000 0.0000 2.3669
50.0000 2.4900 -0.0010 50.0000 -2.4900 0.0009 7.1792
50.0000 2.4900 -0.0010 50.0000 -2.4900 0.0010 7.1792
50.0000 2.4900 -0.0010 50.0000 -2.4900 0.0011 7.2195
50.0000 2.4900 -0.0010 50.0000 -2.4900 0.0012 7.2195
50.0000 -0.0010 2.4900 50.0000 0.0009 -2.4900 4.8045
50.0000 -0.0010 2.4900 50.0000 0.0010 -2.4900 4.8045
50.0000 -0.0010 2.4900 50.0000 0.0011 -2.4900 4.7461
50.0000 2.5000 0.0000 50.0000 0.0000 -2.5000 4.3065
50.0000 2.5000 0.0000 73.0000 25.0000 -18.0000 27.1492
50.0000 2.5000 0.0000 61.0000 -5.0000 29.0000 22.8977
50.0000 2.5000 0.0000 56.0000 -27.0000 -3.0000 31.9030
50.0000 2.5000 0.0000 58.0000 24.0000 15.0000 19.4535
50.0000 2.5000 0.0000 50.0000 3.1736 0.5854 1.0000
50.0000 2.5000 0.0000 50.0000 3.2972 0.0000 1.0000
50.0000 2.5000 0.0000 50.0000 1.8634 0.5757 1.0000
50.0000 2.5000 0.0000 50.0000 3.2592 0.3350 1.0000
60.2574 -34.0099 36.2677 60.4626 -34.1751 39.4387 1.2644
63.0109 -31.0961 -5.8663 62.8187 -29.7946 -4.0864 1.2630
61.2901 3.7196 -5.3901 61.4292 2.2480 -4.9620 1.8731
35.0831 -44.1164 3.7933 35.0232 -40.0716 1.5901 1.8645
22.7233 20.0904 -46.6940 23.0331 14.9730 -42.5619 2.0373
36.4612 47.8580 18.3852 36.2715 50.5065 21.2231 1.4146
90.8027 -2.0831 1.4410 91.1528 -1.6435 0.0447 1.4441
90.9257 -0.5406 -0.9208 88.6381 -0.8985 -0.7239 1.5381
6.7747 -0.2908 -2.4247 5.8714 -0.0985 -2.2286 0.6377
2.0776 0.0795 -1.1350 0.9033 -0.0636 -0.5514 0.9082
"""


def test_the_colour_difference_is_the_published_one():
    table = np.array([line.split() for line in PUBLISHED.split("\n") if line], dtype=float)
    assert len(table) == 34
    found = [ciede2000(row[:3], row[3:6]) for row in table]
    np.testing.assert_allclose(found, table[:, 6], rtol=0.0, atol=5.1e-5)


def test_lab_of_known_colours():
    """White is the white point; the primaries of sRGB under D65 (Lindbloom)."""
    found = lab(linear([[1.0, 1.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
    expected = [[100, 0, 0], [53.24, 80.09, 67.20], [87.73, -86.18, 83.18], [32.30, 79.19, -107.86]]
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=0.02)


def test_simulations_leave_greys_as_they_are():
    for who in SIMULATIONS:
        np.testing.assert_allclose(seen_by([0.3, 0.3, 0.3], who), linear([0.3] * 3), rtol=1e-5)


@pytest.mark.parametrize(
    ("who", "least"), [("trichromat", 12.0), ("protanope", 11.0), ("deuteranope", 12.0), ("grey", 6.0)]
)
def test_classes_that_can_meet_look_different(who, least):
    colours = {label: colour for label, colour in COLOURS.items() if label != "stuck or unresolved"}
    apart = {(a, b): difference(colours[a], colours[b], who) for a, b in combinations(colours, 2)}
    worst = min(apart, key=apart.get)
    assert apart[worst] > least, worst


@pytest.mark.parametrize(
    ("who", "least"), [("trichromat", 10.0), ("protanope", 8.0), ("deuteranope", 7.0), ("grey", 5.0)]
)
def test_classes_of_two_contacts_look_different(who, least):
    colours = [to_rgb(colour) for colour in (*palette.PAIRS, palette.UNRESOLVED_PAIR)]
    assert min(difference(a, b, who) for a, b in combinations(colours, 2)) > least


@pytest.mark.parametrize(
    ("who", "least"), [("trichromat", 12.0), ("protanope", 11.0), ("deuteranope", 12.0), ("grey", 6.0)]
)
def test_motions_on_a_belt_look_different_from_one_another_and_from_numbers_of_stops(who, least):
    own = [look.colour for look in palette.NO_LOAD.values()]
    assert min(difference(to_rgb(a), to_rgb(b), who) for a, b in combinations(own, 2)) > least
    without_stops = palette.NO_LOAD[regimes.CYCLE_WITHOUT_STOPS].colour
    assert without_stops not in [look.colour for look in palette.CLASSES]


@pytest.mark.parametrize(
    ("who", "least"), [("trichromat", 12.0), ("protanope", 8.0), ("deuteranope", 8.0), ("grey", 6.0)]
)
def test_contacts_look_different_from_one_another(who, least):
    pairs = combinations(palette.CONTACTS, 2)
    assert min(difference(to_rgb(a), to_rgb(b), who) for a, b in pairs) > least


@pytest.mark.parametrize(("who", "least"), [("trichromat", 20.0), ("protanope", 14.0), ("deuteranope", 14.0)])
def test_measured_samples_look_like_no_class_and_no_line(who, least):
    others = [look.colour for look in (*palette.CLASSES, *palette.NO_LOAD.values())]
    apart = [difference(to_rgb(palette.MEASURED), to_rgb(other), who) for other in (*others, *palette.LINES)]
    assert min(apart) > least


def test_no_contact_looks_like_a_mass():
    pairs = product(palette.CONTACTS, palette.LINES)
    assert min(difference(to_rgb(a), to_rgb(b), "trichromat") for a, b in pairs) > 15.0


def test_lines_of_masses_and_contacts_have_colours_of_their_own():
    frame = fm.System(
        mass_ratios=[1.0, 1.0],
        stiffness_ratios=[1.0, 1.0],
        contacts=[fm.Contact("fixed-wall", 1), fm.Contact("between-masses", (1, 2))],
    )
    z, stuck, masses = fm.plot_response(fm.response(frame, 0.7, 0.2))[1:4]
    of_contacts, of_masses = ({line.get_color() for line in ax.lines} for ax in (z, masses))
    assert stuck.get_ylabel() == "stuck"
    assert set(palette.CONTACTS[:2]) <= of_contacts
    assert set(palette.LINES[:2]) <= of_masses
    assert not set(palette.CONTACTS) & of_masses
    assert not set(palette.LINES[:2]) & of_contacts


def lightness(label):
    return float(lab(linear(COLOURS[label]))[0])


def test_lightness_falls_with_the_number_of_stops():
    ordered = LABELS[palette.CONTINUOUS : palette.MORE + 1]
    assert ordered == ["continuous", "1 stop", "2 stops", "3 stops", "4 stops", "more stops"]
    assert np.all(np.diff([lightness(label) for label in ordered]) < -10.0)


def test_every_class_has_its_own_lightness():
    found = sorted(lightness(label) for label in LABELS[: palette.NO_STOPS])
    assert min(np.diff(found)) > 6.0


def test_the_colour_table_is_the_palette():
    table = palette.colour_table()
    assert table.shape == (palette.COUNT + 1, 4)
    np.testing.assert_allclose(table[: len(LABELS), :3] / 255.0, list(COLOURS.values()), atol=1e-12)
    assert (table[: len(LABELS), 3] == 255).all()
    assert (table[len(LABELS) :, 3] == 0).all()  # not computed yet, no cell


# Classes and their counts


def one_mu(regime=None, stops=None):
    """A map of one frequency."""
    given = {"regime": regime, "stops_per_cycle": stops}
    cells = {
        name: (("r", "beta"), np.array([values])) for name, values in given.items() if values is not None
    }
    return xr.Dataset(cells)


def labels(ds):
    found = classes.classes(ds)
    assert found.shape == (ds.sizes["r"], ds.sizes["beta"])
    return [LABELS[index] for index in found[0]]


def test_classes_of_whole_numbers_of_stops():
    stops = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 1000.0]
    expected = ["1 stop", "2 stops", "3 stops", "4 stops", "more stops", "more stops", "more stops"]
    assert labels(one_mu([regimes.STICK_SLIP] * 7, stops)) == expected
    assert labels(one_mu(stops=stops)) == expected


def test_classes_of_fractions_of_stops():
    stops = np.array([0.25, 0.5, 1.5, 7 / 3, 100.02], dtype=np.float32)
    expected = ["non-integer stops per cycle"] * 5
    assert labels(one_mu([regimes.STICK_SLIP] * 5, stops)) == expected
    assert labels(one_mu(stops=stops)) == expected


def test_the_regime_decides_before_the_stops():
    regime = [regimes.UNRESOLVED, regimes.PERMANENT_STICKING, regimes.STICK_SLIP, regimes.CONTINUOUS]
    expected = ["unresolved", "permanent sticking", "stick-slip, stops not counted", "continuous"]
    assert labels(one_mu(regime, [np.nan, np.nan, np.nan, 0.0])) == expected
    assert labels(one_mu(regime)) == expected


def test_stops_alone_do_not_distinguish_stuck_from_unresolved():
    assert labels(one_mu(stops=[0.0, np.nan])) == ["continuous", "stuck or unresolved"]


def test_classes_and_counts_do_not_depend_on_how_much_is_looked_at_at_once(monkeypatch):
    rng = np.random.default_rng(3)
    regime = rng.integers(-1, 3, (50, 40)).astype(np.int8)
    stops = np.where(regime == 1, rng.integers(1, 9, regime.shape) / 2.0, 0.0).astype(np.float32)
    ds = xr.Dataset({"regime": (("r", "beta"), regime), "stops_per_cycle": (("r", "beta"), stops)})
    found = classes.classes(ds)
    counts = classes.count(found)
    monkeypatch.setattr(classes, "_AT_ONCE", 64)
    np.testing.assert_array_equal(classes.classes(ds), found)
    np.testing.assert_array_equal(classes.count(found), counts)
    np.testing.assert_array_equal(counts, [(found == index).sum() for index in range(palette.COUNT)])
    inside = stops[found == palette.NON_INTEGER]
    assert classes.stops_range(found, stops, palette.NON_INTEGER) == (inside.min(), inside.max())
    assert classes.stops_range(found, stops, palette.NO_STOPS) == (np.inf, -np.inf)


def test_legends_state_the_number_of_cells():
    assert classes.legend_label(palette.STUCK, 12345, np.inf, -np.inf) == "permanent sticking (12,345)"
    assert classes.legend_label(palette.MORE, 3, 5.0, 12.0) == "5 to 12 stops (3)"
    assert classes.legend_label(palette.MORE, 1, 7.0, 7.0) == "7 stops (1)"
    assert classes.legend_label(palette.NON_INTEGER, 2, 2 / 3, 1.5) == "non-integer, 0.6667 to 1.5 stops (2)"


# Grids


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        (np.linspace(0.1, 2.0, 30), False),
        (np.geomspace(0.1, 2.0, 30), True),
        (np.geomspace(1.0, 1.001, 30), False),  # as even either way
        ([0.01, 0.0316, 0.1, 0.316, 1.0], True),  # rounded
        ([0.0, 0.1, 1.0], False),
        ([0.1, 1.0], False),
        ([1.0, 2.0, 5.0, 10.0], False),
        ([0.5], False),
    ],
)
def test_logarithmic_grids_are_known(values, expected):
    assert grids.Grid(np.array(values)).logarithmic is expected


def test_edges_lie_half_way_as_the_axis_is_drawn():
    np.testing.assert_allclose(grids.Grid(np.array([0.0, 1.0, 3.0])).edges, [-0.5, 0.5, 2.0, 4.0])
    edges = grids.Grid(np.array([1.0, 10.0, 100.0])).edges
    np.testing.assert_allclose(edges, 10.0 ** np.array([-0.5, 0.5, 1.5, 2.5]))
    np.testing.assert_array_equal(grids.Grid(np.array([0.5])).edges, [0.25, 0.75])
    np.testing.assert_array_equal(grids.Grid(np.array([0.0])).edges, [-0.5, 0.5])


@pytest.mark.parametrize("values", [np.linspace(0.5, 3.0, 6), np.geomspace(0.01, 10.0, 7), np.array([2.0])])
def test_shares_of_an_axis(values):
    grid = grids.Grid(values)
    np.testing.assert_allclose(grid.share(np.array(grid.limits)), [0.0, 1.0], atol=1e-12)
    for share in (0.0, 0.3, 1.0):
        assert grid.share(np.array([grid.at(share)]))[0] == pytest.approx(share)
    if grid.logarithmic:
        assert grid.share(np.array([0.0]))[0] == -np.inf


# Cells to pixels


def even(cells, pixels):
    """Edges of equal cells that fill a picture."""
    return np.linspace(0.0, pixels, cells + 1)


def rasterise(found, pixels, x_edges=None, y_edges=None, most=4):
    found = np.asarray(found, dtype=np.uint8)
    x_edges = even(found.shape[0], pixels[0]) if x_edges is None else x_edges
    y_edges = even(found.shape[1], pixels[1]) if y_edges is None else y_edges
    return raster.rasterise(found, np.asarray(x_edges), np.asarray(y_edges), pixels, most)


def test_a_cell_of_many_pixels_fills_them():
    found = np.array([[0, 1, 2], [3, 0, 1]])
    np.testing.assert_array_equal(rasterise(found, (20, 30)), found.repeat(10, axis=0).repeat(10, axis=1))


def test_one_pixel_a_cell_is_the_map_itself():
    found = np.random.default_rng(1).integers(0, 4, (37, 23))
    np.testing.assert_array_equal(rasterise(found, (37, 23)), found)


def test_a_pixel_shows_the_commonest_of_its_cells():
    found = np.zeros((100, 100), dtype=np.uint8)
    found[:56] = 1  # six of the ten cells of the sixth pixel
    found[:, 74:] = 2  # six of ten again
    expected = np.zeros((10, 10))
    expected[:6] = 1
    expected[:, 7:] = 2
    np.testing.assert_array_equal(rasterise(found, (10, 10)), expected)


@pytest.mark.parametrize("row", [0, 1, 777, 2000, 4094, 4095])
def test_a_strip_one_cell_wide_is_kept_whole(row):
    found = np.zeros((4096, 300), dtype=np.uint8)
    found[row] = 1
    shown = rasterise(found, (640, 100))
    assert (shown == 1).sum() == 100
    assert (shown[row * 640 // 4096] == 1).all()


def test_single_cells_are_kept_wherever_they_lie():
    rng = np.random.default_rng(5)
    found = np.zeros((1000, 900), dtype=np.uint8)
    cells = rng.integers(0, [1000, 900], (40, 2))
    found[tuple(cells.T)] = 1 + rng.integers(0, 3, 40)
    shown = rasterise(found, (100, 90))
    for i, j in cells:
        near = shown[max(0, i // 10 - 1) : i // 10 + 2, max(0, j // 10 - 1) : j // 10 + 2]
        assert found[i, j] in near


def test_the_rarest_class_keeps_its_pixel():
    found = np.zeros((100, 100), dtype=np.uint8)
    found[44:47, 44] = 1
    found[45, 45] = 2
    assert rasterise(found, (10, 10))[4, 4] == 2


def test_nothing_is_invented_and_nothing_of_size_lost():
    """Borders stay where they are: shares of the areas within a pixel's width of their lengths."""
    i, j = np.mgrid[:1200, :900]
    found = (np.hypot(i - 600, j - 450) < 300).astype(np.uint8)
    shown = rasterise(found, (120, 90))
    assert abs((shown == 1).mean() - found.mean()) < 0.01
    assert set(np.unique(shown)) == {0, 1}


def test_the_raster_does_not_depend_on_how_much_is_looked_at_at_once(monkeypatch):
    found = np.random.default_rng(7).integers(0, 4, (500, 300)).astype(np.uint8)
    expected = rasterise(found, (61, 47))
    monkeypatch.setattr(classes, "_AT_ONCE", 1000)
    np.testing.assert_array_equal(rasterise(found, (61, 47)), expected)


def test_grids_that_are_not_even():
    """Many narrow cells and a wide one: the wide one fills its pixels, the narrow ones share theirs."""
    edges = np.concatenate((np.linspace(0.0, 2.0, 101), [10.0]))
    found = np.zeros((101, 1), dtype=np.uint8)
    found[:60] = 1
    found[100] = 2
    shown = rasterise(found, (10, 1), x_edges=edges)[:, 0]
    np.testing.assert_array_equal(shown, [1, 0] + [2] * 8)


def test_a_part_of_a_map_and_what_lies_outside_it():
    found = np.array([[0], [1], [2]])
    shown = rasterise(found, (8, 1), x_edges=[-6.0, 2.0, 4.0, 6.0])[:, 0]
    np.testing.assert_array_equal(shown, [0, 0, 1, 1, 2, 2, 4, 4])
    assert (rasterise(found, (8, 1), x_edges=[20.0, 22.0, 24.0, 26.0]) == 4).all()


def test_pictures_are_painted_by_the_table():
    table = np.arange(20, dtype=np.uint8).reshape(5, 4)
    image = raster.paint(np.array([[0, 1, 4], [2, 3, 0]], dtype=np.uint8), table)
    assert image.shape == (3, 2, 4)
    np.testing.assert_array_equal(image[0, 1], table[2])  # the first row is the lowest
    np.testing.assert_array_equal(image[2, 0], table[4])


def test_stripes_rise_to_the_right():
    dark = raster.stripes((60, 40), 14.0, 2.0)
    assert dark.shape == (60, 40)
    np.testing.assert_allclose(dark[:-1, :-1], dark[1:, 1:], atol=1e-9)
    assert dark.mean() == pytest.approx(2.0 / 14.0, rel=0.1)
    image = np.full((40, 60, 4), 200, dtype=np.uint8)
    raster.shade(image, dark, (0, 0, 0))
    assert image[..., :3].min() == 0
    assert (image[..., 3] == 200).all()


# Marks


def test_a_curve_leaves_a_trace_without_gaps():
    x = np.linspace(0.0, 1.0, 30)
    passed = marks.trace(x, x**2)
    assert passed.any(axis=1).all()
    for column in range(1, marks.COARSE):
        both = np.flatnonzero(passed[column - 1 : column + 1].any(axis=0))
        assert (np.diff(both) == 1).all()
    assert not marks.trace(x, np.full(30, np.inf)).any()
    assert not marks.trace(x, np.full(30, np.nan)).any()


def test_names_are_placed_where_there_is_room():
    free = np.zeros((marks.COARSE, marks.COARSE), dtype=bool)
    assert marks.room_for(free, "stuck", (4.0, 3.0)) is None
    free[60:, 30:90] = True
    x, y = marks.room_for(free, "stuck", (4.0, 3.0))
    assert 0.6 < x < 0.9
    assert 0.3 < y < 0.7
    assert marks.room_for(free, "a name much longer than the region is wide", (4.0, 3.0)) is None
    assert marks.room_for(free, "stuck", (0.4, 3.0)) is None


def test_rare_classes():
    np.testing.assert_array_equal(marks.rare_classes(np.array([0, 10**6, 3, 999, 10**5])), [2, 3])


def test_rings_are_drawn_around_small_patches_only():
    """A single cell, two cells beside each other, a short strip; a long one is seen without rings."""
    strip = np.column_stack((np.linspace(0.0, 1.0, 200), np.full(200, 0.9)))
    cells = np.concatenate(([[0.1, 0.1]], [[0.5, 0.5], [0.502, 0.5]], strip))
    found = marks.rings(*cells.T)
    np.testing.assert_allclose(found[np.argsort(found[:, 0])], [[0.1, 0.1], [0.501, 0.5]], atol=1e-12)
    short = marks.rings(np.linspace(0.2, 0.32, 30), np.full(30, 0.01))
    assert 4 <= len(short) <= 8
    assert marks.rings(np.array([1.5]), np.array([0.5])).shape == (0, 2)


@pytest.mark.parametrize(
    "places", [[0.5], [0.1, 0.5, 0.9], [0.5] * 5, [0.0, 0.0, 0.01], [1.0, 0.99, 1.0], [0.4, 0.5, 0.45], []]
)
def test_labels_lie_apart_and_inside(places):
    found = marks.spread(np.array(places), 0.1)
    assert found.size == len(places)
    ordered = np.sort(found)
    assert (np.diff(ordered) > 0.1 - 1e-9).all()
    assert ((ordered >= -1e-12) & (ordered <= 1.0 + 1e-12)).all()
    assert (np.diff(found[np.argsort(places, kind="stable")]) > 0.0).all()


def test_labels_that_have_room_stay_where_they_are():
    np.testing.assert_array_equal(marks.spread(np.array([0.8, 0.2, 0.5]), 0.1), [0.8, 0.2, 0.5])
    np.testing.assert_allclose(marks.spread(np.array([0.5, 0.52]), 0.1), [0.46, 0.56])


def test_marks_that_would_overlap_are_left_out_from_below():
    np.testing.assert_array_equal(
        features.apart(np.array([0.0, 0.001, 0.1, 0.105, 0.5])), [False, True, False, True, True]
    )


# Words


def test_titles_break_into_lines_of_like_length():
    text = "Two masses, contact on mass 2, load on mass 1, modal damping 0.1/w_i (thesis Fig. 7.7)"
    assert words.balanced(text, 200) == text
    lines = words.balanced(text, 60).split("\n")
    assert len(lines) == 2
    assert abs(len(lines[0]) - len(lines[1])) < 12
    assert " ".join(lines) == text
    assert max(len(line) for line in words.balanced("x" * 130, 60).split("\n")) <= 60
    assert words.balanced("", 60) == ""


def test_repeated_ratios_are_abbreviated():
    system = "chain of 4 masses (1, 1, 1, 1), springs (1, 1, 1.5, 1); load (0, 0, 0.5, 0.5, 0.5)"
    told = words.system_words(xr.Dataset(attrs={"system": system}))
    assert told == "chain of 4 masses (4 × 1), springs (1, 1, 1.5, 1); load (0, 0, 3 × 0.5)"


EXCITATIONS = [
    ({}, "force", "load / $P$"),
    ({"excitation": "base"}, "base", "base / $Y$"),
    ({"contact": "joined-base-wall"}, "base", "base / $Y$"),
    ({"mass_ratios": (1.0, 2.0), "stiffness_ratios": (1.0, 1.0), "load": (1.0, 0.5j)}, "forces", None),
]


@pytest.mark.parametrize(("system", "excitation", "label"), EXCITATIONS)
def test_the_load_is_read_from_an_attribute_and_in_older_files_from_the_configuration(
    system, excitation, label
):
    ds = fm.sweep(fm.System(**system), [0.3], [2.0])
    assert ds.attrs["excitation"] == excitation
    assert words.load_of(ds) == label
    assert words.moves_base(ds) is (excitation == "base")
    ds.attrs["system"] = "a system of base motion and of a harmonic load (in other words)"
    assert words.load_of(ds) == label
    del ds.attrs["excitation"]
    assert words.load_of(ds) == label
    assert words.moves_base(ds) is (excitation == "base")


def test_a_file_without_its_load_is_labelled_as_loaded_by_a_force():
    ds = xr.Dataset(attrs={"system": "base motion"})
    assert words.load_of(ds) == "load / $P$"
    assert not words.moves_base(ds)


@pytest.mark.parametrize("kept", [("system", "config"), ("system",), ()])
def test_files_without_the_attribute_are_drawn(kept):
    ds = fm.response(fm.System(excitation="base"), 0.6, 0.4)
    ds.attrs = {name: ds.attrs[name] for name in kept}
    axes = fm.plot_response(ds)
    labels = {ax.get_ylabel() for ax in axes.flat}
    assert any("base / $Y$" in label or "Y" in label for label in labels) is ("config" in kept), labels
