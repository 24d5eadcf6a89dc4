"""`ds.frictionmap`, and descriptions of objects in notebooks."""

import json
import subprocess
import sys

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr

import frictionmap as fm
from frictionmap import InputError
from frictionmap.command_line.cli import main

TWO = fm.System(mass_ratios=[1.0, 2.0], stiffness_ratios=[1.0, 1.0])


@pytest.fixture(scope="module")
def mapped():
    return fm.sweep(fm.System(), np.linspace(0.2, 1.5, 14), np.linspace(0.1, 1.2, 12), [1.0, 1.5])


def test_names_of_regimes(mapped):
    labels = mapped.frictionmap.labels
    assert labels.dims == mapped.regime.dims
    codes = {"permanent-sticking": 0, "stick-slip": 1, "continuous": 2}
    assert set(np.unique(labels)) == set(codes)
    for name, code in codes.items():
        assert ((labels == name) == (mapped.regime == code)).all()
    assert labels.sel(mu=1.0, r=0.5, beta=1.2, method="nearest").item() == "permanent-sticking"


def test_a_summary_is_what_info_prints(mapped, tmp_path, capsys):
    answer = fm.design.stuck(fm.System(damping_ratios=0.05), [0.5, 1.5])
    for ds in (mapped, answer):
        path = tmp_path / "one.nc"
        ds.to_netcdf(path)
        assert main(["info", str(path)]) == 0
        summary = ds.frictionmap.summary()
        assert capsys.readouterr().out.rstrip() == summary.rstrip()
        assert summary._repr_html_().startswith("<pre>")
    assert "friction                           beta = 1\n" in summary
    assert repr(summary) == summary


@pytest.mark.parametrize("name", ["stick-slip", "stick_slip", "stick slip"])
def test_cells_of_a_regime(mapped, name):
    found = mapped.frictionmap.where_regime(name)
    there = (mapped.regime == 1).values
    assert (np.isfinite(found.stops_per_cycle.values) == there).all()
    assert (found.contact_amplitude.values[there] == mapped.contact_amplitude.values[there]).all()
    assert found.beta_lim.equals(mapped.beta_lim)


@pytest.fixture(scope="module")
def of_contacts():
    """A map of two contacts, in which they do different things."""
    contacts = [fm.Contact("fixed-wall", 1, ratio=0.5), fm.Contact("between-masses", (1, 2), name="joint")]
    system = fm.System(
        contacts=contacts, mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.05, load_mass=2
    )
    ds = fm.sweep(system, np.linspace(0.3, 1.5, 9), np.linspace(0.1, 1.5, 9), 1.0)
    assert (ds.contact_regime != ds.regime).any(["mu", "r", "beta"]).all()
    return ds


@pytest.mark.parametrize("number", [1, 2])
def test_regimes_of_a_contact_that_was_chosen(of_contacts, number, tmp_path, capsys):
    """Names, cells and counts are those of the contact, as in its picture."""
    one, codes = of_contacts.sel(contact=number), {"permanent-sticking": 0, "stick-slip": 1, "continuous": 2}
    path = tmp_path / "two.nc"
    of_contacts.to_netcdf(path)
    for name, code in codes.items():
        there = one.contact_regime.values == code
        assert ((one.frictionmap.labels == name).values == there).all()
        kept = one.frictionmap.where_regime(name).contact_amplitude.values
        np.testing.assert_array_equal(kept[there], one.contact_amplitude.values[there])
        assert np.isnan(kept[~there]).all()
        assert ((of_contacts.frictionmap.labels == name) == (of_contacts.regime == code)).all()
    counts = {name.replace("-", " "): int((one.contact_regime == code).sum()) for name, code in codes.items()}
    assert main(["info", str(path), "--at", f"contact={number}"]) == 0
    lines = capsys.readouterr().out.splitlines()
    found = ", ".join(f"{count} {name}" for name, count in counts.items() if count)
    assert f"81 cells ({found})" in lines
    assert main(["info", str(path), "--json", "--at", f"contact={number}"]) == 0
    cells = json.loads(capsys.readouterr().out)["cells"]
    assert cells == {name.replace(" ", "_"): count for name, count in counts.items() if count}


def test_pictures(mapped):
    both = mapped.frictionmap.plot(size="85mm"), fm.plot_regimes(mapped, size="85mm")
    figures = [axes[0].figure for axes in both]
    assert figures[0].get_size_inches().tolist() == figures[1].get_size_inches().tolist()
    axes = mapped.frictionmap.plot("contact_amplitude", log=True)
    assert isinstance(axes[0].figure.axes[-1].collections[-1].norm, mpl.colors.LogNorm)


def test_refusals(mapped):
    with pytest.raises(InputError, match=r"^unknown regime 'stuck' .*; valid: unresolved, "):
        mapped.frictionmap.where_regime("stuck")
    with pytest.raises(InputError, match=r"^unknown regime 3; valid: "):
        mapped.frictionmap.where_regime(3)
    with pytest.raises(InputError, match=r"^cannot find regimes: the dataset has no variable regime; "):
        _ = mapped.drop_vars("regime").frictionmap.labels


@pytest.mark.parametrize(
    "imports",
    [
        "import xarray as xr; import frictionmap as fm",
        "import frictionmap as fm; import xarray as xr; fm.sweep",
    ],
)
def test_datasets_from_files_have_it_too(imports):
    code = f"{imports}; print(xr.Dataset({{'regime': ('x', [1])}}).frictionmap.labels.item())"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=300, check=True
    )
    assert done.stdout == "stick-slip\n"


def test_the_friction_force_of_a_motion_keeps_its_name():
    ds = fm.response(fm.System(), 0.3, 0.5)
    assert isinstance(ds.friction, xr.DataArray)
    assert ds.frictionmap.labels.item() == "stick-slip"


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (
            fm.System(mass_ratios=[1.0, 2.0], stiffness_ratios=[1.0, 1.0]),
            ["System", "chain of 2 masses (1, 2)"],
        ),
        (fm.Solver(cycles=77, outputs=["regime", "period"]), ["Solver", "77", "regime, period"]),
        (fm.Units(natural_frequency="4.2 Hz", load="3 N"), ["Units", "4.2 Hz", "3 N"]),
    ],
)
def test_notebooks_show_what_an_object_is(given, words):
    html = given._repr_html_()
    assert html.startswith("<table>")
    assert all(word in html for word in words)
    assert "None" not in html


def test_natural_frequencies_of_a_system():
    assert ", ".join(f"{w:.5g}" for w in TWO.modes.w) in TWO._repr_html_()


def test_texts_are_escaped():
    units = fm.Units(natural_frequency="4.2 Hz")
    object.__setattr__(units, "load", "<b>")
    assert "&lt;b&gt;" in units._repr_html_()
