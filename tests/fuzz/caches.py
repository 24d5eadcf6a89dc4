"""Damaged caches of kernels, and machines on which no cache can be written: results stay the same."""

import random
import shutil
from pathlib import Path

import xarray as xr

from .damages import DAMAGES, Damage
from .folders import CONFIG
from .machine import environment
from .machine import prepared as preparation
from .machine import run as run_once
from .verdict import ANSWER, CRASH, HANG, Family, Said, wrong_success

#: Seconds for a run that compiles; others may run beside it.
_LIMIT = 900.0

_ARGUMENTS = ["boundaries", "c.toml", "-o", "out.nc", "--overwrite", "--quiet"]

#: Damages of the quick form, and files that it damages: each takes a second to compile.
_QUICK = ("data: cut off",)
_QUICK_FILES = 2


def _installed(package: Path, folder: Path) -> Path:
    """Copy the package alone, without caches of other versions."""
    stale = shutil.ignore_patterns("__pycache__")
    shutil.copytree(package / "frictionmap", folder / "frictionmap", dirs_exist_ok=True, ignore=stale)
    return folder


def _answer(folder: Path) -> xr.Dataset:
    with xr.open_dataset(folder / "out.nc") as opened:
        return opened.load()


def _judge(said: Said, folder: Path, right: xr.Dataset) -> str | None:
    """Check that a run gives the right result and at most one line."""
    if said.status is None:
        return HANG
    if said.status < 0:
        return CRASH
    return wrong_success(said, lines=1) or (None if _answer(folder).equals(right) else ANSWER)


class _Trials:
    """A package with a complete cache, to be damaged repeatedly."""

    def __init__(self, package: Path, folder: Path) -> None:
        self.folder = folder
        self.warm = folder / "warm"
        _installed(package, self.warm)
        self.home = folder / "home"
        self.home.mkdir()
        self.work = folder / "work"
        self.work.mkdir()
        (self.work / "c.toml").write_text(CONFIG)
        self.temporary = folder / "temporary"
        self.temporary.mkdir()
        said = self.run(self.warm)
        if said.status != 0:
            raise RuntimeError(f"boundaries: {said}")
        self.right = _answer(self.work)
        shutil.copytree(self.home, folder / "warm home")

    def run(self, package: Path, **more: str | None) -> Said:
        """Run the program once, under file permissions."""
        (self.work / "out.nc").unlink(missing_ok=True)
        usual = {"HOME": str(self.home), "TMPDIR": str(self.temporary)}
        env = environment(package, **{"XDG_CACHE_HOME": None, "NUMBA_CACHE_DIR": None, **usual, **more})
        return run_once(_ARGUMENTS, self.work, env, _LIMIT, preexec_fn=preparation(ordinary=True))

    def restored(self) -> Path:
        """Restore the package, the home folder and the temporary folder with a complete cache."""
        trial = self.folder / "trial"
        _unsealed(trial, self.home)
        shutil.rmtree(self.temporary)
        self.temporary.mkdir()
        for path, source in ((trial, self.warm), (self.home, self.folder / "warm home")):
            shutil.rmtree(path, ignore_errors=True)
            shutil.copytree(source, path)
        return trial

    def cache(self, package: Path) -> list[Path]:
        """Cache files of kernels in all folders."""
        found = sorted(path for place in (package, self.home) for path in place.rglob("*.nb?"))
        if not found:
            raise RuntimeError("no cache was found")
        return found

    def damaged(self, damage: Damage, most: int | None, rng: random.Random) -> tuple[str | None, str] | None:
        """Damage the cache, `most` files of it or all, and run twice; None if there is nothing to damage."""
        trial = self.restored()
        targets = damage.of(self.cache(trial))[:most]
        if not targets:
            return None
        damage.act(targets, rng)
        for _ in range(2):
            said = self.run(trial)
            wrong = _judge(said, self.work, self.right)
            if wrong is not None:
                return wrong, str(said)
        return None, ""


def _sealed(*folders: Path) -> None:
    """Make folders read-only."""
    for folder in folders:
        for path in [folder, *folder.rglob("*")]:
            if path.is_dir():
                path.chmod(0o555)


def _unsealed(*folders: Path) -> None:
    """Make folders writable again."""
    for folder in folders:
        for path in [folder, *folder.rglob("*")]:
            if path.is_dir():
                path.chmod(0o755)


def _unwritable(trials: _Trials, quick: bool) -> Family:
    """Read-only package and home folders, with and without a complete cache."""
    family = Family("package and home that cannot be written")
    nowhere = str(trials.folder / "nowhere")
    places: dict[str, dict[str, str | None]] = {
        "home": {},
        "no home": {"HOME": None},
        "a home that does not exist": {"HOME": nowhere},
        "home and temporary folder": {"TMPDIR": str(trials.home)},
        "home, XDG_CACHE_HOME there": {"XDG_CACHE_HOME": str(trials.home)},
        "home, NUMBA_CACHE_DIR there": {"NUMBA_CACHE_DIR": str(trials.home / "cache")},
    }
    for warm in (True, False):
        for name, more in places.items():
            if quick and (name != "home" or not warm):
                continue
            trial = trials.restored()
            if not warm:
                for path in trials.cache(trial):
                    path.unlink()
            _sealed(trial, trials.home)
            try:
                said = trials.run(trial, **more)
                what = f"package and {name}; {'warm' if warm else 'no cache'}"
                family.add(what, _judge(said, trials.work, trials.right), said)
            finally:
                _unsealed(trial, trials.home)
    return family


def run(package: Path, folder: Path, quick: bool) -> list[Family]:
    """Run both families."""
    folder.mkdir()
    trials = _Trials(package, folder)
    family = Family("damaged caches of kernels")
    rng = random.Random(5)
    for damage in DAMAGES:
        if not quick or damage.name in _QUICK:
            found = trials.damaged(damage, _QUICK_FILES if quick else None, rng)
            if found is not None:
                family.add(damage.name, *found)
    return [family, _unwritable(trials, quick)]
