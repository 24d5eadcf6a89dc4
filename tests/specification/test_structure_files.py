"""Structures from the files of finite-element programs: the same maps as arrays, labels, and refusals."""

import sys

import numpy as np
import pytest
import scipy.io
import scipy.sparse
import structure_files as written
import xarray as xr
from structures import CHAIN

import frictionmap as fm
from frictionmap.command_line.cli import main
from frictionmap.datasets.provenance import to_toml
from frictionmap.structures.harwell_boeing import read_harwell_boeing

HEADER = f"{'title':<80}\n{5:14d}{1:14d}{1:14d}{1:14d}{0:14d}\n"
LABELS = [(3, 1), (3, 2), (17, 1)]
M = CHAIN["M"] / 3.0  # entries that need all digits
K = CHAIN["K"] / 7.0
C = 0.01 * M + 0.02 * K
FEW = {"M": CHAIN["M"], "K": CHAIN["K"]}  # nine digits are enough
MATRICES = {"M": M, "K": K, "C": C}


def each(folder, write, ending):
    """One file a matrix."""
    for name, matrix in MATRICES.items():
        write(folder / f"{name}{ending}", matrix)
    return {name: f"{name}{ending}" for name in MATRICES}


def op4(folder, **how):
    writer = pytest.importorskip("pyyeti.nastran.op4")
    names = {"MAAX": M, "KAAX": K, "BAAX": C, "PHIX": np.ones((3, 2))}
    writer.write(str(folder / "frame.op4"), names, **how)
    return "frame.op4"


def mat(folder, kind):
    scipy.io.savemat(folder / "frame.mat", {name: kind(matrix) for name, matrix in MATRICES.items()})
    return "frame.mat"


def mat_73(folder, mass=M, kind=b"double"):
    h5py = pytest.importorskip("h5py")
    with h5py.File(folder / "frame.mat", "w", userblock_size=512) as file:
        file["M"] = mass
        file["M"].attrs["MATLAB_class"] = np.bytes_(kind)
        for name, matrix in (("K", K), ("C", C)):
            sparse = scipy.sparse.csc_array(matrix)
            group = file.create_group(name)
            group.attrs["MATLAB_sparse"] = np.uint64(3)
            group["data"], group["ir"], group["jc"] = sparse.data, sparse.indices, sparse.indptr
    with open(folder / "frame.mat", "r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
    return "frame.mat"


def npz(folder):
    np.savez(folder / "frame.npz", **MATRICES)
    return "frame.npz"


def labelled(part):
    return lambda path, matrix: written.abaqus(path, matrix, LABELS, part)


def counted(part):
    return lambda path, matrix: written.abaqus_coordinates(path, matrix, part)


FORMS = {
    "NPZ": npz,
    "MAT": lambda folder: mat(folder, np.asarray),
    "MAT, sparse": lambda folder: mat(folder, scipy.sparse.csc_array),
    "MAT 7.3": mat_73,
    "Matrix Market, symmetric": lambda folder: each(folder, written.market, ".mtx"),
    "Matrix Market, general": lambda folder: each(
        folder, lambda path, matrix: written.market(path, matrix, False), ".mtx"
    ),
    "Matrix Market, symmetric array": lambda folder: each(
        folder, lambda path, matrix: written.market_array(path, matrix, True), ".mtx"
    ),
    "Matrix Market, array": lambda folder: each(folder, written.market_array, ".mtx"),
    "Abaqus, lower": lambda folder: each(folder, labelled(np.tril), ".mtx"),
    "Abaqus, upper": lambda folder: each(folder, labelled(np.triu), ".mtx"),
    "Abaqus, all": lambda folder: each(folder, labelled(np.array), ".mtx"),
    "Abaqus, coordinates": lambda folder: each(folder, counted(np.triu), ".mtx"),
    "Harwell-Boeing, RSA": lambda folder: each(folder, written.harwell_boeing, ".rsa"),
    "Harwell-Boeing, RUA": lambda folder: each(
        folder, lambda path, matrix: written.harwell_boeing(path, matrix, False), ".hb"
    ),
    "Harwell-Boeing of scipy": lambda folder: each(
        folder, lambda path, matrix: scipy.io.hb_write(path, scipy.sparse.csc_array(matrix)), ".rua"
    ),
    "OP4": lambda folder: op4(folder, binary=True),
    "OP4, sparse": lambda folder: op4(folder, binary=True, sparse="bigmat"),
    "OP4, text": lambda folder: op4(folder, binary=False),
}


def mapped(folder, system):
    """The map of these keys of [system], by the command line."""
    grid = {"r": [0.4, 1.0, 1.7], "beta": [0.05, 0.2, 0.6]}
    (folder / "c.toml").write_text(to_toml({"system": system, "grid": grid}))
    assert main(["map", str(folder / "c.toml"), "-o", str(folder / "o.nc"), "--quiet", "--overwrite"]) == 0
    return xr.load_dataset(folder / "o.nc")


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    folder = tmp_path_factory.mktemp("expected")
    return mapped(folder, {"matrices": {name: matrix.tolist() for name, matrix in MATRICES.items()}})


@pytest.mark.parametrize("write", FORMS.values(), ids=FORMS)
def test_every_form_gives_the_map_of_the_arrays(write, tmp_path, expected):
    found = mapped(tmp_path, {"matrices": write(tmp_path)})
    xr.testing.assert_identical(found.drop_attrs(), expected.drop_attrs())


def test_a_punch_file(tmp_path, expected):
    pytest.importorskip("pyyeti")
    written.punch(tmp_path / "frame.pch", {"MAAX": CHAIN["M"], "KAAX": CHAIN["K"]}, LABELS)
    found = mapped(tmp_path, {"matrices": "frame.pch", "contact_masses": ["17.1"], "load_mass": "3.2"})
    arrays = {name: matrix.tolist() for name, matrix in FEW.items()}
    there = mapped(tmp_path, {"matrices": arrays, "contact_masses": [3], "load_mass": 2})
    xr.testing.assert_identical(found.drop_attrs(), there.drop_attrs())
    assert not expected.equals(found)
    assert "friction between mass 3 (17.1) and a fixed wall; harmonic load on mass 2 (3.2)" in found.system


def test_sparse_arrays_are_arrays():
    sparse = {name: scipy.sparse.coo_array(matrix) for name, matrix in MATRICES.items()}
    assert fm.System(matrices=sparse) == fm.System(matrices=MATRICES)


def test_degrees_of_freedom_by_labels(tmp_path):
    """Rows are in the order of the labels, whatever the order in the file; M may lack some without mass."""
    order = [2, 0, 1]
    shuffled = [LABELS[k] for k in order]
    for name in ("M", "K"):
        written.abaqus(tmp_path / f"{name}.mtx", MATRICES[name][np.ix_(order, order)], shuffled)
    files = {"M": tmp_path / "M.mtx", "K": tmp_path / "K.mtx"}
    system = fm.System("between-masses", ["3.2", "17.1"], "3.1", matrices=files)
    assert system == fm.System("between-masses", [2, 3], 1, matrices={"M": M, "K": K})
    assert fm.System("between-masses", [2, 3], 1, matrices=files) == system
    light = M.copy()
    light[1, 1] = 0.0
    written.abaqus(tmp_path / "M.mtx", light, LABELS)
    with pytest.raises(fm.InputError, match=r"M must be positive definite.* 2 \(3.2\) has no mass"):
        fm.System(matrices=files)


def test_boundary_conditions_of_abaqus_are_left_out(tmp_path):
    fixed = K.copy()
    fixed[1, 1] = 1e36
    written.abaqus(tmp_path / "M.mtx", M, LABELS)
    written.abaqus(tmp_path / "K.mtx", fixed, LABELS)
    system = fm.System(matrices={"M": tmp_path / "M.mtx", "K": tmp_path / "K.mtx"}, contact_masses=["17.1"])
    free = np.ix_([0, 2], [0, 2])
    alone = fm.System(matrices={"M": M[free], "K": K[free]}, contact_masses=[2])
    assert system.contact_masses == (3,)
    ds, there = (fm.sweep(one, [0.5], [0.1], outputs=["amplitude"]) for one in (system, alone))
    assert ds.dof.values.tolist() == [1, 3]
    np.testing.assert_array_equal(ds.amplitude, there.amplitude)
    with pytest.raises(fm.InputError, match=r"contact_masses\[0\] must be one of 1, 3; got 2"):
        fm.System(matrices=system.matrices, contact_masses=[2])
    fixed[0, 2] = -0.5  # and K[2, 0] = 0: the row that is held is no measure of what is rounding
    written.abaqus(tmp_path / "K.mtx", fixed, LABELS, np.array)
    with pytest.raises(
        fm.InputError, match=r"K must be symmetric; got -0\.5 at \[0, 2\] and 0\.0 at \[2, 0\]"
    ):
        fm.System(matrices={"M": tmp_path / "M.mtx", "K": tmp_path / "K.mtx"}, contact_masses=["17.1"])


def test_numbers_of_degrees_of_freedom(tmp_path):
    """An array of them stands beside the others; a dataset has them, and its configuration."""
    system = fm.System(matrices={**MATRICES, "dofs": [4, 17, 112]}, contact_masses=[112], load_mass=17)
    ds = fm.curves(system, [0.5], [0.1], quantities=["amplitude"])
    there = fm.curves(fm.System(matrices=MATRICES, contact_masses=[3], load_mass=2), [0.5], [0.1],
                      quantities=["amplitude"])  # fmt: skip
    assert ds.dof.values.tolist() == [4, 17, 112]
    np.testing.assert_array_equal(ds.amplitude, there.amplitude)
    (tmp_path / "again.toml").write_text(ds.attrs["config"])
    assert fm.load_config(tmp_path / "again.toml").system == system
    assert fm.System(matrices={**MATRICES, "dofs": [1, 2, 3]}) == fm.System(matrices=MATRICES)
    assert fm.System(matrices={**MATRICES, "dofs": [1, 2, 4]}) != fm.System(matrices=MATRICES)


@pytest.mark.parametrize(
    ("form", "entry", "value"),
    [
        ("(5F8.1)", "20", 2.0),
        ("(5F8.3)", "-20", -0.02),
        ("(5E8.3)", "25E2", 2.5),
        ("(5F8.1)", "2.5", 2.5),
        ("(5F8.0)", "20", 20.0),
        ("(1P5F8.2)", "25.0", 2.5),
        ("(1P,5E8.2)", "2.5E0", 2.5),
    ],
)
def test_entries_without_point_or_exponent_are_read_as_by_fortran(form, entry, value, tmp_path):
    """Fortran 2018, 13.7.2.3.2: without a point the last d digits are decimals; 13.8.5: without an exponent
    kP is a factor of 10^k."""
    path = tmp_path / "K.rua"
    path.write_text(
        f"{HEADER}RUA{1:25d}{1:14d}{1:14d}{0:14d}\n(8I8) (8I8) {form}\n{1:8d}{2:8d}\n{1:8d}\n{entry:>8}\n"
    )
    assert read_harwell_boeing(path).values.toarray().tolist() == [[value]]


# Refusals


BANNER = "%%MatrixMarket matrix coordinate"

BAD_FILES = {
    "not square": (f"{BANNER} real general\n1 2 1\n1 1 1.0\n", ["square", "1 by 2"]),
    "an entry twice": (f"{BANNER} real general\n1 1 2\n1 1 1.0\n1 1 1.0\n", ["twice", "row 1, column 1"]),
    "symmetric, both triangles": (
        f"{BANNER} real symmetric\n2 2 2\n1 1 1.0\n1 2 0.5\n", ["line 4", "an entry of the lower triangle"]
    ),
    "a row too many": (f"{BANNER} real general\n1 1 1\n2 1 1.0\n", ["line 3", "from 1 to 1", "'2 1 1.0'"]),
    "sizes": (f"{BANNER} real general\n1 1\n1 1 1.0\n", ["line 2", "3 whole numbers"]),
    "no sizes": (f"{BANNER} real general\n", ["line 2", "3 whole numbers"]),
    "an array cut short": (
        "%%MatrixMarket matrix array real symmetric\n2 2\n1.0\n0.5\n", ["3 entries", "got 2"]
    ),
    "an array with words": ("%%MatrixMarket matrix array real general\n1 1\none\n", ["line 3", "one entry"]),
    "no number": (f"{BANNER} real general\n1 1 1\n1 1 one\n", ["line 3", "row column entry", "'1 1 one'"]),
    "words": ("mass\n", ["line 1", "node, dof, node, dof, entry or row column entry", "'mass'"]),
    "Abaqus, no number": ("1,1, 1,1, 2.0\n1,2, 1,1, x\n", ["line 2", "node, dof, node, dof, entry"]),
    "Abaqus, a field too few": ("1,1, 1,1, 2.0\n1,2, 1, 2.0\n", ["line 2", "node, dof, node, dof, entry"]),
    "Abaqus, unsymmetric": ("*MATRIX INPUT, TYPE=UNSYMMETRIC\n1 1 1 1 1.\n", ["line 1", "symmetric"]),
    "Abaqus, another keyword": ("*NODE\n1, 1., 1.\n", ["line 1", "no keyword but *MATRIX", "*NODE"]),
    "Abaqus, row 0": ("0 0 1.0\n", ["line 1", "counted from 1"]),
    "Abaqus, an entry twice": ("1 1 1.0\n1 1 1.0\n", ["an entry is given twice", "row 1, column 1"]),
    "Abaqus, a row far off": ("1 1 1.0\n99999999 1 1.0\n", ["at most 10000000 rows", "99999999"]),
    "Abaqus, nothing": ("** nothing\n", ["it has no entries"]),
    "digits of another alphabet": (
        f"{BANNER} real general\n1 1 1\n1 1 \u0662\n", ["line 3", "row column entry", "'1 1 \u0662'"]
    ),
    "a row in digits of another alphabet": ("\u0661 1 1.0\n", ["line 1", "row column entry"]),
    "zero bytes": ("1 1\0 1.0", ["it is not text"]),
}  # fmt: skip


def refused(capsys, folder, matrices, words, status=2):
    (folder / "c.toml").write_text(
        to_toml({"system": {"matrices": matrices}, "grid": {"r": [1], "beta": [1]}})
    )
    assert main(["map", str(folder / "c.toml"), "-o", str(folder / "o.nc")]) == status
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert message.startswith("frictionmap: system.matrices")
    for word in words:
        assert word in message, message


@pytest.mark.parametrize(("text", "words"), BAD_FILES.values(), ids=BAD_FILES)
def test_bad_texts(text, words, tmp_path, capsys):
    (tmp_path / "M.mtx").write_text(text, encoding="utf-8")
    refused(capsys, tmp_path, {"M": "M.mtx", "K": "M.mtx"}, words)


BAD_BOEING = {
    "empty": ("", ["four lines", "got 0"]),
    "complex": (f"{HEADER}CUA{1:25d}{1:14d}{1:14d}{0:14d}\n(8I10) (8I10) (3E25.16)\n", ["line 3", "real"]),
    "elements": (f"{HEADER}RUE{1:25d}{1:14d}{1:14d}{0:14d}\n(8I10) (8I10) (3E25.16)\n", ["line 3"]),
    "a format": (f"{HEADER}RUA{1:25d}{1:14d}{1:14d}{0:14d}\n(8I10) (8I10) (list)\n", ["line 4", "Fortran"]),
    "a number": (
        f"{HEADER}RUA{1:25d}{1:14d}{1:14d}{0:14d}\n(8I10) (8I10) (3E25.16)\n{1:10d}{2:10d}\n{1:10d}\n    x\n",
        ["line 7", "3 numbers of 25 characters"],
    ),
    "pointers": (
        f"{HEADER}RUA{1:25d}{1:14d}{1:14d}{0:14d}\n(8I10) (8I10) (3E25.16)\n{1:10d}{9:10d}\n{1:10d}\n"
        f"{2.0:25e}\n",
        ["pointers and rows do not fit a matrix of size 1"],
    ),
    "too few": (
        f"{HEADER}RUA{1:25d}{1:14d}{1:14d}{0:14d}\n(8I10) (8I10) (3E25.16)\n{1:10d}\n{1:10d}\n{2.0:25e}\n",
        ["2 numbers from line 5"],
    ),
}


@pytest.mark.parametrize(("text", "words"), BAD_BOEING.values(), ids=BAD_BOEING)
def test_bad_files_of_harwell_boeing(text, words, tmp_path, capsys):
    (tmp_path / "M.hb").write_text(text)
    refused(capsys, tmp_path, {"M": "M.hb", "K": "M.hb"}, words)


@pytest.mark.parametrize(
    ("matrices", "words"),
    [
        ({"M": "K.mtx", "K": "missing.mtx"}, ["missing.mtx", "No such file"]),
        ({"M": "K.mtx", "K": "K.txt"}, ["K must be a file that ends in .mtx", "K.txt"]),
        ({"M": "K.mtx", "K": "L.mtx"}, ["K has labels of nodes, M has none"]),
        ("broken.mat", ["it is not a valid MAT file"]),
        ("missing.mat", ["missing.mat", "No such file"]),
        ("more.mat", ["cannot use D, damping: several may be C; name the one that is meant C"]),
        ({"M": "K.mtx", "K": "two.mat"}, ["K must be in file", "or its only array; got D, damping"]),
    ],
)
def test_bad_choices(matrices, words, tmp_path, capsys):
    written.market(tmp_path / "K.mtx", K)
    written.harwell_boeing(tmp_path / "K.rsa", K)
    written.abaqus(tmp_path / "L.mtx", K, LABELS)
    (tmp_path / "K.txt").write_text("1 1 1.0")
    (tmp_path / "broken.mat").write_bytes(b"no MATLAB")
    scipy.io.savemat(tmp_path / "more.mat", {"M": M, "K": K, "D": C, "damping": C})
    scipy.io.savemat(tmp_path / "two.mat", {"D": K, "damping": K})
    refused(capsys, tmp_path, matrices, words)


@pytest.mark.parametrize("kind", [np.asarray, scipy.sparse.csc_array])
def test_true_and_false_are_no_entries(kind, tmp_path, capsys):
    """MATLAB stores logical ones as bytes, which would pass for numbers."""
    masses = np.eye(3, dtype=bool)
    scipy.io.savemat(tmp_path / "logical.mat", {"M": kind(masses), "K": K})
    refused(capsys, tmp_path, "logical.mat", ["M must be an array of real numbers; got type bool"])
    refused(capsys, tmp_path, mat_73(tmp_path, masses.astype(np.uint8), b"logical"), ["got type bool"])


def test_bad_files_of_nastran(tmp_path, capsys):
    pytest.importorskip("pyyeti")
    from pyyeti.nastran import op4 as writer

    writer.write(str(tmp_path / "two.op4"), {"MAA": M, "MGG": M, "KAA": K})
    refused(capsys, tmp_path, "two.op4", ["more than one matrix may be M", "MAA, MGG"])
    writer.write(str(tmp_path / "none.op4"), {"PHIX": M})
    refused(capsys, tmp_path, "none.op4", ["called M, K and C", "got PHIX"])
    writer.write(str(tmp_path / "half.op4"), {"MAA": M})
    refused(capsys, tmp_path, "half.op4", ["must have arrays M, K", "got M"])
    refused(capsys, tmp_path, {"M": "half.op4", "K": "half.op4"}, ["K must be in file", "got M"])
    (tmp_path / "text.op4").write_text("no matrix at all, but words\n" * 4)
    refused(capsys, tmp_path, "text.op4", ["OP4 file of Nastran"])
    (tmp_path / "text.pch").write_text("GRID,1\n")
    refused(capsys, tmp_path, "text.pch", ["it has no DMIG cards"])
    written.punch(tmp_path / "frame.pch", {"PHIX": M, "MAAX": M, "KAAX": K}, LABELS)
    good = (tmp_path / "frame.pch").read_text()
    entry = f"*       {3:>16}{2:>16}{-2.5:>16.9E}\n"
    (tmp_path / "twice.pch").write_text(good + entry)  # in the column of 17.1; that of 3.2 has it
    refused(capsys, tmp_path, "twice.pch", ["an entry of KAAX is given twice", "3.2, 17.1"])
    real = f"KAAX    {0:>8}{6:>8}{2:>8}"
    (tmp_path / "complex.pch").write_text(good.replace(real, f"{real[:-1]}4"))
    refused(capsys, tmp_path, "complex.pch", ["KAAX is complex", "write real matrices"])


def test_without_the_extra(tmp_path, monkeypatch, capsys):
    (tmp_path / "frame.op4").write_bytes(b"anything")
    monkeypatch.setitem(sys.modules, "pyyeti.nastran.op4", None)
    refused(capsys, tmp_path, "frame.op4", ["frame.op4: pyyeti is not installed", "frictionmap[fe]"])


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"contact_masses": ["9.9"]}, r"label of the file such as 3.1 or 17.1; got '9.9'"),
        ({"contact_masses": [17.1]}, r"contact_masses\[0\] must be a whole number, or a label in quotes"),
        ({"load_mass": "3.3"}, r"load_mass must be a number, or a label .*; got '3.3' \(did you mean"),
        ({"contact": "between-masses", "contact_masses": ["17.1", "3.1"]}, "with A < B; got"),
    ],
)
def test_bad_labels(settings, message, tmp_path):
    for name in ("M", "K"):
        written.abaqus(tmp_path / f"{name}.mtx", MATRICES[name], LABELS)
    with pytest.raises(fm.InputError, match=message):
        fm.System(matrices={"M": tmp_path / "M.mtx", "K": tmp_path / "K.mtx"}, **settings)


def test_labels_that_the_matrices_have_not():
    with pytest.raises(fm.InputError, match=r"contact_masses\[0\] must be a whole number; got '3.1'"):
        fm.System(matrices=MATRICES, contact_masses=["3.1"])


def boundaries_of(matrices, **settings):
    return fm.boundaries(fm.System(matrices=matrices, contact_masses=[1], **settings), [0.3, 0.8])


def assert_same(found, wanted):
    for name in ("beta_lim", "beta_stick", "natural_frequency"):
        np.testing.assert_allclose(found[name], wanted[name], rtol=1e-13)


@pytest.mark.parametrize(
    ("arrays", "unused"),
    [
        ({**MATRICES, "Fex1": np.ones(3), "PhiT": np.eye(3)}, "Fex1, PhiT"),
        ({"m": M, "k": K, "c": C}, ""),
        ({"mass": M, "stiffness": K, "D": C}, ""),
        ({**MATRICES, "D": K}, "D"),
        ({"frame": MATRICES}, ""),
    ],
)
def test_other_arrays_and_common_names(arrays, unused, tmp_path):
    scipy.io.savemat(tmp_path / "frame.mat", arrays)
    found = boundaries_of(tmp_path / "frame.mat")
    assert_same(found, boundaries_of(MATRICES))
    assert ("not used" in found.system) == bool(unused)
    assert f"({unused} not used)" in found.system or not unused


def test_d_of_another_size_is_no_damping(tmp_path):
    """In a workspace of control engineers D is the feedthrough."""
    np.savez(tmp_path / "frame.npz", M=M, K=K, D=np.zeros((1, 2)))
    assert "(D not used)" in boundaries_of(tmp_path / "frame.npz").system


def test_a_null_matrix_of_size_one_is_no_matrix(tmp_path):
    """Nastran writes it for each matrix that a model does not have."""
    writer = pytest.importorskip("pyyeti.nastran.op4")
    writer.write(str(tmp_path / "frame.op4"), {"MAAX": M, "KAAX": K, "BAAX": np.zeros((1, 1))})
    found = boundaries_of(tmp_path / "frame.op4", damping_ratios=0.01)
    assert_same(found, boundaries_of({"M": M, "K": K}, damping_ratios=0.01))
    with pytest.raises(fm.InputError, match="C must have the shape of M"):
        boundaries_of({"M": M, "K": K, "C": np.ones((1, 1))})


@pytest.mark.parametrize("banner", ["%%MATRIXMARKET MATRIX", "%%matrixmarket matrix"])
def test_headers_in_capital_or_small_letters(banner, tmp_path):
    for name, matrix in MATRICES.items():
        written.market(tmp_path / f"{name}.mtx", matrix)
        text = (tmp_path / f"{name}.mtx").read_text()
        first, rest = text.split("\n", 1)
        (tmp_path / f"{name}.mtx").write_text(f"{banner} {' '.join(first.split()[2:]).upper()}\n{rest}")
    assert_same(boundaries_of({name: tmp_path / f"{name}.mtx" for name in MATRICES}), boundaries_of(MATRICES))


@pytest.mark.parametrize("form", ["csr", "csc", "dia"])
def test_one_file_each_of_scipy_and_numpy(form, tmp_path):
    scipy.sparse.save_npz(tmp_path / "mass.npz", scipy.sparse.csr_array(M).asformat(form))
    np.save(tmp_path / "stiffness.npy", K)
    np.savez(tmp_path / "damping.npz", C)
    paths = {"M": tmp_path / "mass.npz", "K": tmp_path / "stiffness.npy", "C": tmp_path / "damping.npz"}
    assert_same(boundaries_of(paths), boundaries_of(MATRICES))


def test_rows_in_any_order_and_by_names(tmp_path):
    order = [2, 0, 1]
    mixed = {name: one[order][:, order] for name, one in MATRICES.items()}
    numbered = fm.System(matrices={**mixed, "dofs": [30, 10, 20]}, contact_masses=[20], load_mass=30)
    named = fm.System(
        matrices={**mixed, "dofs": ["roof", "base", "floor"]}, contact_masses=["floor"], load_mass="roof"
    )
    plain = fm.System(matrices=MATRICES, contact_masses=[2], load_mass=3)
    wanted = fm.sweep(plain, [0.3, 0.8], [0.1, 0.5], outputs=["amplitude"])
    found = fm.sweep(numbered, [0.3, 0.8], [0.1, 0.5], outputs=["amplitude"])
    np.testing.assert_array_equal(found.dof, [10, 20, 30])
    np.testing.assert_allclose(found.amplitude.values, wanted.amplitude.values, rtol=1e-9)
    by_name = fm.sweep(named, [0.3, 0.8], [0.1, 0.5], outputs=["amplitude"])
    np.testing.assert_allclose(by_name.amplitude.values, wanted.amplitude.values[..., order], rtol=1e-9)


def test_damaged_files_of_one_matrix(tmp_path):
    scipy.sparse.save_npz(tmp_path / "whole.npz", scipy.sparse.csr_array(M))
    arrays = dict(np.load(tmp_path / "whole.npz"))
    np.savez(tmp_path / "short.npz", **{**arrays, "indptr": arrays["indptr"][:1]})
    np.savez(tmp_path / "incomplete.npz", **{name: one for name, one in arrays.items() if name != "indices"})
    for name in ("short.npz", "incomplete.npz"):
        with pytest.raises(fm.InputError, match=f"{name}: its sparse matrix is damaged; save it again"):
            boundaries_of({"M": tmp_path / name, "K": tmp_path / "whole.npz"})
    contents = {"text.npy": b"no array", "empty.npy": b"", "npz.npy": (tmp_path / "whole.npz").read_bytes()}
    for name, content in contents.items():
        (tmp_path / name).write_bytes(content)
        with pytest.raises(fm.InputError, match=f"{name}: it is not an .npy file of numbers; save it with"):
            boundaries_of({"M": tmp_path / name, "K": tmp_path / "whole.npz"})
