"""Shared set-up: where kernels are cached, and where the reference values lie."""

import json
import os
import signal
import sys
import tempfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent

# Compiled once for all runs of the tests, wherever the package lies; every state of the kernels has its own.
os.environ.setdefault("NUMBA_CACHE_DIR", str(Path(tempfile.gettempdir()) / "frictionmap-kernels"))
os.environ.setdefault("MPLBACKEND", "agg")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the program does, before numpy is imported

# A shell lets what it starts in the background ignore interrupts, and children inherit that: tests send some.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

#: Files that take a minute or so, first: a worker that begins one of them last works on alone.  The first two
#: need different kernels in their first minute, so that two workers do not compile the same ones.
LONGEST = (
    "test_quick_benchmarks.py", "test_contact_stiffness.py", "test_stores.py", "test_explore_goals_page.py",
    "test_explore_page.py", "test_fuzz.py", "test_explore_contacts_page.py", "test_explore_alive.py",
    "test_interrupts.py", "test_stores_cut.py",
)  # fmt: skip

REFERENCE = Path(os.environ.get("FRICTIONMAP_REFERENCE", ROOT.parent / "shared" / "reference"))


def _rows(name: str) -> tuple[dict, list[dict]]:
    path = REFERENCE / name
    if not path.is_file():
        pytest.skip(f"the reference values {name} are not at hand")
    content = json.loads(path.read_text())
    return content["systems"], content["rows"]


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option of the trials with invalid input."""
    parser.addoption("--whole", action="store_true", help="tests/fuzz: all trials, not some of every kind")


def pytest_configure(config: pytest.Config) -> None:
    """Let workers take files in the order of collection; xdist would take those with few tests last."""
    if hasattr(config.option, "loadscopereorder"):
        config.option.loadscopereorder = False


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the longest files."""
    items.sort(key=lambda item: LONGEST.index(item.path.name) if item.path.name in LONGEST else len(LONGEST))


@pytest.fixture(scope="session")
def boundary_rows() -> list[dict]:
    """Rows of the 22-digit boundary values for one mass."""
    return [row for row in _rows("boundaries.json")[1] if row["system"].startswith("sdof")]


@pytest.fixture(scope="session")
def all_boundaries() -> tuple[dict, list[dict]]:
    """Systems and rows of the 22-digit boundary values."""
    return _rows("boundaries.json")


@pytest.fixture(scope="session")
def steady_rows() -> list[dict]:
    """Rows of the 22-digit steady states for one mass."""
    return [row for row in _rows("steady_states.json")[1] if row["system"].startswith("sdof")]


@pytest.fixture(scope="session")
def all_steady() -> tuple[dict, list[dict]]:
    """Systems and rows of the 22-digit steady states."""
    return _rows("steady_states.json")


@pytest.fixture(scope="session")
def measured() -> Path:
    """The folder of synthetic measurements with their truths."""
    folder = REFERENCE / "identification"
    if not folder.is_dir():
        pytest.skip("the synthetic measurements are not at hand")
    return folder


@pytest.fixture(scope="session")
def cases() -> Path:
    """The folder of inputs that users reported."""
    folder = REFERENCE.parent / "cases"
    if not folder.is_dir():
        pytest.skip("the reported inputs are not at hand")
    return folder


@pytest.fixture(scope="session")
def curve_rows() -> tuple[dict, list[dict]]:
    """Systems and rows of the 17-digit quantities of response curves."""
    return _rows("curves.json")


@pytest.fixture(scope="session")
def browser():
    """Headless Chromium; tests that ask for it are skipped where there is none."""
    from browser import chromium  # imports the package: the cache of kernels is set by then

    with chromium() as driven:
        yield driven


@pytest.fixture(autouse=True)
def _without_pyplot(monkeypatch: pytest.MonkeyPatch) -> None:
    """A package that imports pyplot has it keep every figure: no test may see what another has imported."""
    monkeypatch.delitem(sys.modules, "matplotlib.pyplot", raising=False)
