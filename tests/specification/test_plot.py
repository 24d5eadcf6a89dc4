"""Pictures: made for every kind of file, true to it, with nothing cut off or covered."""

import os
import re
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from layouts import assert_inside_and_apart, drawn
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from outputs import OF_ONE_CONTACT

import frictionmap as fm
from frictionmap import InputError, plot, regimes
from frictionmap.files.reading import read
from frictionmap.files.storage import write
from frictionmap.pictures.classes import classes
from frictionmap.pictures.maps.boundary_map import areas
from frictionmap.pictures.maps.raster import rasterise
from frictionmap.pictures.maps.regime_map import RegimeImage
from frictionmap.pictures.palette import CLASSES, MORE, ONE, colour_table

MAGIC = {".png": b"\x89PNG\r\n\x1a\n", ".pdf": b"%PDF-", ".svg": b"<?xml"}


@pytest.fixture(scope="module")
def tiny_map():
    """Both regimes of sliding, sticking, r = 0; two mu."""
    r, beta = np.linspace(0.0, 2.0, 9), np.linspace(0.0, 1.25, 11)
    return fm.sweep(fm.System(), r, beta, [1.0, 1.5], outputs=OF_ONE_CONTACT)


@pytest.fixture(scope="module")
def tiny_boundaries():
    return fm.boundaries(fm.System(contact="joined-base-wall"), np.linspace(0.0, 2.0, 41), [1.0, 1.5, 2.0])


@pytest.fixture(scope="module")
def tiny_response():
    return fm.response(fm.System(contact="joined-base-wall"), 0.3, 0.05)


# Files


@pytest.mark.parametrize("kind", ["map", "boundaries", "response"])
@pytest.mark.parametrize("ending", plot.FORMATS)
def test_pictures_of_every_kind_in_every_format(request, tmp_path, kind, ending):
    path = tmp_path / f"picture{ending}"
    plot.save_picture(request.getfixturevalue(f"tiny_{kind}"), path)
    content = path.read_bytes()
    assert content.startswith(MAGIC[ending])
    assert len(content) > 5000
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]


def test_the_ending_may_be_in_capitals(tmp_path, tiny_response):
    plot.save_picture(tiny_response, tmp_path / "picture.PNG")
    assert (tmp_path / "picture.PNG").read_bytes().startswith(MAGIC[".png"])


@pytest.mark.parametrize("name", ["picture", "picture.jpg", "picture.png.nc"])
def test_wrong_ending(name):
    with pytest.raises(
        InputError, match=rf"^-o must end in \.png, \.pdf, \.svg, \.gif, \.mp4; got .*{name}$"
    ):
        plot.check_picture(Path(name))


# Axes, legends, texts


def test_given_axes_are_drawn_into_and_returned(tiny_map):
    figure = Figure()
    ax = figure.subplots()
    assert fm.plot_regimes(tiny_map.sel(mu=1.0), ax=ax) is ax
    assert ax.get_xlim() == (0.0, 2.0)
    assert ax.get_ylim() == (0.0, 1.25)
    assert "1" in ax.get_title()
    assert "permanent sticking (27)" in [text.get_text() for text in ax.get_legend().get_texts()]
    drawn(figure)
    assert fm.plot_regimes(tiny_map.isel(mu=[1]), ax=figure.add_subplot()) is figure.axes[-1]


def test_several_mu_do_not_fit_into_given_axes(tiny_map):
    with pytest.raises(InputError, match=r"^ax must be 2 axes, one for each mu; got 1$"):
        fm.plot_regimes(tiny_map, ax=Figure().subplots())
    with pytest.raises(InputError, match=r"^ax must be matplotlib axes, or an array of them; got Figure$"):
        fm.plot_regimes(tiny_map.isel(mu=[0]), ax=Figure())
    with pytest.raises(InputError, match=r"^ax must be matplotlib axes, or an array of them; got Dataset$"):
        fm.plot_regimes(tiny_map.isel(mu=[0]), ax=tiny_map)


def test_a_map_without_regime_and_stops(tiny_map):
    with pytest.raises(InputError, match=r"^a map must hold regime or stops_per_cycle .* neither$"):
        fm.plot_regimes(tiny_map[["contact_amplitude"]])


def test_several_answers_are_hatched():
    """Cells that other starts end differently in: hatched, and in the legend; nothing where none are."""
    r, beta = np.linspace(0.2, 1.2, 6), np.linspace(0.5, 0.9, 5)
    ds = fm.sweep(fm.System(), r, beta, [1.0, 1.5], outputs=["regime", "also_reachable"])
    for mu, expected in ((1.0, False), (1.5, True)):
        for part in (ds, ds.isel(r=[3]), ds.isel(beta=[2])):
            ax = Figure().subplots()
            fm.plot_regimes(part.sel(mu=mu), ax=ax)
            words = [text.get_text() for text in ax.get_legend().get_texts()]
            assert ("several regimes: the initial state decides" in words) == expected
            drawn(ax.figure)


@pytest.mark.parametrize("outputs", [["regime"], ["stops_per_cycle"], ["regime", "stops_per_cycle"]])
def test_either_output_will_do(tiny_map, outputs):
    axes = fm.plot_regimes(tiny_map[[*outputs, "beta_lim", "beta_stick"]])
    assert len(axes) == 2
    drawn(axes[0].figure)


@pytest.mark.parametrize("panels", [1, 2, 3, 5])
def test_a_panel_for_each_mu(panels):
    mu = np.linspace(1.0, 2.0, panels)
    axes = fm.plot_regimes(fm.sweep(fm.System(), [0.5, 1.5], [0.1, 0.5, 1.5], mu))
    assert len(axes) == len(axes[0].figure.axes) == panels
    assert [ax.get_title() for ax in axes] == [rf"$\mu$ = {value:g}" for value in mu]
    drawn(axes[0].figure)


def test_too_many_panels():
    ds = fm.boundaries(fm.System(), [0.5, 1.5], np.linspace(1.0, 2.0, 61))
    with pytest.raises(InputError, match=r"at most 60 mu to be drawn; got 61: .*ds\.sel\(mu=\.\.\.\)"):
        plot.plot_boundaries(ds)


TITLE = r"A long title, with $x_{ and 5 $ and \frac in it, which does not fit in a line: " + "and so on " * 12


@pytest.mark.parametrize("title", ["", "Short", TITLE])
@pytest.mark.parametrize("panels", [1, 2])
def test_nothing_overlaps_with_every_class_in_the_legend(title, panels):
    stops = np.array([[[1, 2, 3, 4, 5, 1.5, np.nan, np.nan, np.nan, 0]]] * panels)
    regime = np.array([[[1, 1, 1, 1, 1, 1, 1, -1, 0, 2]]] * panels, dtype=np.int8)
    cells = {"regime": (("mu", "r", "beta"), regime), "stops_per_cycle": (("mu", "r", "beta"), stops)}
    axes = {"mu": np.arange(1.0, panels + 1.0), "r": [0.5], "beta": np.arange(10.0)}
    (figure,) = {ax.figure for ax in fm.plot_regimes(xr.Dataset(cells, axes, {"title": title}))}
    assert len(figure.legends[0].get_texts()) == 10
    assert_inside_and_apart(figure)


def test_nothing_overlaps_in_the_other_pictures(tiny_boundaries, tiny_response):
    assert_inside_and_apart(plot.plot_boundaries(tiny_boundaries)[0].figure)
    for ds in (tiny_response, fm.response(fm.System(), 0.3, 2.0), fm.response(fm.System(), 2.0, 0.1)):
        assert_inside_and_apart(plot.plot_response(ds)[0].figure)


@pytest.mark.parametrize("contact", ["fixed-wall", "joined-base-wall"])
def test_names_of_regions_lie_in_their_regions(contact):
    r, beta = np.linspace(0.0, 2.5, 60), np.linspace(0.0, 2.0, 50)
    ds = fm.sweep(fm.System(contact=contact), r, beta)
    (ax,) = fm.plot_regimes(ds)
    assert {text.get_text() for text in ax.texts} == {"permanent sticking", "continuous"}
    for text in ax.texts:
        name = text.get_text().replace(" ", "_")
        code = next(code.value for code in regimes.REGIMES if code.name == name)
        drawn(ax.figure)
        box = text.get_window_extent().transformed(ax.transData.inverted())
        inside = ds.sel(mu=1.0, r=slice(box.x0, box.x1), beta=slice(box.y0, box.y1)).regime
        assert inside.size > 4
        assert (inside == code).all()


@pytest.mark.parametrize("level", [0.3, 0.5, 0.75])
def test_names_of_regions_lie_off_the_curves(level):
    """A curve that runs through one region, as beta_lim does for mu > 1."""
    r = np.linspace(0.1, 2.0, 50)
    cells = {"regime": (("r", "beta"), np.full((50, 40), regimes.CONTINUOUS, dtype=np.int8))}
    lim = level + 0.1 * np.sin(6.0 * r)
    axes = {"r": r, "beta": np.linspace(0.0, 1.0, 40), "mu": 2.0}
    (ax,) = fm.plot_regimes(xr.Dataset(cells | {"beta_lim": ("r", lim)}, axes))
    (text,) = ax.texts
    drawn(ax.figure)
    box = text.get_window_extent()
    curve = ax.transData.transform(np.column_stack((r, lim)))
    fine = np.column_stack([np.interp(np.linspace(0, 49, 5000), np.arange(50), part) for part in curve.T])
    assert not any(box.contains(x, y) for x, y in fine)
    frame = ax.get_window_extent()
    assert frame.x0 < box.x0 < box.x1 < frame.x1
    assert frame.y0 < box.y0 < box.y1 < frame.y1


def test_the_name_of_a_region_with_room_for_one_name_only():
    regime = np.full((120, 120), regimes.STICK_SLIP)
    regime[90:113, 100:112] = regimes.CONTINUOUS
    axes = {"r": np.arange(120.0), "beta": np.arange(120.0), "mu": 1.0}
    (ax,) = fm.plot_regimes(xr.Dataset({"regime": (("r", "beta"), regime)}, axes))
    (text,) = ax.texts
    np.testing.assert_allclose(text.get_position(), (101.0 / 119.0, 105.5 / 119.0), atol=0.02)


def test_small_regions_have_no_names():
    ds = fm.sweep(fm.System(), np.linspace(1.0, 1.5, 20), np.linspace(0.7, 1.0, 20))
    assert (ds.regime == regimes.PERMANENT_STICKING).any()  # the uppermost row
    (ax,) = fm.plot_regimes(ds)
    assert [text.get_text() for text in ax.texts] == ["continuous"]


@pytest.mark.parametrize(("r", "beta"), [([0.5], [0.25]), ([0.0], [0.0, 1.0]), ([0.5, 1.0], [0.0])])
def test_maps_of_one_row_or_one_cell(r, beta):
    (ax,) = fm.plot_regimes(fm.sweep(fm.System(), r, beta))
    for limits, values in ((ax.get_xlim(), r), (ax.get_ylim(), beta)):
        assert limits[0] <= values[0]
        assert limits[1] >= values[-1]
        assert limits[1] > limits[0]
    drawn(ax.figure)


def test_boundaries_of_one_frequency():
    (ax,) = plot.plot_boundaries(fm.boundaries(fm.System(), [0.5]))
    assert all(np.ptp(line.get_xdata()) > 0.0 for line in ax.lines)
    drawn(ax.figure)


def test_a_separate_lower_bound_is_drawn(tiny_boundaries):
    assert not any("lower bound" in word for word in words_of(fm.plot_boundaries(tiny_boundaries)))
    lower = tiny_boundaries.assign(beta_lim_modal=0.9 * tiny_boundaries.beta_lim)
    assert any("lower bound" in word for word in words_of(fm.plot_boundaries(lower)))


def test_infinite_boundaries_do_not_spoil_the_scale(tiny_boundaries):
    ds = tiny_boundaries.copy(deep=True)
    ds.beta_stick[:, 20] = np.inf
    axes = fm.plot_boundaries(ds)
    assert all(ax.get_ylim()[1] < 10.0 for ax in axes)
    drawn(axes[0].figure)


def test_boundaries_have_one_axis_of_beta(tiny_boundaries):
    limits = {ax.get_ylim() for ax in fm.plot_boundaries(tiny_boundaries)}
    assert len(limits) == 1
    low, high = limits.pop()
    assert low == 0.0
    assert high > tiny_boundaries.beta_lim.max()


POSSIBLE = {  # regimes that a cell may have in an area: stick-slip besides, if mu > 1
    "continuous": regimes.CONTINUOUS,
    "sticking": regimes.PERMANENT_STICKING,
    "neither": regimes.STICK_SLIP,
}


@pytest.mark.parametrize("mu", [1.0, 1.5, 2.0])
@pytest.mark.parametrize("start", ["rest", "moving"])
@pytest.mark.parametrize("contact", ["fixed-wall", "joined-base-wall"])
def test_fills_of_boundaries_are_true(contact, start, mu):
    """Every cell of a map has a regime that the fill below it calls possible."""
    r, beta = np.linspace(0.11, 2.4, 40), np.linspace(0.003, 1.6, 50)
    ds = fm.sweep(fm.System(contact=contact), r, beta, mu, start=start, outputs=["regime"]).isel(mu=0)
    bounds = areas(ds.beta_lim.values, ds.beta_stick.values, 10.0)._asdict()
    fills = {
        name: (beta > low[:, np.newaxis]) & (beta < high[:, np.newaxis])
        for name, (low, high) in bounds.items()
    }
    assert (sum(fill.astype(int) for fill in fills.values()) == 1).all()  # one fill for each cell
    seen = ds.regime.values
    for fill in fills.values():
        fill[seen == regimes.UNRESOLVED] = False
    besides = regimes.STICK_SLIP if mu > 1.0 else None
    for name, regime in POSSIBLE.items():
        assert set(np.unique(seen[fills[name]])) <= {regime, besides}, name
    assert set(np.unique(seen[fills["both"]])) <= {POSSIBLE["continuous"], POSSIBLE["sticking"], besides}
    assert fills["both"].any() == (mu > 1.0)
    assert all(fills[name].any() for name in POSSIBLE)


def test_legends_of_boundaries_state_what_is_certain_and_what_is_possible(tiny_boundaries):
    certain = words_of(fm.plot_boundaries(tiny_boundaries.sel(mu=[1.0])))
    assert certain[:3] == ["continuous", "stick-slip", "permanent sticking"]
    possible = words_of(fm.plot_boundaries(tiny_boundaries))
    assert possible[:3] == ["continuous motion possible", "stick-slip", "sticking possible"]
    assert "continuous or stuck: the initial state decides" in possible


def test_boundaries_are_drawn_from_a_map_too(tiny_map):
    (axes, other) = (fm.plot_boundaries(ds) for ds in (tiny_map, tiny_map[["beta_lim", "beta_stick"]]))
    np.testing.assert_array_equal(axes[1].lines[0].get_ydata(), tiny_map.beta_lim[1])
    np.testing.assert_array_equal(other[1].lines[1].get_ydata(), tiny_map.beta_stick[1])
    with pytest.raises(InputError, match=r"^a dataset must hold beta_stick for its boundaries"):
        fm.plot_boundaries(tiny_map[["regime", "beta_lim"]])


def test_features_are_marked_on_the_axis(tiny_boundaries):
    (ax, *_) = fm.plot_boundaries(tiny_boundaries)
    marks = {line.get_label(): line for line in ax.lines if line.get_linestyle() == "None"}
    np.testing.assert_array_equal(marks["natural frequency"].get_xdata(), [1.0])
    (name,) = (name for name in marks if name.startswith("invariant point"))
    assert set(marks[name].get_xdata()) <= set(tiny_boundaries.invariant_point.values)
    assert set(marks["natural frequency"].get_ydata()) == {1.0}


# Boundaries over maps


@pytest.fixture(scope="module")
def two_masses():
    """T Fig. 6.7 on a coarse grid; its held structure resonates at r = 1."""
    return fm.System(mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0], contact_masses=[2])


def curves_of(ds):
    """The boundaries that the picture of a map has: their data, by the name of the variable."""
    (ax,) = fm.plot_regimes(ds)
    names = {r"$\beta_\mathrm{lim}$": "beta_lim", r"$\beta_\mathrm{stick}$": "beta_stick"}
    drawn(ax.figure)
    return {names[str(line.get_label())]: line.get_data() for line in ax.lines if line.get_label() in names}


@pytest.mark.parametrize(
    "r", [np.linspace(0.0, 2.5, 26), np.geomspace(0.05, 2.5, 12)], ids=["linear", "logarithmic"]
)
def test_boundaries_over_a_map_are_as_fine_as_the_picture(two_masses, r):
    """Between the map's frequencies they are what `boundaries` says there, to a line's width."""
    top = 1.2
    curves = curves_of(fm.sweep(two_masses, r, np.linspace(0.0, top, 5), outputs=["regime"]))
    for name, (x, y) in curves.items():
        assert np.isfinite(y).all()
        assert set(r) <= set(x)
        assert np.diff(x)[x[1:] > 0.1].max() < 2.5 / 600
        between = np.random.default_rng(1).uniform(0.1, 2.5, 300)
        between.sort()
        exact = np.minimum(fm.boundaries(two_masses, between)[name].values[0], top)
        np.testing.assert_allclose(np.minimum(np.interp(between, x, y), top), exact, rtol=0, atol=0.004 * top)


def test_boundaries_over_a_map_reach_their_cusps_and_poles(two_masses):
    """beta_lim falls to 0 at odd parts of natural frequencies, T(2.26); beta_stick grows at the held one."""
    ds = fm.sweep(two_masses, np.linspace(0.0, 2.5, 26), np.linspace(0.0, 1.2, 5), outputs=["regime"])
    curves = curves_of(ds)
    natural = np.sqrt(0.5 * (3.0 + np.array([-1.0, 1.0]) * np.sqrt(5.0)))
    for part in (3, 5, 7):
        for w in natural:
            x, y = curves["beta_lim"]
            at = np.argmin(np.abs(x - w / part))
            assert abs(x[at] - w / part) < 1e-12
            assert y[at] < 1e-9
    x, y = curves["beta_stick"]
    assert y[np.argmin(np.abs(x - np.sqrt(2.0)))] > 100.0


def test_boundaries_in_the_file_are_drawn_where_no_system_explains_them(two_masses):
    """Without a configuration, and with one that they do not come from."""
    ds = fm.sweep(two_masses, np.linspace(0.0, 2.5, 26), np.linspace(0.0, 1.2, 5), outputs=["regime"])
    other = fm.sweep(fm.System(), [0.5], [0.5])
    for given in (ds.assign_attrs(config=""), ds.assign_attrs(config=other.attrs["config"])):
        for name, (x, y) in curves_of(given).items():
            np.testing.assert_array_equal(x, ds.r)
            stored = ds[name].values[0]
            np.testing.assert_array_equal(np.minimum(y, 1.2), np.minimum(stored, 1.2))


def test_boundaries_of_many_masses_cost_little_however_far_the_axis_reaches_down():
    """The search of S takes steps by w/r: beyond a bound only the map's own frequencies are drawn."""
    chain = fm.System(mass_ratios=[1.0] * 50, stiffness_ratios=[1.0] * 50, contact_masses=[3])
    r = np.geomspace(1e-4, 10.0, 6)
    (x, _) = curves_of(fm.sweep(chain, r, [0.0, 0.1], outputs=["regime"]))["beta_lim"]
    added = np.setdiff1d(x, r)
    assert (50 * chain.modes.w.max() / added).sum() < 1e6
    assert added.size > 1500


# Slices, and datasets the wrong way round


def raster_of(ax, size=(90, 70)):
    """The classes that a panel shows."""
    (image,) = (artist for artist in ax.get_children() if isinstance(artist, RegimeImage))
    x, y = (
        n * grid.share(grid.edges) for n, grid in zip(size, (image.cells.r, image.cells.beta), strict=True)
    )
    return rasterise(image.cells.found, x, y, size, len(CLASSES))


def test_a_transposed_map_is_drawn_as_it_is(tiny_map):
    (expected,) = fm.plot_regimes(tiny_map.isel(mu=[0]))
    for turned in (
        tiny_map.transpose("beta", "r", "mu", ...).isel(mu=[0]),
        tiny_map.isel(mu=0),
        tiny_map.isel(mu=[0], beta=slice(None, None, -1)),
        tiny_map.isel(mu=[0])[["regime", "stops_per_cycle"]],
    ):
        (ax,) = fm.plot_regimes(turned)
        np.testing.assert_array_equal(raster_of(ax), raster_of(expected))


def test_the_picture_shows_the_classes_of_the_cells(tiny_map):
    """Grid point by grid point: the pixel under it has the class of its cell."""
    panel = tiny_map.isel(mu=0)
    (ax,) = fm.plot_regimes(panel)
    expected = classes(panel)
    shown = raster_of(ax, (360, 400))
    for i in range(1, 8):
        for j in range(1, 10):
            assert shown[round(i / 8 * 360), round(j / 10 * 400)] == expected[i, j]


@pytest.mark.parametrize("chosen", [{"r": 2}, {"beta": 3}, {"r": 2, "beta": 3}, {"mu": 1, "r": 4}])
def test_slices_are_drawn(tiny_map, chosen):
    axes = fm.plot_regimes(tiny_map.isel(chosen))
    assert len(axes) == (1 if "mu" in chosen else 2)
    drawn(axes[0].figure)


@pytest.mark.parametrize("excerpt", [slice(0, 2), slice(40, 60)])
def test_excerpts_of_a_motion_show_no_marks_from_outside(tiny_response, tmp_path, excerpt):
    part = tiny_response.isel(tau=excerpt)
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # of marks far outside, matplotlib says that the axes have no room
        plot.save_picture(part, tmp_path / "excerpt.png", "history")
    low, high = part.tau.values[[0, -1]] / np.pi
    for ax in fm.plot_response(part):
        marks = [line.get_xdata() for line in ax.lines if line.get_marker() in ("o", "v")]
        assert all(low <= x <= high for line in marks for x in np.asarray(line))


def test_datasets_the_wrong_way_round(tiny_map, tiny_boundaries, tiny_response):
    for draw, ds, name in (
        (fm.plot_regimes, tiny_response, "plot_response"),
        (fm.plot_regimes, tiny_boundaries, "plot_boundaries"),
        (fm.plot_response, tiny_map, "plot_regimes"),
        (fm.plot_response, tiny_boundaries, "plot_boundaries"),
        (fm.plot_boundaries, tiny_response, "plot_response"),
    ):
        with pytest.raises(
            InputError, match=rf"^ds of {draw.__name__} must be a dataset such as .* \(use {name}\)$"
        ):
            draw(ds)
    for draw in (fm.plot_regimes, fm.plot_boundaries, fm.plot_response):
        for wrong in (tiny_map.beta_lim, "map.nc", None):
            with pytest.raises(
                InputError, match=rf"^ds of {draw.__name__} must be .*; got {type(wrong).__name__}$"
            ):
                draw(wrong)


# What a map's picture says besides


def words_of(axes):
    """The entries of the legend of a figure."""
    return [text.get_text() for text in axes[0].figure.legends[0].get_texts()]


def test_the_legend_counts_the_cells(tiny_map):
    found = np.concatenate([classes(tiny_map.isel(mu=m)).ravel() for m in (0, 1)])
    counted = [word for word in words_of(fm.plot_regimes(tiny_map)) if word.endswith(")")]
    numbers = [int(re.search(r"\(([\d,]+)\)$", word)[1].replace(",", "")) for word in counted]
    assert numbers == np.bincount(found)[np.unique(found)].tolist()
    assert sum(numbers) == tiny_map.regime.size


def synthetic(stops, mu=1.0):
    """A map of stick-slip with these numbers of stops."""
    shape = stops.shape
    cells = {"regime": np.full(shape, regimes.STICK_SLIP, dtype=np.int8), "stops_per_cycle": stops}
    axes = {"r": np.linspace(0.1, 2.0, shape[0]), "beta": np.linspace(0.1, 1.0, shape[1]), "mu": mu}
    return xr.Dataset({name: (("r", "beta"), values) for name, values in cells.items()}, axes)


def test_a_lone_cell_is_ringed_and_keeps_a_pixel():
    stops = np.full((500, 400), 2.0)
    stops[123, 77] = 9.0
    (ax,) = fm.plot_regimes(synthetic(stops))
    (ring,) = (line for line in ax.lines if line.get_marker() == "o")
    np.testing.assert_allclose(ring.get_xydata(), [[123 / 499, 77 / 399]], atol=1e-12)
    assert {"9 stops (1)", "few cells of their class: circled"} <= set(words_of([ax]))
    for size in ((450, 350), (90, 70)):
        assert (raster_of(ax, size) == MORE).sum() == 1
    image = np.asarray(rendered(ax.figure))
    colour = colour_table()[MORE][:3]
    assert (image[..., :3] == colour).all(axis=2).sum() >= 1


def rendered(figure, dpi=100):
    canvas = FigureCanvasAgg(figure)
    figure.set_dpi(dpi)
    canvas.draw()
    return canvas.buffer_rgba()


@pytest.mark.parametrize("dpi", [60, 100, 233])
def test_colours_on_the_canvas_are_those_of_the_cells(dpi):
    """Whatever the resolution, each quarter of the picture has the colour of its class."""
    stops = np.full((40, 40), 1.0)
    stops[20:, :20], stops[:20, 20:], stops[20:, 20:] = 2.0, 3.0, 4.0
    (ax,) = fm.plot_regimes(synthetic(stops))
    image = np.asarray(rendered(ax.figure, dpi))[::-1]
    for share, stop in (((0.2, 0.2), 1), ((0.8, 0.2), 2), ((0.2, 0.8), 3), ((0.8, 0.8), 4)):
        x, y = ax.transAxes.transform(share).astype(int)
        np.testing.assert_array_equal(image[y, x, :3], colour_table()[ONE - 1 + stop][:3])


def test_logarithmic_grids_have_logarithmic_axes():
    ds = fm.sweep(fm.System(), np.geomspace(0.1, 10.0, 9), np.geomspace(0.01, 2.0, 8))
    (ax,) = fm.plot_regimes(ds)
    assert (ax.get_xscale(), ax.get_yscale()) == ("log", "log")
    np.testing.assert_allclose(ax.get_xlim() + ax.get_ylim(), (0.1, 10.0, 0.01, 2.0))
    drawn(ax.figure)
    (ax,) = fm.plot_boundaries(ds)
    assert (ax.get_xscale(), ax.get_yscale()) == ("log", "linear")


def test_the_caption_describes_the_system(tiny_map, tiny_boundaries, tiny_response):
    for axes, ds in (
        (fm.plot_regimes(tiny_map), tiny_map),
        (fm.plot_boundaries(tiny_boundaries), tiny_boundaries),
        (fm.plot_response(tiny_response), tiny_response),
    ):
        heading = axes[0].figure.legends[0].get_title().get_text().replace("\n", " ")
        assert heading.startswith(ds.attrs["system"])
    assert "no viscous damping" in heading


def test_the_caption_states_the_start_and_the_axis_the_features(tiny_map):
    """As far as the configuration in the file contains them."""
    configured = tiny_map.assign_attrs(config='[system]\n[solver]\nstart = "moving"')
    axes = fm.plot_regimes(configured)
    assert "start: moving" in axes[0].figure.legends[0].get_title().get_text()
    marks = {line.get_label(): line.get_xdata() for line in axes[1].lines if line.get_linestyle() == "None"}
    np.testing.assert_array_equal(marks["natural frequency"], [1.0])
    np.testing.assert_allclose(1.0 / marks["natural frequency / n, some left out"], [8, 6, 5, 4, 3, 2])
    axes = fm.plot_regimes(tiny_map.assign_attrs(config=""))
    assert "start" not in axes[0].figure.legends[0].get_title().get_text()
    assert not [line for line in axes[1].lines if line.get_linestyle() == "None"]


def test_large_maps_state_how_they_are_reduced():
    (ax,) = fm.plot_regimes(synthetic(np.full((1500, 10), 2.0)))
    heading = ax.figure.legends[0].get_title().get_text().replace("\n", " ")
    assert "cells that share a pixel show the most frequent class" in heading


def test_arrays_of_axes_are_drawn_into(tiny_map, tiny_boundaries, tiny_response):
    for draw, ds, number in (
        (fm.plot_regimes, tiny_map, 2),
        (fm.plot_boundaries, tiny_boundaries, 3),
        (fm.plot_response, tiny_response, 4),
    ):
        figure = Figure()
        axes = figure.subplots(number, 1)
        np.testing.assert_array_equal(draw(ds, axes), axes)
        assert len(figure.axes) == number
        assert all(ax.lines for ax in axes)
        with pytest.raises(InputError, match=rf"^ax must be {number} axes, .*; got {number - 1}$"):
            draw(ds, list(axes[1:]))
        drawn(figure)


# Responses


def lines_of(ax):
    return [np.asarray(line.get_ydata()) for line in ax.lines]


def test_the_response_shows_load_contact_masses_and_friction(tiny_response):
    ds = tiny_response
    load, contact, masses, friction = fm.plot_response(ds)
    np.testing.assert_allclose(lines_of(load)[0], np.cos(ds.tau), atol=1e-12)
    np.testing.assert_array_equal(lines_of(contact)[0], ds.z)
    np.testing.assert_array_equal(lines_of(masses)[0], ds.x[0])
    np.testing.assert_array_equal(lines_of(friction)[0], ds.friction)
    begins = contact.lines[1]
    assert begins.get_label() == "stop begins"
    assert begins.get_xdata().size == int((ds.event_direction == 0).sum()) == 2
    assert load.get_ylabel() == "base / $Y$"
    assert load.figure._suptitle.get_text() == "r = 0.3, β = 0.05, μ = 1: stick-slip, 2 stops per cycle"
    assert words_of([load]) == ["stop", "maximum of the load (of the base's motion)", "stop begins"]


#: Names of the direction, and of that at events, in files of today and in older ones.
DIRECTION, EVENT_DIRECTION = ("direction", "phase"), ("event_direction", "event_phase")


@pytest.mark.parametrize("names", [("z",), ("x",), ("friction",), DIRECTION])
def test_a_response_without_a_motion_to_draw(names, tiny_response):
    with pytest.raises(InputError, match=rf"^a dataset must hold {names[0]} for its motion to be drawn"):
        fm.plot_response(tiny_response.drop_vars(names))


@pytest.mark.parametrize("names", [("event_tau",), EVENT_DIRECTION, ("event_z",)])
def test_a_response_without_its_events(names, tiny_response):
    whole = sum(len(ax.lines) for ax in fm.plot_response(tiny_response))
    assert sum(len(ax.lines) for ax in fm.plot_response(tiny_response.drop_vars(names))) == whole - 1


def test_the_response_of_a_fixed_wall_has_one_motion():
    load, contact, friction = fm.plot_response(fm.response(fm.System(), 2.0, 0.1))
    assert load.get_ylabel() == "load / $P$"
    assert (len(contact.lines), len(friction.lines)) == (1, 3)
    assert words_of([load]) == ["maximum of the load"]
    assert load.figure._suptitle.get_text().endswith(": continuous")


def test_every_mass_is_drawn_and_numbered():
    system = fm.System(mass_ratios=[1.0] * 5, stiffness_ratios=[1.0] * 5, contact_masses=[3])
    ds = fm.response(system, 0.7, 9.0)
    load, contact, masses, friction = fm.plot_response(ds)
    np.testing.assert_allclose(lines_of(masses), ds.x, atol=1e-12)
    np.testing.assert_array_equal(lines_of(masses)[2], 0.0)  # the mass at rest, not its rounding errors
    assert [text.get_text() for text in masses.texts] == [f"$x_{{{k}}}$" for k in range(1, 6)]
    heights = np.sort([text.xy[1] for text in masses.texts])
    assert np.diff(heights).min() > 0.08  # x3 = x4 = x5 = 0: their numbers lie apart nevertheless
    assert words_of([load]) == ["permanent sticking", "maximum of the load"]
    low, high = contact.get_ylim()
    assert (low, high) == (-0.5, 0.5)
    assert (friction.get_ylim()[0] < -9.0) & (friction.get_ylim()[1] > 9.0)


KINETIC, STATIC = [r"$\beta$", r"$-\beta$"], [r"$\mu\beta$", r"$-\mu\beta$"]


@pytest.mark.parametrize(("mu", "names"), [(1.0, KINETIC), (1.5, KINETIC + STATIC)])
def test_levels_of_friction_are_named(mu, names):
    *_, friction = fm.plot_response(fm.response(fm.System(), 0.3, 0.4, mu))
    assert [text.get_text() for text in friction.texts] == names
    levels = {float(values[0]) for values in lines_of(friction)[1:]}
    assert levels == {sign * factor * 0.4 for sign in (-1.0, 1.0) for factor in {1.0, mu}}


def test_loads_given_mass_by_mass_have_no_one_curve():
    system = fm.System(mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0], load=[1.0, 0.5j])
    assert len(fm.plot_response(fm.response(system, 0.7, 9.0))) == 3


# Reading no more than is drawn


@pytest.mark.parametrize("kind", ["map", "boundaries", "response"])
def test_what_is_not_drawn_need_not_be_read(request, tmp_path, kind):
    """A picture of a file of which only what is drawn was read is the same to the pixel."""
    ds = request.getfixturevalue(f"tiny_{kind}")
    write(ds, tmp_path / "ds.nc")
    part = read(tmp_path / "ds.nc", only=plot.PICTURED)
    assert set(part.variables) < set(ds.variables)
    draw = {"map": fm.plot_regimes, "boundaries": fm.plot_boundaries, "response": fm.plot_response}[kind]
    whole, drawn_part = (np.asarray(rendered(draw(given)[0].figure)) for given in (ds, part))
    np.testing.assert_array_equal(drawn_part, whole)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="peak memory is reported by Linux only")
def test_a_large_map_is_drawn_in_little_memory(tmp_path):
    """4096 by 4096 cells in less than 500 MB, Python and all libraries included."""
    n = 4096
    regime = np.full((1, n, n), regimes.STICK_SLIP, dtype=np.int8)
    stops = np.full((1, n, n), 2.0, dtype=np.float32)
    stops[0, 1000, 2000] = 7.0
    cells = {"regime": regime, "stops_per_cycle": stops, "contact_amplitude": np.ones((1, n, n))}
    axes = {"mu": [1.0], "r": np.linspace(0.1, 2.0, n), "beta": np.linspace(0.1, 1.0, n)}
    ds = xr.Dataset({name: (("mu", "r", "beta"), values) for name, values in cells.items()}, axes)
    write(ds.assign_attrs(source="frictionmap test"), tmp_path / "large.nc")
    code = "import sys; from frictionmap.command_line.cli import main; main(sys.argv[1:]); "
    code += "print(*(line for line in open('/proc/self/status') if line.startswith('VmHWM')))"
    command = [sys.executable, "-c", code, "plot", "large.nc"]
    environment = os.environ | {"PYTHONPATH": str(Path(fm.__file__).parents[1])}
    done = subprocess.run(
        command, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=600, check=True
    )
    said, peak = done.stdout.split("\n", 1)
    assert said == "wrote large.png"
    assert int(peak.split()[1]) < 500_000  # kB


# Where pictures appear


def in_a_new_process(code):
    search = os.pathsep.join([str(Path(fm.__file__).parents[1]), os.environ.get("PYTHONPATH", "")])
    ready = f"""
import sys
import numpy as np
import frictionmap as fm
ds = fm.boundaries(fm.System(), [0.5, 1.0, 2.0])
{code}
"""
    environment = os.environ | {"PYTHONPATH": search, "MPLBACKEND": "agg"}
    command = [sys.executable, "-c", ready]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_figures_are_pyplots_only_where_pyplot_is_in_use():
    before = "fm.plot_boundaries(ds); print('matplotlib.pyplot' in sys.modules)"
    assert in_a_new_process(before) == "False\n"
    after = "import matplotlib.pyplot as plt; axes = fm.plot_boundaries(ds); "
    assert in_a_new_process(f"{after} print(plt.gcf() is axes[0].figure, plt.get_fignums())") == "True [1]\n"


NOTEBOOK = """
from types import ModuleType, SimpleNamespace
sys.modules["IPython"] = ipython = ModuleType("IPython")
ipython.version_info = (9, 0)
ipython.get_ipython = lambda: {shell}
fm.plot_boundaries(ds)
print("matplotlib.pyplot" in sys.modules)
"""


@pytest.mark.parametrize(
    ("shell", "expected"),
    [("SimpleNamespace(events=SimpleNamespace(register=lambda *given: None))", "True"), ("None", "False")],
)
def test_a_notebook_counts_as_pyplot_in_use(shell, expected):
    """IPython may be there without a shell that runs."""
    assert in_a_new_process(NOTEBOOK.format(shell=shell)) == f"{expected}\n"


def test_a_response_of_one_moment_or_beyond_all_axes():
    ds = fm.response(fm.System(), 0.7, 0.2, points=20)
    with pytest.raises(InputError, match=r"^a response must have two tau or more to be drawn; got 1$"):
        fm.plot_response(ds.isel(tau=[3]))
    with pytest.raises(InputError, match=r"^z must be at most 1e\+300 to be drawn; got 1e\+308$"):
        fm.plot_response(ds.assign(z=ds.z * 0.0 - 1e308))
