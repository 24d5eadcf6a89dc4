"""Pictures of several contacts, elastic contacts, belts and periodic loads: labels, lines and colours."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_hex
from matplotlib.lines import Line2D

import frictionmap as fm
from frictionmap import plot, regimes
from frictionmap.datasets.labels import CONTACT_TRACES, with_contact
from frictionmap.files.reading import read, standard_form
from frictionmap.files.storage import write_netcdf
from frictionmap.pictures import classes, palette
from frictionmap.pictures.grids import Grid
from frictionmap.pictures.maps.boundary_curves import further_ranges, through_cells
from frictionmap.pictures.maps.quantity_map import QuantityImage
from frictionmap.pictures.maps.regime_map import RegimeImage
from frictionmap.pictures.motions.history import plot_response
from frictionmap.pictures.motions.traces import load_trace, traces_of

STUCK, SLIP, CONTINUOUS = regimes.PERMANENT_STICKING, regimes.STICK_SLIP, regimes.CONTINUOUS

ONE_WAY = regimes.ONE_WAY_SLIDING

#: A wall at mass 1, and a joint between the masses.
TWO = [
    {"kind": "fixed-wall", "masses": [1]},
    {"kind": "between-masses", "masses": [1, 2], "ratio": 0.4, "name": "joint"},
]


def a_map(**variables):
    """A map of two frequencies and two friction ratios; values over r and beta, or over what is given."""
    coords = {"mu": [1.0], "r": [0.5, 1.0], "beta": [0.2, 0.4]}
    dims = {2: ("mu", "r"), 3: ("mu", "r", "beta"), 4: ("mu", "r", "beta", "contact")}
    cells = {}
    for name, values in variables.items():
        table = np.asarray(values)[np.newaxis]
        cells[name] = ("r", values) if name == "beta_noslip" else (dims[table.ndim], table)
    if any("contact" in dims for dims, _ in cells.values()):
        coords |= {"contact": [1, 2], "contact_name": ("contact", ["wall", "joint"])}
    return xr.Dataset(cells, coords=coords)


def two_contacts():
    regime = [[SLIP, STUCK], [SLIP, CONTINUOUS]]
    of_contacts = [[[SLIP, CONTINUOUS], [STUCK, STUCK]], [[STUCK, SLIP], [CONTINUOUS, CONTINUOUS]]]
    stops = [[[2.0, 0.0], [np.nan, np.nan]], [[np.nan, 4.0], [0.0, 0.0]]]
    ds = a_map(regime=regime, contact_regime=of_contacts, stops_per_cycle=stops)
    limits = {"beta_lim": [[0.1, 0.3]], "beta_stick": [[0.3, 0.5]]}
    ds = ds.assign({name: (("mu", "r"), values) for name, values in limits.items()})
    return ds.assign(beta_stick_contact=(("mu", "r", "contact"), [[[0.3, 0.1], [0.5, 0.2]]]))


def labels_of(axes):
    """Labels of the legend of a figure, without the numbers of cells."""
    (legend,) = axes[0].figure.legends
    return [text.get_text().split(" (")[0] for text in legend.get_texts()]


def classes_of(axes):
    (image,) = [artist for artist in axes[0].get_children() if isinstance(artist, RegimeImage)]
    return image.cells.found


def title(axes):
    return axes[0].figure.get_suptitle()


# Maps


def test_one_way_sliding_is_white_and_hatched():
    axes = plot.plot_regimes(a_map(regime=[[ONE_WAY] * 2] * 2))
    assert labels_of(axes) == ["one-way sliding"]
    assert (classes_of(axes) == palette.ONE_WAY).all()
    figure = axes[0].figure
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    box = axes[0].bbox
    pixels = np.asarray(canvas.buffer_rgba())[::-1][
        int(box.y0) + 3 : int(box.y1) - 3, int(box.x0) + 3 : int(box.x1) - 3, :3
    ]
    rows = pixels[:, 5].mean(axis=1)
    assert rows.max() == 255.0
    assert 4 < np.count_nonzero(np.diff((rows < 250.0).astype(int)) == 1) < 200  # level stripes
    (hatched,) = [handle for handle in figure.legends[0].legend_handles if handle.get_hatch()]
    assert to_hex(hatched.get_facecolor()) == "#ffffff"


def test_one_way_sliding_is_not_unresolved():
    found = classes.of_cells(np.array([ONE_WAY, regimes.UNRESOLVED]), None)
    assert found.tolist() == [palette.ONE_WAY, palette.UNRESOLVED]


def test_elastic_contacts_are_coloured_by_slips():
    slips = [[2.0, 0.0], [6.0, 1.5]]
    ds = a_map(regime=[[SLIP, STUCK], [SLIP, SLIP]], slips_per_cycle=slips, beta_noslip=[0.3, 0.5])
    axes = plot.plot_regimes(ds)
    assert (
        labels_of(axes)
        == [
            "no slip",
            "2 slips",
            "6 slips",
            "non-integer, 1.5 slips",
            r"$\beta_\mathrm{no\,slip}$",
            "few cells of their class: circled",
        ][:5]
    )
    expected = [[palette.ONE + 1, palette.STUCK], [palette.MORE, palette.NON_INTEGER]]
    assert classes_of(axes).tolist() == expected


def test_slip_reversals_come_before_slips():
    ds = a_map(
        regime=[[SLIP, STUCK], [SLIP, SLIP]],
        slips_per_cycle=[[4.0, 0.0], [6.0, 6.0]],
        slip_reversals_per_cycle=[[2.0, 0.0], [2.0, 0.0]],
    )
    axes = plot.plot_regimes(ds)
    assert labels_of(axes) == ["no slip", "2 slip reversals", "slips without reversal"]


def test_several_contacts_have_three_colours():
    axes = plot.plot_regimes(two_contacts())
    expected = [[palette.UNCOUNTED, palette.STUCK], [palette.UNCOUNTED, palette.CONTINUOUS]]
    assert classes_of(axes).tolist() == expected
    labels = ["all contacts stuck", "no contact stops", "stick-slip", palette.LIM["label"]]
    assert labels_of(axes) == [*labels, palette.STICK["label"]]


def test_a_chosen_contact_has_its_own_stops_and_name():
    axes = plot.plot_regimes(two_contacts().assign_attrs(title="E1").sel(contact=2))
    four = palette.ONE + 3
    assert classes_of(axes).tolist() == [
        [palette.CONTINUOUS, palette.STUCK],
        [four, palette.CONTINUOUS],
    ]
    assert title(axes) == "E1, contact 2 (joint)"
    assert palette.STICK_CONTACT["label"] in labels_of(axes)
    assert palette.STICK["label"] not in labels_of(axes)
    (own,) = [line for line in axes[0].lines if line.get_label() == palette.STICK_CONTACT["label"]]
    np.testing.assert_array_equal(own.get_ydata(), [0.1, 0.2])


def test_contacts_have_classes_next_to_their_numbers():
    """A contact that is stuck while the other one moves has no number of stops, and is coloured as stuck."""
    axes = plot.plot_quantity(two_contacts(), "stops_per_cycle")
    images = [one for ax in axes[:2] for one in ax.get_children() if isinstance(one, QuantityImage)]
    stuck = palette.colour_table()[palette.STUCK]
    found = [(image.colours() == stuck).all(axis=-1).tolist() for image in images]
    assert found == [[[False, True], [True, False]], [[False, True], [False, False]]]
    assert [line.get_label() for line in axes[0].lines].count(palette.STICK_CONTACT["label"]) == 1
    assert "permanent sticking" in labels_of(axes)


def test_contacts_with_and_without_spring_count_what_they_have():
    both = two_contacts().drop_vars(["beta_lim", "beta_stick", "beta_stick_contact"])
    slips = both["stops_per_cycle"].where(both["contact"] == 1)
    both = both.assign(stops_per_cycle=both["stops_per_cycle"].where(both["contact"] == 2))
    both = both.assign(slips_per_cycle=slips)
    assert classes.counted(standard_form(both.sel(contact=1))) is classes.SLIPS
    assert classes.counted(standard_form(both.sel(contact=2))) is classes.STOPS


def test_a_boundary_that_is_nowhere_is_not_in_the_legend():
    ds = a_map(regime=[[SLIP] * 2] * 2, beta_lim=[0.1, 0.2], beta_stick=[np.inf, np.inf])
    assert labels_of(plot.plot_regimes(ds)) == [
        "stick-slip, stops not counted",
        palette.LIM["label"],
    ]


def ranges(begin, end, stick):
    """The second of two ranges without stops over three frequencies."""
    first = np.zeros(3), np.full(3, 0.1)
    both = [
        np.stack((one, np.array(second)), axis=-1) for one, second in zip(first, (begin, end), strict=True)
    ]
    return xr.Dataset(
        {
            "no_stop_begin": (("r", "interval"), both[0]),
            "no_stop_end": (("r", "interval"), both[1]),
            "beta_stick": (("r",), np.full(3, stick)),
        },
        coords={"r": [1.0, 2.0, 3.0]},
    )


def test_further_ranges_without_stops():
    nan = np.nan
    ((begin, end),) = further_ranges(ranges([nan, 0.3, 0.4], [nan, 0.5, 0.4001], 1.0), 1.0)
    np.testing.assert_array_equal(begin, [nan, 0.3, nan])  # the last is too narrow to be seen
    np.testing.assert_array_equal(end, [nan, 0.5, nan])
    assert further_ranges(ranges([1.0] * 3, [np.inf] * 3, 1.0), 1.0) == []  # where all contacts stick
    ((begin, end),) = further_ranges(ranges([1.0] * 3, [np.inf] * 3, np.inf), 1.0)
    assert np.isfinite(end).all()


def test_a_value_at_one_frequency_extends_over_its_cell():
    r = Grid(np.array([1.0, 2.0, 3.0]))
    x, y = through_cells(r, np.array([np.nan, 0.3, np.nan]))
    known = np.isfinite(y)
    np.testing.assert_array_equal(x[known], [1.5, 2.0, 2.5])
    np.testing.assert_array_equal(y[known], [0.3] * 3)
    x, y = through_cells(r, np.array([0.1, 0.3, 0.7]))
    np.testing.assert_allclose(y, [0.1, 0.1, 0.2, 0.2, 0.3, 0.5, 0.5, 0.7, 0.7])


def test_further_ranges_are_dashed():
    ds = a_map(regime=[[SLIP] * 2] * 2, beta_lim=[0.1, 0.2], beta_stick=[1.0, 1.0])
    limits = {"no_stop_begin": [0.0, 0.25], "no_stop_end": [0.1, 0.35]}
    ds = ds.assign(
        {name: (("mu", "r", "interval"), np.tile(values, (1, 2, 1))) for name, values in limits.items()}
    )
    axes = plot.plot_regimes(ds)
    dashed = [line for line in axes[0].lines if line.get_label() == palette.FURTHER["label"]]
    assert [set(line.get_ydata()) for line in dashed] == [{0.25}, {0.35}]
    assert {line.get_color() for line in dashed} == {palette.LIM["color"]}
    assert labels_of(axes).count(palette.FURTHER["label"]) == 1


def test_boundaries_of_elastic_contacts():
    ds = a_map(beta_noslip=[0.3, np.inf]).drop_vars("beta")
    axes = plot.plot_boundaries(ds)
    assert labels_of(axes) == ["slips", "no slip", palette.NO_SLIP["label"]]
    assert len([one for one in axes[0].collections if isinstance(one, PolyCollection)]) == 2


@pytest.mark.parametrize(("own", "mu", "exact"), [(2.0, 1.0, False), (1.0, 1.5, True), (None, 1.5, False)])
def test_regions_are_exact_where_the_contacts_have_no_static_excess(own, mu, exact):
    """What counts is the mu of each contact; that of the grid is for those without their own."""
    contacts = [fm.Contact("fixed-wall", 1, mu=own), fm.Contact("between-masses", (1, 2), mu=own)]
    ds = fm.boundaries(
        fm.System(contacts=contacts, mass_ratios=[1, 1], stiffness_ratios=[1, 1]), [0.5, 0.8], mu
    )
    axes = plot.plot_boundaries(ds)
    assert ("permanent sticking" in labels_of(axes)) == exact
    assert ("sticking possible" in labels_of(axes)) != exact


# Files


def test_contacts_follow_the_dimensions_of_cells():
    assert with_contact(("mu", "r", "beta", "harmonic")) == ("mu", "r", "beta", "contact", "harmonic")
    assert with_contact(("tau",)) == ("contact", "tau")


@pytest.fixture(scope="module")
def two():
    system = fm.System(mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0], damping_ratios=0.01, contacts=TWO)
    return fm.response(system, 0.9, 0.5)


def test_files_keep_the_contacts_for_pictures(tmp_path, two):
    write_netcdf(two, tmp_path / "two.nc", "")
    everything = read(tmp_path / "two.nc", contacts=True)
    for name in set(CONTACT_TRACES) & set(two):
        assert everything[name].dims == ("contact", "tau")
        np.testing.assert_array_equal(everything[name], two[name])
    assert "z" not in read(tmp_path / "two.nc")
    second = read(tmp_path / "two.nc", at={"contact": 2})
    np.testing.assert_array_equal(second["z"], two["z"][1])
    assert second["contact_name"].item() == "joint"
    assert second.attrs["system"] == two.attrs["system"]


# Motions in time


def drawn(ax):
    """Lines over all of tau, without levels and dotted lines."""
    return [line for line in ax.lines if isinstance(line, Line2D) and len(line.get_xdata()) > 100]


def test_every_contact_has_a_line_a_bar_and_its_events(two):
    load, z, stuck, masses, friction = plot_response(two)
    for ax, name in ((z, "z"), (friction, "friction")):
        lines = drawn(ax)
        assert [line.get_color() for line in lines] == list(palette.CONTACTS[:2])
        np.testing.assert_array_equal([line.get_ydata() for line in lines], two[name])
    assert [to_hex(bar.get_facecolor()[0]) for bar in stuck.collections] == list(palette.CONTACTS[:2])
    assert len(drawn(masses)) == 2
    dots = {line.get_color(): line for line in z.lines if line.get_marker() == "o"}
    for number, colour in enumerate(palette.CONTACTS[:2], 1):
        begins = (two["event_contact"] == number) & (two["event_direction"] == 0)
        np.testing.assert_array_equal(dots[colour].get_ydata(), two["event_z"][begins.values])
    assert "2 and 2 stops per cycle" in title([load])
    expected = ["maximum of the load", "contact 1", "contact 2", "stop begins"]
    assert labels_of([load]) == expected
    levels = {text.get_text() for text in friction.texts}
    assert levels == {r"$\beta_{1}$", r"$-\beta_{1}$", r"$\beta_{2}$", r"$-\beta_{2}$"}


def test_of_a_chosen_contact_only_its_events(two):
    second = standard_form(two.sel(contact=2))
    (trace,) = traces_of(second)
    begins = (two["event_contact"] == 2) & (two["event_direction"] == 0)
    np.testing.assert_array_equal(trace.stops[1], two["event_z"][begins.values])
    axes = plot_response(second)
    assert len(axes) == 4  # no bars
    assert "contact 2 (joint)" in title(axes)


def test_the_load_is_that_of_the_file():
    harmonics = [
        {"n": 1, "mass": 1, "amplitude": 1.0},
        {"n": 2, "mass": 1, "amplitude": 0.6, "phase_deg": -70},
    ]
    ds = fm.response(fm.System(damping_ratios=0.05, load_harmonics=harmonics), 0.5, 0.5)
    tau = ds["tau"].values
    expected = np.cos(tau) + 0.6 * np.cos(2 * tau - np.radians(70.0))
    np.testing.assert_allclose(load_trace(ds), expected, atol=1e-12)
    load = plot_response(ds)[0]
    np.testing.assert_allclose(drawn(load)[0].get_ydata(), expected, atol=1e-12)
    (mark,) = [line for line in load.lines if line.get_marker() == "v"]
    assert mark.get_xdata() == pytest.approx(tau[np.argmax(expected)] / np.pi)


def test_an_elastic_contact_has_its_loop_next_to_its_history():
    ds = fm.response(fm.System(contact_stiffness=3.0, damping_ratios=0.02), 0.8, 0.5)
    axes = plot_response(ds)
    assert [ax.get_title() for ax in axes] == ["", "", "", "hysteresis loop"]
    (loop,) = axes[3].lines
    np.testing.assert_array_equal(loop.get_xydata(), np.column_stack((ds["z"], ds["friction"])))
    assert labels_of(axes) == ["no slip", "maximum of the load", "slip ends"]
    assert "slips, 2 slips per cycle" in title(axes)


def test_one_way_sliding_has_a_name_in_titles():
    ds = fm.response(fm.System(wall_velocity=3.0, damping_ratios=0.02), 2.0, 0.5)
    assert "one-way sliding" in title(plot_response(ds))


# Curves


def test_contacts_have_panels_of_their_own():
    system = fm.System(mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0], damping_ratios=0.02, contacts=TWO)
    r = np.linspace(0.6, 1.4, 3)
    ds = fm.curves(system, r, [0.1, 0.5], quantities=["amplitude", "energy"])
    panels = {
        "contact": ["contact 1 (fixed-wall 1)", "contact 2 (joint)"],
        "amplitude": ["mass 1", "mass 2", "contact 2 (joint)"],  # mass 1 moves with contact 1
    }
    for quantity, titles in panels.items():
        assert [ax.get_title() for ax in fm.plot_curves(ds, quantity)] == titles
    energy = [(ax.get_title(), ax.get_ylabel().split(" / ")[0]) for ax in fm.plot_curves(ds, "energy")]
    assert ("contact 2 (joint)", "work of friction") in energy
    assert ("", "work of the load") in energy


def test_curves_of_a_belt():
    system = fm.System(wall_velocity=0.3, damping_ratios=0.02)
    ds = fm.curves(system, [1.0, 2.5, 3.0], [0.5], quantities=["amplitude", "energy"])
    assert "one-way sliding" in labels_of(fm.plot_curves(ds))
    assert any("belt" in ax.get_ylabel() for ax in fm.plot_curves(ds, "energy"))


def test_a_contact_without_its_number_has_no_marks_of_others():
    """Marks of another contact may lie far outside; the picture then has no room for its axes."""
    system = fm.System(
        mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.05,
        contacts=[fm.Contact("fixed-wall", 1), fm.Contact("between-masses", (1, 2), ratio=0.5)],
    )  # fmt: skip
    ds = fm.response(system, 0.4, 0.2)
    for k in range(2):
        chosen = fm.plot_response(ds.isel(contact=k, drop=True))
        marks = [line for ax in chosen.ravel() for line in ax.lines if line.get_marker() == "o"]
        assert not [line for line in marks if np.size(line.get_xdata())]
        known = fm.plot_response(ds.isel(contact=k))
        marks = [line for ax in known.ravel() for line in ax.lines if line.get_marker() == "o"]
        starts = (ds.event_contact == k + 1) & (ds.event_direction == 0)
        assert sum(np.size(line.get_xdata()) for line in marks) == int(starts.sum())
