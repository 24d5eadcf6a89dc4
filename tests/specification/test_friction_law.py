"""Friction over speed: break points, formulas, files, units, and what is refused."""

import numpy as np
import pytest
from pages import packet, scene_from, served

import frictionmap as fm
from frictionmap.model.friction_law import SHAPES, FrictionLaw, formula_law
from frictionmap.pictures.classes import of_cells

#: Deviations for 3, 5, 8, 12, 20 segments, from an independent calculation.
DEVIATIONS = {
    "exponential": (0.067, 0.023, 0.0087, 0.0038, 0.0013),
    "gauss": (0.070, 0.024, 0.0090, 0.0039, 0.0013),
    "hyperbolic": (0.068, 0.024, 0.0095, 0.0042, 0.0015),
}


@pytest.mark.parametrize("formula", DEVIATIONS)
def test_segments_have_the_known_deviation(formula):
    """One segment less deviates by at least a tenth more, which the two known digits distinguish."""
    for segments, expected in zip((3, 5, 8, 12, 20), DEVIATIONS[formula], strict=True):
        law = formula_law(formula, 0.0, 1.0, 0.0, 1.06 * expected)
        assert len(law.speed) == segments + 1
        assert law.error == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize("formula", SHAPES)
def test_break_points_are_on_the_curve(formula):
    law = formula_law(formula, 0.6, 0.3, 0.2, 0.004)
    v = np.array(law.speed)
    exact = 0.6 + 0.4 * SHAPES[formula].value(v / 0.3) + 0.2 * v
    assert np.abs(np.array(law.factor) - exact).max() < 1e-14
    fine = np.linspace(0.0, v[-1], 50001)
    found = np.abs(law(fine) - (0.6 + 0.4 * SHAPES[formula].value(fine / 0.3) + 0.2 * fine)).max()
    assert found == pytest.approx(law.error, rel=1e-3)
    assert law.error <= 0.004


@pytest.mark.parametrize(
    ("law", "message"),
    [
        ({"speed": [0.1, 0.5], "factor": [1.0, 0.7]}, "law.speed must begin with 0"),
        ({"speed": [0.0, 0.5], "factor": [0.9, 0.7]}, "law.factor must begin with 1"),
        ({"speed": [0.0, 0.5, 0.5], "factor": [1.0, 0.7, 0.7]}, "law.speed must increase"),
        ({"speed": [0.0, 0.5], "factor": [1.0, -0.1]}, "law.factor must be >= 0"),
        ({"speed": [0.0, 0.5], "factor": [1.0, 0.7], "slope": -0.1}, "law.slope must be >= 0"),
        ({"speed": list(range(25)), "factor": [1.0] * 25}, "at most 24"),
        ({"speed": [0.0, 0.5], "factor": [1.0]}, "as many values as speed"),
        ({"speed": [0.0]}, "law.factor must be given"),
        ({"formula": "stribeck", "kinetic": 0.7, "speed": 0.1}, "law.formula"),
        ({"formula": "gauss", "kinetic": 0.7, "speed": 0.1, "error": 1e-5}, "law.error must be >="),
        ({"speed": [0.0], "factors": [1.0]}, "unknown key 'law.factors'"),
        (0.7, "law must be"),
    ],
)
def test_a_wrong_law_is_refused_by_its_key(law, message):
    with pytest.raises(fm.InputError) as error:
        fm.Contact(law=law)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("key", [{"stiffness": 2.0}, {"normal_load": {1: 0.2}}])
def test_a_law_excludes_springs_and_varying_normal_loads(key):
    with pytest.raises(fm.InputError, match="cannot use law with"):
        fm.Contact(law={"speed": [0.0, 0.5], "factor": [1.0, 0.7]}, **key)


def test_a_law_file_is_the_table(tmp_path):
    path = tmp_path / "law.csv"
    path.write_text("speed,factor\n0,1\n0.5,0.7\n")
    assert fm.Contact(law_file=path).law == FrictionLaw((0.0, 0.5), (1.0, 0.7))
    path.write_text("speed,factor\n0.5,0.7\n")
    with pytest.raises(fm.InputError, match="law_file: speed must begin with 0"):
        fm.Contact(law_file=path)


def test_speeds_of_a_law_may_have_units():
    """omega_1 P/k_1 is 1 m/s here."""
    units = fm.Units(natural_frequency="1 Hz", load="1 N", stiffness=f"{2 * np.pi} N/m")
    contact = {"law": {"speed": ["0 m/s", "500 mm/s"], "factor": [1.0, 0.7], "slope": 0.1}}
    system, _ = fm.system_in_units(units=units, contacts=[contact])
    assert system.contacts[0].law.speed[1] == pytest.approx(0.5, rel=1e-14)


LAWFUL = fm.System(contacts=[fm.Contact(law={"speed": [0.0, 0.5], "factor": [1.0, 0.7]})])


def test_what_is_not_offered_names_the_law():
    with pytest.raises(fm.InputError, match=r"cannot find friction without stops with contacts\[1\].law"):
        fm.design.no_stop(LAWFUL, (0.5, 1.5))


def test_boundaries_with_a_law_are_those_that_it_leaves():
    """Static friction decides whether a contact sticks; friction without stops is not a closed form."""
    ds = fm.boundaries(LAWFUL, [0.5, 1.5])
    flat = fm.boundaries(fm.System(contacts=[fm.Contact()]), [0.5, 1.5])
    assert ds.beta_stick.values.tolist() == flat.beta_stick.values.tolist()
    assert "beta_lim" not in ds


def test_the_page_shows_systems_with_a_law(tmp_path):
    """Classes of the map are those of `sweep`; of the boundaries only that to permanent sticking is drawn."""
    law = "law = { speed = [0.0, 0.5], factor = [1.0, 0.7] }"
    text = f"[system]\n[[system.contacts]]\n{law}\n[grid]\nr = [0.3, 1.8]\nbeta = [0.0, 1.2]\n"
    with served(scene_from(tmp_path, text)) as page:
        _, arrays = packet(page, "/map?columns=4&rows=3&r=0.4,1.6&beta=0.1,0.7")
        system = page.page.scene.system
    ds = fm.sweep(system, [0.55, 0.85, 1.15, 1.45], [0.2, 0.4, 0.6], outputs=["regime", "stops_per_cycle"])
    expected = of_cells(ds.regime.values[0], ds.stops_per_cycle.values[0])
    assert arrays["classes"].tolist() == expected.tolist()
    assert "beta_lim" not in arrays
    assert arrays["beta_stick"] == pytest.approx(ds.beta_stick.values[0], rel=1e-12)


def test_segments_of_contacts_without_a_law_are_left_out():
    plain = fm.System(contact_stiffness=3.0)
    ds = fm.sweep(plain, [0.5], [0.5], outputs=["regime", "segment_fraction"])
    assert "segment_fraction" not in ds
    assert "segment" not in ds.dims
