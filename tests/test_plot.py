"""Pictures: made for every kind of file, classes that tell the truth, colours that survive grey printing."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

import frictionmap as fm
from frictionmap import InputError, plot, regimes
from frictionmap.settings import OUTPUTS

LABELS = [label for label, _ in plot._CLASSES]
COLOURS = dict(plot._CLASSES)
MAGIC = {".png": b"\x89PNG\r\n\x1a\n", ".pdf": b"%PDF-", ".svg": b"<?xml"}


@pytest.fixture(scope="module")
def tiny_map():
    """Both regimes of sliding, sticking, r = 0; two mu."""
    r, beta = np.linspace(0.0, 2.0, 9), np.linspace(0.0, 1.25, 11)
    return fm.sweep(fm.System(), r, beta, [1.0, 1.5], outputs=OUTPUTS)


@pytest.fixture(scope="module")
def tiny_boundaries():
    return fm.boundaries(fm.System(contact="joined-base-wall"), np.linspace(0.0, 2.0, 41), [1.0, 1.5, 2.0])


@pytest.fixture(scope="module")
def tiny_response():
    return fm.response(fm.System(contact="joined-base-wall"), 0.3, 0.05)


def drawn(figure):
    """The figure, laid out; a warning of the layout is an error."""
    figure.draw_without_rendering()
    return figure


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
    with pytest.raises(InputError, match=rf"^-o must end in \.png, \.pdf, \.svg; got .*{name}$"):
        plot.check_picture(Path(name))


# Classes and colours


def one_mu(regime=None, stops=None):
    """A map of one frequency."""
    given = {"regime": regime, "stops_per_cycle": stops}
    cells = {
        name: (("r", "beta"), np.array([values])) for name, values in given.items() if values is not None
    }
    return xr.Dataset(cells)


def labels(ds):
    found = plot.classes(ds)
    assert found.shape == (ds.sizes["r"], ds.sizes["beta"])
    return [LABELS[index] for index in found[0]]


def test_classes_of_whole_numbers_of_stops():
    stops = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 1000.0]
    expected = ["1 stop", "2 stops", "3 stops", "4 stops", "more stops", "more stops", "more stops"]
    assert labels(one_mu([regimes.STICK_SLIP] * 7, stops)) == expected
    assert labels(one_mu(stops=stops)) == expected


def test_classes_of_fractions_of_stops():
    stops = np.array([0.25, 0.5, 1.5, 7 / 3, 100.02], dtype=np.float32)
    expected = ["stops per cycle not whole"] * 5
    assert labels(one_mu([regimes.STICK_SLIP] * 5, stops)) == expected
    assert labels(one_mu(stops=stops)) == expected


def test_the_regime_decides_before_the_stops():
    regime = [regimes.UNRESOLVED, regimes.PERMANENT_STICKING, regimes.STICK_SLIP, regimes.CONTINUOUS]
    expected = ["unresolved", "permanent sticking", "stick-slip, not counted", "continuous"]
    assert labels(one_mu(regime, [np.nan, np.nan, np.nan, 0.0])) == expected
    assert labels(one_mu(regime)) == expected


def test_stops_alone_do_not_tell_stuck_from_unresolved():
    assert labels(one_mu(stops=[0.0, np.nan])) == ["continuous", "stuck or unresolved"]


def test_classes_of_a_map(tiny_map):
    panel = tiny_map.sel(mu=1.0)
    found = plot.classes(panel)
    stuck = panel.regime.values == regimes.PERMANENT_STICKING
    assert stuck.any()
    np.testing.assert_array_equal(found == LABELS.index("permanent sticking"), stuck)
    np.testing.assert_array_equal(found == LABELS.index("continuous"), panel.stops_per_cycle.values == 0.0)
    uncounted = found == LABELS.index("stick-slip, not counted")
    assert uncounted[0].any()  # r = 0
    assert not uncounted[1:].any()


def luminance(colour):
    """Relative luminance of sRGB (WCAG 2)."""
    channels = np.array(to_rgb(colour))
    linear = np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


def test_lightness_falls_with_the_number_of_stops():
    ordered = ["continuous", "1 stop", "2 stops", "3 stops", "4 stops", "more stops"]
    assert LABELS[LABELS.index("continuous") :][: len(ordered)] == ordered
    lightness = np.array([luminance(COLOURS[label]) ** (1 / 2.4) for label in ordered])
    assert np.all(np.diff(lightness) < -0.07)


def test_colours_that_can_meet_are_distinct():
    colours = [to_rgb(colour) for label, colour in plot._CLASSES if label != "stuck or unresolved"]
    gaps = [np.linalg.norm(np.subtract(a, b)) for i, a in enumerate(colours) for b in colours[:i]]
    assert min(gaps) > 0.15


# Axes, legends, texts


def test_given_axes_are_drawn_into_and_returned(tiny_map):
    figure = Figure()
    ax = figure.subplots()
    assert fm.plot_regimes(tiny_map.sel(mu=1.0), ax=ax) is ax
    assert ax.get_xlim() == (0.0, 2.0)
    assert ax.get_ylim() == (0.0, 1.25)
    assert "1" in ax.get_title()
    assert "permanent sticking" in [text.get_text() for text in ax.get_legend().get_texts()]
    drawn(figure)
    assert fm.plot_regimes(tiny_map.isel(mu=[1]), ax=figure.add_subplot()) is figure.axes[-1]


def test_several_mu_do_not_fit_into_given_axes(tiny_map):
    with pytest.raises(InputError, match=r"^ax must come with a map of one mu; got 2: use ds\.sel"):
        fm.plot_regimes(tiny_map, ax=Figure().subplots())


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
            assert ("several answers: the start decides" in words) == expected
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


def legends(figure):
    return figure.legends + [ax.get_legend() for ax in figure.axes if ax.get_legend()]


def assert_inside_and_apart(figure):
    """Legend and titles lie within the picture and off the axes."""
    renderer = FigureCanvasAgg(figure).get_renderer()
    drawn(figure)
    texts = [figure._suptitle, *legends(figure)]
    boxes = [item.get_window_extent(renderer) for item in texts]
    for box in boxes:
        assert box.x0 >= 0
        assert box.y0 >= 0
        assert box.x1 <= figure.bbox.x1
        assert box.y1 <= figure.bbox.y1
        for ax in figure.axes:
            assert not box.overlaps(ax.get_window_extent(renderer))
    tight = [ax.get_tightbbox(renderer) for ax in figure.axes]
    assert not any(a.overlaps(b) for i, a in enumerate(tight) for b in tight[:i])


TITLE = r"A long title, with $x_{ and 5 $ and \frac in it, which does not fit in a line: " + "and so on " * 12


@pytest.mark.parametrize("title", ["", "Short", TITLE])
@pytest.mark.parametrize("panels", [1, 2])
def test_nothing_overlaps_with_every_class_in_the_legend(title, panels):
    stops = np.array([[[1, 2, 3, 4, 5, 1.5, np.nan, np.nan, np.nan, 0]]] * panels)
    regime = np.array([[[1, 1, 1, 1, 1, 1, 1, -1, 0, 2]]] * panels, dtype=np.int8)
    cells = {"regime": (("mu", "r", "beta"), regime), "stops_per_cycle": (("mu", "r", "beta"), stops)}
    axes = {"mu": np.arange(1.0, panels + 1.0), "r": [0.5], "beta": np.arange(10.0)}
    (figure,) = {ax.figure for ax in fm.plot_regimes(xr.Dataset(cells, axes, {"title": title}))}
    assert len(figure.legends[0].get_texts()) == 10 + 2
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


def test_the_name_of_a_region_with_room_for_one_name_only():
    regime = np.full((120, 120), regimes.STICK_SLIP)
    regime[90:113, 100:109] = regimes.CONTINUOUS
    axes = {"r": np.arange(120.0), "beta": np.arange(120.0)}
    (ax,) = fm.plot_regimes(xr.Dataset({"regime": (("r", "beta"), regime)}, axes))
    assert [text.get_position() for text in ax.texts] == [(101.0, 104.0)]


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
    def lines(ds):
        return [text.get_text() for text in plot.plot_boundaries(ds)[0].figure.legends[0].get_texts()]

    assert "lower bound, sum of modal maxima" not in lines(tiny_boundaries)
    lower = tiny_boundaries.assign(beta_lim_modal=0.9 * tiny_boundaries.beta_lim)
    assert "lower bound, sum of modal maxima" in lines(lower)


def test_infinite_boundaries_do_not_spoil_the_scale(tiny_boundaries):
    ds = tiny_boundaries.copy(deep=True)
    ds.beta_stick[:, 20] = np.inf
    axes = plot.plot_boundaries(ds)
    assert all(ax.get_ylim()[1] < 10.0 for ax in axes)
    drawn(axes[0].figure)


def test_the_response_shows_stops_and_motion(tiny_response):
    top, bottom = plot.plot_response(tiny_response)
    names = top.get_legend_handles_labels()[1]
    assert names == ["motion in the contact, $z$", "mass, $x$", "stop", "stop begins"]
    assert top.lines[-1].get_xdata().size == int((tiny_response.event_phase == 0).sum()) == 2
    np.testing.assert_array_equal(bottom.lines[0].get_ydata(), tiny_response.friction)
    title = top.figure._suptitle.get_text()
    assert title == r"$r$ = 0.3, $\beta$ = 0.05, $\mu$ = 1: stick slip, 2 stops per cycle"


def test_the_response_of_a_fixed_wall_has_one_motion():
    top, _ = plot.plot_response(fm.response(fm.System(), 2.0, 0.1))
    assert top.get_legend_handles_labels()[1] == ["motion in the contact, $z$"]
    assert top.figure._suptitle.get_text().endswith(": continuous")
