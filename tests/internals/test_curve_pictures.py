"""What pictures of response curves are made of: pieces by regime, phases, colours, ends of axes, marks."""

from itertools import combinations, pairwise

import numpy as np
import pytest
import xarray as xr
from colours import difference, lab, linear
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

import frictionmap as fm
from frictionmap.pictures import palette
from frictionmap.pictures.curves import axes as curve_axes
from frictionmap.pictures.curves import families, harmonics, invariants, works
from frictionmap.pictures.curves import lines as curve_lines

UNRESOLVED, STUCK, SLIP, CONTINUOUS = -1, 0, 1, 2
TWO = {"mass_ratios": [1.0, 1.0], "stiffness_ratios": [1.0, 1.0]}


# Colours


@pytest.mark.parametrize("number", [2, 5, 8])
@pytest.mark.parametrize("who", ["trichromat", "protanope", "deuteranope", "grey"])
def test_colours_of_a_family_stay_apart(number, who):
    colours = [to_rgb(colour) for colour in palette.sequence(number)]
    assert min(difference(a, b, who) for a, b in combinations(colours, 2)) > 5.0


def test_colours_of_a_family_darken_and_show_on_paper():
    found = [float(lab(linear(to_rgb(colour)))[0]) for colour in palette.sequence(8)]
    assert (np.diff(found) < -5.0).all()
    assert found[0] < 86.0
    assert palette.sequence(1) == [palette.sequence(8)[-1]]


# Pieces


def parts(regime):
    x = np.arange(len(regime), dtype=float)
    return curve_lines.by_regime(x, 10.0 * x, np.array(regime))


def pieces(line):
    """The runs of points that a line joins."""
    x, y = line
    np.testing.assert_array_equal(y, 10.0 * x)
    runs = [run[~np.isnan(run)].tolist() for run in np.split(x, np.flatnonzero(np.isnan(x)))]
    return [run for run in runs if run]


@pytest.mark.parametrize(
    ("regime", "expected"),
    [
        ([2, 2, 2], {CONTINUOUS: [[0, 1, 2]]}),
        ([1, 1, 2, 2], {SLIP: [[0, 1, 2]], CONTINUOUS: [[2, 3]]}),
        ([0, 1, 1, 0], {STUCK: [[0, 1], [2, 3]], SLIP: [[1, 2]]}),
        ([2, 1, 2], {SLIP: [[0, 1, 2]]}),
        ([2, 2, 1, 2, 2], {CONTINUOUS: [[0, 1], [3, 4]], SLIP: [[1, 2, 3]]}),
        ([2, -1, 2], {UNRESOLVED: [[0, 1, 2]]}),
    ],
)
def test_a_curve_is_cut_up_by_regime(regime, expected):
    """Each step between neighbours is in one piece, that of the lower regime."""
    found = {code: pieces(line) for code, line in parts(regime).items()}
    assert found == expected
    steps = [step for runs in found.values() for run in runs for step in pairwise(run)]
    assert sorted(steps) == [(k, k + 1) for k in range(len(regime) - 1)]


def test_a_phase_is_not_joined_over_half_a_turn():
    x = np.arange(5.0)
    at, degrees = curve_lines.without_jumps(x, np.array([150.0, 175.0, -170.0, -150.0, 30.0]))
    np.testing.assert_array_equal(at, [0.0, 1.0, np.nan, 2.0, 3.0, 4.0])
    np.testing.assert_array_equal(degrees, [150.0, 175.0, np.nan, -170.0, -150.0, 30.0])


def bands(begin, end):
    ax = Figure().subplots()
    curve_lines.draw_band(ax, np.arange(len(begin), dtype=float), np.array(begin), np.array(end), "black")
    return [path.vertices for drawn in ax.collections for path in drawn.get_paths()]


def test_a_stop_is_a_band_from_its_beginning_to_its_end():
    (upper, lower) = bands([10.0, 20.0], [40.0, 60.0])
    assert {tuple(point) for point in upper} >= {(0.0, 10.0), (0.0, 40.0), (1.0, 20.0), (1.0, 60.0)}
    np.testing.assert_allclose(lower[:, 1], upper[:, 1] - 360.0)


def test_a_stop_over_half_a_turn_is_seen_on_both_sides():
    (upper, lower) = bands([170.0, 170.0], [-170.0, -170.0])
    assert upper[:, 1].max() == 190.0
    assert lower[:, 1].max() == -170.0


def test_curves_are_drawn_in_the_styles_of_their_regimes():
    ax = Figure().subplots()
    y = np.array([0.0, 0.5, 1.0, np.inf, 2.0, np.nan])
    curve_lines.draw_curve(ax, np.arange(6.0), y, np.array([0, 0, 1, 2, 2, -1]), "#123456", 5.0)
    styles = [line.get_linestyle() for line in ax.lines]
    assert styles == ["--", "--", "-"]  # matplotlib calls all patterns so
    assert all(line.get_color() == "#123456" for line in ax.lines)
    drawn = np.concatenate([line.get_ydata() for line in ax.lines])
    assert np.nanmax(drawn) == 5000.0  # what is infinite leaves the picture
    assert [handle.get_label() for handle in curve_lines.regime_handles(np.array([0, 2]))] == [
        "continuous",
        "permanent sticking",
    ]


# Families


def amplitudes(mu, r, beta):
    shape = len(mu), len(r), len(beta)
    values = {
        "regime": np.full(shape, CONTINUOUS, dtype=np.int8),
        "contact_amplitude": np.arange(np.prod(shape), dtype=float).reshape(shape),
    }
    cells = {name: (("mu", "r", "beta"), array) for name, array in values.items()}
    return xr.Dataset(cells, {"mu": mu, "r": r, "beta": beta})


def test_lines_differ_in_beta_and_of_several_mu_the_first_is_drawn():
    ds = amplitudes([1.0, 1.5], [0.5, 1.0, 1.5], [0.2, 0.4])
    family = families.family_of(ds)
    assert (family.labels, family.chosen) == (["β = 0.2", "β = 0.4"], "μ = 1 (the first of 2)")
    np.testing.assert_array_equal(family.rows("contact_amplitude"), ds.contact_amplitude[0].values.T)


def test_lines_differ_in_mu_where_there_is_one_beta():
    ds = amplitudes([1.0, 1.5], [0.5, 1.0, 1.5], [0.2])
    family = families.family_of(ds)
    assert (family.labels, family.chosen) == (["μ = 1", "μ = 1.5"], "β = 0.2")
    np.testing.assert_array_equal(family.rows("contact_amplitude"), ds.contact_amplitude[:, :, 0].values)
    np.testing.assert_array_equal(family.beta, [0.2, 0.2])


def test_a_single_frequency_reaches_over_its_cell():
    family = families.family_of(amplitudes([1.0], [0.5], [0.2, 0.4]))
    np.testing.assert_array_equal(family.cells.r, [0.25, 0.75])
    np.testing.assert_array_equal(family.rows("contact_amplitude"), [[0.0, 0.0], [1.0, 1.0]])


# Axes


def family_with(system, beta, sizes=(1.0, 2.0, 3.0)):
    ds = fm.sweep(system, np.linspace(0.2, 2.4, 3), beta, outputs=["regime"])
    return families.family_of(ds), [np.array(sizes)]


def test_infinite_resonances_are_those_below_the_threshold():
    """T(6.2): finite from beta = pi/4 |lambda/chi| on; with contact on mass 2 0.485 and 1.271, T 6.3."""
    system = fm.System(contact_masses=[2], **TWO)
    family, _ = family_with(system, [0.0, 1.0])
    found = invariants.infinite_resonances(family)
    np.testing.assert_allclose(found, [[0.618, 0.485], [1.618, 1.271]], rtol=0, atol=5e-4)
    family, _ = family_with(system, [1.0])
    assert [round(r, 3) for r, _ in invariants.infinite_resonances(family)] == [1.618]
    family, _ = family_with(fm.System(contact_masses=[2], damping_ratios=0.01, **TWO), [0.0, 1.0])
    assert invariants.infinite_resonances(family) == []


def test_axes_end_above_the_largest_peak_or_where_peaks_are_infinite():
    damped, sizes = family_with(fm.System(damping_ratios=0.1), [0.2])
    assert curve_axes.scale_of(damped, sizes, 5.0, False).top == pytest.approx(3.6)
    assert curve_axes.scale_of(damped, [np.array([1.0, np.inf])], 5.0, False).top == 5.0
    sharp = [np.array([1.0, 500.0])]  # all else would be flat below it
    assert curve_axes.scale_of(damped, sharp, 5.0, False).top == 5.0
    assert curve_axes.scale_of(damped, sharp, 100.0, True).top == pytest.approx(600.0)
    free, sizes = family_with(fm.System(), [0.2])
    scale = curve_axes.scale_of(free, sizes, 5.0, False)
    assert scale.top == 5.0
    assert curve_axes.about_peaks(free) == ["infinite at r = 1, finite at or above β = 0.7854"]
    assert curve_axes.about_cut(scale, [np.array([4.9, 5.1])]) == ["cut off above 5"]
    assert curve_axes.about_cut(scale, sizes) == []


def test_logarithmic_axes_begin_at_the_least_value_within_some_decades():
    ax = Figure().subplots()
    curve_axes.Scale(100.0, True).apply(ax, np.array([0.0, 1e-9, 0.5, 20.0, np.nan, np.inf]))
    assert ax.get_yscale() == "log"
    np.testing.assert_allclose(ax.get_ylim(), (0.5, 100.0))


@pytest.mark.parametrize(
    ("panels", "below", "shape"),
    [(1, 1, [2]), (2, 2, [2, 2]), (3, 0, [3]), (4, 0, [2, 2]), (5, 5, [3, 3, 3, 3]), (5, 0, [3, 3])],
)
def test_panels_lie_in_rows_with_their_phases_below(panels, below, shape):
    names = [f"a{k}" for k in range(panels)]
    others = [f"p{k}" for k in range(below)]
    rows = curve_axes.in_rows(names, others)
    assert [len(row) for row in rows] == shape
    assert sorted(item for row in rows for item in row if item is not None) == names + others
    if panels > 1 and below:
        for upper, lower in zip(rows[::2], rows[1::2], strict=True):
            assert [name and name[1:] for name in upper] == [name and name[1:] for name in lower]


def test_works_are_cut_off_above_most_of_their_values():
    """One value in ten may be a part of a peak."""
    values = np.append(np.linspace(0.0, 1.0, 900), np.geomspace(1.0, 1e6, 50))
    assert 1.0 < works._cut(values) < 3.0
    assert works._cut(np.zeros(3)) == 1.0


# Invariant points, T chapter 6


@pytest.mark.parametrize(
    ("contact", "quantity", "dof", "expected"),
    [
        (1, "amplitude", None, [0.559017, 1.118034]),  # sqrt(5)/4 and sqrt(5)/2
        (2, "amplitude", 2, [0.543048, 1.449813]),
        (2, "amplitude", 1, [0.828219, 1.549362]),
        (2, "first_harmonic", 2, [0.547034, 1.414214, 1.475070]),
        (1, "first_harmonic", None, [0.572614, 1.202347]),  # and 1, where no motion is continuous
    ],
)
def test_invariant_points_lie_on_the_curve_without_friction(contact, quantity, dof, expected):
    system = fm.System(contact_masses=[contact], **TWO)
    family = families.family_of(fm.sweep(system, np.linspace(0.0, 2.5, 6), [0.05, 0.1], outputs=["regime"]))
    found = invariants.invariant_points(family, quantity, dof).places
    for r in expected:
        assert np.abs(found[:, 0] - r).min() < 1e-6
    for r, size in found:
        free = fm.continuous_motion(system, r, 0.0)
        exact = free.contact_amplitude if dof is None else free.amplitude[dof - 1]
        assert size == pytest.approx(exact, rel=1e-12)
        assert fm.boundaries(system, [r]).beta_lim.item() > 0.05


def test_invariant_points_that_no_curve_passes_are_not_marked():
    family = families.family_of(fm.sweep(fm.System(), [0.1, 2.0], [1.5], outputs=["regime"]))
    assert not invariants.invariant_points(family, "amplitude", None).places.size
    system = fm.System(damping_ratios=0.1)
    damped = families.family_of(fm.sweep(system, [0.1, 2.0], [0.1], outputs=["regime"]))
    assert not invariants.invariant_points(damped, "amplitude", None).places.size


def test_points_of_the_monoharmonic_amplitude_are_called_so():
    family = families.family_of(
        fm.sweep(fm.System(contact_masses=[2], **TWO), [0.1, 2.0], [0.1], outputs=["regime"])
    )
    labels = [invariants.invariant_points(family, "amplitude", dof).label for dof in (1, 2, None)]
    assert labels == ["invariant point (monoharmonic)", "invariant point", "invariant point"]


# Harmonics


def test_levels_of_a_square_wave():
    """Its harmonics are 1, 1/3, 1/5 of the first: 20 log10 of that, and none where they vanish."""
    sizes = np.array([0.0, 1.0, 0.0, 1.0 / 3.0, 0.0, 1.0 / 5.0])
    turn = np.exp(0.7j * np.arange(6))
    values = np.stack(((sizes * turn).real, (sizes * turn).imag), axis=-1)
    found = harmonics.levels_of(values)
    np.testing.assert_allclose(found[[1, 3, 5]], [0.0, -9.5424251, -13.9794001], atol=1e-6)
    assert np.isneginf(found[[0, 2, 4]]).all()
