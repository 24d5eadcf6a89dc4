"""Pictures of response curves and of orbits: what is drawn is what the dataset holds."""

from pathlib import Path

import numpy as np
import pytest
from layouts import assert_inside_and_apart, rendered, words_of
from matplotlib.figure import Figure

import frictionmap as fm
from frictionmap import InputError, plot
from frictionmap.command_line import cli
from frictionmap.files.reading import read
from frictionmap.files.storage import write

TWO = {"mass_ratios": [1.0, 1.0], "stiffness_ratios": [1.0, 1.0]}


# Orbits


@pytest.fixture(scope="module")
def orbit():
    return fm.response(fm.System(contact_masses=[2], **TWO), 0.4, 0.3)


def test_an_orbit_is_drawn_as_portrait_and_loop(orbit):
    portrait, loop, *_ = axes = fm.plot_orbit(orbit)
    for line, x, v in zip(portrait.lines, orbit.x, orbit.v, strict=True):
        np.testing.assert_array_equal(line.get_xydata(), np.column_stack((x, v)))
    (line,) = loop.lines
    np.testing.assert_array_equal(line.get_xydata(), np.column_stack((orbit.z, orbit.friction)))
    assert words_of(axes) == ["mass 1", "mass 2", "contact", "stop begins"]
    assert "stick-slip, 2 stops per cycle" in portrait.figure._suptitle.get_text()
    rendered(axes)


def test_the_loop_encloses_the_work_of_friction(orbit):
    """beta times the way of the contact, as one may read it off the picture."""
    (line,) = fm.plot_orbit(orbit)[1].lines
    z, friction = line.get_xydata().T
    area = float(np.sum(0.5 * (friction[1:] + friction[:-1]) * np.diff(z)))
    assert area == pytest.approx(0.3 * np.abs(np.diff(orbit.z)).sum(), rel=1e-3)


@pytest.mark.parametrize(("contact", "motions"), [("fixed-wall", 1), ("joined-base-wall", 2)])
def test_the_spectrum_of_an_orbit_is_that_of_the_dataset(contact, motions):
    """In dB beside the first harmonic, of every mass, and of the contact where none moves as it does."""
    ds = fm.response(fm.System(contact=contact), 0.3, 0.05)
    axes = fm.plot_orbit(ds)
    assert len(axes[2].lines) == motions
    for line, name in zip(axes[2].lines, ("displacement_harmonic", "contact_harmonic"), strict=False):
        size = np.hypot(*ds[name].values.reshape(-1, 2).T)
        n = np.rint(line.get_xdata()).astype(int)
        np.testing.assert_array_equal(n, [1, 3, 5, 7])
        np.testing.assert_allclose(line.get_ydata(), 20.0 * np.log10(size[n] / size[1]), atol=1e-9)
    rendered(axes)


def test_loops_show_their_direction_and_where_stops_begin(orbit):
    """A stop begins at the end of sliding, with the kinetic friction of that direction."""
    portrait, loop, *_ = fm.plot_orbit(orbit)
    begins = orbit.event_z[orbit.event_direction == 0].values
    (dots,) = loop.collections
    np.testing.assert_allclose(dots.get_offsets()[:, 0], begins)
    np.testing.assert_allclose(dots.get_offsets()[:, 1], np.copysign(0.3, begins), atol=1e-12)
    (stops,) = portrait.collections  # of the mass in contact alone
    np.testing.assert_allclose(stops.get_offsets(), np.column_stack((begins, 0.0 * begins)))
    for arrow in loop.texts:  # the friction force is against the motion: + beta in the equation of z
        (x0, y0), (x1, y1) = arrow.xyann, arrow.xy
        assert (x1 - x0) * y0 > 0.0
        assert y0 == pytest.approx(y1)
    assert len(loop.texts) == 2
    assert len(portrait.texts) == 2
    for arrow in portrait.texts:  # clockwise: to the right where the velocity is positive
        assert (arrow.xy[0] - arrow.xyann[0]) * arrow.xy[1] > 0.0


@pytest.mark.parametrize("system", [fm.System(), fm.System(contact_masses=[2], **TWO)])
def test_a_contact_at_rest_is_drawn_as_zero(system):
    """Not as its rounding errors, which an axis would blow up."""
    ds = fm.response(system, 0.3, 9.0)
    row = system.contact_masses[0] - 1
    ds["z"] = ds.z + 1e-14 * np.cos(7.0 * ds.tau)
    ds["x"] = ds.x + 1e-14 * np.cos(5.0 * ds.tau)
    portrait, loop, spectrum = axes = fm.plot_orbit(ds)
    np.testing.assert_array_equal(loop.lines[0].get_xdata(), 0.0)
    np.testing.assert_array_equal(portrait.lines[row].get_xdata(), 0.0)
    assert not loop.texts
    assert spectrum.texts[0].get_text() == "at rest" if ds.sizes["dof"] == 1 else spectrum.lines
    rendered(axes)


def test_one_unit_has_one_name_in_a_figure():
    """With a base that moves, displacements are over its amplitude everywhere."""
    ds = fm.response(fm.System(excitation="base", mass_ratios=[1, 1], stiffness_ratios=[1, 1]), 0.4, 0.3)
    labels = [ax.get_xlabel() + ax.get_ylabel() for ax in (*fm.plot_orbit(ds), *fm.plot_response(ds))]
    assert not any("P/k_1" in label for label in labels)
    assert sum("$Y$" in label for label in labels) == 5


def test_orbits_are_drawn_into_given_axes(orbit):
    number = len(fm.plot_orbit(orbit))
    axes = Figure().subplots(1, number)
    np.testing.assert_array_equal(fm.plot_orbit(orbit, axes), axes)
    assert "contact" in [text.get_text() for text in axes[-1].get_legend().get_texts()]
    assert fm.plot_orbit(orbit, Figure().subplots(1, number), legend=False)[-1].get_legend() is None
    with pytest.raises(InputError, match=rf"^ax must be {number} axes, one for each panel; got 1$"):
        fm.plot_orbit(orbit, axes[:1])


def test_orbits_that_cannot_be_drawn(orbit):
    with pytest.raises(InputError, match=r"^a dataset must hold v for its orbit to be drawn"):
        fm.plot_orbit(orbit.drop_vars("v"))
    with pytest.raises(InputError, match=r"^a response must have two tau or more to be drawn; got 1$"):
        fm.plot_orbit(orbit.isel(tau=[0]))
    with pytest.raises(InputError, match=r"^ds of plot_orbit must be .*use plot_boundaries\)$"):
        fm.plot_orbit(fm.boundaries(fm.System(), [0.5]))


# What is asked for


def test_the_quantity_of_a_file_that_has_one_picture_only(orbit, tmp_path):
    path = tmp_path / "picture.png"
    plot.save_picture(orbit, path, "orbit")
    assert path.stat().st_size > 5000
    with pytest.raises(InputError, match=r"unknown quantity 'x' .*; valid: history, orbit$"):
        plot.save_picture(orbit, path, "x")
    ds = fm.boundaries(fm.System(), [0.5, 1.5])
    with pytest.raises(InputError, match=r"^unknown quantity 'orbit' in .*; valid: boundaries$"):
        plot.save_picture(ds, path, "orbit")
    message = (
        r"^cannot draw boundaries with log: it applies to response curves and quantities of maps; omit log$"
    )
    with pytest.raises(InputError, match=message):
        plot.save_picture(ds, path, log=True)


# Curves of a map with amplitudes


def test_a_map_with_amplitudes_has_curves():
    """Fig. 7.3: of one mass against the wall x is z; the largest peak is below the top."""
    r, beta = np.linspace(0.1, 2.5, 49), [0.1, 0.3]
    system = fm.System(damping_ratios=0.1)
    ds = fm.sweep(system, r, beta, outputs=["regime", "amplitude", "contact_amplitude"])
    (ax,) = axes = fm.plot_curves(ds)
    for k, colour in enumerate({line.get_color() for line in ax.lines if line.get_linestyle() != "None"}):
        lines = [line.get_xydata() for line in ax.lines if line.get_color() == colour]
        places = {tuple(point) for line in lines for point in line if np.isfinite(point).all()}
        expected = [set(zip(r, ds.amplitude.values[0, :, j, 0], strict=True)) for j in range(2)]
        assert places in expected, k
    assert ax.get_ylim() == pytest.approx((0.0, 1.2 * float(ds.amplitude.max())))
    assert words_of(axes)[:2] == ["β = 0.1", "β = 0.3"]
    rendered(axes)


# Response curves

ALL = ["amplitude", "phase", "first_harmonic", "harmonics", "energy", "transmitted_force"]
SLIP, CONTINUOUS = 1, 2


@pytest.fixture(scope="module")
def wall():
    """T Fig. 4.7 on a coarse grid: one mass against a fixed wall."""
    return fm.curves(fm.System(), np.linspace(0.05, 2.5, 50), [0.2, 0.6], harmonics=5, quantities=ALL)


@pytest.fixture(scope="module")
def base():
    """T Fig. 3.14 on a coarse grid: a wall that moves with the base; two mu."""
    system = fm.System(contact="joined-base-wall")
    return fm.curves(system, np.linspace(0.1, 2.5, 25), [0.2, 1.0, 2.0], [1.0, 1.5], quantities=ALL)


@pytest.fixture(scope="module")
def two():
    """T Fig. 6.13 on a coarse grid: load on mass 1, wall on mass 2."""
    system = fm.System(contact_masses=[2], **TWO)
    return fm.curves(system, np.linspace(0.1, 2.5, 25), [0.0, 0.4, 2.0], quantities=ALL)


def coloured(ax):
    """Lines of the family, by colour in the order of drawing; black ones are references."""
    found = {}
    for line in ax.lines:
        if line.get_linestyle() != "None" and line.get_color() != "black":
            found.setdefault(line.get_color(), []).append(line)
    return list(found.values())


def points(lines):
    """Finite points of some lines, without those that stand for infinite values."""
    values = np.concatenate([line.get_xydata() for line in lines])
    values = values[np.isfinite(values).all(axis=1)]
    return {tuple(point) for point in values[values[:, 1] < 1e3]}


def expected_points(r, values):
    return {(x, y) for x, y in zip(r.tolist(), values.tolist(), strict=True) if np.isfinite(y) and y < 1e3}


def solid(lines):
    return [line for line in lines if line.get_linestyle() == "-"]


def caption_of(axes):
    return axes[0].figure.legends[0].get_title().get_text().replace("\n", " ")


@pytest.mark.parametrize(
    ("quantity", "size", "phase"),
    [
        ("amplitude", "amplitude", "phase_lag"),
        ("first_harmonic", "first_harmonic_amplitude", "first_harmonic_phase"),
        ("contact", "contact_amplitude", "contact_phase"),
    ],
)
def test_amplitude_and_phase_are_those_of_the_dataset(wall, quantity, size, phase):
    upper, lower = axes = fm.plot_curves(wall, quantity)
    for k, (above, below) in enumerate(zip(coloured(upper), coloured(lower), strict=True)):
        cells = wall.isel(mu=0, beta=k)
        sizes, phases = (np.ravel(cells[name].values) for name in (size, phase))
        assert points(above) == expected_points(wall.r.values, sizes)
        assert points(below) == expected_points(wall.r.values, np.degrees(phases))
        continuous = cells.regime.values == CONTINUOUS
        assert points(solid(above)) <= expected_points(wall.r.values[continuous], sizes[continuous])
    assert words_of(axes)[:4] == ["β = 0.2", "β = 0.6", "continuous", "stick-slip"]
    rendered(axes)


def test_stops_that_have_no_phase_are_bands(wall):
    """A mass that a fixed wall stops is at its largest displacement throughout; T 3.6.1 gives no phase."""
    _, lower = axes = fm.plot_curves(wall, "amplitude")
    cells = wall.isel(mu=0, beta=1, dof=0)
    stopped = np.isnan(cells.phase_lag.values)
    assert stopped.sum() > 10
    assert (cells.regime.values[stopped] == SLIP).all()
    vertices = np.concatenate([path.vertices for band in lower.collections for path in band.get_paths()])
    drawn_points = {tuple(point) for point in vertices}
    for r, begin in zip(cells.r.values[stopped], np.degrees(cells.phase_begin.values[stopped]), strict=True):
        assert (r, begin) in drawn_points
    assert "largest throughout a stop" in words_of(axes)


def references(ax, dash):
    """Data of black lines, dotted or dashed."""
    return [
        line.get_xydata() for line in ax.lines if line.get_color() == "black" and line.get_linestyle() == dash
    ]


def test_boundary_and_stuck_configuration_are_drawn(two):
    axes = fm.plot_curves(two, "amplitude")
    assert len(axes) == 4
    for k, ax in enumerate(axes[:2]):
        (limit,) = references(ax, "--")
        np.testing.assert_array_equal(limit[:, 1], np.minimum(two.limit_amplitude[0, :, k], 5000.0))
    (held,) = references(axes[0], ":")
    np.testing.assert_array_equal(held[:, 1], np.minimum(two.held_response.sel(dof=1), 5000.0))
    assert not references(axes[1], ":")  # the wall holds mass 2
    assert {r"continuous motion at $\beta_\mathrm{lim}$", "contact held"} <= set(words_of(axes))
    (limit,) = references(axes[2], "--")
    there = np.isfinite(limit[:, 1])
    expected = np.degrees(two.limit_phase[0, :, 0].values)
    np.testing.assert_array_equal(limit[there, 1], expected[np.isfinite(expected)])


def test_every_mass_has_a_column_and_the_contact_where_it_moves_by_itself(wall, base, two):
    def titles(ds):
        return [ax.get_title() for ax in fm.plot_curves(ds, "first_harmonic")]

    assert titles(wall) == ["mass 1", "mass 1"]
    assert titles(base) == ["mass 1", "contact"] * 2
    assert titles(two) == ["mass 1", "mass 2"] * 2
    assert titles(two.sel(dof=[1])) == ["mass 1", "contact"] * 2


def test_open_circles_are_points_that_friction_leaves_alone(two):
    """T 6.3: 0.828 and 1.549 of mass 1; of the first harmonic of mass 2 the frequency sqrt(2)."""
    first, _, _, _ = fm.plot_curves(two, "amplitude")
    circles = [line.get_xydata() for line in first.lines if line.get_marker() == "o"]
    places = np.concatenate(circles)[:, 0]
    for expected in (0.828, 1.549):
        assert np.abs(places - expected).min() < 1e-3
    _, second, _, _ = fm.plot_curves(two, "first_harmonic")
    (circles,) = (line.get_xydata() for line in second.lines if line.get_marker() == "o")
    assert np.abs(circles[:, 0] - np.sqrt(2.0)).min() < 1e-9


def test_captions_state_what_is_cut_off_and_which_peaks_are_finite(wall):
    axes = fm.plot_curves(wall, "amplitude")
    assert axes[0].get_ylim() == (0.0, 5.0)
    caption = caption_of(axes)
    assert caption.startswith(wall.attrs["system"])
    assert "cut off above 5" in caption
    assert "infinite at r = 1, finite at or above β = 0.7854" in caption
    assert "cut off" not in caption_of(fm.plot_curves(wall.sel(beta=[0.6], r=slice(1.3, 2.5)), "amplitude"))


def test_the_first_of_several_mu_is_drawn_or_all_of_one_beta(base):
    axes = fm.plot_curves(base)
    assert axes[0].figure._suptitle.get_text().endswith("μ = 1 (the first of 2)")
    axes = fm.plot_curves(base.sel(beta=[1.0]))
    assert words_of(axes)[:2] == ["μ = 1", "μ = 1.5"]
    assert axes[0].figure._suptitle.get_text().endswith("β = 1")
    for m, lines in enumerate(coloured(axes[0])):
        assert points(lines) == expected_points(base.r.values, base.amplitude.values[m, :, 1, 0])


def test_amplitudes_may_have_a_logarithmic_axis(two):
    axes = fm.plot_curves(two, "amplitude", log=True)
    assert [ax.get_yscale() for ax in axes] == ["log", "log", "linear", "linear"]
    assert axes[0].get_ylim()[1] == 100.0
    rendered(axes)
    with pytest.raises(InputError, match=r"^cannot draw harmonics with log: they are in decibels; omit log"):
        fm.plot_curves(two, "harmonics", log=True)


def test_harmonics_are_drawn_relative_to_the_first(wall):
    axes = fm.plot_curves(wall, "harmonics")
    assert [ax.get_title() for ax in axes] == ["mass 1, β = 0.2", "mass 1, β = 0.6"]
    for k, ax in enumerate(axes):
        values = wall.displacement_harmonic.isel(mu=0, beta=k, dof=0)
        size = np.hypot(values.isel(part=0).values, values.isel(part=1).values)
        for n, lines in zip((3, 5), coloured(ax), strict=True):
            found = np.array(sorted(points(lines)))
            with np.errstate(invalid="ignore", divide="ignore"):  # the first is infinite, or both are
                level = 20.0 * np.log10(size[:, n] / size[:, 1])
            seen = ~np.isnan(level)
            np.testing.assert_array_equal(found[:, 0], wall.r[seen])
            np.testing.assert_allclose(found[:, 1], np.maximum(level[seen], -132.0), atol=1e-9)
    assert {"harmonic 3", "harmonic 5"} <= set(words_of(axes))
    assert not {"harmonic 2", "harmonic 4"} & set(words_of(axes))  # the motion is its own mirror image
    rendered(axes)


def test_works_and_forces_have_a_panel_each(two, base):
    axes = fm.plot_curves(two, "energy")
    names = ["work_input", "work_friction", "sliding_distance", "equivalent_damping"]
    assert len(axes) == len(names)
    for ax, name in zip(axes, names, strict=True):
        for k, lines in enumerate(coloured(ax)):
            assert points(lines) == expected_points(two.r.values, two[name].values[0, :, k])
    rendered(axes)
    damped = fm.curves(fm.System(damping_ratios=0.1), [0.5, 1.0, 2.0], [0.1, 0.5], quantities=["energy"])
    assert len(fm.plot_curves(damped)) == 5
    axes = fm.plot_curves(base, "transmitted_force")
    assert [ax.get_ylabel() for ax in axes] == ["transmitted force / $P$", "its first harmonic / $P$"]
    rendered(axes)


def test_phases_have_an_axis_that_holds_them(two, base):
    _, _, first, second = fm.plot_curves(two, "first_harmonic")
    low, high = second.get_ylim()
    assert high == 180.0
    phases = np.degrees(two.first_harmonic_phase.values[0])
    assert low <= np.nanmin(phases)
    assert first.get_ylim() == (low, high)
    *_, last = fm.plot_curves(base.isel(mu=0), "first_harmonic")
    assert last.get_ylim() == (0.0, 180.0)


@pytest.mark.parametrize("quantity", ["amplitude", "first_harmonic", "contact", "harmonics", "energy"])
@pytest.mark.parametrize("name", ["wall", "base", "two"])
def test_nothing_overlaps(request, name, quantity):
    assert_inside_and_apart(fm.plot_curves(request.getfixturevalue(name), quantity)[0].figure)


def test_what_cannot_be_drawn(wall):
    legal = "amplitude, first_harmonic, contact, harmonics, energy, transmitted_force"
    with pytest.raises(InputError, match=rf"^quantity must be one of {legal}; got phase$"):
        fm.plot_curves(wall, "phase")
    with pytest.raises(InputError, match=r"^quantity must be one of energy; got amplitude$"):
        fm.plot_curves(wall[["regime", "work_friction"]], "amplitude")
    with pytest.raises(InputError, match=r"^ax must be 2 axes, one for each panel; got 1$"):
        fm.plot_curves(wall, ax=[Figure().subplots()])
    many = fm.curves(fm.System(), [0.5, 1.5], np.linspace(0.1, 0.7, 13), quantities=["amplitude"])
    with pytest.raises(InputError, match=r"at most 12 beta .* got 13: .*ds\.sel\(beta=\[\.\.\.\]\)"):
        fm.plot_curves(many)


def test_the_command_draws_some_of_many_curves(tmp_path, capsys):
    many = fm.curves(fm.System(), [0.5, 1.5], np.linspace(0.1, 0.7, 13), quantities=["amplitude"])
    path, picture = tmp_path / "many.nc", tmp_path / "many.png"
    write(many, path)
    assert cli.main(["plot", str(path), "-o", str(picture)]) == 0
    said = f"wrote {picture} with 6 of 13 friction ratios; --beta chooses others\n"
    assert capsys.readouterr().out == said
    assert cli.main(["plot", str(path), "-o", str(tmp_path / "one.png"), "--beta", "0.1,0.7"]) == 0
    assert capsys.readouterr().out == f"wrote {tmp_path / 'one.png'}\n"


@pytest.mark.parametrize("ending", plot.FORMATS)
def test_files_of_curves_are_drawn_of_what_they_hold(wall, tmp_path, ending):
    """What is read for the picture is enough for it, to the pixel."""
    write(wall, tmp_path / "ds.nc")
    part = read(tmp_path / "ds.nc", only=plot.PICTURED)
    assert set(part.variables) < set(wall.variables)
    plot.save_picture(part, tmp_path / f"picture{ending}", "first_harmonic")
    assert (tmp_path / f"picture{ending}").stat().st_size > 5000
    for quantity in (None, "harmonics", "energy"):
        whole, of_part = (rendered(fm.plot_curves(ds, quantity)) for ds in (wall, part))
        np.testing.assert_array_equal(of_part, whole)


def test_slices_and_transposed_datasets_are_drawn_as_they_are(two):
    expected = rendered(fm.plot_curves(two.isel(mu=0), "amplitude"))
    turned = two.transpose("beta", "r", ...).isel(r=slice(None, None, -1))
    np.testing.assert_array_equal(rendered(fm.plot_curves(turned, "amplitude")), expected)
    (upper, lower) = axes = fm.plot_curves(two.isel(r=[3], dof=[1]), "amplitude")
    assert all(np.nanmin(line.get_xdata()) < np.nanmax(line.get_xdata()) for line in upper.lines[:3])
    assert lower.get_title() == "mass 2"
    rendered(axes)


def test_the_command_draws_what_it_is_asked_for(wall, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write(wall, Path("curves.nc"))
    assert cli.main(["plot", "curves.nc", "--quantity", "energy", "--log", "-o", "energy.png"]) == 0
    assert cli.main(["plot", "curves.nc", "--quiet"]) == 0
    assert Path("energy.png").read_bytes() != Path("curves.png").read_bytes()
    assert capsys.readouterr().out == "wrote energy.png\n"
    assert cli.main(["plot", "curves.nc", "--quantity", "phase", "-o", "no.png"]) == 2
    assert capsys.readouterr().err.startswith("frictionmap: quantity must be one of amplitude,")
    assert not Path("no.png").exists()
