"""Source archive and wheel are built, hold what they should, and run where nothing else of this tree is."""

import os
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import zipfile

import pytest
from conftest import ROOT

import frictionmap as fm

PACKED = ("frictionmap", "configs", "docs", "paper", "tests", "benchmarks")
PAGES = (
    "pyproject.toml",
    "README.md",
    "LICENSE",
    "CHANGELOG.md",
    "CITATION.cff",
    "CONTRIBUTING.md",
    "MANIFEST.in",
    "SECURITY.md",
)


def run(*command, cwd, **environment):
    done = subprocess.run(
        [str(word) for word in command],
        cwd=cwd,
        env={key: value for key, value in os.environ.items() if key != "PYTHONPATH"} | environment,
        capture_output=True,
        text=True,
        timeout=3000,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """The folder of both, made from a copy: a build leaves things beside its sources."""
    pytest.importorskip("build")
    folder = tmp_path_factory.mktemp("wheel")
    made = shutil.ignore_patterns("__pycache__", "*.pyc", "figures", "reference", "_build", "local")
    for name in PACKED:
        shutil.copytree(ROOT / name, folder / "tree" / name, ignore=made)
    for name in PAGES:
        shutil.copy(ROOT / name, folder / "tree" / name)
    run(sys.executable, "-m", "build", "--no-isolation", "--outdir", folder, cwd=folder / "tree")
    return folder


def test_the_wheel_holds_the_package_and_nothing_else(built):
    (wheel,) = built.glob("*.whl")
    assert wheel.name == f"frictionmap-{fm.__version__}-py3-none-any.whl"
    names = {name for name in zipfile.ZipFile(wheel).namelist() if ".dist-info/" not in name}
    sources = {
        path.relative_to(ROOT).as_posix()
        for path in (ROOT / "frictionmap").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert names == sources
    assert "frictionmap/py.typed" in names


def test_the_archive_holds_what_tests_need(built):
    (archive,) = built.glob("*.tar.gz")
    with tarfile.open(archive) as opened:
        names = {name.partition("/")[2] for name in opened.getnames()}
    assert {*PAGES, "configs/fig-3-12.toml", "docs/index.md", "tests/conftest.py"} <= names
    assert archive.stat().st_size < 5e6


def test_an_index_would_take_both(built):
    pytest.importorskip("twine")
    pytest.importorskip("check_wheel_contents")
    (archive,), (wheel,) = built.glob("*.tar.gz"), built.glob("*.whl")
    said = run(sys.executable, "-m", "twine", "check", "--strict", archive, wheel, cwd=built)
    assert said.count("PASSED") == 2
    run(sys.executable, "-m", "check_wheel_contents", wheel, cwd=built)


def test_the_wheel_runs_in_a_fresh_environment(built):
    """Its dependencies are those of this environment; the package is its own."""
    (wheel,) = built.glob("*.whl")
    fresh, folder = built / "fresh", built / "empty"
    folder.mkdir()
    run(sys.executable, "-m", "venv", "--without-pip", fresh, cwd=built)
    python = fresh / "bin" / "python"
    run(
        sys.executable,
        "-m",
        "pip",
        "--python",
        python,
        "install",
        "--no-deps",
        "--no-index",
        wheel,
        cwd=folder,
    )
    (packages,) = fresh.glob("lib/python*/site-packages")
    (packages / "dependencies.pth").write_text(sysconfig.get_path("purelib"))
    where = run(python, "-c", "import frictionmap; print(frictionmap.__file__)", cwd=folder)
    assert where.startswith(str(packages))
    program = fresh / "bin" / "frictionmap"
    assert run(program, "--version", cwd=folder) == f"frictionmap {fm.__version__}\n"
    run(program, "init", cwd=folder)
    run(program, "map", "map.toml", "--set", "grid.r.step=9 Hz", "--set", "grid.beta.num=7", cwd=folder)
    run(program, "plot", "map.nc", cwd=folder)
    assert (folder / "map.png").read_bytes().startswith(b"\x89PNG")
