"""The page of systems with several contacts, springs, belts and periodic loads: what its server computes."""

import numpy as np
import pytest
import xarray as xr
from pages import ask, packet, scene_from, served

import frictionmap as fm
from frictionmap import regimes
from frictionmap.explorer import stored
from frictionmap.files.config import config_of
from frictionmap.pictures.classes import of_cells
from frictionmap.pictures.palette import ONE_WAY

GRID = "[grid]\nr = [0.3, 1.8]\nbeta = [0.0, 1.2]\n"
TWO = (
    """\
title = "Two braces"
[system]
excitation = "base"
mass_ratios = [1.0, 1.0]
stiffness_ratios = [1.0, 1.0]
damping_ratios = 0.02
[[system.contacts]]
name = "lower brace"
kind = "joined-base-wall"
masses = [1]
[[system.contacts]]
name = "upper brace"
kind = "between-masses"
masses = [1, 2]
ratio = 0.5
"""
    + GRID
)
ELASTIC = "[system]\ndamping_ratios = 0.02\ncontact_stiffness = 1.0\n" + GRID
BELT = "[system]\ndamping_ratios = 0.02\nwall_velocity = 0.5\n" + GRID
SQUARE = '[system]\ndamping_ratios = 0.02\nwaveform = "square"\nharmonics = 7\n' + GRID
FREE = '[system]\ncontact = "joined-base-wall"\nstiffness_ratios = [0]\n' + GRID


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """Servers and systems by name."""
    with (
        served(scene_from(tmp_path_factory.mktemp("two"), TWO)) as two,
        served(scene_from(tmp_path_factory.mktemp("elastic"), ELASTIC)) as elastic,
        served(scene_from(tmp_path_factory.mktemp("belt"), BELT)) as belt,
        served(scene_from(tmp_path_factory.mktemp("square"), SQUARE)) as square,
        served(scene_from(tmp_path_factory.mktemp("free"), FREE)) as free,
    ):
        yield {"two": two, "elastic": elastic, "belt": belt, "square": square, "free": free}


def middles(low, high, count):
    half = (high - low) / (2 * count)
    return np.linspace(low + half, high - half, count)


R, BETA = middles(0.3, 1.8, 12), middles(0.0, 1.2, 9)
PIECE = "columns=12&rows=9&r=0.3,1.8&beta=0,1.2"


def swept(page, *outputs, mu=1.0):
    solver = fm.Solver(outputs=("regime", *outputs))
    return fm.sweep(page.page.scene.system, R, BETA, mu, solver=solver).isel(mu=0)


def test_all_contacts_together_have_the_regime_of_sweep(pages):
    ds = swept(pages["two"])
    header, arrays = packet(pages["two"], f"/map?{PIECE}")
    np.testing.assert_array_equal(arrays["classes"], of_cells(ds.regime.values, None))
    for name in ("beta_lim", "beta_stick"):
        np.testing.assert_array_equal(arrays[name], ds[name].values)
    labels = [look["label"] for look in header["about"]["classes"]]
    assert labels[regimes.CONTINUOUS] == "no contact stops"
    assert header["about"]["contact"] == ""


@pytest.mark.parametrize(
    "name", ["stops_per_cycle", "turns_per_cycle", "stuck_fraction", "contact_peak_to_peak", "work_friction"]
)
@pytest.mark.parametrize("k", [0, 1])
def test_a_chosen_contact_has_the_cells_of_sweep(pages, name, k):
    ds = swept(pages["two"], "stops_per_cycle", name).isel(contact=k)
    header, arrays = packet(pages["two"], f"/map?{PIECE}&contact=contact-{k + 1}&quantity={name}")
    right = of_cells(ds.contact_regime.values, ds.stops_per_cycle.values)
    np.testing.assert_array_equal(arrays["classes"], right)
    np.testing.assert_array_equal(arrays["values"], ds[name].values.astype(np.float32))
    np.testing.assert_array_equal(arrays["beta_stick"], ds.beta_stick_contact.values)
    assert header["about"]["contact"] == ("lower brace", "upper brace")[k]


@pytest.mark.parametrize("name", ["amplitude_2", "multiplier", "period", "work_friction"])
def test_quantities_of_all_contacts_are_those_of_sweep(pages, name):
    output = name.removesuffix("_2")
    values = swept(pages["two"], output)[output]
    values = values.isel(dof=1) if output == "amplitude" else values
    values = values.sum("contact", skipna=False) if output == "work_friction" else values
    _, arrays = packet(pages["two"], f"/map?{PIECE}&quantity={name}")
    np.testing.assert_array_equal(arrays["values"], values.values.astype(np.float32))


@pytest.mark.parametrize(
    "name", ["slips_per_cycle", "slip_reversals_per_cycle", "elastic_fraction", "contact_amplitude"]
)
def test_an_elastic_contact_slips(pages, name):
    ds = swept(pages["elastic"], "slips_per_cycle", name)
    header, arrays = packet(pages["elastic"], f"/map?{PIECE}&quantity={name}&lines=12")
    right = of_cells(ds.regime.values, ds.slips_per_cycle.values)
    np.testing.assert_array_equal(arrays["classes"], right)
    np.testing.assert_array_equal(arrays["values"], ds[name].values.astype(np.float32))
    for line in ("beta_noslip", "line_noslip"):
        np.testing.assert_array_equal(arrays[line], ds.beta_noslip.values)
    assert [line["lower"] for line in header["about"]["lines"]] == ["noslip"]
    assert header["about"]["events"] == "slips"


def test_a_belt_pulls_one_way(pages):
    ds = swept(pages["belt"], "stops_per_cycle")
    header, arrays = packet(pages["belt"], f"/map?{PIECE}")
    np.testing.assert_array_equal(arrays["classes"], of_cells(ds.regime.values, ds.stops_per_cycle.values))
    assert (arrays["classes"] == ONE_WAY).any()
    assert header["about"]["classes"][ONE_WAY]["label"] == "one-way sliding"
    np.testing.assert_array_equal(arrays["beta_lim"], ds.beta_lim.values)
    assert "beta_stick" not in arrays  # the belt takes a stuck mass along


def test_a_block_without_a_spring_is_shown(pages):
    ds = swept(pages["free"], "stops_per_cycle")
    _, arrays = packet(pages["free"], f"/map?{PIECE}&lines=12")
    np.testing.assert_array_equal(arrays["classes"], of_cells(ds.regime.values, ds.stops_per_cycle.values))
    for name in ("beta_lim", "beta_stick"):
        np.testing.assert_array_equal(arrays[name], ds[name].values)


@pytest.mark.parametrize("name", ["two", "elastic", "belt", "square"])
def test_boundaries_without_a_search_come_first(pages, name):
    """Sticking and slipping are closed forms at once; motions are followed for the others, which are NaN."""
    _, known = packet(pages[name], "/lines?count=12&known=")
    _, whole = packet(pages[name], "/lines?count=12")
    assert known.keys() == whole.keys()
    for line in whole.keys() & {"line_stick", "line_noslip"}:
        np.testing.assert_array_equal(known[line], whole[line])
        assert not np.isnan(known[line]).any()
    if "line_lim" in whole:
        assert np.isnan(known["line_lim"]).all()
        assert not np.isnan(whole["line_lim"]).any()


def test_further_ranges_without_stops_are_those_of_sweep(pages):
    ds = swept(pages["square"])
    _, arrays = packet(pages["square"], f"/map?{PIECE}")
    begins, ends = ds.no_stop_begin.values, ds.no_stop_end.values
    for k in range(begins.shape[1]):
        further = begins[:, k] != 0.0
        for name, values in ((f"no_stop_begin_{k + 1}", begins), (f"no_stop_end_{k + 1}", ends)):
            np.testing.assert_array_equal(arrays[name], np.where(further, values[:, k], np.nan))


@pytest.mark.parametrize(("name", "r", "beta"), [("two", 0.6, 0.6), ("two", 0.9, 0.3), ("two", 0.5, 1.1)])
def test_a_cell_has_the_motion_of_response(pages, name, r, beta):
    page = pages[name]
    ds = fm.response(page.page.scene.system, r, beta, points=400)
    header, arrays = packet(page, f"/motion?at={r},{beta}")
    assert header["contacts"] == ["lower brace", "upper brace"]
    assert header["others"] is False
    for trace in ("z", "friction", "x"):
        np.testing.assert_array_equal(arrays[trace], ds[trace].values.astype(np.float32))
    np.testing.assert_array_equal(arrays["direction"], ds.direction.values)
    named = [(entry["name"], entry["group"]) for entry in header["entries"]]
    for k, contact in enumerate(header["contacts"]):
        place = named.index(("contact_peak_to_peak", contact))
        assert arrays["numbers"][place] == ds.contact_peak_to_peak.values[k]


def test_a_cell_of_one_contact_shows_that_one(pages):
    ds = fm.response(pages["two"].page.scene.system, 0.6, 0.6, points=400)
    header, arrays = packet(pages["two"], "/motion?at=0.6,0.6&contact=contact-2")
    assert header["contacts"] == []
    assert header["contact"] == "upper brace"
    np.testing.assert_array_equal(arrays["z"], ds.z.values[1].astype(np.float32))
    harmonics = np.hypot(*ds.friction_harmonic.values[1].T).astype(np.float32)
    np.testing.assert_array_equal(arrays["friction_harmonics"], harmonics)
    assert {entry["group"] for entry in header["entries"]} == {"upper brace", "masses and all contacts"}


@pytest.mark.parametrize(
    ("name", "words"), [("elastic", "slips per cycle"), ("belt", "stop"), ("square", "stop"), ("free", "")]
)
def test_one_contact_has_plain_curves(pages, name, words):
    ds = fm.response(pages[name].page.scene.system, 0.8, 0.5, points=400)
    header, arrays = packet(pages[name], "/motion?at=0.8,0.5")
    assert words in header["summary"][0]
    for trace in ("z", "friction", "x"):
        np.testing.assert_array_equal(arrays[trace], ds[trace].values.astype(np.float32))


@pytest.mark.parametrize(("along", "place"), [("r", 0.4), ("beta", 0.7)])
def test_a_cut_is_that_of_curves(pages, along, place):
    places = {"r": [place], "beta": [place], along: R if along == "r" else BETA}
    ds = fm.curves(
        pages["two"].page.scene.system, places["r"], places["beta"], quantities=("amplitude", "energy")
    )
    count = places[along].size
    query = f"along={along}&place={place}&count={count}&r=0.3,1.8&beta=0,1.2"
    header, arrays = packet(pages["two"], f"/cut?{query}")
    other = {"mu": 0, "beta" if along == "r" else "r": 0}
    assert header["contacts"] == ["lower brace", "upper brace"]
    for name in ("contact_amplitude", "work_friction", "amplitude"):
        right = ds[name].isel(other, missing_dims="ignore").values.T.astype(np.float32)
        np.testing.assert_array_equal(arrays[name], right)


@pytest.mark.parametrize(
    ("name", "key", "value", "changes"),
    [
        ("two", "contacts[2].ratio", 1.25, None),
        ("elastic", "contact_stiffness", 2.0, {"contact_stiffness": 2.0}),
        ("belt", "wall_velocity", 0.25, {"wall_velocity": 0.25}),
    ],
)
def test_a_slider_changes_the_system(pages, name, key, value, changes):
    page = pages[name]
    text = TWO.replace("ratio = 0.5", f"ratio = {value}") if changes is None else None
    system = config_of(text, {}).system if text else fm.System(damping_ratios=0.02, **changes)
    ds = fm.sweep(system, R, BETA, solver=fm.Solver(outputs=("regime", "multiplier"))).isel(mu=0)
    _, arrays = packet(page, f"/map?{PIECE}&{key}={value}&quantity=multiplier")
    np.testing.assert_array_equal(arrays["values"], ds.multiplier.values.astype(np.float32))
    assert key in [slider.key for slider in page.page.scene.sliders]


def test_what_is_not_offered_has_no_slider_and_is_refused(pages):
    keys = [slider.key for slider in pages["elastic"].page.scene.sliders]
    assert "mu" not in keys
    status, body, _ = ask(pages["elastic"], f"/map?{PIECE}&mu=1.5")
    assert (status, body.decode().count("\n")) == (400, 1)
    assert "got 1.5" in body.decode()
    status, body, _ = ask(pages["two"], "/others?at=0.6,0.6")
    assert status == 400
    assert "compare initial states" in body.decode()
    status, body, _ = ask(pages["two"], f"/map?{PIECE}&contact=contact-3")
    assert status == 400
    assert "contact-3" in body.decode()


@pytest.mark.parametrize("name", ["two", "elastic", "belt", "square"])
def test_a_configuration_gives_the_view_again(pages, name):
    status, body, _ = ask(pages[name], f"/configuration.toml?{PIECE}")
    assert status == 200, body
    config = config_of(body.decode(), {})
    again = fm.sweep(config.system, config.r, config.beta, config.mu, outputs=("multiplier",)).isel(mu=0)
    np.testing.assert_array_equal(again.multiplier.values, swept(pages[name], "multiplier").multiplier.values)


def test_cells_as_files_have_every_contact(pages, tmp_path):
    query = f"{PIECE}&contact=contact-2&quantity=stuck_fraction"
    ds = swept(pages["two"], "stuck_fraction")
    status, body, _ = ask(pages["two"], f"/map.nc?{query}")
    assert status == 200
    (tmp_path / "map.nc").write_bytes(body)
    with xr.open_dataset(tmp_path / "map.nc") as saved:
        np.testing.assert_array_equal(saved.stuck_fraction.isel(mu=0).values, ds.stuck_fraction.values)
    status, body, _ = ask(pages["two"], f"/map.csv?{query}")
    lines = body.decode().splitlines()
    names, first = lines[0].split(","), lines[1].split(",")
    assert {"contact_regime_2", "stuck_fraction_1", "stuck_fraction_2"} <= set(names)
    assert len(lines) == 1 + R.size * BETA.size
    found = first[names.index("contact_regime_2")]
    assert found == regimes.regime_name(int(ds.contact_regime.values[0, 0, 1]))


def test_a_page_as_a_file_is_written(pages, monkeypatch):
    monkeypatch.setattr(stored, "_CELLS", {False: (8, 6), True: (8, 6)})
    monkeypatch.setattr(stored, "_PLACES", 2)
    for name in ("elastic", "two"):
        text = stored.write_page(pages[name].page.scene, lambda done, total: None).decode()
        assert "beta_noslip" in text if name == "elastic" else "all contacts can stay stuck" in text
