"""The command `design`: what it prints and writes, its files and its pictures."""

import re
import tomllib

import jsonschema
import numpy as np
import pytest
import xarray as xr
from conftest import ROOT
from layouts import assert_inside_and_apart

import frictionmap as fm
from frictionmap.command_line.cli import main
from frictionmap.datasets.design_labels import answer_labels, beta_label
from frictionmap.datasets.questions import records
from frictionmap.design import questions
from frictionmap.design.answers import answer
from frictionmap.design.band import Band
from frictionmap.design.configuration import load_design
from frictionmap.design.questions.keys import BAND, MU
from frictionmap.design.questions.record import Goal, Question
from frictionmap.design.questions.rows import answer_rows
from frictionmap.explorer.goal import describe_goals
from frictionmap.files.designs import describe_design
from frictionmap.files.export import csv_of
from frictionmap.files.json_schema import map_schema
from frictionmap.files.reading import read, standard_form
from frictionmap.files.summary import describe_file
from frictionmap.pictures.maps.working_point import WORKING_POINT
from frictionmap.pictures.palette import LINES
from frictionmap.units.scales import scales_of

CONFIGS = sorted((ROOT / "configs" / "design").glob("*.toml"))
SCHEMA = jsonschema.Draft202012Validator(map_schema())

QUESTION = """\
title = "A damper"
[system]
contact_masses = [2]
mass_ratios = [1.0, 1.0]
stiffness_ratios = [1.0, 1.0]
damping_ratios = 0.05
[units]
natural_frequency = "2 Hz"
load = "50 N"
stiffness = "10 N/mm"
[design]
question = "{}"
band = ["0.8 Hz", "4 Hz"]
spread = 0.1
limit = "14 mm"
beta = {}
r = "1.5 Hz"
"""
QUESTIONS = ("least-peak", "robust", "at-most", "no-stop", "stuck", "margin")


def written(folder, question):
    beta = '"20 N"' if question == "margin" else '["1 N", "200 N"]'
    path = folder / f"{question}.toml"
    path.write_text(QUESTION.format(question, beta))
    return path


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    """The files that the command writes for all questions."""
    folder = tmp_path_factory.mktemp("design")
    found = {}
    for question in QUESTIONS:
        path = folder / f"{question}.nc"
        assert main(["design", str(written(folder, question)), "-o", str(path), "--quiet"]) == 0
        found[question] = path
    return found


@pytest.mark.parametrize("question", QUESTIONS)
def test_files_open_with_plain_xarray_and_read_back(answers, question):
    with xr.open_dataset(answers[question]) as ds:
        assert str(ds.question.values) == question
        assert set(ds.variables) <= set(answer_labels())
        assert ds.attrs["title"] == "A damper"
        plain = ds.load()
    ours = read(answers[question])
    for name in plain.data_vars:
        np.testing.assert_array_equal(ours[name].values, plain[name].values)
    assert describe_file(ours).count("\n") < 40


@pytest.mark.parametrize("question", QUESTIONS)
def test_the_configuration_in_a_file_asks_the_same(answers, question, tmp_path):
    ds = read(answers[question])
    again = tmp_path / "again.toml"
    again.write_text(ds.attrs["config"])
    found = load_design(again).ask()
    np.testing.assert_array_equal(found.beta.values, ds.beta.values)


@pytest.mark.parametrize("question", QUESTIONS)
def test_the_configuration_of_a_python_call_asks_the_same(question, tmp_path):
    system = fm.System(damping_ratios=0.08, mass_ratios=[1, 1], stiffness_ratios=[1, 1], contact_masses=[2])
    band = [0.4, 2.0]
    calls = {
        "least-peak": lambda: fm.design.least_peak(system, band),
        "robust": lambda: fm.design.robust(system, band, 0.1),
        "at-most": lambda: fm.design.at_most(system, band, 3.0),
        "no-stop": lambda: fm.design.no_stop(system, band, 1.2),
        "stuck": lambda: fm.design.stuck(system, band),
        "margin": lambda: fm.design.margin(system, 0.8, 0.4),
    }
    ds = calls[question]()
    path = tmp_path / "again.toml"
    path.write_text(ds.attrs["config"])
    np.testing.assert_allclose(load_design(path).ask().beta, ds.beta, rtol=1e-12)


def test_a_question_is_its_record_alone(monkeypatch, tmp_path):
    """With an entry among the records it has labels, a command, a file, a summary, a picture and a goal."""

    def half_of_stuck(system, band, mu=1.0, *, units=None):
        ds = fm.design.stuck(system, band, mu, units=units)
        found = {"beta": 0.5 * ds.beta, "at_r": ds.at_r, "mu": mu, "whole": ds.beta}
        found |= {name: ds[name].values for name in ("r_search", "beta_stick_of_r")}
        given = Band(*band), found, {"mu": mu}
        return answer("half-of-stuck", system, *given, units, scales_of(units, system))

    own = Question(
        name="half-of-stuck",
        title="Half the friction that holds",
        function=half_of_stuck,
        needed=(BAND,),
        optional=(MU,),
        labels={"whole": beta_label("friction that holds")},
        rows=(answer_rows, lambda ds: iter([("whole", f"{float(ds['whole']):.3f}")])),
        panels=("limits",),
        mark="half of it",
        goal=Goal("half stuck", lambda ds, _: [(0.0, float(ds["beta"]))]),
    )
    monkeypatch.setattr(questions, "RECORDS", (*questions.RECORDS, own))
    for kept in (records, answer_labels):
        kept.cache_clear()
    try:
        path = tmp_path / "half.toml"
        path.write_text(
            '[system]\ndamping_ratios = 0.1\n[design]\nquestion = "half-of-stuck"\nband = [0.5, 1.5]\n'
        )
        assert main(["design", str(path), "-o", str(tmp_path / "half.nc"), "--quiet"]) == 0
        ds = read(tmp_path / "half.nc")
        assert ds.beta == 0.5 * fm.design.stuck(fm.System(damping_ratios=0.1), [0.5, 1.5]).beta
        assert f"whole{' ' * 30}{ds.whole.item():.3f}" in describe_file(ds)
        (ax,) = fm.plot_design(ds)
        assert any("half of it" in text.get_text() for text in ax.figure.legends[0].get_texts())
        assert {
            "key": "half-of-stuck",
            "label": "half stuck",
            "response": False,
            "limit": False,
        } in describe_goals()
    finally:
        monkeypatch.undo()
        for kept in (records, answer_labels):
            kept.cache_clear()


SAMPLES = {"mass_ratios[2]": [0.95, 1.0, 1.04], "stiffness_ratios[2]": [1.0, 1.05, 0.97]}


def test_samples_by_a_configuration_and_a_call_are_the_same(tmp_path, capsys):
    system = fm.System(damping_ratios=0.05, mass_ratios=[1, 1], stiffness_ratios=[1, 1], contact_masses=[2])
    ds = fm.design.robust(system, [0.6, 2.0], fm.design.Samples({"sample": SAMPLES}, 0.6))
    path = tmp_path / "samples.toml"
    path.write_text(ds.attrs["config"])
    assert main(["design", str(path), "-o", str(tmp_path / "samples.nc")]) == 0
    assert "samples" in capsys.readouterr().out
    found = read(tmp_path / "samples.nc")
    np.testing.assert_array_equal(found.peak_of_sample, ds.peak_of_sample)
    assert (found.beta, found["quantile"]) == (ds.beta, 0.6)
    axes = fm.plot_design(found)
    assert_inside_and_apart(axes[0].figure)


def test_the_curve_that_is_drawn_was_minimised_and_goes_through_the_answer():
    """With a spread: the largest response within it, here from a sweep; of samples the one that decides."""
    system = fm.System(damping_ratios=0.05, mass_ratios=[1, 1], stiffness_ratios=[1, 1], contact_masses=[2])
    ds = fm.design.robust(system, [0.6, 2.0], 0.3)
    best = ds.sel(worst_search=ds.beta).worst_of_beta
    np.testing.assert_allclose(best, ds.peak[0], rtol=1e-12)
    assert (ds.worst_of_beta >= best * (1.0 - 1e-9)).all()
    worst = ds.worst_of_beta.sel(worst_search=2.0 * ds.beta, method="nearest")
    beta = worst.worst_search.item() * np.linspace(0.7, 1.3, 13)
    found = fm.sweep(system, np.linspace(0.6, 2.0, 1401), beta, outputs=["amplitude"]).amplitude.sel(dof=1)
    assert worst.item() == pytest.approx(found.max().item(), rel=1e-3)
    performance, responses = fm.plot_design(ds)
    line = performance.lines[0].get_xydata()
    assert np.abs(line - [ds.beta.item(), ds.peak[0].item()]).max(axis=1).min() < 1e-9
    highest = max(np.max(line.get_ydata()) for line in responses.lines if line.get_color() != "#808080")
    assert ds.peak[0] <= highest * (1.0 + 1e-6) <= responses.get_ylim()[1]  # not cut off
    samples = fm.design.robust(system, [0.6, 2.0], fm.design.Samples({"sample": SAMPLES}, 0.6))
    np.testing.assert_allclose(samples.response_of_sample.max(), samples.peak[0], rtol=1e-3)
    own = samples.peak_of_sample.sel(sample=samples.deciding_sample)
    np.testing.assert_allclose(own, samples.peak[0], rtol=1e-9)


def test_the_answer_alone_is_blue_and_has_its_units(answers):
    ds = read(answers["least-peak"])
    axes = fm.plot_design(ds)
    lines = [line for line in axes[1].lines if line.get_linestyle() == "-" and line.get_marker() == "None"]
    blue = [line for line in lines if line.get_color() == LINES[0]]
    (answer,) = blue
    row = int(np.argmin(np.abs(ds.curve.values - ds.beta.item())))
    np.testing.assert_array_equal(answer.get_ydata(), ds.response_of_r[row])
    words = [text.get_text() for text in axes[0].figure.legends[0].get_texts()]
    unit = axes[0].child_axes[0].get_xlabel().partition("[")[2][:-1]  # as on the axis
    force = ds.friction_force.item() / {"N": 1.0, "kN": 1e3}[unit]
    assert any(f"({force:.4g} {unit})" in text for text in words)


@pytest.mark.parametrize("question", QUESTIONS)
def test_pictures_and_tables(answers, question, tmp_path):
    for ending in (".png", ".svg"):
        path = tmp_path / f"answer{ending}"
        assert main(["plot", str(answers[question]), "-o", str(path), "--quiet"]) == 0
        assert path.stat().st_size > 5000
    assert main(["export", str(answers[question]), "-o", str(tmp_path / "answer.csv"), "--quiet"]) == 0
    assert len((tmp_path / "answer.csv").read_text().splitlines()) > 10
    axes = fm.plot_design(read(answers[question]))
    assert_inside_and_apart(axes[0].figure)


@pytest.mark.parametrize("question", QUESTIONS)
def test_tables_have_units_in_their_header(answers, question):
    """P = 50 N, k1 = 10 N/mm, 2 Hz: friction in newtons, frequencies in hertz, peaks in metres."""
    ds = read(answers[question])
    short, every = (csv_of(ds, everything).splitlines() for everything in (False, True))
    head, *rows = (line.split(",") for line in short)
    values = np.array(rows, dtype=float).T
    over_friction = "beta_search" in ds.coords
    over = ("friction_force_N", "beta_search", 50.0), ("frequency_Hz", "r_search", 2.0)
    first, axis, one = over[0 if over_friction else 1]
    assert head[:2] == [first, axis]
    np.testing.assert_allclose(values[0], one * values[1], rtol=1e-12)
    np.testing.assert_array_equal(values[1], ds[axis])
    in_units = {"peak_of_beta": ("m", 0.005)} if over_friction else {"beta_stick_of_r": ("N", 50.0)}
    for name, (unit, size) in in_units.items():
        np.testing.assert_allclose(values[head.index(f"{name}_{unit}")], size * ds[name], rtol=1e-12)
        assert name not in head
        assert {name, f"{name}_{unit}"} <= set(every[0].split(","))


def test_what_is_printed(answers, capsys, tmp_path):
    path = written(tmp_path, "at-most")
    assert main(["design", str(path), "-o", str(tmp_path / "a.nc")]) == 0
    out = capsys.readouterr().out
    first, answer, *table = out.splitlines()
    assert re.fullmatch(rf"A damper: at-most in \S+ s; wrote {re.escape(str(tmp_path / 'a.nc'))}", first)
    assert re.fullmatch(
        r"  From \S+ to \S+ N mass 1 moves at most 14 mm between 0.8 and 4 Hz \(\S+ mm at \S+ N\)\.", answer
    )
    assert [line for line in table if re.match(r"  with 20 % less friction +\S+ mm \(\+\S+ %\)$", line)]
    assert not re.search(r"\binf\b|-0\.0|\d\.\d{7}", out)
    assert out.isascii()
    assert main(["info", str(tmp_path / "a.nc")]) == 0
    info = capsys.readouterr().out
    assert "A damper [design]" in info
    assert "friction for at most 14 mm" in info


def test_answers_in_sentences(answers):
    """The answer first, in units; bounds are rounded to the side on which they hold."""
    said = {question: describe_design(read(answers[question])) for question in QUESTIONS}
    spread = read(answers["robust"])
    nominal = spread.peak_at_offset.sel(offset=0.0).item()
    assert 0.0 < nominal < spread.peak.values[0]
    (regime,) = fm.sweep(load_design_system(answers), [0.75], [0.4]).regime.values.ravel()
    does = ("stays stuck", "sticks and slips", "slides without stops")[regime]
    patterns = {
        "least-peak": r"Set (\S+) N: mass 1 moves at most (\S+) mm between 0\.8 and 4 Hz\.",
        "robust": r"Set (\S+) N \+- 10 %: mass 1 moves at most (\S+) mm between .* Hz \((\S+) mm at .*",
        "no-stop": r"Up to (\S+) N there are no stops between 0\.8 and 4 Hz \(\S+ Hz decides\)\.",
        "stuck": r"From (\S+) N everything is stuck between 0\.8 and 4 Hz \(\S+ Hz decides\)\.",
        "margin": rf"At 1\.5 Hz and 20 N the contact {does}\.",
    }
    found = {question: re.fullmatch(words, said[question][0]) for question, words in patterns.items()}
    assert all(found.values()), said
    force = {question: read(answers[question]).friction_force.item() for question in QUESTIONS}
    assert 0.99 * force["no-stop"] < float(found["no-stop"][1]) <= force["no-stop"]
    assert force["stuck"] <= float(found["stuck"][1]) < 1.01 * force["stuck"]
    peak = 1e3 * spread.peak_m.values[0]
    assert peak <= float(found["robust"][2]) < 1.01 * peak
    assert 5.0 * nominal <= float(found["robust"][3]) < 1.01 * 5.0 * nominal  # 1 is 5 mm


def test_margins_above_and_below_the_working_point(answers):
    """The boundaries in hertz and newtons, and whether they are above or below the working point."""
    ds = read(answers["margin"])
    lines = describe_design(ds)
    for name, words in (("beta_lim", "motion without stops"), ("beta_stick", "permanent sticking")):
        (line,) = (line for line in lines if line.startswith(f"{words}, in friction"))
        side = "above" if ds[name] > ds.beta else "below"
        newtons = f"{50.0 * ds[name].item():.5g} N"
        assert newtons in line
        assert f"{side} the working point ({100.0 * (ds[name] / ds.beta - 1.0).item():+.3g} %)" in line


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("limit=-3", "design.limit must be a number > 0, or a length or force with its unit; got -3"),
        ('limit="0,5 mm"', "design.limit must be a number > 0, .* got '0,5 mm'"),
        ("spread=1.5", "design.spread must be a number from 0 to below 1; got 1.5"),
        ("quantile=2", "design.quantile must be a number above 0, up to 1; got 2"),
        ("band=['4 Hz','0.8 Hz']", "design.band must be two increasing frequencies; got 4 Hz to 0.8 Hz"),
    ],
)
def test_invalid_values_are_refused_by_every_question(key, words, tmp_path):
    with pytest.raises(fm.InputError, match=words):
        load_design(written(tmp_path, "stuck"), [f"design.{key}"]).ask()


def test_units_and_ratios_in_the_file(answers):
    ds = read(answers["at-most"])
    np.testing.assert_allclose(ds.friction_force, 50.0 * ds.beta, rtol=1e-15)
    np.testing.assert_allclose(ds.limit, 2.8, rtol=1e-15)  # 14 mm over 50 N / (10 N/mm)
    np.testing.assert_allclose(ds.peak_m, 5e-3 * ds.peak, rtol=1e-15)
    np.testing.assert_allclose(ds.interval_end_N, 50.0 * ds.interval_end, rtol=1e-15)


def test_the_limit_holds_inside_the_range_and_not_outside(answers):
    ds = read(answers["at-most"])
    system = load_design_system(answers)
    r = np.geomspace(0.4, 2.0, 1500)
    inside = np.array([ds.interval_begin.values[0] * 1.0001, ds.interval_end.values[0] * 0.9999])
    outside = np.array([ds.interval_begin.values[0] * 0.999, ds.interval_end.values[0] * 1.001])
    for beta, holds in ((inside, True), (outside, False)):
        found = fm.sweep(system, r, beta, outputs=["amplitude"]).amplitude.sel(dof=1).max("r")
        assert ((found <= ds.limit.item()) == holds).all()


def load_design_system(answers):
    return fm.System(contact_masses=[2], mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.05)


def test_slices_of_an_answer_are_read(answers):
    ds = read(answers["least-peak"])
    part = standard_form(ds.isel(peak=slice(0, 1), beta_search=slice(5, 20)))
    assert part.sizes["beta_search"] == 15
    wrong = ds.isel(beta_search=slice(None, None, -1))
    with pytest.raises(fm.InputError, match="beta_search must be strictly increasing"):
        standard_form(wrong)


@pytest.mark.parametrize("path", CONFIGS, ids=lambda path: path.stem)
def test_configurations_of_designs(path):
    tree = tomllib.loads(path.read_text(encoding="utf-8"))
    assert not list(SCHEMA.iter_errors(tree))
    assert load_design(path).question == tree["design"]["question"]
    assert fm.load_config(path).r.size > 10  # the same file is one of a map


def test_a_curve_of_zeros_is_drawn(answers):
    """As of a part of a file in which nothing moves: an axis from 0 to 0 would be one from -0.05 to 0.05."""
    ds = read(answers["least-peak"])
    ds["peak_of_beta"], ds["peak"] = 0.0 * ds.peak_of_beta, 0.0 * ds.peak
    ax = fm.plot_design(ds.drop_vars("limit", errors="ignore"))[0]
    assert ax.get_ylim() == (0.0, 1.0)


def test_a_working_point_is_drawn_where_it_is(answers):
    ds = read(answers["margin"])
    (ax,) = fm.plot_design(ds)
    marks = [line.get_xydata() for line in ax.lines if line.get_marker() == WORKING_POINT["marker"]]
    np.testing.assert_allclose(marks[0], [[ds.at_r.item(), ds.beta.item()]])
