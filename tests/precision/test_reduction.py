"""Reduction after Craig and Bampton: against the textbook's matrices, dense, and against whole structures."""

import dataclasses
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
import structure_files as written
import xarray as xr
from scipy.linalg import eigh, null_space
from scipy.sparse import csr_array, diags_array, eye_array, kron
from structures import chain_matrices

import frictionmap as fm
from frictionmap.command_line.cli import main
from frictionmap.datasets.provenance import to_toml
from frictionmap.files.config import read_system
from frictionmap.steady.refinement import boundary_changes, with_more_modes
from frictionmap.structures.accuracy import FullStructure

RNG = np.random.default_rng(20)
CHAIN = chain_matrices(RNG.uniform(0.5, 2.0, 40), RNG.uniform(0.5, 2.0, 40))
CONTACT, LOAD, KEPT = 27, 5, 14
SYSTEM = {"contact_masses": [CONTACT], "load_mass": LOAD}


def membrane(nx=25, ny=22):
    """Masses joined by springs in a rectangle, held along its edges: 550, too many to be solved densely."""

    def line(n):
        return diags_array([2.0, -1.0, -1.0], offsets=[0, 1, -1], shape=(n, n))

    stiffness = kron(line(nx), eye_array(ny)) + 1.37 * kron(eye_array(nx), line(ny))
    return {"M": diags_array(1.0 + 0.3 * np.sin(np.arange(nx * ny))).tocsr(), "K": stiffness.tocsr()}


def textbook(matrices, kept, modes):
    """Matrices of Craig and Bampton in kept displacements and modal coordinates."""
    M, K = (np.asarray(matrices[name]) for name in "MK")
    others = np.setdiff1d(np.arange(len(K)), kept)
    follow = -np.linalg.solve(K[np.ix_(others, others)], K[np.ix_(others, kept)])
    shapes = eigh(K[np.ix_(others, others)], M[np.ix_(others, others)])[1][:, :modes]
    columns = np.zeros((len(K), len(kept) + modes))
    columns[kept, np.arange(len(kept))] = 1.0
    columns[others, : len(kept)], columns[others, len(kept) :] = follow, shapes
    return columns.T @ M @ columns, columns.T @ K @ columns


def reduced(matrices=CHAIN, modes=8, **settings):
    given = {"keep": [KEPT], "modes": modes, "allow": 1.0} | settings.pop("reduce", {})
    return fm.System(matrices=matrices, reduce=given, **(SYSTEM | settings))


@pytest.mark.parametrize("modes", [0, 1, 8, 37])
def test_the_matrices_are_those_of_the_textbook(modes):
    """Their natural frequencies are, free and with the contact held, whatever the coordinates."""
    system = reduced(modes=modes, frequency_scale=1.0)
    kept = [LOAD - 1, KEPT - 1, CONTACT - 1]
    M, K = textbook(CHAIN, kept, modes)
    assert system.n == 3 + modes
    np.testing.assert_allclose(system.modes.w**2, eigh(K, M, eigvals_only=True), rtol=1e-9)
    held = np.delete(np.arange(3 + modes), 2)
    squares = eigh(K[np.ix_(held, held)], M[np.ix_(held, held)], eigvals_only=True)
    np.testing.assert_allclose(system.modes.held_frequencies() ** 2, squares, rtol=1e-9)


def test_many_degrees_of_freedom_are_solved_as_few():
    """The sparse way to the modes against the dense one."""
    matrices = membrane()
    system = reduced(matrices, modes=10, contact_masses=[260], frequency_scale=1.0)
    dense = {name: matrix.toarray() for name, matrix in matrices.items()}
    M, K = textbook(dense, [LOAD - 1, KEPT - 1, 259], 10)
    np.testing.assert_allclose(system.modes.w**2, eigh(K, M, eigvals_only=True), rtol=1e-8)
    again = reduced(matrices, modes=10, contact_masses=[260], frequency_scale=1.0)
    assert again == system


SETTINGS = {
    "wall": {},
    "between masses": {"contact": "between-masses", "contact_masses": [9, CONTACT]},
    "base": {"contact": "joined-base-wall", "load_mass": None},
    "base and wall": {"excitation": "base", "load_mass": None},
    "loads": {"load_mass": None, "load": [0.0] * 10 + [1.0, 0.5j] + [0.0] * 28},
}


@pytest.mark.parametrize("settings", SETTINGS.values(), ids=SETTINGS)
def test_all_modes_are_the_whole_structure(settings):
    settings = SYSTEM | settings
    modes = 39 - (settings["load_mass"] is not None) - (settings.get("contact") == "between-masses")
    modes -= 2 * ("load" in settings)
    whole = fm.System(matrices=CHAIN, damping_ratios=0.01, **settings)
    system = fm.System(matrices=CHAIN, damping_ratios=0.01, reduce={"modes": modes}, **settings)
    r = np.linspace(0.3, 12.0, 9)
    assert system.n == 40
    assert system.accuracy(r).worst < 1e-9
    for name in ("beta_lim", "beta_stick"):
        found, expected = (fm.boundaries(one, r)[name].values for one in (system, whole))
        np.testing.assert_allclose(found, expected, rtol=1e-8)


@pytest.mark.parametrize("settings", SETTINGS.values(), ids=SETTINGS)
def test_some_modes_are_as_good_as_is_said(settings):
    """Motions of the contact, held and free, of the whole structure; the base shakes all masses."""
    settings = SYSTEM | settings
    whole = fm.System(matrices=CHAIN, frequency_scale=1.0, **settings)
    system = fm.System(matrices=CHAIN, frequency_scale=1.0, reduce={"modes": 20, "allow": 0.01}, **settings)
    r = np.linspace(0.0, 0.4, 7)
    accuracy = system.accuracy(r)
    w, held = whole.modes.w, whole.modes.held_frequencies()
    pairs = ((w, system.modes.w), (held, system.modes.held_frequencies()))
    errors = [np.abs(own[: sum(true <= 0.42)] / true[true <= 0.42] - 1.0).max() for true, own in pairs]
    assert accuracy.frequencies == pytest.approx(max(errors), rel=1e-3, abs=1e-11)
    assert max(errors) < 0.01
    assert accuracy.compliances < 0.01
    far = r[np.abs(r[:, np.newaxis] - np.concatenate((w, held))).min(axis=1) > 0.05 * r]
    assert far.size > 2
    for name in ("contact_response", "held_load"):
        found, expected = (getattr(one.modes, name)(far) for one in (system, whole))
        scale = np.abs(expected).max()
        np.testing.assert_allclose(found, expected, rtol=0.02, atol=0.002 * scale)


def test_r_means_the_same_however_much_is_left():
    whole = fm.System(matrices=CHAIN, **SYSTEM)
    for modes in (0, 3, 20):
        system = reduced(modes=modes)
        assert system.omega_1 == pytest.approx(whole.omega_1, rel=1e-12)
        assert system == dataclasses.replace(system, frequency_scale=system.omega_1)


def test_a_single_frequency_near_a_resonance_is_compared():
    """1 % from one, where a range as narrow has nothing further off."""
    whole = fm.System(matrices=CHAIN, frequency_scale=1.0, **SYSTEM)
    r = np.array([1.01 * whole.modes.w[3]])
    system = reduced(modes=10, frequency_scale=1.0)
    kept = [LOAD - 1, KEPT - 1, CONTACT - 1]
    full = np.linalg.inv(CHAIN["K"] - r**2 * CHAIN["M"])[np.ix_(kept, kept)]
    rows = [system.dofs.row(k + 1) for k in kept]
    small = system.reduction.reduced.arrays
    own = np.linalg.inv(small["K"] - r**2 * small["M"])[np.ix_(rows, rows)]
    units = np.sqrt(np.diag(np.linalg.inv(CHAIN["K"])))[kept]
    scale = np.outer(units, units)
    worst = np.linalg.norm((own - full) / scale) / np.linalg.norm(full / scale)
    assert worst > 1e-3
    assert system.accuracy(r).compliances == pytest.approx(worst, rel=1e-6)
    with pytest.raises(fm.InputError, match=r"reduce: cannot keep the error below 0.001"):
        reduced(modes=10, frequency_scale=1.0, reduce={"allow": 0.001}).accuracy(r)


@pytest.mark.parametrize("modes", [0, 8, 37])
def test_the_effective_mass_of_the_contact_is_reported(modes):
    """What friction that reverses feels at once: more with fewer modes, and exact with all."""
    system = reduced(modes=modes)
    told = system.accuracy(np.array([0.5])).contact_mass
    row = system.dofs.row(CONTACT)
    inverses = [np.linalg.inv(M)[k, k] for M, k in ((CHAIN["M"], CONTACT - 1), (system.matrices.mass, row))]
    assert told == pytest.approx(inverses[0] / inverses[1], rel=1e-9)
    assert told >= 1.0 - 1e-12
    assert f"effective mass is {told:.4g} times" in fm.boundaries(system, [0.5]).attrs["reduction"]


def test_degrees_of_freedom_without_mass_follow_exactly():
    light = {"M": CHAIN["M"].copy(), "K": CHAIN["K"]}
    some = [2, 16, 17, 33]
    light["M"][some, some] = 0.0
    others = np.setdiff1d(np.arange(40), some)
    K = CHAIN["K"]
    condensed = K[np.ix_(others, others)] - K[np.ix_(others, some)] @ np.linalg.solve(
        K[np.ix_(some, some)], K[np.ix_(some, others)]
    )
    own = {"M": light["M"][np.ix_(others, others)], "K": condensed, "dofs": others + 1}
    system, exact = reduced(light, modes=33), fm.System(matrices=own, **SYSTEM)
    assert system.n == 36
    np.testing.assert_allclose(system.modes.w, exact.modes.w, rtol=1e-9)
    r = np.linspace(0.2, 20.0, 7)
    np.testing.assert_allclose(system.contact_load(r), exact.contact_load(r), rtol=1e-7)
    with pytest.raises(fm.InputError, match=r"reduce.modes must be at most 33, .*; got 34"):
        reduced(light, modes=34)
    with pytest.raises(fm.InputError, match=r"cannot keep degree of freedom 17: no mass in M"):
        reduced(light, contact_masses=[17])
    with pytest.raises(fm.InputError, match="degree of freedom 3 has no mass; eliminate it with reduce"):
        fm.System(matrices=light)


def test_damping_matrices_are_reduced_alike():
    """C = a M + b K: by the matrix, reduced; by its numbers; and mode by mode."""
    a, b = 0.003, 0.04
    by_matrix = reduced({**CHAIN, "C": a * CHAIN["M"] + b * CHAIN["K"]})
    by_numbers = reduced(rayleigh=[a, b])
    w = reduced(frequency_scale=1.0).modes.w
    np.testing.assert_allclose(by_numbers.modes.zeta, 0.5 * (a / w + b * w), rtol=1e-12)
    np.testing.assert_allclose(by_matrix.modes.zeta, by_numbers.modes.zeta, rtol=1e-9)
    again = dataclasses.replace(by_numbers, rayleigh=[0.0, b])
    assert again.reduction.reduced is by_numbers.reduction.reduced
    assert "from C = 0.003 M + 0.04 K" in by_numbers.describe()


def test_too_few_modes_are_refused_and_a_sufficient_number_is_stated(tmp_path, capsys):
    keys = {"matrices": {name: matrix.tolist() for name, matrix in CHAIN.items()}, **SYSTEM}
    tree = {"system": {**keys, "reduce": {"modes": 3}}, "grid": {"r": [0.5, 6.0], "beta": [0.1]}}
    (tmp_path / "c.toml").write_text(to_toml(tree))
    assert main(["map", str(tmp_path / "c.toml")]) == 2
    message = capsys.readouterr().err
    found = re.fullmatch(
        r"frictionmap: system\.reduce: cannot keep the error below 0\.001 in the range of r with 3 modes: "
        r"natural frequencies within .*, compliances within .*; (\d+) modes suffice\n",
        message,
    )
    assert found, message
    system = fm.System(matrices=CHAIN, reduce={"modes": 3}, **SYSTEM)
    with pytest.raises(fm.InputError, match=r"reduce: cannot keep the error below"):
        fm.sweep(system, [0.5, 6.0], [0.1])
    with pytest.raises(fm.InputError, match=r"reduce: cannot keep the error below"):
        fm.boundaries(system, [0.5, 6.0])
    with pytest.raises(fm.InputError, match=r"reduce: cannot keep the error below"):
        fm.response(system, 6.0, 0.1)
    enough = int(found[1])
    assert fm.System(matrices=CHAIN, reduce={"modes": enough}, **SYSTEM).accuracy(np.array([0.5, 6.0]))
    for fewer in (4, 7, enough - 1):  # and no fewer do, whatever is tried first
        short = fm.System(matrices=CHAIN, reduce={"modes": fewer}, **SYSTEM)
        with pytest.raises(fm.InputError, match=rf"with {fewer} modes: .*; {enough} modes suffice"):
            short.accuracy(np.array([0.5, 6.0]))
    with pytest.raises(
        fm.InputError, match=r"with 0 modes: natural frequencies of the whole .* are missing; 38 modes"
    ):
        fm.System(matrices=CHAIN, reduce={"modes": 0}, **SYSTEM).accuracy(np.array([0.5, 50.0]))
    coarse = fm.System(matrices=CHAIN, reduce={"modes": 3, "allow": 1.0}, frequency_scale=1.0, **SYSTEM)
    low = coarse.accuracy(np.array([0.0, 0.02]))
    assert low is coarse.accuracy(np.array([0.01])) is coarse.accuracy(np.array([0.0, 0.02]))
    assert low.worst < coarse.accuracy(np.array([0.0, 0.1])).worst


def test_a_dataset_names_the_degrees_of_freedom_of_the_file(tmp_path):
    labels = [(node, dof) for node in range(101, 121) for dof in (1, 2)]
    for name in "MK":
        written.abaqus(tmp_path / f"{name}.mtx", CHAIN[name], labels)
    tree = {
        "system": {
            "matrices": {"M": "M.mtx", "K": "K.mtx"}, "contact_masses": ["114.1"], "load_mass": "103.1",
            "reduce": {"keep": ["107.2"], "modes": 9}, "rayleigh": [0.001, 0.0],
        },
        "grid": {"r": [0.4, 1.3], "beta": [0.1, 0.4]},
        "solver": {"outputs": ["regime", "stops_per_cycle", "amplitude"]},
    }  # fmt: skip
    (tmp_path / "c.toml").write_text(to_toml(tree))
    assert main(["map", str(tmp_path / "c.toml"), "-o", str(tmp_path / "o.nc"), "--quiet"]) == 0
    ds = xr.load_dataset(tmp_path / "o.nc")
    assert {CONTACT, LOAD, KEPT} <= set(ds.dof.values.tolist())
    assert ds.sizes["dof"] == 12
    assert re.search(r"natural frequencies within .*e-.* for r = 0.4 to 1.3", ds.attrs["reduction"])
    assert "reduced from the 40 of M.mtx, K.mtx with 9 fixed-interface modes" in ds.attrs["system"]
    python = fm.System(matrices=CHAIN, reduce={"keep": [KEPT], "modes": 9}, rayleigh=[0.001, 0.0], **SYSTEM)
    there = fm.sweep(python, [0.4, 1.3], [0.1, 0.4], outputs=["regime", "stops_per_cycle", "amplitude"])
    xr.testing.assert_equal(ds.drop_attrs(), there.drop_attrs())
    (tmp_path / "again.toml").write_text(there.attrs["config"])
    again = fm.load_config(tmp_path / "again.toml").system
    assert again == python
    np.testing.assert_array_equal(fm.boundaries(again, [0.4]).beta_lim, fm.boundaries(python, [0.4]).beta_lim)


def test_a_store_resumes_with_reduced_matrices(tmp_path, capsys):
    pytest.importorskip("zarr")
    np.savez(tmp_path / "chain.npz", **CHAIN)
    keys = {"matrices": "chain.npz", **SYSTEM, "reduce": {"modes": 12}}
    tree = {"system": keys, "grid": {"r": [0.4, 1.3], "beta": [0.1, 0.4]}}
    (tmp_path / "c.toml").write_text(to_toml(tree))
    for name in ("o.zarr", "o.zarr", "o.nc"):
        assert main(["map", str(tmp_path / "c.toml"), "-o", str(tmp_path / name), "--quiet"]) == 0
    with (
        xr.open_zarr(tmp_path / "o.zarr", consolidated=False) as store,
        xr.open_dataset(tmp_path / "o.nc") as ds,
    ):
        np.testing.assert_array_equal(store.regime, ds.regime)
        assert "within" in store.attrs["reduction"]
    assert main(["info", str(tmp_path / "o.nc")]) == 0
    assert "reduction" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"reduce": 16}, r"reduce must be \{ keep = \[...\], modes = 16 \}; got 16"),
        ({"reduce": {"keep": [1]}}, "reduce must be .*modes = 16"),
        ({"reduce": {"modes": 2, "mods": 2}}, "unknown key of reduce 'mods'; valid: keep, modes, allow"),
        ({"reduce": {"modes": 2.5}}, "reduce.modes must be a whole number; got 2.5"),
        ({"reduce": {"modes": -1}}, "reduce.modes must be >= 0; got -1"),
        ({"reduce": {"modes": 39}}, "reduce.modes must be at most 38, as many as there are; got 39"),
        ({"reduce": {"modes": 2, "keep": 7}}, "reduce.keep must be a list of degrees of freedom; got 7"),
        ({"reduce": {"modes": 2, "keep": [41]}}, r"reduce.keep\[0\] must be <= 40; got 41"),
        ({"reduce": {"modes": 2, "allow": 0}}, "reduce.allow must be > 0; got 0"),
        ({"rayleigh": [0.1]}, r"rayleigh must be two numbers \[a, b\], C = a M \+ b K; got \[0.1\]"),
        ({"rayleigh": [0.1, -1]}, r"rayleigh\[1\] must be >= 0; got -1"),
        ({"rayleigh": [1e6, 0]}, r"rayleigh must make damping ratios <= 100; got"),
        (
            {"rayleigh": [0, 0.1], "damping_ratios": 0.1},
            "cannot use damping_ratios with rayleigh",
        ),
    ],
)
def test_what_is_refused(settings, message):
    with pytest.raises(fm.InputError, match=message) as caught:
        fm.System(matrices=CHAIN, **SYSTEM, **settings)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("key", ["reduce", "rayleigh"])
def test_a_chain_is_not_reduced(key):
    with pytest.raises(fm.InputError, match=f"cannot use {key} without matrices"):
        fm.System(**{key: {"modes": 3}})


def test_matrices_that_cannot_be_reduced():
    K = CHAIN["K"].copy()
    K[20, 20] = 0.1  # less than its neighbours take
    with pytest.raises(
        fm.InputError, match="K must be positive definite; got a singular or indefinite matrix"
    ):
        reduced({"M": CHAIN["M"], "K": K})
    K[20], K[:, 20] = 0.0, 0.0
    with pytest.raises(fm.InputError, match="got no positive stiffness of degree of freedom 21"):
        reduced({"M": CHAIN["M"], "K": K})
    M = CHAIN["M"].copy()
    M[20, 20] = -1.0
    with pytest.raises(fm.InputError, match="got a negative mass of degree of freedom 21"):
        reduced({"M": M, "K": CHAIN["K"]})
    large = csr_array(eye_array(3000))
    with pytest.raises(fm.InputError, match="at most 2000 degrees of freedom, unless they are reduced"):
        fm.System(matrices={"M": large, "K": large})


# What more modes change


def of_chain(modes, **reduce):
    return fm.System(
        matrices=CHAIN, damping_ratios=0.01, reduce={"modes": modes, "allow": 1.0} | reduce, **SYSTEM
    )


WHOLE = fm.System(matrices=CHAIN, damping_ratios=0.01, **SYSTEM)
AXIS = np.linspace(0.3, 2.2, 45)


@pytest.mark.parametrize(("modes", "factor"), [(4, 5.0), (6, 3.0), (10, 2.0)])
def test_the_check_states_the_error_of_beta_lim(modes, factor):
    """beta_lim is off by more than these factors from that of the whole structure, and the check says so."""
    system = of_chain(modes)
    found, true = (fm.boundaries(one, AXIS) for one in (system, WHOLE))
    off = np.abs(found.beta_lim / true.beta_lim - 1.0).values[0]
    assert off.max() > factor - 1.0
    assert system.accuracy(AXIS).worst < 2e-3  # the statement on compliances says nothing of it
    finer = with_more_modes(system)
    changes = boundary_changes(system, finer, AXIS, 1.0)
    assert changes.modes == changes.all_modes == 38
    assert changes.of["beta_lim"].share == pytest.approx(off.max(), rel=1e-6)
    assert changes.of["beta_lim"].r == AXIS[np.argmax(off)]
    stick = np.abs(found.beta_stick / true.beta_stick - 1.0).max().item()
    assert changes.of["beta_stick"].share == pytest.approx(stick, rel=1e-6)
    words = found.attrs["reduction_check"]
    most = changes.of["beta_lim"]
    assert words == "against all 38 modes beta_lim changes by " + (
        f"up to {100.0 * most.share:.0f} % (at r = {most.r:.4g}), beta_stick "
        f"{changes.of['beta_stick'].describe()}"
    )


def test_the_check_states_which_regimes_change(tmp_path, capsys):
    """The cells of the coarse map that change are those of the reduction and the whole structure."""
    beta = np.linspace(0.02, 1.0, 15)
    r = AXIS[::5]
    systems = [of_chain(4), WHOLE]
    maps = [fm.sweep(system, r, beta, outputs=["regime"]) for system in systems]
    changed = int((maps[0].regime != maps[1].regime).sum())
    assert changed > 1
    words = maps[0].attrs["reduction_check"]
    assert words.endswith(f"; {changed} of {r.size * 15} cells of a coarse map (mu = 1) change regime")
    tree = {
        "system": {
            "matrices": {name: matrix.tolist() for name, matrix in CHAIN.items()},
            **SYSTEM,
            "damping_ratios": 0.01,
            "reduce": {"modes": 4, "allow": 1.0},
        },
        "grid": {"r": r.tolist(), "beta": beta.tolist()},
        "solver": {"outputs": ["regime"]},
    }
    (tmp_path / "c.toml").write_text(to_toml(tree))
    for command, of_command in (("map", words), ("boundaries", words.split("; ")[0])):
        path = tmp_path / f"{command}.nc"
        assert main([command, str(tmp_path / "c.toml"), "-o", str(path)]) == 0
        assert f"reduction: {of_command}" in capsys.readouterr().out
        assert xr.load_dataset(path).attrs["reduction_check"] == of_command
        assert main(["info", str(path)]) == 0
        shown = " ".join(capsys.readouterr().out.split())
        assert f"reduction check {of_command}" in shown


def test_all_modes_have_none_to_be_compared_with():
    assert "reduction_check" not in fm.boundaries(of_chain(38), [0.5]).attrs
    assert "reduction_check" not in fm.boundaries(WHOLE, [0.5]).attrs
    assert "against all 38 modes" in fm.boundaries(of_chain(0), [0.1]).attrs["reduction_check"]


def test_the_check_states_how_many_of_many_modes_it_compares():
    """100, or twice as many; 548 are left of the membrane without contact and load."""
    for modes, compared in ((0, 100), (60, 120)):
        system = reduced(membrane(), modes, contact_masses=[260], reduce={"keep": []})
        words = fm.boundaries(system, [0.5]).attrs["reduction_check"]
        assert words.startswith(f"against {compared} of 548 modes beta_lim changes by")


def test_finer_reductions_keep_load_damping_and_scale():
    """Each kind of damping, and loads by mass: the finer one has all modes, as one made by hand."""
    for settings in (
        {"rayleigh": [0.001, 0.01]},
        {"damping_ratios": [0.01 * k for k in range(1, 7)]},
        {"load": [0.0] * 10 + [1.0, 0.5j] + [0.0] * 28, "load_mass": None, "damping_ratios": 0.02},
        {"contact": "joined-base-wall", "load_mass": None, "damping_ratios": 0.02},
        {"frequency_scale": 0.1},
    ):
        given = SYSTEM | settings
        coarse = fm.System(matrices=CHAIN, reduce={"modes": 4, "allow": 1.0}, **given)
        modes = coarse.reduction.most_modes
        if isinstance(settings.get("damping_ratios"), list):
            given["damping_ratios"] = [*settings["damping_ratios"], *[0.06] * (modes - 4)]
        by_hand = fm.System(matrices=CHAIN, reduce={"modes": modes, "allow": 1.0}, **given)
        finer = with_more_modes(coarse)
        assert finer.n == by_hand.n
        r = np.array([0.4, 1.1])
        for name in ("beta_lim", "beta_stick"):
            found, expected = (fm.boundaries(one, r)[name].values for one in (finer, by_hand))
            np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_a_comparison_that_cannot_be_made_gives_the_reason():
    """Frequencies that one reduction just reaches are too low for the faster modes of the other."""
    system = of_chain(4)
    least = 1e-6 * system.modes.free.omega.max()
    words = fm.boundaries(system, [1.0001 * least]).attrs["reduction_check"]
    assert words.startswith("not compared with more modes: r must be 0, or >= ")


# Several contacts, springs, loads of several harmonics

LINE = {"M": np.diag([1.0, 2.0] * 7), "K": 2.0 * np.eye(14) - np.eye(14, k=1) - np.eye(14, k=-1)}
JOINTS = [
    {"masses": [14], "stiffness": 2.0},
    {"kind": "between-masses", "masses": [4, 5]},
    {"masses": [9], "ratio": 0.5},
]
LOADED = {
    "contacts": JOINTS, "damping_ratios": 0.02, "frequency_scale": 0.3,
    "load_harmonics": [{"n": 1, "mass": 2, "amplitude": 1.0}, {"n": 2, "mass": 7, "amplitude": 0.3}],
}  # fmt: skip


def of_line(modes, **settings):
    return fm.System(matrices=LINE, reduce={"modes": modes, "allow": 1.0}, **(LOADED | settings))


def test_contacts_and_loads_keep_their_masses_under_their_numbers():
    system = of_line(0)
    assert system.dofs.numbers == (2, 4, 5, 7, 9, 14)
    offset = [0.0] * 14
    offset[11] = 0.1
    moved = of_line(0, load_offset=offset)
    assert moved.dofs.numbers == (2, 4, 5, 7, 9, 12, 14)
    np.testing.assert_array_equal(moved.contact_system.offset, [0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.0])
    assert moved.contact_system.rows == list(range(7))
    vector = [0.0] * 14
    vector[9] = 1.0
    by_vector = of_line(1, load_harmonics={1: vector, 3: [0.2 * one for one in vector]})
    assert {4, 5, 9, 10, 14} <= set(by_vector.dofs.numbers)
    assert len(by_vector.dofs.numbers) == 6


def test_all_modes_give_the_map_of_the_whole_structure():
    """A reduction to all modes changes the coordinates only."""
    cells = {"r": [0.7, 1.9], "beta": [0.03, 0.2], "outputs": ["regime", "contact_amplitude", "amplitude"]}
    whole = fm.sweep(fm.System(matrices=LINE, **LOADED), **cells)
    system = of_line(8)
    found = fm.sweep(system, **cells)
    assert "reduction_check" not in found.attrs
    np.testing.assert_array_equal(found.regime, whole.regime)
    np.testing.assert_allclose(found.contact_amplitude, whole.contact_amplitude, rtol=1e-6)
    own = whole.amplitude.sel(dof=found.dof.values)
    np.testing.assert_allclose(found.amplitude, own, rtol=1e-6)
    for name in ("beta_noslip", "beta_stick"):
        np.testing.assert_allclose(found[name], whole[name], rtol=1e-8)


def test_frequencies_with_all_contacts_held():
    """Against a null space of all vectors by singular values: walls hold, contacts between masses join."""
    vectors = np.zeros((4, 14))
    vectors[0, 13] = vectors[1, 4] = vectors[2, 5] = vectors[3, 8] = 1.0
    vectors[1, 3] = vectors[2, 4] = -1.0  # 4, 5 and 6 move as one
    whole = FullStructure(csr_array(LINE["M"]), csr_array(LINE["K"]), vectors, np.eye(14)[:, :1])
    basis = null_space(vectors)
    squares = eigh(basis.T @ LINE["K"] @ basis, basis.T @ LINE["M"] @ basis, eigvals_only=True)
    np.testing.assert_allclose(whole.frequencies(True, 9.0, 10, 14), np.sqrt(squares), rtol=1e-10)


def test_the_stated_errors_are_those_with_contacts_free_and_held():
    system = of_line(2)
    accuracy = system.accuracy(np.array([0.5, 1.5]))
    small, vectors = system.matrices.arrays, system.contact_system.vectors
    rows = [number - 1 for number in system.dofs.numbers]
    wide = np.zeros((3, 14))
    wide[:, rows] = vectors
    worst = 0.0
    for own, true in ((np.eye(len(rows)), np.eye(14)), (null_space(vectors), null_space(wide))):
        found, exact = (
            np.sqrt(eigh(b.T @ m["K"] @ b, b.T @ m["M"] @ b, eigvals_only=True))
            for b, m in ((own, small), (true, LINE))
        )
        inside = exact[exact <= 1.05 * 1.5 * 0.3]
        worst = max(worst, np.abs(found[: inside.size] / inside - 1.0).max())
    assert worst > 1e-4
    assert accuracy.frequencies == pytest.approx(worst, rel=1e-6)
    assert "effective masses of contacts are up to" in system.costs(np.array([0.5, 1.5]))["reduction"]
    strict = {"modes": 2, "allow": 1e-5}
    with pytest.raises(fm.InputError, match=r"reduce: cannot keep the error below 1e-05 .*modes? suffices?"):
        fm.boundaries(fm.System(matrices=LINE, reduce=strict, **LOADED), [0.5, 1.5])


def test_more_modes_are_compared_by_the_engine_of_several_contacts():
    r = np.array([0.7, 1.9])
    found, true = fm.boundaries(of_line(2), r), fm.boundaries(fm.System(matrices=LINE, **LOADED), r)
    changes = boundary_changes(of_line(2), with_more_modes(of_line(2)), r, 1.0)
    assert changes.modes == changes.all_modes == 8
    assert list(changes.of) == ["beta_noslip", "beta_stick"]
    for name, change in changes.of.items():
        off = np.abs(found[name] / true[name] - 1.0).max().item()
        assert off > 1e-5
        assert change.share == pytest.approx(off, rel=1e-4)
    assert found.attrs["reduction_check"] == changes.describe()
    cell = fm.sweep(of_line(2), [0.7], [0.2], outputs=["regime"])
    assert cell.attrs["reduction_check"].endswith("of 1 cells of a coarse map (mu = 1) change regime")


def test_a_reduced_structure_is_written_with_its_contacts():
    """The configuration in a file gives the same system again."""
    ds = fm.boundaries(of_line(2), [0.7])
    again = read_system(tomllib.loads(ds.attrs["config"])["system"], Path())
    assert again.dofs.numbers == of_line(2).dofs.numbers
    np.testing.assert_allclose(fm.boundaries(again, [0.7]).beta_stick, ds.beta_stick, rtol=1e-12)
