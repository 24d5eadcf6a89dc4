"""Scripts of the gallery run on their own, and compute what the configurations of the same figures say."""

import runpy
import shutil
import sys
import tomllib

import matplotlib.pyplot as plt
import numpy as np
import pytest
from conftest import ROOT

import frictionmap as fm

GALLERY = sorted((ROOT / "docs/gallery").glob("plot_*.py"))

#: Those whose figures are not of the thesis.
OWN = ("plot_11_plate", "plot_12_for_papers", "plot_13_published", "plot_14_plates")

#: Values kept of an axis of a map, so that a script runs in seconds.
KEPT = 6

#: Values that scripts select by name.
SELECTED = (0.5, 0.6)


class Calls:
    """Functions of the package that note what they are asked for, and compute a few cells of it."""

    def __init__(self):
        self.made = []

    def _few(self, values):
        values = np.atleast_1d(np.asarray(values, dtype=float))
        some = np.isin(values, SELECTED)
        some[:: max(1, values.size // KEPT)] = True
        return values[some]

    def gridded(self, function):
        def called(system, r, beta, mu=1.0, **more):
            found = function(system, self._few(r), self._few(beta), mu, **more)
            self.made.append((cell_key(found), grid_key(r, beta, mu)))
            return found

        return called

    def response(self, function):
        def called(system, r, beta, mu=1.0, **more):
            found = function(system, r, beta, mu, **more)
            self.made.append((cell_key(found), grid_key(r, beta, mu)))
            return found

        return called


def cell_key(ds):
    """The system of a dataset, as its configuration has it; damping ratios may differ by rounding."""
    table = tomllib.loads(ds.attrs["config"], parse_float=lambda text: f"{float(text):.12g}")["system"]
    return str(sorted(table.items()))


def grid_key(r, beta, mu):
    return tuple(np.atleast_1d(np.asarray(values, dtype=float)).tobytes() for values in (r, beta, mu))


def run(path, folder, monkeypatch):
    """Run a script from an empty folder, as one who has downloaded it does; return its calls."""
    calls = Calls()
    monkeypatch.setattr(fm, "sweep", calls.gridded(fm.sweep))
    monkeypatch.setattr(fm, "curves", calls.gridded(fm.curves))
    monkeypatch.setattr(fm, "response", calls.response(fm.response))
    script = shutil.copy(path, folder)
    monkeypatch.chdir(folder)
    monkeypatch.setattr(sys, "path", [place for place in sys.path if place not in (str(path.parent.parent),)])
    monkeypatch.delitem(sys.modules, "picture_data", raising=False)
    try:
        runpy.run_path(str(script))
    finally:
        plt.close("all")
    return calls.made


def wanted():
    """System and grid of every configuration of a figure."""
    found = {}
    for path in sorted((ROOT / "configs").glob("*.toml")):
        config = fm.load_config(path)
        one = fm.boundaries(config.system, [1.0])
        found[path.stem] = (cell_key(one), grid_key(config.r, config.beta, config.mu))
    return found


def test_scripts_compute_the_cells_of_the_configurations(tmp_path, monkeypatch):
    figures = wanted()
    made = []
    for path in GALLERY:
        if path.stem not in OWN:
            with monkeypatch.context() as patched:
                made += run(path, tmp_path, patched)
    assert len(made) >= 50
    assert [name for name, figure in figures.items() if figure not in made] == []


@pytest.mark.parametrize(
    "path", [path for path in GALLERY if path.stem == "plot_12_for_papers"], ids=lambda p: p.stem
)
def test_the_others_run_on_their_own(path, tmp_path, monkeypatch):
    assert run(path, tmp_path, monkeypatch)


def test_no_script_needs_what_is_not_downloaded_with_it():
    for path in GALLERY:
        text = path.read_text(encoding="utf-8")
        assert "picture_data" not in text
        assert "configs/" not in "\n".join(line for line in text.splitlines() if not line.startswith("#"))
        assert "from frictionmap" not in text
