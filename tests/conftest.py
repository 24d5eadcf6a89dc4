"""Shared set-up: where kernels are cached, and where the reference values lie."""

import json
import os
import signal
import sys
import tempfile
from collections.abc import Callable
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

#: Files that take a minute or so, first: a worker that begins one of them last works on alone.
LONGEST = (
    "test_quick_benchmarks.py", "test_unexplained.py", "test_contact_stiffness.py", "test_stores.py",
    "test_cache.py", "test_compiler.py", "test_explore_goals.py", "test_explore_goals_page.py",
    "test_explore_page.py", "test_fuzz.py", "test_explore_contacts_page.py", "test_explore_alive.py",
    "test_interrupts.py", "test_stores_cut.py",
)  # fmt: skip


#: Fixtures that mark the tests that use them.
FIXTURES = {"reference": "reference_path", "browser": "browser"}

#: Files of tests by what they need beside the package and a processor: a place to build, install, kill or
#: fill; minutes of measurements.
MARKED = {
    "environment": (
        "test_wheel.py", "test_manual.py", "test_manual_commands.py", "test_gallery.py", "test_readme.py",
        "test_processors.py", "test_memory.py", "test_cache.py", "test_compiler.py", "test_interrupts.py",
        "test_stores.py", "test_stores_cut.py", "test_fuzz.py", "test_harness.py",
    ),
    "benchmark": ("test_quick_benchmarks.py",),
}  # fmt: skip


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option of the trials with invalid input."""
    whole = "tests that take minutes (marker `whole`), too; tests/fuzz: all trials, not some of every kind"
    parser.addoption("--whole", action="store_true", help=whole)


def pytest_configure(config: pytest.Config) -> None:
    """Let workers take files in the order of collection; xdist would take those with few tests last."""
    if hasattr(config.option, "loadscopereorder"):
        config.option.loadscopereorder = False


@pytest.hookimpl(tryfirst=True)
def pytest_sessionstart(session: pytest.Session) -> None:
    """Compile the kernels before several workers run all tests, so that none compiles what another does."""
    config = session.config
    workers = getattr(config.option, "numprocesses", None) or 0
    whole = config.args_source is not pytest.Config.ArgsSource.ARGS and not config.option.collectonly
    if workers > 1 and whole and os.environ.get("NUMBA_DISABLE_JIT", "0") in ("", "0"):
        import precompile  # imports the package: the cache of kernels is set by then

        precompile.all_parts()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Mark tests by what they need, skip those that take minutes, and begin with the longest files."""
    for item in items:
        if item.get_closest_marker("whole") and not config.getoption("--whole"):
            item.add_marker(pytest.mark.skip(reason="takes minutes; run with --whole"))
        fixtures = getattr(item, "fixturenames", ())
        needed = [name for name, files in MARKED.items() if item.path.name in files]
        needed += [name for name, fixture in FIXTURES.items() if fixture in fixtures]
        for name in needed:
            item.add_marker(name)
    items.sort(key=lambda item: LONGEST.index(item.path.name) if item.path.name in LONGEST else len(LONGEST))


@pytest.fixture(scope="session")
def reference_path() -> Callable[[str], Path]:
    """Path of a file or folder of the reference data; the test is skipped where it is not at hand.

    No clone holds these data.  Nothing else finds them: whatever uses this gets the marker `reference`.
    """
    folder = Path(os.environ.get("FRICTIONMAP_REFERENCE", ROOT.parent / "shared" / "reference"))

    def find(name: str) -> Path:
        if not (folder / name).exists():
            pytest.skip(f"the reference data {name} are not at hand")
        return folder / name

    return find


@pytest.fixture(scope="session")
def reference_table(reference_path: Callable[[str], Path]) -> Callable[[str], dict]:
    """Content of a file of the reference data."""
    return lambda name: json.loads(reference_path(name).read_text())


@pytest.fixture(scope="session")
def all_boundaries(reference_table: Callable[[str], dict]) -> tuple[dict, list[dict]]:
    """Systems and rows of the 22-digit boundary values."""
    content = reference_table("boundaries.json")
    return content["systems"], content["rows"]


@pytest.fixture(scope="session")
def boundary_rows(all_boundaries: tuple[dict, list[dict]]) -> list[dict]:
    """Rows of the 22-digit boundary values for one mass."""
    return [row for row in all_boundaries[1] if row["system"].startswith("sdof")]


@pytest.fixture(scope="session")
def all_steady(reference_table: Callable[[str], dict]) -> tuple[dict, list[dict]]:
    """Systems and rows of the 22-digit steady states."""
    content = reference_table("steady_states.json")
    return content["systems"], content["rows"]


@pytest.fixture(scope="session")
def steady_rows(all_steady: tuple[dict, list[dict]]) -> list[dict]:
    """Rows of the 22-digit steady states for one mass."""
    return [row for row in all_steady[1] if row["system"].startswith("sdof")]


@pytest.fixture(scope="session")
def measured(reference_path: Callable[[str], Path]) -> Path:
    """The folder of synthetic measurements with their truths."""
    return reference_path("identification")


@pytest.fixture(scope="session")
def cases(reference_path: Callable[[str], Path]) -> Path:
    """The folder of inputs that users reported, beside the reference data."""
    return reference_path("../cases")


@pytest.fixture(scope="session")
def curve_rows(reference_table: Callable[[str], dict]) -> tuple[dict, list[dict]]:
    """Systems and rows of the 17-digit quantities of response curves."""
    content = reference_table("curves.json")
    return content["systems"], content["rows"]


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
