"""Pictures of fits to measured data: what is drawn is what was measured and fitted, all of it to be read."""

import contextlib
import re
import warnings
from pathlib import Path

import numpy as np
import pytest
from decays import Truth, marched, synthetic
from fuzz import malformed
from fuzz.malformed import STRUCTURE, VALUES
from layouts import assert_inside_and_apart, rendered, words_of
from matplotlib.figure import Figure
from records import Truth as Shaking
from records import places, steady
from records import synthetic as noisy
from responses import Truth as Responses
from responses import continuous, table
from scipy.linalg import eigh
from sweeps import F_K1M1, GAMMA, KAPPA, amplitudes, swept

import frictionmap as fm
from frictionmap import InputError, plot
from frictionmap.command_line import cli
from frictionmap.files.reading import read
from frictionmap.files.storage import write

MIXED = Truth(3.1, 0.01, 0.2, 10.0, -0.02, 0.3, 200.0, 4.0, 0.02)


@pytest.fixture(scope="module")
def datasets():
    return {
        "decay": fm.identify.free_decay(*synthetic(MIXED, 1)),
        "sweep": fm.identify.sweep(*swept(), sigma_amplitude=0.02),
    }


def caption_of(axes):
    words = axes[0].figure.legends[0].get_title().get_text()
    return words.replace("\n", " ").replace("\u00a0", " ")


def line(ax, label):
    """Data of the one line with a label."""
    (found,) = (one.get_xydata() for one in ax.lines if one.get_label() == label and one.get_xdata().size)
    return found


def dots(ax):
    """Data of all dots."""
    return [one.get_xydata() for one in ax.lines if one.get_marker() == "o" and one.get_xdata().size]


@pytest.mark.parametrize("kind", ["decay", "sweep"])
@pytest.mark.parametrize("ending", plot.FORMATS)
def test_fits_of_every_kind_in_every_format(datasets, tmp_path, kind, ending):
    plot.save_picture(datasets[kind], tmp_path / f"picture{ending}")
    assert (tmp_path / f"picture{ending}").stat().st_size > 5000


@pytest.mark.parametrize("kind", ["decay", "sweep"])
def test_nothing_overlaps(datasets, kind):
    assert_inside_and_apart(fm.plot_fit(datasets[kind])[0].figure)


# Free decays


def test_samples_and_residuals_are_those_measured(datasets):
    ds = datasets["decay"]
    upper, lower = axes = fm.plot_fit(ds)
    np.testing.assert_array_equal(dots(upper)[0], np.column_stack((ds.time, ds.data)))
    np.testing.assert_array_equal(dots(lower)[0], np.column_stack((ds.time, ds.residual)))
    assert upper.get_ylabel() == "displacement [mm]"
    assert lower.get_ylabel() == "residual [mm]"
    assert lower.get_xlabel() == "time [s]"
    rendered(axes)


def places_at(truth, time):
    """The motion at a few times; between them marching wants some more."""
    every = np.union1d(np.linspace(truth.t0, truth.length, 400), time)
    return marched(truth, 1.0, every)[0][np.searchsorted(every, time)]


@pytest.mark.parametrize("truth", [MIXED, MIXED._replace(zeta=0.0, x_F=0.45), MIXED._replace(X0=-10.0)])
def test_the_curve_moves_as_the_equation_has_it(truth):
    """Without noise the fit is the truth; marching knows no closed form."""
    ds = fm.identify.free_decay(*synthetic(truth._replace(noise=0.0), 1))
    upper, _ = fm.plot_fit(ds)
    time, place = line(upper, "fitted").T
    expected, halves = marched(truth, 1.0, time)
    np.testing.assert_allclose(place, expected, atol=1e-5)  # to the six digits of a fit of exact data
    (points,) = (found for found in dots(upper) if found.shape[0] < 60)
    beside = [places_at(truth, points[:, 0] + step) for step in (-0.01, 0.0, 0.01)]
    np.testing.assert_allclose(points[:, 1], beside[1], atol=1e-5)
    inward = -np.sign(points[:, 1] - truth.centre)[:-1]  # from the last one it does not turn back
    assert (inward * (beside[0] - beside[1])[:-1] > 0.0).all()
    assert (inward * (beside[2] - beside[1])[:-1] > 0.0).all()
    assert points.shape[0] == halves  # all but the one before the record
    above, below = (one.get_ydata() for one in upper.lines if len(one.get_xdata()) == 400)
    np.testing.assert_allclose(above + below, 2.0 * truth.centre, atol=1e-5)


@pytest.mark.parametrize(
    ("known", "words"),
    [
        ({"zeta": 0.0}, "envelope: straight, as under friction alone"),
        ({"x_F": 0.0}, "envelope: exponential, as under viscous damping alone"),
        ({}, "envelope: friction and viscous damping"),
    ],
)
def test_the_legend_names_the_envelope(known, words):
    ds = fm.identify.free_decay(*synthetic(MIXED, 1), known=known)
    axes = fm.plot_fit(ds)
    assert words in words_of(axes)
    assert ("comes to rest" in words_of(axes)) == bool(ds.at_rest)
    rendered(axes)


def test_the_caption_states_estimates_verdict_and_whether_residuals_are_white(datasets):
    ds = datasets["decay"]
    words = caption_of(fm.plot_fit(ds))
    for name in ds.parameter.values:
        value, error = re.search(rf"\b{name} (\S+) ± ([^\s,;]+)", words).groups()
        one = ds.sel(parameter=name)
        assert float(value) == pytest.approx(float(one.estimate), abs=0.06 * float(one.standard_error))
        assert float(error) == pytest.approx(float(one.standard_error), rel=0.06)
    assert "friction and viscous damping found; lag-1 correlation of residuals" in words
    assert "no more than chance makes (0.07)" in words  # 2/sqrt(800)


def test_coloured_residuals_are_reported():
    time, x = synthetic(MIXED._replace(noise=0.0), 1)
    noise = np.random.default_rng(2).normal(0.0, 0.02, x.size)
    ds = fm.identify.free_decay(time, x + noise + np.roll(noise, 1))  # lag-1 correlation 1/2
    lag, chance, grown = re.search(
        r"residuals (\S+), more than chance makes \((\S+)\): errors are taken (\S+) times as large",
        caption_of(fm.plot_fit(ds)),
    ).groups()
    assert float(lag) == pytest.approx(0.5, abs=0.1)
    assert float(chance) == 0.07
    assert float(grown) == pytest.approx(np.sqrt(3.0), abs=0.2)


# Sweeps


def test_the_curve_of_a_sweep_is_that_of_two_masses(datasets):
    ds = datasets["sweep"]
    upper, lower = axes = fm.plot_fit(ds)
    f, found = line(upper, "fitted").T
    gamma, kappa, f_k1m1 = ds.estimate.sel(parameter=["gamma", "kappa", "f_k1m1"]).values
    np.testing.assert_allclose(found, amplitudes(f, gamma, kappa, f_k1m1), rtol=1e-6)
    measured = dots(upper)[0]
    np.testing.assert_allclose(measured, np.column_stack(swept()), rtol=1e-13)
    (bars,) = upper.collections
    ends = np.array([segment[:, 1] for segment in bars.get_segments()])
    np.testing.assert_allclose(ends / measured[:, 1:], np.broadcast_to(np.exp([-0.02, 0.02]), ends.shape))
    assert upper.get_yscale() == "log"
    assert [text.get_text() for text in upper.texts] == ["$f_0$", "$f_1$", "$f_2$"]
    assert "measured, with one standard error" in words_of(axes)
    np.testing.assert_array_equal(dots(lower)[0][:, 1], ds.residual)


def test_peaks_and_zero_are_where_the_masses_have_them():
    f = np.linspace(0.5, 8.0, 61)
    upper, _ = fm.plot_fit(fm.identify.sweep(f, amplitudes(f)))
    places = sorted(one.get_xdata()[0] for one in upper.lines if one.get_linestyle() == ":")
    K = np.array([[1.0 + KAPPA, -KAPPA], [-KAPPA, KAPPA]])
    natural = np.sqrt(np.sort(np.linalg.eigvals(np.diag([1.0, 1.0 / GAMMA]) @ K))) * F_K1M1
    expected = [natural[0], np.sqrt(KAPPA / GAMMA) * F_K1M1, natural[1]]
    np.testing.assert_allclose(places, expected, rtol=1e-6)


# Forced responses

RIG = Responses(3.1, 0.01, (0.2, 0.5), (0.62, 0.8, 0.95, 1.05, 1.3, 1.7, 2.1))


@pytest.fixture(scope="module")
def responses():
    sets, frequency, lag, amplitude = table(RIG, 1)
    return fm.identify.forced(
        frequency, lag, amplitude, sets=sets, known={"mu": 1.0}, sigma_phase=0.7, sigma_amplitude=0.01
    )


def test_fitted_curves_of_forced_responses_are_steady_motions(responses):
    """Every curve against half a period of the motion, solved from its equation."""
    upper, lower, *_ = axes = fm.plot_fit(responses)
    of = responses.estimate.sel(parameter=["f_n", "zeta", "beta_1", "beta_2"]).values
    f_n, zeta, *beta = of.tolist()
    for panel, told in ((upper, abs), (lower, lambda X: -np.degrees(np.angle(X)))):
        solid = [
            one.get_xydata()
            for one in panel.lines
            if one.get_linestyle() == "-" and one.get_label()[0] == "_"
        ]
        curves = [points[np.isfinite(points).all(axis=1)] for points in solid if len(points) > 50]
        assert len(curves) == 2
        for points, ratio in zip(curves, beta, strict=True):
            some = points[::40]
            expected = [told(continuous(f / f_n, ratio, zeta)) for f in some[:, 0]]
            np.testing.assert_allclose(some[:, 1], expected, rtol=1e-7)
    rendered(axes)


def test_forced_responses_are_drawn_as_measured(responses):
    upper, lower, residuals, _ = axes = fm.plot_fit(responses)
    for panel, quantity in ((upper, 0), (lower, 1)):
        for number, points in zip("12", dots(panel), strict=True):
            chosen = (responses["set"].values == number) & (responses.quantity.values == quantity)
            expected = np.column_stack((responses.frequency, responses.data))[chosen]
            np.testing.assert_array_equal(points, expected[np.argsort(expected[:, 0])])
    drawn = np.concatenate([one.get_ydata() for one in residuals.lines if one.get_marker() in "o^"])
    np.testing.assert_allclose(np.sort(drawn), np.sort(responses.residual / responses.sigma), atol=1e-12)
    assert {"set 1: β = 0.", "set 2: β = 0."} == {
        words[:13] for words in words_of(axes) if words[:3] == "set"
    }
    assert [lower.get_ylabel(), residuals.get_xlabel()] == ["lag [deg]", "frequency [Hz]"]


def test_the_place_on_the_map_is_that_of_the_fit(responses):
    *_, regimes = axes = fm.plot_fit(responses)
    places = np.concatenate([one.get_xydata() for one in regimes.lines if one.get_marker() == "o"])
    f_n, *beta = responses.estimate.sel(parameter=["f_n", "beta_1", "beta_2"]).values.tolist()
    expected = [(r * RIG.f_n / f_n, ratio) for ratio in beta for r in RIG.r]
    np.testing.assert_allclose(places, expected, rtol=1e-12)
    assert regimes.get_xlim()[1] > places[:, 0].max()
    assert regimes.get_ylim()[1] > 1.0  # where it sticks, beta_stick = 1 of a fixed wall
    assert {"continuous", "2 stops", "permanent sticking", r"$\beta_\mathrm{lim}$"} <= set(words_of(axes))


def test_without_the_structure_fitted_values_are_joined(responses):
    ds = responses.copy()
    del ds.attrs["config"]
    upper, _, _ = axes = fm.plot_fit(ds)
    (first, _) = (
        one.get_xydata() for one in upper.lines if one.get_linestyle() == "-" and len(one.get_xdata()) > 2
    )
    chosen = (ds["set"].values == "1") & (ds.quantity.values == 0)
    np.testing.assert_array_equal(first, np.column_stack((ds.frequency, ds.model))[chosen])
    assert "as the file does not contain the structure" in caption_of(axes)
    rendered(axes)


def test_lags_of_another_mass_may_turn_farther():
    """Two masses, contact and load apart: the second one lags by more than half a turn."""
    two = {"mass_ratios": [1.0, 1.0], "stiffness_ratios": [1.0, 1.0], "contact_masses": [2]}
    system = fm.System(damping_ratios=0.02, **two)
    r = np.array([0.5, 0.8, 1.2, 1.5, 1.9, 2.3])
    ds = fm.curves(system, r, 0.1, quantities=["first_harmonic"]).isel(mu=0, beta=0)
    lag = np.degrees(ds.first_harmonic_phase.values.T) % 360.0
    fitted = fm.identify.forced(
        3.0 * r, dict(enumerate(lag, 1)), dict(enumerate(ds.first_harmonic_amplitude.values.T, 1)),
        system=fm.System(**two), known={"f_n": 3.0, "mu": 1.0}, sigma_phase=1.0, sigma_amplitude=0.02,
    )  # fmt: skip
    axes = fm.plot_fit(fitted)
    assert [ax.get_ylabel() for ax in axes[:4]] == [
        "amplitude of mass 1", "amplitude of mass 2", "lag of mass 1 [deg]", "lag of mass 2 [deg]"
    ]  # fmt: skip
    assert axes[3].get_ylim()[1] > lag.max() > 180.0
    assert_inside_and_apart(axes[0].figure)


# Records

STICKS = Shaking(3.1, 0.01, 0.7, 1.0, -0.1, 1.0, (0.0, 1.75, 0.02), rate=50.0, length=6.0)


@pytest.fixture(scope="module")
def shaken():
    return fm.identify.record(*noisy(STICKS, steady(STICKS), 1), damping_reference="base", known={"mu": 1.0})


def test_a_record_is_drawn_in_time_and_cycle_over_cycle(shaken):
    """The fitted motion against the equation, integrated; errors of estimates move it by some 0.001 mm."""
    upper, lower, cycle, _ = axes = fm.plot_fit(shaken)
    np.testing.assert_array_equal(line(upper, "fitted"), np.column_stack((shaken.time, shaken.model)))
    np.testing.assert_array_equal(line(upper, "base, measured"), np.column_stack((shaken.time, shaken.base)))
    np.testing.assert_array_equal(dots(upper)[0], np.column_stack((shaken.time, shaken.data)))
    np.testing.assert_array_equal(dots(lower)[0][:, 1], shaken.residual)
    turns, place = line(cycle, "fitted").T
    assert (np.diff(turns) >= 0.0).all()
    assert 0.0 <= turns[0] < turns[-1] < 1.0
    np.testing.assert_allclose(place, places(STICKS, steady(STICKS), turns / STICKS.f), atol=0.01)
    assert_inside_and_apart(axes[0].figure)


def test_the_place_of_a_record_on_the_map(shaken):
    *_, regimes = fm.plot_fit(shaken)
    ((r, beta),) = np.concatenate([one.get_xydata() for one in regimes.lines if one.get_marker() == "o"])
    assert r == pytest.approx(STICKS.f / STICKS.f_n, abs=0.003)
    assert beta == pytest.approx(0.7 / 1.75, abs=0.003)
    assert regimes.get_title() == r"$\mu$ = 1"
    assert len(fm.plot_fit(shaken.assign_attrs(config=""))) == 3


def test_a_record_without_frequencies_cannot_be_drawn(shaken):
    with pytest.raises(InputError, match=r"^base_frequency and f_n must be > 0 to be drawn; got 0, 3\."):
        fm.plot_fit(shaken.assign(base_frequency=0.0))


# Sweeps of chains

MASSES, SPRINGS, ZETA, F_K1M1_OF_THREE = [1.0, 0.8, 1.2], [1.0, 1.1, 0.9], [0.01, 0.015, 0.02], 2.9


def chain(f, masses, springs, zeta, f_k1m1, sees_base):
    """X_k/Y of a chain on a shaken base, by its modes: (samples, masses)."""
    M, n = np.diag(masses), len(masses)
    K = np.diag(np.add(springs, [*springs[1:], 0.0])) - np.diag(springs[1:], 1) - np.diag(springs[1:], -1)
    squares, shapes = eigh(K, M)
    w, r = np.sqrt(squares), np.asarray(f)[:, None] / f_k1m1
    damper = 2j * np.array(zeta) * w * r
    answers = (squares + damper * sees_base) / (squares - r**2 + damper)
    return (answers * (shapes.T @ M @ np.ones(n))) @ shapes.T


@pytest.mark.parametrize("sees_base", [True, False])
def test_the_curves_of_a_chain_are_those_of_its_modes(sees_base):
    f = np.concatenate((np.linspace(0.6, 2.0, 14), np.linspace(2.1, 4.0, 20), np.linspace(4.1, 7.0, 20)))
    exact = chain(f, MASSES, SPRINGS, ZETA, F_K1M1_OF_THREE, sees_base)
    rng = np.random.default_rng(1)
    amplitude = {k + 1: np.abs(exact[:, k]) * np.exp(rng.normal(0.0, 0.02, f.size)) for k in (0, 2)}
    lag = {1: -np.degrees(np.angle(exact[:, 0])) + rng.normal(0.0, 1.0, f.size)}
    ds = fm.identify.sweep(
        f, amplitude, lag, masses=3, damping="base" if sees_base else "ground", sigma_amplitude=0.02,
        sigma_phase=1.0,
    )  # fmt: skip
    axes = fm.plot_fit(ds)
    assert [ax.get_ylabel() for ax in axes] == [
        "amplitude of mass 1", "amplitude of mass 3", "lag of mass 1 [deg]", "residual / error"
    ]  # fmt: skip
    f_k1m1, m2, m3, k2, k3, *zeta = ds.estimate.values.tolist()
    for ax, mass, told in zip(
        axes, (0, 2, 0), (np.abs, np.abs, lambda X: -np.degrees(np.angle(X))), strict=False
    ):
        (points,) = (one.get_xydata() for one in ax.lines if len(one.get_xdata()) > 900)
        points = points[np.isfinite(points).all(axis=1)]
        expected = chain(points[:, 0], [1.0, m2, m3], [1.0, k2, k3], zeta, f_k1m1, sees_base)[:, mass]
        np.testing.assert_allclose(points[:, 1], told(expected), rtol=1e-7, atol=1e-7)
    for ax, given in zip(axes, (amplitude[1], amplitude[3], lag[1]), strict=False):
        np.testing.assert_allclose(dots(ax)[0], np.column_stack((f, given)), rtol=1e-12)
    assert_inside_and_apart(axes[0].figure)


def test_chains_that_cannot_be_drawn():
    f = np.linspace(0.5, 8.0, 61)
    exact = np.abs(chain(f, [1.0, 0.9], [1.0, 1.1], [0.0, 0.0], 3.0, True))
    ds = fm.identify.sweep(f, dict(enumerate(exact.T, 1)))
    rendered(fm.plot_fit(ds))
    with pytest.raises(InputError, match=r"^frequency and ratios must be > 0 to be drawn; got -"):
        fm.plot_fit(ds.assign(estimate=-ds.estimate))
    with pytest.raises(InputError, match=r"^data must be logarithms of at most 600 to be drawn; got "):
        fm.plot_fit(ds.assign(data=1e4 + ds.data))


# Slices, axes, refusals


def test_what_lacks_its_parameters_is_drawn_by_its_samples(datasets):
    ds = datasets["decay"]
    part = ds.sel(parameter=["f_n", "x_F"]).isel(sample=slice(0, 100))
    upper, lower = axes = fm.plot_fit(part)
    np.testing.assert_array_equal(line(upper, "fitted"), np.column_stack((part.time, part.model)))
    assert len(upper.collections) == len(lower.collections) == 1  # so few have their errors
    rendered(axes)
    rendered(fm.plot_fit(ds.drop_vars(["time", "sigma"])))
    rendered(fm.plot_fit(datasets["sweep"].isel(sample=[3])))


def test_fits_are_drawn_into_given_axes(datasets):
    axes = Figure().subplots(2, 1)
    np.testing.assert_array_equal(fm.plot_fit(datasets["decay"], axes), axes)
    with pytest.raises(InputError, match=r"^ax must be 2 axes, one for each panel; got 1$"):
        fm.plot_fit(datasets["decay"], axes[:1])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda ds: ds.drop_vars("model"),
            "a dataset must hold model for its fit to be drawn; got no such variable",
        ),
        (lambda ds: ds.assign(data=1e301 * ds.data), r"data must be at most 1e\+300 to be drawn; got"),
        (lambda ds: ds.assign(estimate=-ds.estimate), "must have f_n > 0 and zeta < 1 to be drawn; got -3"),
        (lambda ds: ds.assign(half_cycles=10**9), "must have at most 400 half cycles to be drawn; got 1e"),
        (lambda ds: ds.assign(time=1e4 * ds.time), "must have at most 400 half cycles to be drawn; got"),
        (
            lambda ds: fm.boundaries(fm.System(), [0.5]),
            r"^ds of plot_fit must be .* \(use plot_boundaries\)$",
        ),
    ],
)
def test_what_cannot_be_drawn(datasets, change, message):
    with pytest.raises(InputError, match=message):
        fm.plot_fit(change(datasets["decay"]))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda ds: ds.assign(data=1e3 * ds.data), r"data must be logarithms of at most 600 .*; got \d+"),
        (lambda ds: ds.assign(estimate=0.0 * ds.estimate), "f0, f1 and f2 must be > 0 to be drawn; got 0"),
        (lambda ds: ds.isel(sample=[]), "must have at least one sample for its fit to be drawn; got none"),
    ],
)
def test_sweeps_that_cannot_be_drawn(datasets, change, message):
    with pytest.raises(InputError, match=message):
        fm.plot_fit(change(datasets["sweep"]))


def test_malformed_files_are_drawn_or_refused(datasets, tmp_path):
    """Files changed at random, as far as they can be read: a picture without a warning, or an InputError."""
    write(datasets["decay"], tmp_path / "decay.nc")
    write(datasets["sweep"], tmp_path / "sweep.nc")
    path, drawn = tmp_path / "malformed.nc", 0
    for seed in range(30):
        base, family = tmp_path / ("decay.nc", "sweep.nc")[seed % 2], (STRUCTURE, VALUES)[seed % 4 // 2]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            malformed.make(base, family, seed, path)
        with contextlib.suppress(InputError):
            rendered(fm.plot_fit(read(path)))
            drawn += 1
    assert 7 < drawn < 25


def test_other_pictures_send_fits_here(datasets):
    with pytest.raises(InputError, match=r"^ds of plot_regimes must be .* \(use plot_fit\)$"):
        fm.plot_regimes(datasets["decay"])
    with pytest.raises(
        InputError, match=r"^unknown quantity 'history' in a file of kind estimates; valid: fit$"
    ):
        plot.save_picture(datasets["decay"], Path("no.png"), "history")


def test_the_command_draws_what_identify_wrote(datasets, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write(datasets["decay"], Path("fit.nc"))
    assert cli.main(["plot", "fit.nc"]) == 0
    assert capsys.readouterr().out == "wrote fit.png\n"
    again = rendered(fm.plot_fit(read(Path("fit.nc"))))
    np.testing.assert_array_equal(again, rendered(fm.plot_fit(datasets["decay"])))
