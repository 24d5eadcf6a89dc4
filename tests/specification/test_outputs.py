"""Output files: whole or not there, nobody else's, nothing left beside them."""

import errno
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from fuzz.machine import prepared

import frictionmap as fm
from frictionmap import InputError
from frictionmap.files import places as outputs
from frictionmap.files import storage
from frictionmap.files.places import claimed

POSIX = pytest.mark.skipif(os.name == "nt", reason="permissions, links and locks of POSIX")


@pytest.fixture
def tiny():
    return fm.boundaries(fm.System(), [0.5, 2.0])


def write(text):
    """What a command would do with the path that it is given."""
    return lambda scratch: scratch.write_text(text)


def make(path, text="new", **options):
    with claimed(path, **options) as output:
        output.fill(write(text))


# Whole or not at all


def fail_halfway(error):
    def to_netcdf(self, path, **options):
        with open(path, "wb") as file:
            file.write(b"half")
        raise error

    return to_netcdf


@pytest.mark.parametrize(
    "error", [OSError("disk"), RuntimeError("HDF"), KeyboardInterrupt(), ValueError("x"), MemoryError()]
)
@pytest.mark.parametrize("existing", [True, False])
def test_a_failing_write_leaves_what_there_was(tiny, tmp_path, monkeypatch, error, existing):
    path = tmp_path / "out.nc"
    if existing:
        path.write_bytes(b"old")
    monkeypatch.setattr(xr.Dataset, "to_netcdf", fail_halfway(error))
    with pytest.raises(OSError if isinstance(error, RuntimeError) else type(error)):
        storage.write(tiny, path)
    assert os.listdir(tmp_path) == (["out.nc"] if existing else [])
    if existing:
        assert path.read_bytes() == b"old"


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (RuntimeError("NetCDF: HDF error"), r"NetCDF: HDF error; check disk space"),
        (OSError(errno.ENOSPC, "No space left on device", "/secret/scratch"), r"No space left on device.*"),
        (OSError("odd"), r"odd; check .*"),
    ],
)
def test_trouble_names_the_file_that_the_user_named(tiny, tmp_path, monkeypatch, error, words):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(xr.Dataset, "to_netcdf", fail_halfway(error))
    with pytest.raises(OSError, match=rf"^cannot write out\.nc: {words}$"):
        storage.write(tiny, Path("out.nc"))


def test_the_old_file_is_there_until_the_new_one_is_complete(tiny, tmp_path, monkeypatch):
    path = tmp_path / "out.nc"
    path.write_bytes(b"old")
    original = xr.Dataset.to_netcdf
    seen = []

    def to_netcdf(self, scratch, **options):
        original(self, scratch, **options)
        seen.append((path.read_bytes(), scratch.parent))

    monkeypatch.setattr(xr.Dataset, "to_netcdf", to_netcdf)
    storage.write(tiny, path)
    ((old, folder),) = seen
    assert old == b"old"
    assert folder.parent == tmp_path  # the same file system, so that the move is one step
    assert folder.name.startswith(".")
    assert os.listdir(tmp_path) == ["out.nc"]
    with xr.open_dataset(path) as ds:
        np.testing.assert_array_equal(ds.r, [0.5, 2.0])


def test_a_claim_leaves_nothing(tmp_path):
    with claimed(tmp_path / "out.nc"):
        assert len(os.listdir(tmp_path)) == 1
    assert os.listdir(tmp_path) == []


def test_a_place_that_cannot_be_written_to_is_refused_before_the_work(tmp_path, monkeypatch):
    def mkdir(self, **options):
        raise OSError(errno.EROFS, "Read-only file system")

    monkeypatch.setattr(Path, "mkdir", mkdir)
    with (
        pytest.raises(InputError, match=r"^cannot write .*out\.nc: Read-only file system; use another -o$"),
        claimed(tmp_path / "out.nc"),
    ):
        pytest.fail("the work began")


@pytest.mark.parametrize("name", ["x" * 252 + ".nc", "x." + "n" * 253])
def test_a_name_of_the_longest_length(tmp_path, name):
    make(tmp_path / name)
    assert os.listdir(tmp_path) == [name]


# Nobody else's


def test_no_output_is_an_input(tmp_path):
    given = tmp_path / "given.toml"
    given.write_text("given")
    names = ["given.toml", "folder/../given.toml", "symbolic", "hard", "link to link"]
    (tmp_path / "folder").mkdir()
    (tmp_path / "symbolic").symlink_to("given.toml")
    (tmp_path / "link to link").symlink_to("symbolic")
    (tmp_path / "hard").hardlink_to(given)
    for name in names:
        for overwrite in (False, True):
            with (
                pytest.raises(
                    InputError,
                    match=r"^cannot write .*: it is the input file .*given\.toml; use another -o$",
                ),
                claimed(tmp_path / name, overwrite, inputs=[given]),
            ):
                pytest.fail("the work began")
    assert given.read_text() == "given"


def test_a_file_that_appears_during_the_work_is_left_alone_and_so_is_the_result(tmp_path):
    path = tmp_path / "out.nc"
    (tmp_path / "out-1.nc").write_text("another")
    words = r"out\.nc: a file of this name has appeared meanwhile; the result is in .*out-2\.nc$"
    with claimed(path) as output:
        path.write_text("theirs")
        with pytest.raises(OSError, match=words):
            output.fill(write("ours"))
    assert path.read_text() == "theirs"
    assert (tmp_path / "out-1.nc").read_text() == "another"
    assert (tmp_path / "out-2.nc").read_text() == "ours"
    assert len(os.listdir(tmp_path)) == 3


@POSIX
def test_two_runs_to_one_name(tmp_path):
    """Also under another path of the same folder; another name is free."""
    (tmp_path / "folder").mkdir()
    with claimed(tmp_path / "out.nc"):
        for again in ("out.nc", "folder/../out.nc"):
            with (
                pytest.raises(InputError, match=r"out\.nc: another run is writing it"),
                claimed(tmp_path / again, overwrite=True),
            ):
                pytest.fail("the work began")
        make(tmp_path / "other.nc")
    make(tmp_path / "out.nc")
    assert sorted(os.listdir(tmp_path)) == ["folder", "other.nc", "out.nc"]


@POSIX
def test_of_many_runs_to_one_name_one_succeeds(tmp_path):
    """They start at the same moment, again and again."""
    for turn in range(100):
        path = tmp_path / f"{turn}.nc"
        start = threading.Barrier(4)
        found = []

        def run(number, path=path, start=start, found=found):
            start.wait()
            try:
                make(path, str(number))
                found.append(number)
            except InputError:
                pass

        threads = [threading.Thread(target=run, args=(number,)) for number in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert len(found) == 1
        assert path.read_text() == str(found[0])
    assert sorted(os.listdir(tmp_path)) == sorted(f"{turn}.nc" for turn in range(100))


def test_a_run_that_ends_between_a_look_and_a_claim(tmp_path, monkeypatch):
    """The second run had seen that there is no file; it is refused before its work, not after."""
    path = tmp_path / "out.nc"
    claim = outputs.Output.claim

    def late(output):
        monkeypatch.setattr(outputs.Output, "claim", claim)
        make(path, "first")
        claim(output)

    monkeypatch.setattr(outputs.Output, "claim", late)
    with pytest.raises(InputError, match=r"out\.nc: it already exists"), claimed(path):
        pytest.fail("the work began")
    assert path.read_text() == "first"
    assert os.listdir(tmp_path) == ["out.nc"]


def test_without_hard_links(tmp_path, monkeypatch):
    def link(source, target):
        raise OSError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(os, "link", link)
    path = tmp_path / "out.nc"
    make(path, "ours")
    assert path.read_text() == "ours"
    with claimed(tmp_path / "more.nc") as output:
        (tmp_path / "more.nc").write_text("theirs")
        with pytest.raises(OSError, match="appeared"):
            output.fill(write("ours"))
    assert (tmp_path / "more.nc").read_text() == "theirs"
    assert sorted(os.listdir(tmp_path)) == ["more-1.nc", "more.nc", "out.nc"]


# Trouble with what is printed, in the program itself


def program(folder, arguments, **streams):
    environment = os.environ | {"PYTHONPATH": str(Path(fm.__file__).parent.parent)}
    return subprocess.run(
        [sys.executable, "-m", "frictionmap", *arguments],
        cwd=folder, env=environment, text=True, timeout=600, **streams,
    )  # fmt: skip


@pytest.fixture
def folder(tmp_path, tiny):
    """A file whose title is not in ASCII, and a configuration."""
    storage.write(tiny.assign_attrs(title="Größe µ"), tmp_path / "file.nc")
    (tmp_path / "c.toml").write_text("[system]\n[grid]\nr = 0.5\nbeta = 1\n")
    return tmp_path


def test_an_ascii_terminal(folder, monkeypatch):
    monkeypatch.setenv("PYTHONIOENCODING", "ascii")
    done = program(folder, ["info", "file.nc"], capture_output=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith(r"Gr\xf6\xdfe \xb5 [boundaries]")


@POSIX
@pytest.mark.parametrize("arguments", [["info", "file.nc"], ["--help"], ["boundaries", "c.toml"]])
def test_whoever_reads_has_had_enough(folder, arguments):
    reading, writing = os.pipe()
    os.close(reading)
    done = program(folder, arguments, stdout=writing, stderr=subprocess.PIPE)
    os.close(writing)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device of Linux")
@pytest.mark.parametrize("arguments", [["info", "file.nc"], ["boundaries", "c.toml"]])
def test_what_is_printed_finds_a_full_disk(folder, arguments):
    with open("/dev/full", "w") as full:
        done = program(folder, arguments, stdout=full, stderr=subprocess.PIPE)
    assert done.returncode == 1
    assert done.stderr.startswith("frictionmap: cannot print: No space left on device")
    assert done.stderr.count("\n") == 1


@POSIX
def test_without_any_streams(folder):
    """No file of ours gets the number of a stream, and messages with it."""
    done = program(folder, ["boundaries", "c.toml"], preexec_fn=lambda: os.closerange(0, 3))
    assert done.returncode == 0
    assert storage_of(folder / "c-boundaries.nc").sizes["r"] == 1


def storage_of(path):
    with xr.open_dataset(path) as ds:
        return ds.load()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="limits of POSIX")
@pytest.mark.parametrize(
    ("arguments", "name"),
    [(["boundaries", "c.toml", "--set", "grid.r={start=0,stop=1,num=20000}"], "c-boundaries.nc")]
    + [(["plot", "file.nc", "-o", f"new.{ending}"], f"new.{ending}") for ending in ("png", "pdf", "svg")],
)
def test_a_full_disk(folder, arguments, name):
    """Stands for it: no file may be larger than 8 kB."""
    before = sorted(os.listdir(folder))
    done = program(folder, arguments, capture_output=True, preexec_fn=prepared(file_size=8192))
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.startswith(f"frictionmap: cannot write {name}: ")
    assert done.stderr.count("\n") == 1
    assert sorted(os.listdir(folder)) == before


# What the user pointed at


@POSIX
@pytest.mark.parametrize("existing", [True, False])
def test_a_link_is_followed(tmp_path, existing):
    (tmp_path / "far").mkdir()
    if existing:
        (tmp_path / "far" / "target").write_text("old")
    (tmp_path / "out.nc").symlink_to("far/target")
    make(tmp_path / "out.nc", overwrite=existing)
    assert (tmp_path / "out.nc").is_symlink()
    assert (tmp_path / "far" / "target").read_text() == "new"
    assert sorted(p.name for p in tmp_path.rglob("*")) == ["far", "out.nc", "target"]


@POSIX
def test_links_that_lead_nowhere(tmp_path):
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "no folder").symlink_to("missing/out.nc")
    for name in ("loop", "no folder"):
        with pytest.raises(InputError, match=name), claimed(tmp_path / name, overwrite=True):
            pytest.fail("the work began")
    assert sorted(os.listdir(tmp_path)) == ["loop", "no folder"]


@POSIX
@pytest.mark.parametrize(
    ("umask", "expected"), [(0o022, 0o644), (0o027, 0o640), (0o077, 0o600), (0o002, 0o664)]
)
def test_permissions_follow_the_umask(tiny, tmp_path, umask, expected):
    before = os.umask(umask)
    try:
        storage.write(tiny, tmp_path / "out.nc")
    finally:
        os.umask(before)
    assert (tmp_path / "out.nc").stat().st_mode & 0o777 == expected


@POSIX
@pytest.mark.parametrize("mode", [0o600, 0o664, 0o755])
def test_a_file_that_is_replaced_keeps_its_permissions(tmp_path, mode):
    path = tmp_path / "out.nc"
    path.write_text("old")
    path.chmod(mode)
    make(path, overwrite=True)
    assert path.read_text() == "new"
    assert path.stat().st_mode & 0o777 == mode


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="root alone may give files away")
def test_a_file_that_is_replaced_keeps_its_owner(tmp_path):
    path = tmp_path / "out.nc"
    path.write_text("old")
    os.chown(path, 65534, 65533)
    path.chmod(0o4640)
    make(path, overwrite=True)
    found = path.stat()
    assert (found.st_uid, found.st_gid, found.st_mode & 0o7777) == (65534, 65533, 0o4640)


def test_a_file_protected_from_writing_is_not_replaced(tmp_path, monkeypatch):
    path = tmp_path / "out.nc"
    path.write_text("old")
    monkeypatch.setattr(os, "access", lambda path, mode: mode != os.W_OK)  # root may do everything
    with pytest.raises(InputError, match="protected"), claimed(path, overwrite=True):
        pytest.fail("the work began")


# Interrupts and killed runs, in Python


def test_an_interrupt_while_a_file_is_written(tmp_path):
    """It is raised, what was begun is gone, and the next file can be written: no lock is held."""
    began = threading.Event()
    ended = threading.Event()

    def slow(scratch):
        scratch.write_text("half")
        began.set()
        time.sleep(0.5)
        ended.set()

    def interrupt():
        began.wait(60)
        signal.raise_signal(signal.SIGINT) if os.name == "nt" else os.kill(os.getpid(), signal.SIGINT)

    helper = threading.Thread(target=interrupt)
    helper.start()
    with pytest.raises(KeyboardInterrupt), claimed(tmp_path / "out.nc") as output:
        output.fill(slow)
    helper.join()
    assert ended.is_set()
    assert os.listdir(tmp_path) == []
    make(tmp_path / "out.nc")


KILLED = """
import os, signal, sys
from pathlib import Path
from frictionmap.files.places import claimed

def die(scratch):
    scratch.write_text("half")
    os.kill(os.getpid(), signal.SIGKILL)

with claimed(Path(sys.argv[1])) as output:
    output.fill(die)
"""


def leave(path):
    """What a killed run leaves."""
    environment = os.environ | {"PYTHONPATH": str(Path(fm.__file__).parent.parent)}
    done = subprocess.run([sys.executable, "-c", KILLED, str(path)], env=environment, timeout=120)
    assert done.returncode == -signal.SIGKILL


@POSIX
@pytest.mark.parametrize("name", ["one.nc", "two.nc"])
def test_the_next_run_clears_away_what_killed_runs_have_left(tmp_path, name):
    """Whether it has the same name or another."""
    leave(tmp_path / "one.nc")
    (left,) = tmp_path.iterdir()
    assert any(file.read_bytes() == b"half" for file in left.iterdir())
    make(tmp_path / name)
    assert os.listdir(tmp_path) == [name]


@POSIX
def test_what_is_not_a_leftover_stays(tmp_path):
    """Folders of runs that are alive, of others, of the user."""
    (tmp_path / ".frictionmap-notes").mkdir()
    (tmp_path / ".frictionmap-0123456789abcdef").mkdir()
    (tmp_path / ".frictionmap-0123456789abcdef" / "thesis.tex").write_text("all of it")
    (tmp_path / ".frictionmap-0123456789abcdef" / "lock").write_text("")
    with claimed(tmp_path / "alive.nc") as output:
        output.fill(write("first"))
        make(tmp_path / "other.nc")
        assert len(list(tmp_path.glob(".frictionmap-*"))) == 3
    assert (tmp_path / ".frictionmap-notes").is_dir()
    assert (tmp_path / ".frictionmap-0123456789abcdef" / "thesis.tex").read_text() == "all of it"
    assert (tmp_path / "alive.nc").read_text() == "first"


def test_a_file_system_without_locks(tmp_path, monkeypatch):
    def flock(handle):
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(outputs, "_flock", flock)
    with claimed(tmp_path / "one.nc") as output:
        make(tmp_path / "two.nc")  # does not clear away what may be alive
        output.fill(write("one"))
    assert sorted(os.listdir(tmp_path)) == ["one.nc", "two.nc"]
