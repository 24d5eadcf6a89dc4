"""Damaged caches of kernels, and machines on which none can be written: an answer all the same."""

import pickle
import random
import shutil
from collections.abc import Callable
from pathlib import Path

import xarray as xr

from .folders import CONFIG
from .machine import environment
from .machine import prepared as preparation
from .machine import run as run_once
from .verdict import ANSWER, CRASH, HANG, Family, Said, wrong_success

#: Seconds for a run that compiles; others may run beside it.
_LIMIT = 900.0

_ARGUMENTS = ["boundaries", "c.toml", "-o", "out.nc", "--overwrite", "--quiet"]


def _each(what: Callable[[Path, random.Random], object]) -> Callable[[list[Path], random.Random], None]:
    def act(files: list[Path], rng: random.Random) -> None:
        for path in files:
            what(path, rng)

    return act


def _cut(path: Path, rng: random.Random) -> None:
    content = path.read_bytes()
    path.write_bytes(content[: rng.randrange(1, len(content))])


def _empty(path: Path, rng: random.Random) -> None:
    path.write_bytes(b"")


def _garbage(path: Path, rng: random.Random) -> None:
    path.write_bytes(rng.randbytes(path.stat().st_size))


def _zeros(path: Path, rng: random.Random) -> None:
    path.write_bytes(bytes(path.stat().st_size))


def _wrong_pickle(path: Path, rng: random.Random) -> None:
    path.write_bytes(pickle.dumps(rng.choice([None, [1, 2], {"a": 1}, "text", 1.5])))


class _Elsewhere:
    """Pickles as a name of a module that does not exist."""

    def __reduce__(self) -> tuple:
        return (_nowhere, ())


def _nowhere() -> None:
    """Stands for a name that the reader does not have."""


def _lost_module(path: Path, rng: random.Random) -> None:
    path.write_bytes(pickle.dumps(_Elsewhere()).replace(b"faults.caches", b"faults.nowher"))


def _folder(path: Path, rng: random.Random) -> None:
    path.unlink()
    path.mkdir()


def _unreadable(path: Path, rng: random.Random) -> None:
    path.chmod(0)


def _gone(path: Path, rng: random.Random) -> None:
    path.unlink()


def _flipped(path: Path, rng: random.Random) -> None:
    content = bytearray(path.read_bytes())
    for _ in range(8):
        content[rng.randrange(len(content))] ^= 0xFF
    path.write_bytes(content)


def _swapped(files: list[Path], rng: random.Random) -> None:
    contents = [path.read_bytes() for path in files]
    for path, content in zip(files, contents[1:] + contents[:1], strict=True):
        path.write_bytes(content)


#: What is done to the index files, or to the data files.
_DAMAGES: dict[str, tuple[str, Callable[[list[Path], random.Random], None]]] = {
    f"{words}: {how}": (ending, act)
    for ending, words in (("nbi", "index"), ("nbc", "data"))
    for how, act in {
        "cut off": _each(_cut),
        "empty": _each(_empty),
        "garbage": _each(_garbage),
        "zeros": _each(_zeros),
        "another pickle": _each(_wrong_pickle),
        "a pickle of a lost module": _each(_lost_module),
        "a folder in its place": _each(_folder),
        "not readable": _each(_unreadable),
        "gone": _each(_gone),
        "bytes flipped": _each(_flipped),
        "swapped": _swapped,
    }.items()
}
_QUICK = ("index: empty",)


def _installed(package: Path, folder: Path) -> Path:
    """A copy of the package alone, its cache with it."""
    shutil.copytree(package / "frictionmap", folder / "frictionmap", dirs_exist_ok=True)
    return folder


def _answer(folder: Path) -> xr.Dataset:
    with xr.open_dataset(folder / "out.nc") as opened:
        return opened.load()


def _judge(said: Said, folder: Path, right: xr.Dataset) -> str | None:
    """An answer, the right one, and one line said at most."""
    if said.status is None:
        return HANG
    if said.status < 0:
        return CRASH
    return wrong_success(said, lines=1) or (None if _answer(folder).equals(right) else ANSWER)


class _Trials:
    """A package with a warm cache, to be damaged again and again."""

    def __init__(self, package: Path, folder: Path) -> None:
        self.folder = folder
        self.warm = folder / "warm"
        _installed(package, self.warm)
        self.home = folder / "home"
        self.home.mkdir()
        self.work = folder / "work"
        self.work.mkdir()
        (self.work / "c.toml").write_text(CONFIG)
        said = self.run(self.warm)
        if said.status != 0:
            raise RuntimeError(f"boundaries: {said}")
        self.right = _answer(self.work)
        shutil.copytree(self.home, folder / "warm home")

    def run(self, package: Path, **more: str | None) -> Said:
        """One run, for which permissions hold."""
        (self.work / "out.nc").unlink(missing_ok=True)
        given = {"HOME": str(self.home), "XDG_CACHE_HOME": None, "NUMBA_CACHE_DIR": None, **more}
        env = environment(package, **given)
        return run_once(_ARGUMENTS, self.work, env, _LIMIT, preexec_fn=preparation(ordinary=True))

    def restored(self) -> Path:
        """The package and the home folder as they were when the cache was warm."""
        trial = self.folder / "trial"
        for path, source in ((trial, self.warm), (self.home, self.folder / "warm home")):
            shutil.rmtree(path, ignore_errors=True)
            shutil.copytree(source, path)
        return trial

    def damaged(self, ending: str, act: Callable, rng: random.Random) -> tuple[str | None, str]:
        """Damage the cache wherever it lies; then two runs."""
        trial = self.restored()
        found = sorted(path for place in (trial, self.home) for path in place.rglob("*.nb?"))
        files = [path for path in found if path.suffix == f".{ending}"]
        if not found:
            raise RuntimeError("no cache was found")
        act(files, rng)
        for _ in range(2):
            said = self.run(trial)
            wrong = _judge(said, self.work, self.right)
            if wrong is not None:
                return wrong, str(said)
        return None, ""


def _sealed(*folders: Path) -> None:
    """Nobody writes there any more."""
    for folder in folders:
        for path in [folder, *folder.rglob("*")]:
            if path.is_dir():
                path.chmod(0o555)


def _unsealed(*folders: Path) -> None:
    for folder in folders:
        for path in [folder, *folder.rglob("*")]:
            if path.is_dir():
                path.chmod(0o755)


def _unwritable(trials: _Trials, quick: bool) -> Family:
    """Package folder and home that cannot be written, with a warm cache and with none."""
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
                for cache in [path for place in (trial, trials.home) for path in place.rglob("*.nb?")]:
                    cache.unlink()
            _sealed(trial, trials.home)
            try:
                said = trials.run(trial, **more)
                what = f"package and {name}; {'warm' if warm else 'no cache'}"
                family.add(what, _judge(said, trials.work, trials.right), said)
            finally:
                _unsealed(trial, trials.home)
    return family


def run(package: Path, folder: Path, quick: bool) -> list[Family]:
    """Both families."""
    folder.mkdir()
    trials = _Trials(package, folder)
    family = Family("damaged caches of kernels")
    rng = random.Random(5)
    for name, (ending, act) in _DAMAGES.items():
        if not quick or name in _QUICK:
            family.add(name, *trials.damaged(ending, act, rng))
    return [family, _unwritable(trials, quick)]
