"""Stores: block by block the same bytes as at once, however a run was stopped."""

import contextlib
import filecmp
import os
import random
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import frictionmap as fm
from frictionmap import InputError
from frictionmap.command_line.cli import main
from frictionmap.files.config import load_config
from frictionmap.files.places import claimed_folder
from frictionmap.files.reading import opened as read_opened
from frictionmap.model.variations import checked_variations
from frictionmap.stores.run import fill_store, in_this_process
from frictionmap.stores.store import opened
from frictionmap.stores.study import Study, study_of

zarr = pytest.importorskip("zarr")

ONE = fm.System(contact="joined-base-wall")
FIVE = fm.System(mass_ratios=[1] * 5, stiffness_ratios=[1] * 5, damping_ratios=0.01, contact_masses=[3])
CONFIG = """
[system]
contact = "joined-base-wall"
[grid]
r = { start = 0.05, stop = 2.0, num = 40 }
beta = { start = 0.0, stop = 1.5, num = 40 }
mu = [1.0, 1.5]
[axes]
damping_ratios = { start = 0.0, stop = 0.1, num = 36 }
"""


def study(system, block_cells, outputs=("regime", "stops_per_cycle", "contact_amplitude", "amplitude")):
    grid = {"mu": np.array([1.0, 1.5]), "r": np.linspace(0.05, 2.0, 23), "beta": np.linspace(0.0, 1.5, 40)}
    whole = study_of(system, None, grid, fm.Solver(outputs=outputs))
    return Study(whole.variations, whole.mu, whole.r, whole.beta, whole.solver, block_cells)


def same_files(one, other):
    """Whether two folders hold the same bytes under the same names."""
    names = sorted(path.relative_to(one) for path in one.rglob("*") if path.is_file())
    assert names == sorted(path.relative_to(other) for path in other.rglob("*") if path.is_file())
    assert filecmp.cmpfiles(one, other, names, shallow=False)[1:] == ([], [])


@pytest.mark.parametrize("system", [ONE, FIVE], ids=["one mass", "five"])
@pytest.mark.parametrize(("block_cells", "threads"), [(1, 1), (300, 2), (10**6, 2)])
def test_a_store_is_the_map_to_the_bit(tmp_path, system, block_cells, threads):
    asked = study(system, block_cells)
    path = tmp_path / "map.zarr"
    fill_store(path, asked, "map", in_this_process(threads))
    whole = fm.sweep(system, asked.r, asked.beta, asked.mu, solver=asked.solver)
    with xr.open_zarr(path, consolidated=False, chunks=None) as stored:
        assert set(whole.variables) == set(stored.variables) - {"block_done"}
        for name, variable in whole.variables.items():
            assert stored[name].dims == variable.dims
            assert stored[name].dtype == variable.dtype
            np.testing.assert_array_equal(stored[name].values, variable.values)
            assert stored[name].attrs["long_name"] == variable.attrs["long_name"]
        assert stored["block_done"].values.all()


def test_matrices_are_part_of_a_store(tmp_path):
    mass, stiffness = np.diag([1.0, 2.0]), np.array([[2.0, -1.0], [-1.0, 1.5]])
    system = fm.System(matrices={"M": mass, "K": stiffness})
    fill_store(tmp_path / "m.zarr", study(system, 300), "m", in_this_process(1))
    assert opened(tmp_path / "m.zarr").study.system == system
    other = fm.System(matrices={"M": mass, "K": 2.0 * stiffness})
    with pytest.raises(InputError, match=r"its configuration differs, system\.matrices"):
        fill_store(tmp_path / "m.zarr", study(other, 300), "m", in_this_process(1))


def test_what_is_done_is_not_done_again(tmp_path):
    asked, path = study(ONE, 300), tmp_path / "map.zarr"
    count = asked.blocks
    computed = []

    def stops_after(number):
        def fill(store, blocks):
            for block, _ in zip(blocks, range(number), strict=False):
                store.write(block, store.study.compute(block, 1))
                computed.append(block)
                yield block

        return fill

    fill_store(path, asked, "map", stops_after(3))
    assert opened(path).marks().sum() == 3
    fill_store(path, asked, "map", stops_after(10**6))
    assert len(computed) == len(set(computed)) == count
    fill_store(tmp_path / "at once.zarr", asked, "map", in_this_process(1))
    same_files(path, tmp_path / "at once.zarr")


def test_a_block_without_its_mark_is_written_anew(tmp_path):
    """A chunk that a stop has damaged, and what was being written."""
    asked, path = study(ONE, 300), tmp_path / "map.zarr"
    fill_store(path, asked, "map", in_this_process(1))
    fill_store(tmp_path / "well.zarr", asked, "map", in_this_process(1))
    mark = path / "block_done" / "c" / "0" / "1"
    mark.unlink()
    chunk = path / "contact_amplitude" / "c" / "0" / "1" / "0"
    chunk.write_bytes(chunk.read_bytes()[:10])
    chunk.with_suffix(".0123.partial").write_bytes(b"half")
    fill_store(path, asked, "map", in_this_process(1))
    same_files(path, tmp_path / "well.zarr")


def test_what_killed_workers_were_writing_is_gone_at_the_end(tmp_path):
    asked, path = study(ONE, 300), tmp_path / "map.zarr"

    def leaves_a_part(store, batches):
        for batch in in_this_process(1)(store, batches):
            (path / "block_done" / "0.0123.partial").write_bytes(b"half")
            yield batch

    fill_store(path, asked, "map", leaves_a_part)
    fill_store(tmp_path / "well.zarr", asked, "map", in_this_process(1))
    same_files(path, tmp_path / "well.zarr")


@pytest.mark.parametrize("gone", ["contact_amplitude", "cycles", "beta_lim"])
def test_a_block_that_lacks_a_chunk_is_computed_again(tmp_path, gone):
    """Whatever the chunk would say: that of cycles holds nothing but zeros, which is its fill value."""
    asked, path = study(ONE, 300, outputs=("contact_amplitude", "cycles", "regime")), tmp_path / "map.zarr"
    asked = replace(asked, beta=np.array([0.0, 3.0]))  # decided without motion
    fill_store(path, asked, "map", in_this_process(1))
    shutil.copytree(path, tmp_path / "well.zarr")
    again = []

    def recorded(store, batches):
        for batch in in_this_process(1)(store, batches):
            again.append(batch)
            yield batch

    fill_store(path, asked, "map", recorded)
    assert again == []
    next(file for file in (path / gone / "c").rglob("*") if file.is_file()).unlink()
    fill_store(path, asked, "map", recorded)
    assert len(again) == 1
    same_files(path, tmp_path / "well.zarr")


@pytest.mark.parametrize(
    ("cells", "together"), [(2**20, (3, 10, 2, 1)), (64 * 8 * 20, (1, 4, 2, 1)), (64 * 20 - 1, (1, 1, 1, 1))]
)
def test_small_maps_are_written_together(tmp_path, cells, together):
    """Of 20 cells and two masses: as many as fit into a 64th of a large block, the last ones fewer."""
    axes = {"stiffness_ratios[2]": [0.5, 1.0, 2.0], "mass_ratios[2]": np.linspace(0.5, 2.0, 10)}
    grid = {"r": np.linspace(0.3, 1.5, 5), "beta": np.linspace(0.0, 1.2, 4), "mu": np.array([1.0, 1.5])}
    two = fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.02)
    solver = fm.Solver(outputs=("regime", "amplitude", "stops_per_cycle"))
    asked = replace(study_of(two, checked_variations(two, axes), grid, solver), block_cells=2 * cells)
    assert asked.together == together
    path = tmp_path / "map.zarr"
    fill_store(path, asked, "map", lambda store, batches: islice(in_this_process(1)(store, batches), 1))
    assert opened(path).marks().sum() == np.prod(together)
    fill_store(path, asked, "map", in_this_process(2))
    whole = fm.sweep(two, **grid, axes=axes, solver=solver)
    with xr.open_zarr(path, consolidated=False, chunks=None) as stored:
        assert stored["block_done"].values.all()
        for name, variable in whole.variables.items():
            np.testing.assert_array_equal(stored[name].values, variable.values)
    assert len([file for file in (path / "regime").rglob("*") if file.name.isdigit() and file.is_file()]) == (
        np.prod([np.ceil(size / most) for size, most in zip(asked.shape, together, strict=True)])
    )


def config(tmp_path, text=CONFIG):
    path = tmp_path / "study.toml"
    path.write_text(text)
    return path


def test_a_name_that_the_shell_completed(tmp_path):
    """A store is a folder: shells put a slash behind it."""
    single = ["--set", "axes.damping_ratios=[0.0]"]
    for end in ("", "/"):
        arguments = ["map", str(config(tmp_path)), "-o", f"{tmp_path}/out.zarr{end}", "--quiet", *single]
        assert main(arguments) == 0
    assert sorted(os.listdir(tmp_path)) == ["out.zarr", "study.toml"]


def command(tmp_path, *further):
    return [sys.executable, "-m", "frictionmap", "map", str(config(tmp_path)), *further]


def environment():
    return os.environ | {"PYTHONPATH": str(Path(fm.__file__).parent.parent)}


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("grid.beta.num=21", "grid.beta.num: 40 there, 21 now"),
        ("axes.damping_ratios.num=11", r"axes.damping_ratios: \[0.0\] there, \[0.0, 0.01, .* 0.1\] now"),
        ("solver.steps=30", "solver.steps: 24 there, 30 now"),
        ('system.contact="fixed-wall"', "system.contact: 'joined-base-wall' there, 'fixed-wall' now"),
    ],
)
def test_another_configuration_is_refused_by_name(tmp_path, capsys, override, words):
    path, out = config(tmp_path), tmp_path / "out.zarr"
    assert main(["map", str(path), "-o", str(out), "--quiet", "--set", "axes.damping_ratios=[0.0]"]) == 0
    before = opened(out).marks()
    first = [] if "axes" in override else ["--set", "axes.damping_ratios=[0.0]"]
    again = ["map", str(path), "-o", str(out), "--quiet", *first, "--set", override]
    assert main(again) == 2
    message = capsys.readouterr().err
    assert re.search(words, message), message
    np.testing.assert_array_equal(opened(out).marks(), before)
    assert main([*again, "--overwrite"]) == 0


def test_another_version_is_refused(tmp_path, capsys):
    asked, path = study(ONE, 300), tmp_path / "map.zarr"
    fill_store(path, asked, "map", in_this_process(1))
    zarr.open_group(path, mode="r+").attrs["source"] = "frictionmap 0.0.1"
    with pytest.raises(InputError, match=r"written by frictionmap 0\.0\.1, this is frictionmap"):
        fill_store(path, asked, "map", in_this_process(1))


def test_what_is_no_store_is_left_alone(tmp_path):
    asked = study(ONE, 300)
    (tmp_path / "file.zarr").write_text("mine")
    (tmp_path / "folder.zarr").mkdir()
    (tmp_path / "folder.zarr" / "thesis.tex").write_text("mine")
    for name, overwrite in (("file", False), ("file", True), ("folder", False), ("folder", True)):
        with pytest.raises(InputError):
            fill_store(tmp_path / f"{name}.zarr", asked, "map", in_this_process(1), overwrite)
    assert (tmp_path / "file.zarr").read_text() == "mine"
    assert (tmp_path / "folder.zarr" / "thesis.tex").read_text() == "mine"


def test_a_stop_while_a_store_is_replaced(tmp_path, monkeypatch):
    """Remains of the old one are not taken for the new one, which may be of the same configuration."""
    asked, path = study(ONE, 300), tmp_path / "map.zarr"
    fill_store(path, asked, "map", in_this_process(1))
    fill_store(tmp_path / "well.zarr", asked, "map", in_this_process(1))

    def stops(folder, **_):
        if folder.exists():
            (folder / "regime").rename(tmp_path / "regime")
            raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(shutil, "rmtree", stops)
        with pytest.raises(KeyboardInterrupt):
            fill_store(path, asked, "map", in_this_process(1), overwrite=True)
    fill_store(path, asked, "map", in_this_process(1))
    same_files(path, tmp_path / "well.zarr")
    assert sorted(os.listdir(tmp_path)) == ["map.zarr", "regime", "well.zarr"]


@pytest.mark.skipif(os.name == "nt", reason="symbolic links")
def test_a_link_to_a_store(tmp_path):
    asked, link, path = study(ONE, 300), tmp_path / "link.zarr", tmp_path / "elsewhere" / "map.zarr"
    path.parent.mkdir()
    link.symlink_to(path)
    for overwrite in (False, True):
        fill_store(link, asked, "map", in_this_process(1), overwrite)
        assert link.is_symlink()
        assert opened(path).marks().all()
    assert sorted(os.listdir(path.parent)) == ["map.zarr"]


@pytest.mark.parametrize("gone", ["regime/zarr.json", "block_done"])
def test_a_damaged_store_is_refused(tmp_path, gone):
    asked, path = study(ONE, 300), tmp_path / "map.zarr"
    fill_store(path, asked, "map", in_this_process(1))
    (path / gone).rename(tmp_path / "gone")
    with pytest.raises(InputError, match=rf"{gone.split('/')[0]}/zarr\.json is damaged; use --overwrite"):
        fill_store(path, asked, "map", in_this_process(1))
    fill_store(path, asked, "map", in_this_process(1), overwrite=True)
    assert opened(path).marks().all()


#: Root may do everything, unless it lays down what lets it.
ROOT = hasattr(os, "geteuid") and os.geteuid() == 0
OBEYING = ["setpriv", "--bounding-set=-dac_override,-dac_read_search"] if ROOT else []


@pytest.mark.skipif(os.name == "nt" or (ROOT and not shutil.which("setpriv")), reason="root may do all")
@pytest.mark.parametrize(
    ("where", "mode", "words"),
    [
        (".", 0o500, "cannot write m.zarr: it is write-protected"),
        ("status", 0o500, "cannot write m.zarr/status: it is write-protected"),
        (".", 0o000, "m.zarr/zarr.json is read-protected"),
    ],
)
def test_a_protected_store_is_refused_by_name(tmp_path, where, mode, words):
    found = load_config(config(tmp_path))
    axes = {"mu": found.mu, "r": found.r, "beta": found.beta}
    begun = study_of(found.system, found.variations, axes, found.solver)
    fill_store(tmp_path / "m.zarr", begun, "study", lambda store, blocks: iter(()))
    os.chmod(tmp_path / "m.zarr" / where, mode)
    told = subprocess.run(
        [*OBEYING, *command(tmp_path, "-o", "m.zarr", "--quiet")],
        cwd=tmp_path, env=environment(), capture_output=True, text=True, timeout=600,
    )  # fmt: skip
    os.chmod(tmp_path / "m.zarr" / where, 0o700)  # so that it can be cleared away
    assert (told.returncode, told.stderr.count("\n")) == (2, 1), told.stderr
    assert words in told.stderr


def test_without_zarr_a_store_is_left_alone(tmp_path, monkeypatch):
    asked, path = study(ONE, 300), tmp_path / "map.zarr"
    fill_store(path, asked, "map", in_this_process(1))
    with monkeypatch.context() as patched:
        patched.setitem(sys.modules, "zarr", None)
        for overwrite in (False, True):
            with pytest.raises(InputError, match=r"pip install 'frictionmap\[zarr\]'"):
                fill_store(path, asked, "map", in_this_process(1), overwrite)
    assert opened(path).marks().all()


def test_one_run_at_a_time(tmp_path):
    with (
        claimed_folder(tmp_path / "map.zarr"),
        pytest.raises(InputError, match="another run is writing it"),
    ):
        fill_store(tmp_path / "map.zarr", study(ONE, 300), "map", in_this_process(1))


def test_a_full_disk_keeps_what_is_done(tmp_path, monkeypatch):
    asked, path = study(ONE, 300), tmp_path / "map.zarr"

    def full(store, blocks):
        for number, block in enumerate(blocks):
            if number == 2:
                raise OSError(28, "No space left on device")
            store.write(block, store.study.compute(block, 1))
            yield block

    with pytest.raises(OSError, match=r"cannot write .*: No space left.*; 2 of .* blocks are in .*resume"):
        fill_store(path, asked, "map", full)
    fill_store(path, asked, "map", in_this_process(1))
    fill_store(tmp_path / "well.zarr", asked, "map", in_this_process(1))
    same_files(path, tmp_path / "well.zarr")


@pytest.fixture(scope="module")
def well(tmp_path_factory):
    """The store of the configuration by one run that nothing disturbs, and the seconds that it takes."""
    folder = tmp_path_factory.mktemp("well")
    for _ in range(2):  # kernels are compiled in the first
        began = time.monotonic()
        arguments = command(folder, "-o", folder / "well.zarr", "--overwrite", "--quiet")
        subprocess.run(arguments, env=environment(), check=True, timeout=900)
    return folder / "well.zarr", time.monotonic() - began


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.parametrize("number", ["SIGKILL", "SIGTERM"])
def test_stopped_at_random_moments(tmp_path, number, well):
    """Again and again, until it gets through."""
    out, (whole, usual) = tmp_path / "out.zarr", well
    chance = random.Random(number)
    for _ in range(3):
        run = subprocess.Popen(
            command(tmp_path, "-o", out, "--quiet"), env=environment(), stderr=subprocess.PIPE, text=True
        )
        time.sleep(usual * chance.uniform(0.5, 1.5))
        run.send_signal(getattr(signal, number))
        message = run.communicate(timeout=600)[1]
        if number != "SIGKILL" and run.returncode == 130:
            assert "nothing was written" in message or "repeat the command to resume" in message
        assert "Traceback" not in message
    subprocess.run(command(tmp_path, "-o", out, "--quiet"), env=environment(), check=True, timeout=600)
    same_files(out, whole)
    assert sorted(os.listdir(tmp_path)) == ["out.zarr", "study.toml"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (
            ["--workers", "2"],
            "cannot use --workers or --scheduler: they compute stores only; give -o OUT.zarr",
        ),
        (["--workers", "0", "-o", "x.zarr"], "must be >= 1"),
        (["--workers", "2", "--scheduler", "tcp://x:1", "-o", "x.zarr"], "not allowed with"),
        (["--scheduler", "", "-o", "x.zarr"], "must be an address such as tcp://"),
        (["--workers", "2", "--threads", "2", "-o", "x.zarr"], "cannot use --threads with workers"),
        (["-o", "x.nc/"], "must be the name of a file; got 'x.nc/'"),
    ],
)
def test_arguments(tmp_path, capsys, arguments, words):
    try:
        status = main(["map", str(config(tmp_path)), *arguments])
    except SystemExit as stopped:
        status = stopped.code
    assert status == 2
    assert words in capsys.readouterr().err


@pytest.mark.slow
def test_two_workers_write_the_same_bytes(tmp_path, well):
    pytest.importorskip("distributed")
    two = tmp_path / "two.zarr"
    done = subprocess.run(
        command(tmp_path, "-o", two, "--workers", "2", "--quiet"),
        env=environment(), capture_output=True, text=True, timeout=900,
    )  # fmt: skip
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    same_files(well[0], two)


@pytest.mark.slow
def test_lost_workers_cost_no_block(tmp_path, well):
    """Workers are killed again and again; others take their place."""
    pytest.importorskip("distributed")
    import psutil  # distributed brings it

    two = tmp_path / "two.zarr"
    run = subprocess.Popen(command(tmp_path, "-o", two, "--workers", "2", "--quiet"), env=environment())
    while not (two / "block_done" / "c").exists() and run.poll() is None:
        time.sleep(0.01)  # workers that are lost before any has begun are too few to go on
    chance, killed = random.Random(5), 0
    for _ in range(4):
        family = psutil.Process(run.pid).children(recursive=True) if run.poll() is None else []
        for worker in [child for child in family if "spawn_main" in " ".join(child.cmdline())][:1]:
            worker.kill()
            killed += 1
        time.sleep(chance.uniform(0.5, 2.0))
    assert killed
    assert run.wait(900) == 0
    same_files(well[0], two)


def test_a_worker_with_another_store(tmp_path):
    pytest.importorskip("distributed")
    from frictionmap.stores.workers import compute

    fill_store(tmp_path / "map.zarr", study(ONE, 300), "map", in_this_process(1))
    digest = opened(tmp_path / "map.zarr").digest
    assert compute(str(tmp_path / "map.zarr"), digest, (0, 0)) == (0, 0)
    with pytest.raises(OSError, match="a worker found another store there"):
        compute(str(tmp_path / "map.zarr"), "another", (0, 0))


def test_a_store_that_was_replaced_meanwhile(tmp_path):
    """A worker of a run that has ended leaves the store of the one that followed alone."""
    pytest.importorskip("distributed")
    from frictionmap.stores.workers import compute

    path, other = tmp_path / "map.zarr", study(ONE, 300, outputs=("regime",))
    fill_store(path, study(ONE, 300), "map", in_this_process(1))
    digest = opened(path).digest
    compute(str(path), digest, (0, 0))
    fill_store(path, other, "map", lambda store, blocks: iter(()), overwrite=True)
    with pytest.raises(OSError, match="a worker found another store there"):
        compute(str(path), digest, (0, 0))
    assert not opened(path).marks().any()
    shutil.rmtree(path)
    with pytest.raises(OSError, match="workers must see the store under the same path"):
        compute(str(path), "another", (0, 0))


def test_workers_that_come_later_have_work(tmp_path, monkeypatch):
    distributed = pytest.importorskip("distributed")
    from frictionmap.stores import study as study_module
    from frictionmap.stores.workers import NO_DASHBOARD, _on

    path, asked = tmp_path / "map.zarr", study(ONE, 40)
    monkeypatch.setattr(study_module, "study_of", lambda *given: replace(study_of(*given), block_cells=40))
    fill_store(path, asked, "map", lambda store, batches: iter(()))
    submitted = []
    with (
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=1, processes=False, **NO_DASHBOARD
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        submit = client.submit
        client.submit = lambda *task, **how: submitted.append(task) or submit(*task, **how)
        done = _on(client, opened(path), asked.batches())
        next(done)
        assert len(submitted) == 3
        cluster.scale(4)
        client.wait_for_workers(4)
        next(done)
        assert len(submitted) == 3 + 10
        assert len(list(done)) == asked.blocks - 2
    fill_store(tmp_path / "well.zarr", asked, "map", in_this_process(1))
    same_files(path, tmp_path / "well.zarr")


def test_workers_start_next_to_another_cluster():
    """Dask's usual port is taken; a warning would be an error here."""
    pytest.importorskip("distributed")
    from frictionmap.stores.workers import _cluster

    with socket.socket() as other:
        with contextlib.suppress(OSError):  # another process has it already
            other.bind(("", 8787))
            other.listen()
        with _cluster(1) as cluster:
            assert cluster.scheduler.http_server.port != 8787


@pytest.fixture
def scheduler():
    distributed = pytest.importorskip("distributed")
    from frictionmap.stores.workers import NO_DASHBOARD

    with distributed.LocalCluster(
        n_workers=0, protocol="tcp://", silence_logs="CRITICAL", **NO_DASHBOARD
    ) as cluster:
        yield cluster.scheduler_address


#: A process with dask, where nothing of that name can be imported.
BARE = """
import sys
from distributed.cli.dask_worker import main

class Hidden:
    def find_spec(name, *rest):
        if name.partition(".")[0] == "frictionmap":
            raise ModuleNotFoundError(f"No module named {name!r}")

sys.meta_path.insert(0, Hidden)
main(args=[sys.argv[1], "--no-nanny", "--nthreads=1", "--no-dashboard"])
"""


def test_a_worker_that_lacks_the_package_is_named(tmp_path, scheduler):
    """There is none at first, which is reported; then one comes that cannot compute."""
    from frictionmap.stores import workers

    told, started = [], []

    def say(text):
        told.append(text)
        started.append(subprocess.Popen([sys.executable, "-c", BARE, scheduler], stderr=subprocess.DEVNULL))

    try:
        with pytest.raises(OSError, match=(
            rf"worker tcp://[0-9.:]+: it needs frictionmap\[dask\] {fm.__version__} \(No module named "
            rf"'frictionmap'\); install it for {re.escape(sys.executable)} .*; 0 of 2 blocks are in"
        )):  # fmt: skip
            fill_store(tmp_path / "map.zarr", study(ONE, 10**6), "map", workers.running(scheduler, say))
    finally:
        for process in started:
            process.kill()
            process.wait()
    assert told == [f"waiting for workers of {scheduler}"]


def test_workers_that_never_come(tmp_path, scheduler, monkeypatch):
    from frictionmap.stores import workers

    monkeypatch.setattr(workers, "_PATIENCE", 0.36)
    fill = workers.running(scheduler, lambda text: None)
    with pytest.raises(OSError, match=f"{scheduler}: it had no worker for 0.0001 hours"):
        fill_store(tmp_path / "map.zarr", study(ONE, 10**6), "map", fill)


def test_a_worker_of_another_version_is_named():
    distributed = pytest.importorskip("distributed")
    from frictionmap.stores.workers import NO_DASHBOARD, task

    with distributed.Client(processes=False, n_workers=1, **NO_DASHBOARD) as client:
        sent = client.submit(task("0.0.1", "state"), "map.zarr", "digest", (0, 0))
        words = rf"\[dask\] 0\.0\.1 \(frictionmap has version {re.escape(fm.__version__)} there\)"
        with pytest.raises(OSError, match=words):
            sent.result()


# Checksums, and states of the program


def flipped(file, place, bit):
    """Flip one bit of a file."""
    content = bytearray(file.read_bytes())
    content[place] ^= 1 << bit
    file.write_bytes(bytes(content))


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A finished store of a structure with matrices, and the study that it is of."""
    system = fm.System(matrices={"M": np.diag([1.0, 2.0]), "K": np.array([[2.0, -1.0], [-1.0, 1.5]])})
    asked, path = study(system, 300), tmp_path_factory.mktemp("small") / "m.zarr"
    fill_store(path, asked, "map", in_this_process(1))
    return asked, path


def contents(path):
    """All values of a store that its readers use, loaded."""
    with read_opened(path) as ds:
        return ds.load()


def refusal(path):
    """The message where a store cannot be read, or its values."""
    try:
        return contents(path)
    except InputError as error:
        return str(error)


def test_no_flipped_bit_changes_a_value(small, tmp_path):
    """In any file of a store: what is read stays the same, or is refused with the name of the file."""
    whole, path = small[1], tmp_path / "m.zarr"
    before, chance = contents(whole), np.random.default_rng(5)
    files = [file for file in sorted(whole.rglob("*")) if file.is_file() and "matrices" not in file.parts]
    refused = 0
    for file in chance.choice(files, 60, replace=False):
        shutil.copytree(whole, path)
        damaged = path / file.relative_to(whole)
        flipped(damaged, chance.integers(damaged.stat().st_size), chance.integers(8))
        found = refusal(path)
        if isinstance(found, str):
            assert str(damaged) in found, found
            refused += 1
        else:
            xr.testing.assert_identical(found, before)
        shutil.rmtree(path)
    assert refused >= 50


@pytest.mark.parametrize(
    "name",
    ["regime/c/0/0/0", "amplitude/c/0/1/0/0", "beta_lim/c/0/0", "block_done/c/0/1", "r/c/0", "beta/c/0"],
)
def test_a_damaged_chunk_is_named_and_written_again(small, tmp_path, name, caplog):
    asked, whole = small
    path = tmp_path / "m.zarr"
    shutil.copytree(whole, path)
    flipped(path / name, 5, 3)
    with pytest.raises(InputError, match=f"cannot read .*{name} is damaged; repeat the command"):
        contents(path)
    with caplog.at_level("WARNING", "frictionmap"):
        fill_store(path, asked, "map", in_this_process(1))
    assert f"{path / name} is damaged" in caplog.text
    same_files(path, whole)


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("zarr.json", '"system":', '"sistem":'),
        ("zarr.json", "Conventions", "Conventionz"),
        ("regime/zarr.json", '"fill_value": -1', '"fill_value": -3'),
        ("r/zarr.json", "frequency", "grequency"),
        ("matrices/M/zarr.json", "float64", "int64"),
    ],
)
def test_a_damaged_description_is_refused(small, tmp_path, name, old, new):
    asked, whole = small
    path = tmp_path / "m.zarr"
    shutil.copytree(whole, path)
    text = (path / name).read_text()
    assert old in text
    (path / name).write_text(text.replace(old, new, 1))
    with pytest.raises(InputError, match=f"cannot read .*{name} is damaged; compute the store again"):
        contents(path)
    with pytest.raises(InputError, match=f"cannot resume .*{name} is damaged; use --overwrite"):
        fill_store(path, asked, "map", in_this_process(1))


def test_a_damaged_matrix_is_refused(small, tmp_path):
    asked, whole = small
    path = tmp_path / "m.zarr"
    shutil.copytree(whole, path)
    flipped(path / "matrices" / "K" / "c" / "0" / "0", 20, 0)
    with pytest.raises(InputError, match=r"cannot resume .* array 'matrices/K' is damaged"):
        fill_store(path, asked, "map", in_this_process(1))


def test_attributes_may_be_added(small, tmp_path):
    asked, whole = small
    path = tmp_path / "m.zarr"
    shutil.copytree(whole, path)
    zarr.open_group(path, mode="r+").attrs["comment"] = "rig B"
    assert contents(path).attrs["comment"] == "rig B"
    fill_store(path, asked, "map", in_this_process(1))


def test_a_store_of_another_state_of_the_program_is_refused(tmp_path, monkeypatch):
    """Version numbers stay for hundreds of changes; blocks of two states must not be mixed."""
    asked, path = study(ONE, 300), tmp_path / "map.zarr"
    fill_store(path, asked, "map", lambda store, batches: islice(in_this_process(1)(store, batches), 2))
    with monkeypatch.context() as patched:
        patched.setattr("frictionmap.stores.store.state", lambda: "0123456789abcdef")
        with pytest.raises(InputError, match=r"begun by another state .*0123456789abcdef.*; use --over"):
            fill_store(path, asked, "map", in_this_process(1))
    fill_store(path, asked, "map", in_this_process(1))
    assert opened(path).marks().all()


def test_the_state_of_the_program_is_that_of_its_sources(tmp_path):
    """Of all that cells come from: another line in a kernel, a boundary or a model is another state."""
    root = Path(fm.__file__).parent
    shutil.copytree(root, tmp_path / "frictionmap", ignore=shutil.ignore_patterns("__pycache__"))

    def state():
        code = "from frictionmap.version import state; print(state())"
        done = subprocess.run(
            [sys.executable, "-c", code], env=os.environ | {"PYTHONPATH": str(tmp_path)}, cwd=tmp_path,
            capture_output=True, text=True, check=True,
        )  # fmt: skip
        return done.stdout.strip()

    found = {state()}
    for name in ("_kernels/one_mass/newton.py", "theory/boundaries.py", "model/modes.py", "general/held.py"):
        with open(tmp_path / "frictionmap" / name, "a") as file:
            file.write("# another\n")
        found.add(state())
    assert len(found) == 5
    with open(tmp_path / "frictionmap" / "pictures" / "words.py", "a") as file:
        file.write("# another\n")
    assert state() in found


def test_all_that_computes_blocks_is_part_of_the_state(tmp_path):
    """No module that a block is computed with lies in a room that the state leaves out."""
    code = (
        "import sys, numpy as np, frictionmap as fm\n"
        "from frictionmap.stores.study import study_of\n"
        "from frictionmap import version\n"
        "for system in (fm.System(), fm.System(contact_stiffness=1.0)):\n"
        "    grid = {'mu': np.ones(1), 'r': np.ones(1), 'beta': np.ones(1)}\n"
        "    _ = study_of(system, None, grid, fm.Solver()).sample\n"
        "rooms = {name.split('.')[1] for name in sys.modules if name.startswith('frictionmap.')}\n"
        "print(sorted(rooms & version._NO_MATTER))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment(), capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]", done.stdout
