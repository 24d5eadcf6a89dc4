"""Figures for a publication: size on paper, readable text, fonts, options of all functions that draw."""

import re
import zlib

import matplotlib as mpl
import numpy as np
import pytest
from conftest import ROOT
from layouts import assert_inside_and_apart, drawn
from matplotlib.figure import Figure
from matplotlib.text import Text
from PIL import Image

import frictionmap as fm
from frictionmap import InputError, plot
from frictionmap.command_line.cli import main
from frictionmap.files.reading import read
from frictionmap.files.storage import write
from frictionmap.pictures.maps.quantity_map import QuantityImage
from frictionmap.pictures.maps.regime_map import RegimeImage
from frictionmap.pictures.palette import CLASSES, STUCK, colour_table

WIDTH = 85.0 / 25.4  # inch
KINDS = ("map", "curves", "response", "fit", "design")


@pytest.fixture(scope="module")
def mapped():
    r, beta = np.linspace(0.1, 2.0, 40), np.linspace(0.02, 1.25, 30)
    outputs = ["regime", "stops_per_cycle", "contact_amplitude", "multiplier", "amplitude"]
    system = fm.System(mass_ratios=[1.0, 0.8], stiffness_ratios=[1.0, 1.2])
    return fm.sweep(system, r, beta, [1.0, 1.5], outputs=outputs)


@pytest.fixture(scope="module")
def curves():
    five = fm.System(mass_ratios=[1.0] * 5, stiffness_ratios=[1.0] * 5, damping_ratios=0.02)
    return fm.curves(five, np.linspace(0.2, 3.0, 57), [0.1, 0.3, 0.9], harmonics=5)


@pytest.fixture(scope="module")
def files(tmp_path_factory, mapped, curves):
    """A file of each kind."""
    folder = tmp_path_factory.mktemp("files")
    mapped.to_netcdf(folder / "map.nc")
    datasets = {"map": mapped, "curves": curves, "response": fm.response(fm.System(), 0.3, 0.3)}
    for name, ds in datasets.items():
        write(ds, folder / f"{name}.nc")
    assert main(["identify", str(ROOT / "configs/rigs/free-decay.toml"), "-o", str(folder / "fit.nc")]) == 0
    question = folder / "question.toml"
    question.write_text("title = 'A damper'\n[system]\ndamping_ratios = 0.05\n[design]\nband = [0.5, 1.5]\n")
    assert main(["design", str(question), "-o", str(folder / "design.nc")]) == 0
    return folder


@pytest.fixture
def draw(files, tmp_path):
    """Draw a file of a kind with options of the command line; return the picture."""

    def run(kind, ending, *options):
        path = tmp_path / f"picture{ending}"
        assert main(["plot", str(files / f"{kind}.nc"), "-o", str(path), "--overwrite", *options]) == 0
        return path

    return run


def size_of_text(text):
    return text.get_fontsize()


def seen(figure):
    """Texts that are drawn."""
    drawn(figure)
    return [text for text in figure.findobj(Text) if text.get_text() and text.get_visible()]


def pixels(path):
    """Width and height of a picture."""
    with Image.open(path) as image:
        return image.size


def cells_in_legend(figure):
    """Sum of the numbers of cells in brackets."""
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    return sum(
        int(found[1].replace(",", "")) for word in words if (found := re.search(r"\(([\d,]+)\)$", word))
    )


def boundaries_in(ax):
    """Names and styles of beta_lim and beta_stick."""
    names = (r"$\beta_\mathrm{lim}$", r"$\beta_\mathrm{stick}$")
    lines = [line for line in ax.lines if line.get_label() in names]
    return {(line.get_label(), line.get_color(), line.get_linestyle()) for line in lines}


def streams(pdf):
    """The contents of a PDF file."""
    parts = re.findall(rb"stream\r?\n(.*?)\r?\nendstream", pdf, re.DOTALL)
    return [zlib.decompress(part) for part in parts if part[:1] == b"x"]


# Size, text, fonts


@pytest.mark.parametrize("kind", KINDS)
def test_a_figure_of_one_column_by_one_command(draw, kind):
    content = draw(kind, ".pdf", "--size", "85mm").read_bytes()
    width = float(re.search(rb"/MediaBox \[ 0 0 ([\d.]+) ", content)[1])
    assert width == pytest.approx(72.0 * WIDTH, abs=0.1)
    fonts = set(re.findall(rb"/Subtype /(Type0|Type3|Type1|CIDFontType2|TrueType)\b", content))
    assert fonts == {b"Type0", b"CIDFontType2"}  # TrueType, embedded as a composite font: fonttype 42
    assert b"/FontFile2" in content
    drawing = max(streams(content), key=lambda part: part.count(b" Tf"))
    sizes = {float(size) for size in re.findall(rb"/F\S+ ([\d.]+) Tf", drawing)}
    assert max(sizes) < 10.0  # all that is smaller are indices
    svg = draw(kind, ".svg", "--size", "85mm").read_text(encoding="utf-8")
    assert f'width="{72.0 * WIDTH:.6f}'[:12] in svg
    assert "<text" in svg
    assert "frequency ratio" in svg or "time" in svg or "friction" in svg


@pytest.mark.parametrize("kind", KINDS)
def test_text_of_a_small_figure_is_readable_and_apart(files, kind):
    ds = read(files / f"{kind}.nc", plot.pictured(None), contacts=True)
    options = {"mass": 1} if kind == "curves" else {}
    figure = plot.draw(ds, size="85mm", **options)[0].figure
    assert figure.get_figwidth() == pytest.approx(WIDTH)
    texts = seen(figure)
    assert len(texts) > 10
    assert min(map(size_of_text, texts)) >= 7.0
    assert_inside_and_apart(figure)


def test_width_and_height(draw):
    path = draw("map", ".png", "--size", "85mm x 100mm", "--dpi", "254")
    assert pixels(path) == (850, 1000)


@pytest.mark.parametrize(("text", "inches"), [("3.3in", 3.3), ("8.5 cm", WIDTH), ((4.0, 3.0), 4.0)])
def test_sizes_in_other_units(mapped, text, inches):
    assert fm.plot_regimes(mapped, size=text)[0].figure.get_figwidth() == pytest.approx(inches)


def test_panels_stand_below_each_other_in_one_column_and_next_to_each_other_in_two(mapped):
    one, two = (fm.plot_regimes(mapped, size=size) for size in ("85mm", "170mm"))
    assert one[0].get_position().x0 == pytest.approx(one[1].get_position().x0, abs=0.05)
    assert two[0].get_position().x1 < two[1].get_position().x0


def test_cells_are_shapes_where_few_and_pixels_where_many(tmp_path, mapped):
    fine = {"r": np.linspace(0.1, 2.0, 210), "beta": np.linspace(0.02, 1.25, 70)}
    many = mapped[["regime"]].isel(mu=[0]).interp(fine, method="nearest").astype(np.int8)
    images = []
    for name, ds in {"few": mapped.isel(mu=[0]), "many": many}.items():
        plot.save_picture(ds, tmp_path / f"{name}.pdf", size="85mm")
        images.append((tmp_path / f"{name}.pdf").read_bytes().count(b"/Subtype /Image"))
    assert images[0] == 0 < images[1]


def test_resolution_of_many_cells(tmp_path):
    r, beta = np.linspace(0.5, 2.0, 120), np.linspace(0.0, 1.0, 100)
    ds = fm.sweep(fm.System(), r, beta, outputs=["regime"])
    widths = []
    for dpi in (100, 400):
        plot.save_picture(ds, tmp_path / f"{dpi}.pdf", size="85mm", dpi=dpi)
        content = (tmp_path / f"{dpi}.pdf").read_bytes()
        widths.append(max(int(width) for width in re.findall(rb"/Width (\d+)", content)))
    assert widths[1] == pytest.approx(4 * widths[0], rel=0.02)


# Settings of matplotlib


def test_the_size_set_by_the_user_is_used(mapped):
    with mpl.rc_context({"figure.figsize": (5.0, 4.0)}):
        figure = fm.plot_regimes(mapped.isel(mu=[0]))[0].figure
    assert tuple(figure.get_size_inches()) == (5.0, 4.0)


def test_letters_set_by_the_user_are_used(mapped):
    with mpl.rc_context({"font.size": 15.0}):
        (ax,) = fm.plot_regimes(mapped.isel(mu=[0]))
    assert ax.title.get_fontsize() == 15.0
    assert ax.figure.legends[0].get_texts()[0].get_fontsize() == 12.0
    with mpl.rc_context({"legend.fontsize": 6.0}):
        (ax,) = fm.plot_regimes(mapped.isel(mu=[0]))
    assert ax.figure.legends[0].get_texts()[0].get_fontsize() == 6.0


def test_a_style_from_a_file(draw, tmp_path):
    style = tmp_path / "paper.mplstyle"
    style.write_text("font.family: serif\naxes.grid: True\nsavefig.dpi: 50\nfigure.figsize: 4, 5\n")
    assert b"Serif" in draw("map", ".pdf", "--style", str(style)).read_bytes()
    assert pixels(draw("map", ".png", "--style", str(style))) == (200, 250)
    assert mpl.rcParams["axes.grid"] is False


# Legend, caption, title, limits


def test_legend_caption_and_title(mapped):
    ds = mapped.assign_attrs(title="Two masses")
    figure = fm.plot_regimes(ds, legend=False, caption=False, title="Mine")[0].figure
    assert figure.legends == []
    assert figure._suptitle.get_text() == "Mine"
    assert fm.plot_regimes(ds, title="")[0].figure._suptitle.get_text() == ""
    (legend,) = fm.plot_regimes(ds, caption=False)[0].figure.legends
    assert legend.get_texts()
    assert legend.get_title().get_text() == ""
    (legend,) = fm.plot_regimes(ds, legend=False)[0].figure.legends
    assert not legend.get_texts()
    assert "masses" in legend.get_title().get_text()


def test_narrow_figures_leave_the_room_of_the_caption_to_the_data(mapped):
    def headings(**options):
        return [one.get_title().get_text() for one in fm.plot_regimes(mapped, **options)[0].figure.legends]

    assert headings(size="85mm") == [""]
    assert "masses" in headings(size="85mm", caption=True)[0]
    assert "masses" in headings(size="170mm")[0]


def test_options_of_the_command_line_leave_out_legend_and_caption(draw):
    with_all = pixels(draw("map", ".png", "--size", "85mm"))
    without = pixels(draw("map", ".png", "--size", "85mm", "--no-legend", "--no-caption"))
    assert without[0] == with_all[0]
    assert without[1] < with_all[1] - 50


def test_limits_of_a_map_leave_out_what_is_not_in_view(mapped):
    (ax,) = fm.plot_regimes(mapped, panels=1, xlim=(0.5, 1.0), ylim=(0.0, 0.4))
    assert ax.get_xlim() == (0.5, 1.0)
    assert ax.get_ylim() == (0.0, 0.4)
    drawn(ax.figure)
    for text in ax.texts:
        box = text.get_window_extent()
        assert ax.get_window_extent().containsx(box.x0)
        assert ax.get_window_extent().containsy(box.y1)
    (whole,) = fm.plot_regimes(mapped, panels=1)
    all_cells, some = (cells_in_legend(one.figure) for one in (whole, ax))
    assert some < all_cells / 4


def test_limits_of_the_amplitudes_leave_the_phases_alone(curves):
    amplitude, phase = fm.plot_curves(curves, mass=2, xlim=(0.5, 1.5), ylim=(0.0, 2.0))
    assert amplitude.get_ylim() == (0.0, 2.0)
    assert phase.get_ylim()[1] == 180.0
    assert amplitude.get_xlim() == phase.get_xlim() == (0.5, 1.5)


def test_limits_of_a_logarithmic_axis():
    ds = fm.boundaries(fm.System(), np.geomspace(0.1, 10.0, 20))
    with pytest.raises(InputError, match=r"^limits of r must be > 0 on a logarithmic axis; got 0$"):
        fm.plot_boundaries(ds, xlim=(0.0, 1.0))
    curves = fm.curves(fm.System(), np.geomspace(0.1, 10.0, 20), [0.5])
    with pytest.raises(InputError, match=r"^xlim must be > 0 on a logarithmic axis; got 0$"):
        fm.plot_curves(curves, xlim=(0.0, 1.0))


# Choice of panels, masses and curves


def test_five_masses_and_their_harmonics_show_what_is_asked_for(curves):
    assert len(fm.plot_curves(curves)) == 10
    assert [ax.get_title() for ax in fm.plot_curves(curves, mass=3)] == ["mass 3"] * 2
    titles = [ax.get_title() for ax in fm.plot_curves(curves, "harmonics", mass=[1, 5], beta=0.3)]
    assert titles == ["mass 1, β = 0.3", "mass 5, β = 0.3"]
    assert [ax.get_title() for ax in fm.plot_curves(curves, panels=[2, 1])] == ["mass 2", "mass 1"]
    with pytest.raises(InputError, match=r"^mass must be one of 1, 2, 3, 4, 5; got 6$"):
        fm.plot_curves(curves, mass=6)


def test_curves_of_the_nearest_friction(curves):
    axes = fm.plot_curves(curves, mass=1, beta=[0.12, 0.8])
    words = [text.get_text() for text in axes[0].figure.legends[0].get_texts()]
    assert [word for word in words if word.startswith("β =")] == ["β = 0.1", "β = 0.9"]


def test_panels_of_a_motion(files):
    ds = read(files / "response.nc")
    assert [ax.get_ylabel().split()[0] for ax in fm.plot_response(ds)] == ["load", "contact", "friction"]
    (ax,) = fm.plot_response(ds, panels=3)
    assert ax.get_ylabel() == "friction / $P$"
    assert ax.get_xlabel() == r"$\tau/\pi$"


def test_panels_of_fits_and_designs(files):
    assert len(fm.plot_design(read(files / "design.nc"), panels=2)) == 1
    fit = read(files / "fit.nc")
    assert len(fm.plot_fit(fit, panels=[1, 2])) == 2 < len(fm.plot_fit(fit)) + 1


# Quantities


def image_of(ax, kind):
    (image,) = (artist for artist in ax.get_children() if isinstance(artist, kind))
    return image


def test_colours_of_a_quantity_are_those_of_its_scale(mapped):
    ds = mapped.sel(mu=1.0)
    (ax,) = fm.plot_quantity(ds, "contact_amplitude")
    image = image_of(ax, QuantityImage)
    colours, values = image.colours(), ds["contact_amplitude"].values
    moves = ds["regime"].values > 0
    expected = image.scale.to_rgba(values, bytes=True)
    assert (colours[moves] == expected[moves]).all()
    assert ax.figure.axes[-1].get_ylabel().replace("\n", " ") == ds["contact_amplitude"].long_name
    assert ax.figure._suptitle.get_text() == "Amplitude of the motion in the contact"  # not that of the map


def test_one_regime_has_one_colour_in_every_picture(mapped):
    ds = mapped.sel(mu=1.5)
    stuck = ds["regime"].values == 0
    of_quantities = [fm.plot_quantity(ds, name) for name in ("contact_amplitude", "multiplier")]
    pictures = (fm.plot_regimes(ds), *of_quantities)
    for axes, kind in zip(pictures, (RegimeImage, QuantityImage, QuantityImage), strict=True):
        assert stuck.any()
        assert (image_of(axes[0], kind).colours()[stuck] == colour_table()[STUCK]).all()
    (ax,) = fm.plot_boundaries(ds)
    colours = [part.get_facecolor() for part in ax.collections]
    assert {CLASSES[STUCK].colour, "#ffffff"} <= {mpl.colors.to_hex(one[0]) for one in colours if one.size}
    assert len(boundaries_in(ax)) == 2
    assert boundaries_in(pictures[0][0]) == boundaries_in(pictures[1][0]) == boundaries_in(ax)


def test_pixels_of_a_quantity_are_those_of_its_cells(mapped):
    """An image with one pixel per cell shows the cells; outside of them it is transparent."""
    (ax,) = fm.plot_quantity(mapped.sel(mu=1.0), "amplitude", mass=2)
    image = image_of(ax, QuantityImage)
    edges = np.arange(41.0), np.arange(31.0)
    pixels = image.image(edges, (45, 30), 100.0)
    assert (pixels[:, :40] == image.colours().swapaxes(0, 1)).all()
    assert (pixels[:, 40:] == 0).all()


def test_quantities_of_masses_have_a_panel_each(mapped):
    titles = [ax.get_title() for ax in fm.plot_quantity(mapped, "amplitude")]
    assert titles == [rf"mass {k}, $\mu$ = {mu}" for mu in ("1", "1.5") for k in (1, 2)]
    titles = [ax.get_title() for ax in fm.plot_quantity(mapped, "amplitude", mass=2)]
    assert titles == [rf"mass 2, $\mu$ = {mu}" for mu in ("1", "1.5")]


def test_a_quantity_by_one_command(draw, capsys):
    path = draw("map", ".svg", "--quantity", "contact_amplitude", "--log", "--panels", "1", "--size", "85mm")
    assert "amplitude of the" in path.read_text(encoding="utf-8")
    assert main(["plot", str(path.with_name("no.nc")), "--quantity", "contact_amplitude"]) == 2
    assert "does not exist" in capsys.readouterr().err


def test_peaks_are_cut_off_and_infinite_cells_have_the_last_colour():
    ds = fm.sweep(
        fm.System(),
        np.linspace(0.5, 1.5, 21),
        np.linspace(0.0, 0.5, 9),
        outputs=["regime", "contact_amplitude"],
    )
    assert np.isinf(ds["contact_amplitude"]).any()
    (ax,) = fm.plot_quantity(ds, "contact_amplitude")
    scale = image_of(ax, QuantityImage).scale
    assert np.isfinite(scale.norm.vmax)
    where = np.isinf(ds["contact_amplitude"].values[0])
    assert (image_of(ax, QuantityImage).colours()[where] == scale.to_rgba(scale.norm.vmax, bytes=True)).all()


# Working point


@pytest.mark.parametrize("function", ["plot_regimes", "plot_boundaries", "plot_quantity"])
def test_a_working_point_with_its_box(mapped, function):
    given = ("contact_amplitude",) if function == "plot_quantity" else ()
    (ax,) = getattr(fm, function)(mapped.sel(mu=1.0), *given, point=(1.0, 0.3), box=(0.1, 0.05))
    words = [text.get_text() for text in ax.figure.legends[0].get_texts()]
    assert words[-2:] == ["working point: r = 1, β = 0.3", "uncertainty: r ± 0.1, β ± 0.05"]
    (box,) = ax.patches
    np.testing.assert_allclose(box.get_bbox().extents, (0.9, 0.25, 1.1, 0.35))
    (mark,) = (line for line in ax.lines if line.get_marker() == "X")
    assert mark.get_xydata().tolist() == [[1.0, 0.3]]


def test_a_working_point_by_one_command(draw):
    svg = draw("map", ".svg", "--point", "1", "0.3", "--box", "0.1", "0.05").read_text(encoding="utf-8")
    assert "working point: r = 1, β = 0.3" in svg


# Axes given by the caller


def test_given_axes_keep_their_place_and_the_legend_may_be_left_out(mapped):
    figure = Figure(figsize=(3.3, 2.6), layout="constrained")
    ax = figure.subplots()
    fm.plot_regimes(mapped.sel(mu=1.0), ax=ax, legend=False)
    drawn(figure)
    assert ax.get_legend() is None
    assert ax.get_position().height > 0.6
    figure = Figure(figsize=(3.3, 2.6), layout="constrained")
    ax = figure.subplots()
    fm.plot_regimes(mapped.sel(mu=1.0), ax=ax)  # the legend would leave no room
    drawn(figure)
    assert ax.get_legend() is None
    assert ax.get_position().height > 0.6
    figure = Figure(figsize=(6.4, 7.0), layout="constrained")
    ax = figure.subplots()
    fm.plot_regimes(mapped.sel(mu=1.0), ax=ax)
    drawn(figure)
    assert figure.bbox.y0 <= ax.get_legend().get_window_extent().y0
    with pytest.raises(InputError, match=r"^cannot use size with ax: "):
        fm.plot_regimes(mapped.sel(mu=1.0), ax=ax, size="85mm")


def test_options_are_those_of_one_picture_only(mapped):
    """After an error, and after a picture, nothing is left of its options."""
    before = fm.plot_regimes(mapped)[0].figure.get_size_inches().tolist()
    fm.plot_regimes(mapped, size="85mm", legend=False)
    with pytest.raises(InputError):
        fm.plot_regimes(mapped, size="85mm", panels=9)
    assert fm.plot_regimes(mapped)[0].figure.get_size_inches().tolist() == before
    assert mpl.rcParams["font.size"] == 10.0
