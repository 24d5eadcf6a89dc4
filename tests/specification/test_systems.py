"""Systems as objects, in words and from files; every way to get them wrong, and what is said of it."""

import dataclasses
import io
import math
import pickle
import zipfile

import numpy as np
import pytest
import xarray as xr
from structures import CHAIN, RATIOS

import frictionmap as fm
from frictionmap.command_line.cli import main
from frictionmap.datasets.provenance import to_toml

# The object


def test_equal_systems_are_equal_and_hash_alike(tmp_path):
    np.savez(tmp_path / "frame.npz", **CHAIN)
    by_path = fm.System(matrices=tmp_path / "frame.npz")
    by_text = fm.System(matrices=str(tmp_path / "frame.npz"))
    by_mapping = fm.System(matrices=CHAIN)
    lists = fm.System(matrices={name: matrix.tolist() for name, matrix in CHAIN.items()})
    assert by_path == by_text == by_mapping == lists
    assert len({by_path, by_text, by_mapping, lists}) == 1
    assert by_path != fm.System(matrices=CHAIN, damping_ratios=0.1)
    assert by_path != fm.System(matrices={**CHAIN, "K": 2.0 * CHAIN["K"]})
    assert fm.System(load=[1.0]) == fm.System(load=np.array([1.0 + 0.0j]))
    again = dataclasses.replace(by_path, contact_masses=[2])
    assert again == fm.System(matrices=CHAIN, contact_masses=[2])
    assert pickle.loads(pickle.dumps(by_path)) == by_path


def test_matrices_are_copied():
    given = {name: matrix.copy() for name, matrix in CHAIN.items()}
    system = fm.System(matrices=given)
    given["K"][:] = 0.0
    assert system == fm.System(matrices=CHAIN)
    with pytest.raises(ValueError, match="read-only"):
        system.matrices.mass[0, 0] = 2.0


def test_rounding_of_an_assembly_is_symmetrised():
    K = CHAIN["K"].copy()
    K[0, 1] *= 1.0 + 1e-13
    system = fm.System(matrices={**CHAIN, "K": K})
    assert np.array_equal(system.matrices.stiffness, system.matrices.stiffness.T)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        (
            {},
            "one mass; friction between the mass and a fixed wall, harmonic load on the mass; no viscous "
            "damping",
        ),
        (
            {"excitation": "base", "damping_reference": "base", "damping_ratios": 0.1},
            "one mass; friction between the mass and a fixed wall, harmonic base motion through the spring "
            "and dashpot; damping ratio 0.1",
        ),
        (
            {"load": [1.0 - 0.5j]},
            "one mass; friction between the mass and a fixed wall, harmonic load (1-0.5j) on the mass; "
            "no viscous damping",
        ),
        (
            {"contact": "joined-base-wall", "contact_masses": [2], "damping_ratios": 0.1,
             "damping_reference": "base", **RATIOS},
            "chain of 3 masses (1, 0.7, 1.9), springs (1, 1.3, 0.6); friction between mass 2 and a wall that "
            "moves with the base; harmonic base motion through the springs and dashpots; modal damping "
            "ratios 0.1",
        ),
        (
            {"matrices": CHAIN, "frequency_scale": 12.3, "load": [1, 0, 0.5j]},
            "structure of 3 degrees of freedom, r = omega/12.3, displacements in P/1; friction between "
            "mass 1 and a fixed wall; harmonic load (1, 0, 0+0.5j) on the masses; no viscous damping",
        ),
        (
            {"matrices": {"M": [[1.0]], "K": [[4.0]], "C": [[0.4]]}, "stiffness_scale": 4},
            "structure of 1 degree of freedom, r = omega/2 (the first natural frequency), displacements in "
            "P/4; friction between the mass and a fixed wall; harmonic load on the mass; damping ratio 0.1",
        ),
    ],
)  # fmt: skip
def test_description(settings, words):
    assert fm.System(**settings).describe() == words


def test_description_of_a_file_has_no_folder(tmp_path):
    np.savez(tmp_path / "frame.npz", **CHAIN, C=0.1 * CHAIN["M"])
    words = fm.System(matrices=tmp_path / "frame.npz", frequency_scale=1.0).describe()
    assert words.startswith("structure of 3 degrees of freedom from frame.npz, r = omega/1, ")
    assert words.endswith("; modal damping ratios 0.024647 to 0.137844, from C")


# Bad input: the words that its message has, from Python and from the command line


def changed(name, i, j, value):
    """The chain's matrices with one entry changed."""
    matrix = CHAIN[name].copy()
    matrix[i, j] = value
    return {**CHAIN, name: matrix}


def full(value):
    return np.full((3, 3), value)


FRAME = {"matrices": CHAIN}

BAD_SYSTEMS = {
    # matrices
    "M indefinite": (
        {"matrices": changed("M", 1, 1, -2.0)},
        ["matrices: M must be positive definite", "indefinite", "eigenvalues from -2 to 1.9"],
    ),
    "C indefinite": (
        {"matrices": {**CHAIN, "C": np.diag([1.0, 1.0, -0.5])}},
        ["matrices: C must be positive semi-definite", "indefinite", "-0.5"],
    ),
    "C that damps too much": (
        {"matrices": {**CHAIN, "C": 1e3 * CHAIN["M"]}},
        ["matrices: C must make damping ratios <= 100", "of mode 1"],
    ),
    "infinite": ({"matrices": changed("M", 0, 0, math.inf)}, ["matrices: M must be finite", "inf at [0, 0]"]),
    "huge": (
        {"matrices": {**CHAIN, "K": 1e200 * CHAIN["K"]}},
        ["matrices: K must have a largest entry of 1e-100 to 1e+100", "2.3e+200"],
    ),
    "tiny": ({"matrices": {**CHAIN, "M": 1e-200 * CHAIN["M"]}}, ["matrices: M must have a largest entry"]),
    "frequencies too far apart": (
        {"matrices": {"M": np.diag([1.0, 1e-10]), "K": np.diag([1.0, 1e10])}},
        ["cannot compute the natural frequencies", "1e+10", "change matrices"],
    ),
    "stiffness ratios too far apart": (
        {"mass_ratios": [1, 1], "stiffness_ratios": [1, 1e20]},
        ["change mass_ratios and stiffness_ratios", "1.41e+10"],
    ),
    "a frequency of zero": ({**FRAME, "frequency_scale": 0.0}, ["frequency_scale must be > 0", "got 0"]),
    "a frequency below zero": ({**FRAME, "frequency_scale": -1.0}, ["frequency_scale must be > 0", "-1"]),
    "a frequency as text": ({**FRAME, "frequency_scale": "1"}, ["frequency_scale must be a number", "'1'"]),
    "a frequency far off": (
        {**FRAME, "frequency_scale": 1e-90},
        ["frequency_scale and stiffness_scale must leave M", "1e-90"],
    ),
    "a stiffness of zero": ({**FRAME, "stiffness_scale": 0.0}, ["stiffness_scale must be > 0", "got 0"]),
    "a stiffness far off": (
        {**FRAME, "stiffness_scale": 1e200},
        ["frequency_scale and stiffness_scale must leave", "1e+200"],
    ),
    # contact and load
    "between a mass and itself": (
        {**FRAME, "contact": "between-masses", "contact_masses": [2, 2]},
        ["contact_masses must be [A, B] with A < B", "[2, 2]"],
    ),
    "between masses in the wrong order": (
        {"contact": "between-masses", "contact_masses": [3, 1], **RATIOS},
        ["contact_masses must be [A, B] with A < B", "[3, 1]"],
    ),
    "an unknown reference": (
        {"damping_reference": "wall"},
        ["damping_reference must be one of ground, base", "'wall'"],
    ),
    "a load on mass 2 of a moving base": (
        {"excitation": "base", "load_mass": 2, **RATIOS},
        ["load_mass must be 1 for base excitation", "got 2"],
    ),
    "a load on mass 2 of a joined base-wall": (
        {**FRAME, "contact": "joined-base-wall", "load_mass": 2},
        ["load_mass must be 1 for joined-base-wall", "got 2"],
    ),
    # chains
}  # fmt: skip


@pytest.mark.parametrize(("settings", "words"), BAD_SYSTEMS.values(), ids=BAD_SYSTEMS)
def test_bad_systems(settings, words):
    with pytest.raises(fm.InputError) as caught:
        fm.System(**settings)
    message = str(caught.value)
    assert "\n" not in message
    for word in words:
        assert word in message, message


def status_and_message(folder, capsys, system):
    """Exit status of `boundaries` for these keys of [system], and the one line on standard error."""
    tree = {"system": system, "grid": {"r": [0.5], "beta": [0.5]}}
    (folder / "configs").mkdir(exist_ok=True)
    (folder / "configs" / "c.toml").write_text(to_toml(tree))
    before = sorted(folder.rglob("*"))
    status = main(["boundaries", str(folder / "configs" / "c.toml"), "-o", str(folder / "out.nc")])
    out, err = capsys.readouterr()
    if status:
        assert sorted(folder.rglob("*")) == before
        assert out == ""
        assert err.count("\n") == 1
    return status, err


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"load": [math.nan]}, ["load[0] must be finite", "nan"]),
        ({"load": [complex(1.0, math.inf)]}, ["load[0] must be finite", "inf"]),
        ({"load": ["1"]}, ["load[0] must be a number", "'1'"]),
        ({"load": [True]}, ["load[0] must be a number", "True"]),
        ({"load": 1.0}, ["load must be a list of numbers", "1.0"]),
    ],
)
def test_bad_systems_that_a_configuration_cannot_have(settings, words):
    with pytest.raises(fm.InputError) as caught:
        fm.System(**settings)
    message = str(caught.value)
    assert "\n" not in message
    for word in words:
        assert word in message, message


# Files


class Harm:
    """Code that loading a pickle runs."""

    def __reduce__(self):
        return (print, ("a program has run",))


def archive(**members):
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as opened:
        for name, data in members.items():
            opened.writestr(name.replace("_", "."), data)
    return content.getvalue()


def saved(save, *arrays, **named):
    content = io.BytesIO()
    save(content, *arrays, **named)
    return content.getvalue()


PICKLED = saved(np.savez, M=np.array([[Harm()]], dtype=object), K=np.eye(1))
GOOD = saved(np.savez, **CHAIN)
EYE = saved(np.save, np.eye(2))

BAD_FILES = {
    "empty": (b"", "not an .npz file"),
    "text": (b"M = 1", "not an .npz file"),
    "one array": (EYE, "one array"),
    "a pickle": (pickle.dumps(Harm()), "not an .npz file"),
    "a pickled matrix": (PICKLED, "not an .npz file of plain arrays"),
    "cut short": (GOOD[:-100], "not an .npz file"),
    "damaged": (GOOD.replace(b"\x00\x00\xf0\x3f", b"\x00\x00\xf1\x3f"), "not an .npz file of plain arrays"),
    "an archive of something else": (archive(M_npy=b"M", K_npy=b"K"), "real numbers"),
    "an archive of text": (archive(a_txt=b"M"), "got a.txt"),
    "an empty archive": (archive(), "got none"),
    "a header that promises too much": (
        archive(M_npy=EYE.replace(b"(2, 2)", b"(9, 9)"), K_npy=EYE),
        "not an .npz file of plain arrays",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("content", "word"), BAD_FILES.values(), ids=BAD_FILES)
def test_bad_files(tmp_path, capsys, content, word):
    (tmp_path / "configs").mkdir()
    (tmp_path / "configs" / "frame.npz").write_bytes(content)
    status, message = status_and_message(tmp_path, capsys, {"matrices": "frame.npz"})
    assert status == 2
    assert message.startswith("frictionmap: system.matrices")
    assert any(words in message for words in ("M, K and optionally C", "unknown array", "must be an array"))
    assert word in message
    assert "a program has run" not in message


def test_a_good_file(tmp_path, capsys, monkeypatch):
    """A path is relative to the folder of the configuration, wherever the program is run; or absolute."""
    (tmp_path / "configs").mkdir()
    np.savez_compressed(tmp_path / "configs" / "frame.npz", **CHAIN)
    monkeypatch.chdir(tmp_path)
    for path in ("frame.npz", str(tmp_path / "configs" / "frame.npz")):
        keys = {"matrices": path, "frequency_scale": 2.0, "excitation": "base", "damping_ratios": 0.02}
        assert status_and_message(tmp_path, capsys, keys) == (0, "")
        ds = xr.load_dataset(tmp_path / "out.nc")
        (tmp_path / "out.nc").unlink()
        assert f'matrices = "{path}"' in ds.attrs["config"]
        assert ds.attrs["system"].startswith(
            "structure of 3 degrees of freedom from frame.npz, r = omega/2, "
        )
        system = fm.System(matrices=CHAIN, frequency_scale=2.0, excitation="base", damping_ratios=0.02)
        np.testing.assert_array_equal(ds.beta_lim, fm.boundaries(system, [0.5]).beta_lim)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (
            {"contact": "joined-base-wall", "excitation": "force"},
            "excitation must be base for a",
        ),
        ({"mass_ratios": np.ma.masked_array([1.0], [True])}, "mass_ratios must have no masked values"),
        ({"damping_ratios": np.ma.masked_array([0.1], [True])}, "damping_ratios must have no masked values"),
        ({"mass_ratios": np.array(1.0)}, "mass_ratios must be a list of numbers; got array"),
        ({"mass_ratios": xr.DataArray([[1.0]])}, "mass_ratios must be a list of numbers; got <xarray"),
        ({"damping_ratios": [[0.1]]}, r"damping_ratios\[0\] must be a number"),
        (
            {"matrices": {"M": np.eye(2), "K": np.ma.masked_array(np.eye(2), np.eye(2))}},
            "matrices: K must have no masked values",
        ),
    ],
)
def test_nothing_is_dropped_in_silence(settings, message):
    with pytest.raises(fm.InputError, match=message) as error:
        fm.System(**settings)
    assert "\n" not in str(error.value)


def test_arrays_of_any_kind_are_lists():
    ratios = xr.DataArray([1.0, 2.0])
    system = fm.System(mass_ratios=ratios, stiffness_ratios=ratios.values, damping_ratios=0.1 * ratios)
    assert system == fm.System(mass_ratios=[1, 2], stiffness_ratios=[1, 2], damping_ratios=[0.1, 0.2])
    assert fm.System(damping_ratios=xr.DataArray(0.1)) == fm.System(damping_ratios=0.1)
    assert fm.System("joined-base-wall").excitation == "base"
    assert fm.System().excitation == "force"


@pytest.mark.filterwarnings("error")
def test_scales_that_are_none():
    with pytest.raises(fm.InputError, match=r"^cannot use stiffness_scale = True without matrices"):
        fm.System(stiffness_scale=True)
    with pytest.raises(
        fm.InputError, match=r"^frequency_scale and stiffness_scale must leave M with entries"
    ):
        fm.System(matrices={"M": np.eye(2), "K": 2.0 * np.eye(2) - np.eye(2)[::-1]}, frequency_scale=1e200)
