"""Compiled kernels on disk: found again, never believed when damaged, kept wherever there is a place."""

import ast
import functools
import os
import pickle
import shutil
import stat
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numba
import pytest
from fuzz.machine import prepared

import frictionmap as fm
from frictionmap._kernels.compiler import entry, folders, notices, sources

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")
POSIX = pytest.mark.skipif(os.name == "nt", reason="permissions of POSIX")


KERNELS = sources.SOURCES


def twice(x):
    return 2.0 * x


def thrice(x):
    return 3.0 * x


def user_cache(monkeypatch, path):
    monkeypatch.setattr(folders, "_user_cache", lambda: Path(path))


def forget():
    """As in a new process."""
    for known in (
        folders.folders, folders.versions, folders.state, folders.forget, notices.warn_once,
        sources._source, sources.digest_of_all, sources.digest_for,
    ):  # fmt: skip
        known.cache_clear()


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch):
    """The folder of NUMBA_CACHE_DIR, empty; the user's and the temporary one lie beside it."""
    # numba reads its settings anew where one has changed in the environment: both have to say the same
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "given"))
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "given"))
    user_cache(monkeypatch, tmp_path / "user")
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr(tempfile, "gettempdir", lambda: str(tmp_path / "temporary"))
    forget()
    yield tmp_path / "given"
    forget()


def hits(function=twice):
    """Call the function as a new process would; whether it was found on disk."""
    forget()
    compiled = entry(function)
    assert compiled(1.5) == function(1.5)
    return len(compiled.stats.cache_hits)


def only_file(place):
    (file,) = (path for path in place.rglob("*") if not path.is_dir())
    return file


def test_found_again(place, tmp_path):
    assert [hits(), hits()] == [0, 1]
    assert list((tmp_path / "temporary").iterdir()) == []
    assert not (tmp_path / "user").exists()
    assert only_file(place).name.startswith("test_cache.twice-")


def test_each_type_and_each_function_has_a_file_of_its_own(place):
    assert [hits(), hits(thrice), hits(), hits(thrice)] == [0, 0, 1, 1]
    assert entry(twice)(3) == 6
    assert len(list(place.rglob("*.nbc"))) == 3


def test_listeners_hear_of_what_is_compiled(place, monkeypatch):
    heard = []
    monkeypatch.setattr(notices, "listeners", [lambda: heard.append(1)])
    hits()
    assert heard == [1]
    hits()
    assert heard == [1]


#: A kernel that two others call.
SHARED = """
from frictionmap._kernels.compiler import entry, kernel

@kernel
def increased(x):
    return x + 1.0

@entry
def once(x):
    return increased(x)

@entry
def twice(x):
    return increased(increased(x))
"""


def test_what_is_compiled_later_calls_what_was_kept(place, tmp_path):
    """In a new process: what it compiles calls what an earlier one has compiled for something else."""
    (tmp_path / "shared.py").write_text(SHARED)
    search = os.pathsep.join([str(tmp_path), str(Path(fm.__file__).parent.parent)])
    said = [
        subprocess.run(
            [sys.executable, "-c", f"import shared; print(shared.{name}(1.0))"],
            env=os.environ | {"PYTHONPATH": search}, capture_output=True, text=True, timeout=600,
        )
        for name in ("once", "twice", "once")
    ]  # fmt: skip
    assert [(done.returncode, done.stdout) for done in said] == [(0, "2.0\n"), (0, "3.0\n"), (0, "2.0\n")]
    assert len(list(place.rglob("*.nbc"))) == 3


# Damage


def cut(path):
    path.write_bytes(path.read_bytes()[:-100])


def flip(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def folder(path):
    path.unlink()
    path.mkdir()


def swap(path):
    """Another kernel, whole, under this one's name."""
    hits(thrice)
    (other,) = set(path.parent.iterdir()) - {path}
    other.replace(path)


def loop(path):
    path.unlink()
    path.symlink_to(path)


def pipe(path):
    path.unlink()
    os.mkfifo(path)


DAMAGES = {
    "cut off": cut,
    "empty": lambda path: path.write_bytes(b""),
    "shorter than a digest": lambda path: path.write_bytes(b"frictionmap"),
    "zeros": lambda path: path.write_bytes(bytes(path.stat().st_size)),
    "garbage": lambda path: path.write_bytes(os.urandom(path.stat().st_size)),
    "one bit": flip,
    "another pickle": lambda path: path.write_bytes(pickle.dumps([1, 2])),
    "another kernel": swap,
    "a folder": folder,
    "a link to itself": loop,
    "a pipe": pipe,
}


@POSIX
@pytest.mark.parametrize("damage", DAMAGES.values(), ids=DAMAGES)
def test_what_is_damaged_is_compiled_anew_and_that_is_said_once(place, caplog, damage):
    hits()
    file = only_file(place)
    damage(file)
    forget()
    one, two = entry(twice), entry(twice)
    assert one(1.5) == two(1.5) == 3.0
    assert len(one.stats.cache_hits) == 0
    message = f"frictionmap: the compiled kernels in {file.parent} are damaged; they are compiled again"
    assert caplog.messages == [message]
    assert hits() == 1
    assert caplog.messages == [message]


def test_a_folder_with_something_in_it_instead_of_a_kernel(place, caplog):
    """It stays; the kernel is compiled in every run."""
    hits()
    file = only_file(place)
    folder(file)
    (file / "thesis.tex").write_text("all of it")
    assert hits() == 0
    damaged, lost = caplog.messages
    assert "damaged" in damaged
    assert f"cannot keep compiled kernels in {file.parent}: Directory not empty;" in lost
    assert (file / "thesis.tex").read_text() == "all of it"


# Places


@pytest.fixture
def unwritable(monkeypatch):
    """A set of folders that cannot be written to; root would write in any."""
    found = set()
    access = os.access
    monkeypatch.setattr(
        os, "access", lambda path, mode: not found & {path, *Path(path).parents} and access(path, mode)
    )
    return found


def test_the_next_place_is_taken_if_one_cannot_be_written(place, unwritable, tmp_path, caplog):
    unwritable.add(place)
    assert [hits(), hits()] == [0, 1]
    assert list((tmp_path / "user").rglob("*.nbc"))
    message = (
        f"frictionmap: cannot keep compiled kernels in {place}: it cannot be written to; "
        f"they are kept in {tmp_path / 'user'}"
    )
    assert caplog.messages == [message]

    unwritable.add(tmp_path / "user")
    assert [hits(thrice), hits(thrice)] == [0, 1]
    (temporary,) = (tmp_path / "temporary").iterdir()
    assert caplog.messages[1].endswith(f"they are kept in {temporary}")
    if os.name != "nt":
        assert stat.S_IMODE(temporary.stat().st_mode) == 0o700


def test_kernels_that_can_only_be_read_are_used(place, unwritable, tmp_path, caplog):
    """As in a container whose image was made with the kernels in it."""
    hits()
    unwritable.add(place)
    assert [hits(), hits(thrice), hits(thrice)] == [1, 0, 1]
    assert len(list(place.rglob("*.nbc"))) == len(list((tmp_path / "user").rglob("*.nbc"))) == 1


def test_no_place_at_all(place, unwritable, tmp_path, caplog):
    unwritable.update((place, tmp_path / "user", tmp_path / "temporary"))
    assert [hits(), hits()] == [0, 0]
    lines = caplog.messages
    assert len(lines) == 2  # one a process
    where = f"{place}, {tmp_path / 'user'}, {tmp_path / 'temporary'}"
    assert lines[0].startswith(f"frictionmap: cannot keep compiled kernels: none of {where}")
    assert lines[0].endswith("can be written to; every run compiles them again")


@POSIX
@pytest.mark.parametrize("mode", [0o777, 0o755, 0o770, 0o700])
def test_a_temporary_folder_that_others_can_enter_is_not_trusted(place, unwritable, tmp_path, mode):
    unwritable.update((place, tmp_path / "user"))
    folder = tmp_path / "temporary" / f"frictionmap-{os.getuid()}"
    folder.mkdir()
    folder.chmod(mode)
    assert [hits(), hits()] == [0, int(mode == 0o700)]


@POSIX
def test_a_temporary_folder_that_is_a_link_is_not_trusted(place, unwritable, tmp_path):
    unwritable.update((place, tmp_path / "user"))
    (tmp_path / "theirs").mkdir(mode=0o700)
    (tmp_path / "temporary" / f"frictionmap-{os.getuid()}").symlink_to(tmp_path / "theirs")
    assert [hits(), hits()] == [0, 0]
    assert list((tmp_path / "theirs").iterdir()) == []


def test_the_current_folder_is_no_temporary_one(place, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path / "temporary")
    assert len(folders.places()) == 2


def test_without_a_home(place, monkeypatch):
    """What would be a folder named ~ in the current one is no place."""
    user_cache(monkeypatch, "~/.cache")
    assert all(path.is_absolute() for path in folders.places())


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="places of Linux")
def test_the_cache_of_the_user_follows_the_environment(monkeypatch, tmp_path):
    monkeypatch.undo()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "own"))
    assert folders._user_cache() == tmp_path / "own" / "frictionmap"
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert folders._user_cache() == tmp_path / ".cache" / "frictionmap"


# What a kernel depends on


@pytest.fixture
def tree(tmp_path, monkeypatch):
    """A copy of the sources of all kernels that the package takes for its own."""
    package = Path(fm.__file__).parent
    copied = tmp_path / "package"
    shutil.copytree(package / "_kernels", copied / "_kernels", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(package / "regimes.py", copied)
    monkeypatch.setattr(sources, "SOURCES", copied / "_kernels")
    forget()
    return copied / "_kernels"


def modules(tree):
    """Every module of kernels with the digest of its sources."""
    forget()
    names = [name_of(path, tree) for path in tree.rglob("*.py") if path.parent.name != "compiler"]
    return {name: sources.digest_for(f"frictionmap._kernels.{name}") for name in names}


@functools.cache
def importing():
    """The modules of kernels that each module imports, by Python's own reading of the files."""
    found = {}
    for path in KERNELS.rglob("*.py"):
        found[path] = set()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.level:
                place = path.parents[node.level - 1].joinpath(*(node.module or "").split("."))
                named = [place / f"{alias.name}.py" for alias in node.names]
                found[path] |= {file for file in (place.with_suffix(".py"), *named) if file.is_file()}
            elif isinstance(node, ast.Import | ast.ImportFrom):
                assert "frictionmap" not in ast.unparse(node)
    return {path: {file for file in files if file.is_relative_to(KERNELS)} for path, files in found.items()}


def name_of(path, folder=KERNELS):
    return ".".join(path.relative_to(folder).with_suffix("").parts)


def test_sources_are_those_that_python_would_import():
    assert sum(map(len, importing().values())) > 300
    for path, files in importing().items():
        assert files <= sources._source(path).imports <= {*files, *KERNELS.rglob("__init__.py")}, path


def test_folders_of_kernels_have_no_code_of_their_own():
    """An import from a folder is an import of its modules."""
    for path in KERNELS.rglob("__init__.py"):
        body = ast.parse(path.read_text(encoding="utf-8")).body
        assert path.parent.name == "compiler" or [type(node) for node in body] == [ast.Expr], path


@pytest.mark.parametrize(
    "edited", ["closed_form", "engine.fill", "engine.motion", "general.events", "structure.newton", "logs"]
)
def test_an_edit_concerns_what_reaches_the_file_and_nothing_else(tree, edited):
    before = modules(tree)
    path = tree.joinpath(*edited.split(".")).with_suffix(".py")
    path.write_text(path.read_text() + "\n")
    after = modules(tree)
    reaching, more = set(), {edited}
    while more:
        reaching |= more
        more = {name_of(file) for file, files in importing().items() if reaching & set(map(name_of, files))}
        more -= reaching
    assert {name for name in before if after[name] != before[name]} == reaching
    assert len(reaching) < len(before)


@pytest.mark.parametrize("edited", ["../regimes", "compiler/linking"])
def test_codes_and_compiler_concern_every_kernel(tree, edited):
    before = modules(tree)
    path = tree / f"{edited}.py"
    path.write_text(path.read_text() + "\n")
    after = modules(tree)
    assert all(after[name] != before[name] for name in before)


#: Modules of kernels: `outer` reaches the other two, `apart` neither.  `reads` gets its argument from
#: a file that it does not import.
SMALL = {
    "numbers": "FACTOR = 2.0\n",
    "inner": """
from .compiler import kernel
from .numbers import FACTOR

@kernel
def times(x):
    return FACTOR * x
""",
    "outer": """
from .compiler import entry
from .inner import (
    times,
)

@entry
def shifted(x):
    return times(x) + 1.0
""",
    "apart": """
from .compiler import entry, kernel

@kernel
def halved(x):
    return 0.5 * x

@entry
def quartered(x):
    return halved(halved(x))
""",
    "pairs": """
from typing import NamedTuple

class Pair(NamedTuple):
    first: float
    second: float
""",
    "reads": """
from .compiler import entry

@entry
def first_of(pair):
    return pair.first
""",
}


class Copied:
    """A copy of the package with some kernels of its own."""

    def __init__(self, site):
        self.kernels = site / "frictionmap" / "_kernels"
        self.place = site / "kernels"
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(Path(fm.__file__).parent, site / "frictionmap", ignore=ignored)
        for name, text in SMALL.items():
            (self.kernels / f"{name}.py").write_text(text)

    def edit(self, name, old, new):
        text = (self.kernels / f"{name}.py").read_text()
        assert old in text
        (self.kernels / f"{name}.py").write_text(text.replace(old, new))

    def ask(self):
        """Answers of a new process, and the names of the kernels that it has compiled."""
        code = (
            "from frictionmap._kernels import apart, outer, pairs, reads;"
            "pair = pairs.Pair(second=5.0, first=7.0);"
            "print(outer.shifted(3.0), apart.quartered(3.0), reads.first_of(pair))"
        )
        before = set(self.place.rglob("*.nbc"))
        environment = {"PYTHONPATH": str(self.kernels.parent.parent), "NUMBA_CACHE_DIR": str(self.place)}
        done = subprocess.run(
            [sys.executable, "-B", "-c", code],
            env=os.environ | environment, cwd=self.place.parent, capture_output=True, text=True, timeout=600,
        )  # fmt: skip
        assert (done.returncode, done.stderr) == (0, "")
        new = set(self.place.rglob("*.nbc")) - before
        return [float(x) for x in done.stdout.split()], {
            file.name.rpartition("-")[0].removeprefix("frictionmap._kernels.") for file in new
        }


def test_an_edit_compiles_what_depends_on_it_and_loads_the_rest(tmp_path):
    """Callee, caller, constant and the fields of an argument are edited in turn, and then all is undone."""
    copied = Copied(tmp_path)
    all_kernels = {"inner.times", "outer.shifted", "apart.halved", "apart.quartered", "reads.first_of"}
    assert copied.ask() == ([7.0, 0.75, 7.0], all_kernels)
    assert copied.ask() == ([7.0, 0.75, 7.0], set())
    copied.edit("inner", "FACTOR * x", "FACTOR * x * x")
    assert copied.ask() == ([19.0, 0.75, 7.0], {"inner.times", "outer.shifted"})
    copied.edit("outer", "1.0", "2.0")
    assert copied.ask() == ([20.0, 0.75, 7.0], {"outer.shifted"})
    copied.edit("numbers", "2.0", "3.0")
    assert copied.ask() == ([29.0, 0.75, 7.0], {"inner.times", "outer.shifted"})
    copied.edit("pairs", "    first: float\n    second: float\n", "    second: float\n    first: float\n")
    assert copied.ask() == ([29.0, 0.75, 7.0], {"reads.first_of"})
    for name, text in SMALL.items():
        (copied.kernels / f"{name}.py").write_text(text)
    assert copied.ask() == ([7.0, 0.75, 7.0], set())


def test_a_function_from_elsewhere_depends_on_its_own_file_and_on_all_kernels(tree, tmp_path, monkeypatch):
    own = tmp_path / "own.py"
    own.write_text("a = 1")
    monkeypatch.setattr(sys.modules[__name__], "__file__", str(own))
    assert [hits(), hits()] == [0, 1]
    for path in (own, tree / "engine" / "fill.py", tree / "logs.py"):
        path.write_text(path.read_text() + "\n")
        assert [hits(), hits()] == [0, 1]


def test_another_setting_of_numba_has_another_folder(place, monkeypatch):
    assert [hits(), hits()] == [0, 1]
    monkeypatch.setenv("NUMBA_BOUNDSCHECK", "1")
    assert [hits(), hits()] == [0, 1]
    monkeypatch.setenv("NUMBA_NUM_THREADS", "1")
    assert hits() == 1
    assert len(list(place.iterdir())) == 2


def test_plain_numba_has_a_folder_for_each_state_of_the_sources(tree):
    before = folders.state()
    forget()
    assert folders.state() == before != folders.versions()
    (tree / "logs.py").write_text("")
    forget()
    assert folders.state() != before


# What is no longer used

LONG_AGO = time.time() - 100 * 86400


def test_kernels_not_used_for_long_go(place):
    old, recent, other, in_use = (place / f"kernels-{16 * letter}" for letter in "abcd")
    for path in (old, recent, other, in_use):
        path.mkdir(parents=True)
        (path / "new-half").write_text("")
        (path / "kernel.nbc").write_text("")
    (in_use / "unused.nbc").write_text("")
    (other / "thesis.tex").write_text("all of it")
    (old / "engine_0").mkdir()  # of plain numba
    for ending in ("nbi", "1.nbc"):
        (old / "engine_0" / f"fill.{ending}").write_text("")
    for path in (
        old / "kernel.nbc", other / "kernel.nbc", in_use / "unused.nbc",
        *place.glob("*/new-half"), old, other, in_use,
    ):  # fmt: skip
        os.utime(path, (LONG_AGO, LONG_AGO))
    hits()
    assert not old.exists()
    assert [path.name for path in recent.iterdir()] == ["kernel.nbc"]
    assert [path.name for path in in_use.iterdir()] == ["kernel.nbc"]
    assert [path.name for path in other.iterdir()] == ["thesis.tex"]


def test_kernels_of_former_sources_go_when_new_ones_are_compiled(place):
    """They lie in the same folder, which is there already."""
    hits()
    former = only_file(place).with_name("former.nbc")
    former.write_text("")
    os.utime(former, (LONG_AGO, LONG_AGO))
    hits()
    assert former.exists()
    hits(thrice)
    assert not former.exists()


def test_a_kernel_that_is_used_is_not_old(place):
    hits()
    file = only_file(place)
    os.utime(file, (LONG_AGO, LONG_AGO))
    assert [hits(), hits(thrice), hits()] == [1, 0, 1]


# For real


@pytest.fixture
def installed(tmp_path):
    """A copy of the package, a home, a configuration."""
    package = Path(fm.__file__).parent
    shutil.copytree(package, tmp_path / "site" / "frictionmap", ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("home", "work"):
        (tmp_path / name).mkdir()
    (tmp_path / "work" / "c.toml").write_text("[system]\n[grid]\nr = [0.5, 2.0]\nbeta = 1\n")
    yield tmp_path
    for path in tmp_path.rglob("*"):
        if path.is_dir() and not path.is_symlink():
            path.chmod(0o755)


def run(installed, **environment):
    """The program, permissions holding for it even if it is root's; what it says."""
    left_out = ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME", "TMPDIR", "HOME", "PYTHONPATH")
    kept = {name: value for name, value in os.environ.items() if name not in left_out}
    arguments = ["boundaries", "c.toml", "-o", "out.nc", "--overwrite", "--quiet"]
    done = subprocess.run(
        [sys.executable, "-B", "-m", "frictionmap", *arguments],
        env=kept | {"PYTHONPATH": str(installed / "site"), **environment},
        cwd=installed / "work", capture_output=True, text=True, timeout=1800,
        preexec_fn=prepared(ordinary=True),
    )  # fmt: skip
    assert (done.returncode, done.stdout) == (0, ""), done.stderr
    return done.stderr


@POSIX
def test_package_and_home_that_cannot_be_written(installed):
    """Without any cache, with a temporary folder, with a cache that the image brings along."""
    package, home, work = installed / "site" / "frictionmap", installed / "home", installed / "work"
    for path in [package, *package.rglob("*"), home]:
        if path.is_dir():
            path.chmod(0o555)
    own = package / "_kernels" / "__pycache__"
    places = f"{own}, {home}/.cache/frictionmap"
    none = f"frictionmap: cannot keep compiled kernels: none of {places} can be written to"
    said = run(installed, HOME=str(home), TMPDIR=str(work))  # the current folder does not count
    assert said.startswith(none)

    temporary = installed / "temporary"
    kept = temporary / f"frictionmap-{os.getuid()}"
    cannot = f"frictionmap: cannot keep compiled kernels in {own}: it cannot be written to"
    message = f"{cannot}; they are kept in {kept}\n"
    assert run(installed, HOME=str(home), TMPDIR=str(temporary)) == message
    assert run(installed, HOME=str(home), TMPDIR=str(temporary)) == ""

    own.parent.chmod(0o755)
    shutil.copytree(kept, own)
    for path in (own.parent, own, *own.iterdir()):
        path.chmod(0o555)
    assert run(installed, HOME=str(home), TMPDIR=str(work)) == ""
    assert sorted(path.name for path in work.iterdir()) == ["c.toml", "out.nc"]


@POSIX
def test_a_cache_in_ruins(installed):
    """Every file of it; the next run says so, the one after it has nothing to say."""
    own = installed / "work" / "own"
    assert run(installed, NUMBA_CACHE_DIR=str(own)) == ""
    files = list(own.rglob("*.nbc"))
    assert len(files) > 5
    for path, damage in zip(files, (cut, flip, folder, loop, DAMAGES["empty"]) * 10, strict=False):
        damage(path)
    err = run(installed, NUMBA_CACHE_DIR=str(own))
    assert (
        err
        == f"frictionmap: the compiled kernels in {files[0].parent} are damaged; they are compiled again\n"
    )
    assert run(installed, NUMBA_CACHE_DIR=str(own)) == ""


# Kernels that are called by name

CALLS = """
import sys
from collections import Counter
from frictionmap._kernels.compiler import linking, notices
if "inner" not in sys.argv:
    linking._SMALL = 0  # all are
from frictionmap._kernels.compiler import entry, kernel

compiled = []
notices.listeners.append(lambda: compiled.append(1))

@kernel
def half(x):
    return 0.5 * x

@kernel
def quarter(x):
    return half(half(x))

@entry
def eighth(x):
    return half(quarter(x))

class Taken(Counter):
    def __missing__(self, name):
        return 1 if ".half" in name else 0

if "taken" in sys.argv:  # the name of `half` is
    linking._times = Taken()
print(eighth(1.0), len(compiled))
"""


def run_calls(place, *arguments):
    """How many kernels a new process compiled, whose answer is right."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(place)}
    command = [sys.executable, "-c", CALLS, *arguments]
    found = subprocess.run(command, env=environment, capture_output=True, text=True, check=True, timeout=600)
    value, compiled = found.stdout.split()
    assert float(value) == 0.125
    return int(compiled)


def kept(place, name):
    """The file of a kernel."""
    (file,) = place.rglob(f"*.{name}-*.nbc")
    return file


def test_kernels_that_are_called_by_name_are_compiled_once(place):
    assert [run_calls(place), run_calls(place)] == [3, 0]


@pytest.mark.parametrize("name", ["half", "quarter", "eighth"])
@pytest.mark.parametrize("damage", [Path.unlink, cut], ids=["missing", "damaged"])
def test_a_kernel_that_is_missing_is_compiled_anew_with_those_that_call_it(place, name, damage):
    run_calls(place)
    damage(kept(place, name))
    assert run_calls(place) > 0
    assert run_calls(place) == 0


def test_a_caller_is_compiled_with_inner_kernels_from_the_disk(place):
    """Inner kernels have no code of their own in the process, whose environment could be set."""
    run_calls(place, "inner")
    kept(place, "eighth").unlink()
    assert [run_calls(place, "inner"), run_calls(place, "inner")] == [1, 0]


def test_callers_of_a_kernel_that_has_another_name_now_are_compiled_anew(place):
    run_calls(place)
    first = kept(place, "half").read_bytes()
    kept(place, "half").unlink()
    assert run_calls(place, "taken") == 3
    kept(place, "half").write_bytes(first)
    assert run_calls(place) == 2  # the callers: what they call by name is no more
    assert run_calls(place) == 0
