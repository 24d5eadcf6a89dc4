"""The pictures of the gallery are made again as numbers, and show what they showed.

That they showed what is right, the tests beside this one say, and here a march that knows no formula, for
some cells of each kind.
"""

import sys
from dataclasses import replace

import numpy as np
import pytest
from conftest import ROOT

import frictionmap as fm
from benchmarks.references.naive import naive_steady_state
from frictionmap.pictures.palette import CLASSES, CONTINUOUS, ONE, STUCK

sys.path.append(str(ROOT / "docs"))
import picture_data

#: By the contacts of `System`, as the march has them.
CONTACTS = {"fixed-wall": "wall", "joined-base-wall": "base", "between-masses": "masses"}


def test_every_configuration_is_a_figure():
    assert {path.stem for path in picture_data.DATA.iterdir()} == set(picture_data.FIGURES)
    assert len(picture_data.FIGURES) >= 51
    assert sum(path.stat().st_size for path in picture_data.DATA.iterdir()) < 500_000


@pytest.mark.parametrize("name", picture_data.FIGURES)
def test_the_picture_shows_what_it_showed(name):
    assert picture_data.differences(name, picture_data.coarse(name)) == []


@pytest.mark.parametrize("name", picture_data.FIGURES)
def test_nearly_all_cells_are_compared(name):
    with np.load(picture_data.DATA / f"{name}.npz") as known:
        compared = (known["class"] != picture_data.ANY).mean()
    assert compared > 0.9


# A changed map fails


@pytest.mark.parametrize("name", ["fig-2-5", "fig-3-5", "fig-3-14", "fig-6-24", "fig-7-5-zeta-0.1"])
def test_a_map_of_another_mu_fails(name):
    config = fm.load_config(picture_data.CONFIGS / f"{name}.toml")
    ds = picture_data.coarse(name)
    other = picture_data.compute(replace(config, mu=1.01 * config.mu), ds.r.values, ds.beta.values)
    found = picture_data.differences(name, other.assign_coords(mu=config.mu))
    assert any(text.startswith("beta_stick differs") for text in found)
    assert any(text.startswith(("class differs", "amplitude differs")) for text in found)


@pytest.mark.parametrize(
    ("variable", "change"),
    [
        ("regime", lambda values: np.where(values == 1, 2, 1).astype(values.dtype)),
        ("stops_per_cycle", lambda values: values + 1),
        ("contact_amplitude", lambda values: values * (1.0 + 1e-5)),
        ("beta_lim", lambda values: values * (1.0 + 1e-5)),
        ("beta_stick", lambda values: values + 1e-5),
    ],
)
def test_one_changed_value_fails(variable, change):
    ds = picture_data.coarse("fig-3-12").copy(deep=True)
    slips = np.argwhere(ds.regime.values == 1)
    place = tuple(slips[len(slips) // 2])[: ds[variable].ndim]
    ds[variable].values[place] = change(ds[variable].values[place])
    (text,) = picture_data.differences("fig-3-12", ds)
    name = "class" if variable in ("regime", "stops_per_cycle") else variable
    assert text.startswith(f"{name} differs in 1 places, at {tuple(int(index) for index in place)}")


@pytest.mark.parametrize("variable", ["amplitude", "phase_lag"])
def test_one_changed_point_of_a_curve_fails(variable):
    ds = picture_data.coarse("fig-6-13").copy(deep=True)
    ds[variable].values[0, 5, 1, 0] += 1e-4
    (text,) = picture_data.differences("fig-6-13", ds)
    assert text.startswith(f"{variable} differs in 1 places, at (0, 5, 1, 0)")


def test_one_changed_instant_of_a_motion_fails():
    ds = picture_data.coarse("fig-7-10-zeta-0.01").copy(deep=True)
    ds["z"].values[40] += 1e-5
    (text,) = picture_data.differences("fig-7-10-zeta-0.01", ds)
    assert text.startswith("z differs in 1 places, at (1,)")


def test_another_grid_and_other_quantities_fail():
    ds = picture_data.coarse("fig-2-5")
    assert picture_data.differences("fig-2-5", ds.isel(r=slice(1, None))) == ["its axis r lacks values"]
    (text,) = picture_data.differences("fig-2-5", ds.drop_vars("contact_amplitude"))
    assert "contact_amplitude" in text


def test_a_figure_of_another_system_fails():
    config = fm.load_config(picture_data.CONFIGS / "fig-7-4-zeta-0.001.toml")
    ds = picture_data.coarse("fig-7-4-zeta-0.001")
    other = replace(config.system, damping_ratios=0.002)
    changed = picture_data.compute(replace(config, system=other), ds.r.values, ds.beta.values)
    (text, *_) = picture_data.differences("fig-7-4-zeta-0.001", changed)
    assert text.startswith("class differs in")


# It is right


@pytest.mark.parametrize(
    "name",
    [
        "fig-2-5", "fig-3-5", "fig-3-12", "fig-3-13", "fig-6-7", "fig-6-14", "fig-6-24",
        "fig-6-26", "fig-7-4-zeta-0.01", "fig-7-7-zeta-0.1", "rig",
    ],
)  # fmt: skip
def test_some_cells_are_what_a_march_finds(name):
    """One stuck, one continuous, and two that stick and slip, of mu = 1, where the start is all the same."""
    system = fm.load_config(picture_data.CONFIGS / f"{name}.toml").system
    with np.load(picture_data.DATA / f"{name}.npz") as known:
        kept = dict(known)
    found, r, beta = kept["class"][0], kept["r"], kept["beta"]
    sizes = kept["contact_amplitude"][0]
    rng = np.random.default_rng(20 + len(name))
    for wanted, how_many in ((STUCK, 1), (CONTINUOUS, 1), (ONE + 1, 2)):
        cells = np.argwhere((found == wanted) & (r[:, None] > 0.3) & (beta > 0.1))
        assert cells.size, CLASSES[wanted].label
        compared = 0
        for i, j in rng.permutation(cells)[:10]:
            marched = naive_steady_state(
                gamma=system.mass_ratios, kappa=system.stiffness_ratios, zeta=system.damping_ratios,
                contact=(CONTACTS[system.contact], *system.contact_masses), load=system.load_mass,
                r=float(r[i]), beta=float(beta[j]),
            )  # fmt: skip
            if marched.status == "unconverged":  # after 400 periods, which says nothing
                continue
            where = f"r = {r[i]:g}, beta = {beta[j]:g}"
            assert (marched.status == "stuck") == (wanted == STUCK), where
            if wanted != STUCK:
                assert marched.stops == (0 if wanted == CONTINUOUS else 2), where
                assert sizes[i, j] == pytest.approx(marched.Z, rel=1e-6), where
            compared += 1
            if compared == how_many:
                break
        assert compared == how_many
