"""Interrupts of the program: the end comes soon and nothing is left; at random moments: tests/fuzz."""

import contextlib
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from conftest import ROOT

ENVIRONMENT = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}

pytestmark = pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")

#: Seconds after which a run that does not end counts as hung, on a machine ten times as slow as a slow one.
HANG = 120.0

CONFIG = """\
[system]
contact = "fixed-wall"
[grid]
r = { start = 0.02, stop = 2.5, num = 500 }
beta = { start = 0.01, stop = 3.0, num = 400 }
"""

NOTHING = "frictionmap: interrupted; nothing was written"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A configuration and its boundaries; the kernels are compiled."""
    folder = tmp_path_factory.mktemp("interrupts")
    (folder / "large.toml").write_text(CONFIG)
    few = ["--set", "grid.r=[0.3, 0.8]", "--set", "grid.beta=[0.1, 0.5]"]
    run(folder, "map", "large.toml", "-o", "small.nc", *few)
    run(folder, "boundaries", "large.toml", "-o", "boundaries.nc")
    return folder


def start(folder, *arguments, **options):
    command = [sys.executable, "-m", "frictionmap", *arguments]
    return subprocess.Popen(
        command, cwd=folder, env=ENVIRONMENT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        **options,
    )  # fmt: skip


def run(folder, *arguments):
    """Run the program to its end."""
    process = start(folder, *arguments)
    assert process.communicate(timeout=10 * HANG) is not None
    assert process.returncode == 0


def wait_until_caught(process, number):
    """Wait until the program has its own handler for a signal, or has ended."""
    status = Path(f"/proc/{process.pid}/status")
    if not status.exists():  # only Linux lists them
        time.sleep(1.0)
        return
    wanted = 1 << (number - 1)
    while process.poll() is None:
        caught = re.search(r"^SigCgt:\s*(\w+)", status.read_text(), re.MULTILINE)
        if caught and int(caught[1], 16) & wanted:
            return
        time.sleep(0.001)


def listing(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


COMMANDS = {
    "map": ["map", "large.toml", "--quiet", "-o", "new.nc"],
    "boundaries": ["boundaries", "large.toml", "-o", "new.nc"],
}


#: A write that takes as long as it likes and holds the interpreter's lock of no file, as netCDF's does.
WRITING = """
import sys, time
import frictionmap.files.storage
def write_netcdf(ds, path, command=""):
    path.write_text("half")
    print("writing", flush=True)
    time.sleep({seconds})
frictionmap.files.storage.write_netcdf = write_netcdf
from frictionmap.__main__ import run
sys.argv = ["frictionmap", "boundaries", "large.toml", "-o", "new.nc"]
sys.exit(run())
"""

BUSY = {
    "writing": (WRITING.format(seconds=1000), "writing"),
    "in the main thread": (
        "import sys, time\n"
        "from frictionmap.command_line import interrupts\n"
        "interrupts.obey()\n"
        "import ctypes\n"
        "print('busy', flush=True)\n"
        "while True:\n"
        "    ctypes.CDLL(None).sleep(1000)\n",
        "busy",
    ),
}


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
@pytest.mark.parametrize("work", BUSY)
def test_in_the_middle_of_something_that_takes_long(folder, work, name):
    """A file that takes a quarter of an hour to write; a library that does not come back, as LLVM's."""
    code, word = BUSY[work]
    before = listing(folder)
    process = subprocess.Popen(
        [sys.executable, "-c", code], cwd=folder, env=ENVIRONMENT, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stdout.readline() == f"{word}\n"
    began = time.monotonic()
    process.send_signal(getattr(signal, name))
    _, err = process.communicate(timeout=HANG)
    assert time.monotonic() - began < 20.0
    assert process.returncode == 130
    assert err == f"{NOTHING}\n"
    assert listing(folder) == before


LATE = """
import sys, time
from frictionmap.__main__ import run
class Slow:
    def write(self, text):
        sys.__stdout__.write("printing\\n")
        sys.__stdout__.flush()
        time.sleep(1000)
    def flush(self): pass
    def reconfigure(self, **options): pass
sys.stdout = Slow()
sys.argv = ["frictionmap", "boundaries", "large.toml", "-o", "new.nc"]
sys.exit(run())
"""


def test_after_the_file_is_in_its_place(folder):
    process = subprocess.Popen(
        [sys.executable, "-c", LATE], cwd=folder, env=ENVIRONMENT, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stdout.readline() == "printing\n"
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=HANG)
    assert process.returncode == 130
    assert err == "frictionmap: interrupted; new.nc had been written\n"
    (folder / "new.nc").unlink()


def test_a_killed_run_leaves_nothing_after_the_next(folder):
    before = listing(folder)
    killed = start(folder, *COMMANDS["map"])
    while not any(path.is_dir() for path in folder.iterdir()):
        assert killed.poll() is None
        time.sleep(0.01)
    killed.kill()
    killed.communicate(timeout=HANG)
    run(folder, *COMMANDS["boundaries"])
    (folder / "new.nc").unlink()
    assert listing(folder) == before


def test_a_signal_that_was_ignored_stays_so(folder):
    """As after nohup."""
    process = start(
        folder, *COMMANDS["boundaries"], preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN)
    )
    wait_until_caught(process, signal.SIGTERM)
    process.send_signal(signal.SIGHUP)
    _, err = process.communicate(timeout=HANG)
    assert (process.returncode, err) == (0, "")
    (folder / "new.nc").unlink()


@pytest.mark.parametrize("full", [True, False])
def test_nobody_listens(folder, full):
    """A pipe that is full, or closed, does not keep the program."""
    reading, writing = os.pipe()
    if full:
        os.set_blocking(writing, False)
        with contextlib.suppress(BlockingIOError):
            while True:
                os.write(writing, bytes(65536))
        os.set_blocking(writing, True)
    else:
        os.close(reading)
    code = BUSY["in the main thread"][0]
    with subprocess.Popen(
        [sys.executable, "-c", code], env=ENVIRONMENT, stdout=subprocess.PIPE, stderr=writing
    ) as process:
        process.stdout.readline()
        process.send_signal(signal.SIGTERM)
        assert process.wait(timeout=HANG) == 130
    for end in (reading, writing) if full else (writing,):
        os.close(end)
