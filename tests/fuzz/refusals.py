"""Runs with invalid configurations and command lines: each is refused in one line and changes nothing."""

import random
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from .child import Child, Ended
from .command_lines import command_lines
from .configurations import Case, configurations
from .folders import CONFIG, Change, fresh, snapshot
from .verdict import CHANGED, CRASH, HANG, LEFT, Family, Said, wrong_refusal

#: Cases of the quick form, of each family.
_QUICK = 10

_FRAME = """\
[system]
matrices = "frame.npz"
damping_ratios = 0.05
[grid]
r = [0.4, 0.9]
beta = [0.2]
"""


def template(folder: Path) -> Path:
    """Content of the folder of every case, without output of the program."""
    folder.mkdir()
    (folder / "c.toml").write_text(CONFIG)
    (folder / "one.toml").write_text(CONFIG.replace("[1.0, 1.5]", "[1.0]"))
    for name in ("taken.toml", "c.nc"):
        (folder / name).write_text(CONFIG)
    (folder / "frame.toml").write_text(_FRAME)
    np.savez(folder / "frame.npz", M=np.eye(2), K=np.array([[2.0, -1.0], [-1.0, 1.0]]))
    (folder / "folder").mkdir()
    for link, target in (
        ("link.toml", "c.toml"), ("folder/up.toml", "../c.toml"), ("dead.toml", "nowhere.toml"),
        ("dead", "nowhere"),
        ("maplink.png", "m.nc"),
    ):  # fmt: skip
        (folder / link).symlink_to(target)
    for name in ("taken.nc", "taken.png", "empty.nc"):
        (folder / name).write_bytes(b"")
    (folder / "taken.nc").write_text("somebody's work")
    (folder / "text.nc").write_text("netcdf text {\n}\n")
    return folder


def with_outputs(child: Child, folder: Path) -> Path:
    """Content of the folder with a map, boundaries and damaged files."""
    for arguments in (["map", "c.toml", "-o", "m.nc"], ["boundaries", "c.toml", "-o", "b.nc"]):
        said = child.main(arguments, folder, limit=1800.0)
        if said.status != 0:
            raise RuntimeError(f"{' '.join(arguments)}: {said}")
    content = (folder / "m.nc").read_bytes()
    (folder / "map.png").write_bytes(content)
    (folder / "cut.nc").write_bytes(content[: len(content) // 2])
    _foreign(folder / "foreign.nc")
    return folder


def _foreign(path: Path) -> None:
    import xarray as xr

    xr.Dataset({"regime": ("x", [1.0])}).to_netcdf(path)


def try_case(child: Child, case: Case, prepared: Path, folder: Path) -> tuple[str | None, object]:
    """Run one case; return the defect and the run."""
    fresh(prepared, folder)
    for name, content in case.files.items():
        (folder / name).write_bytes(content)
    before = snapshot(folder)
    try:
        said: Said = child.main(list(case.arguments), folder, limit=120.0)
    except Ended as end:
        return (HANG if end.hang else CRASH), end
    change = Change.between(before, snapshot(folder))
    if change.lost:
        return CHANGED, f"{change}; {said}"
    wrong = wrong_refusal(said, case.says)
    if wrong is None and change.new:
        return LEFT, f"{change}; {said}"
    return wrong, said


def _family(name: str, cases: Sequence[Case], child: Child, prepared: Path, folder: Path) -> Family:
    family = Family(name)
    for case in cases:
        family.add(case, *try_case(child, case, prepared, folder))
    return family


def families(folder: Path) -> dict[str, list[Case]]:
    """Both families; `folder` to work in."""
    return {"bad configurations": configurations(folder), "bad command lines": command_lines()}


def run(child: Child, folder: Path, quick: bool) -> list[Family]:
    """Run both families."""
    prepared = with_outputs(child, template(folder / "prepared"))
    (folder / "made").mkdir()
    tried = families(folder / "made")
    if quick:
        tried = {name: random.Random(1).sample(cases, _QUICK) for name, cases in tried.items()}
    return [_family(name, cases, child, prepared, folder / "here") for name, cases in tried.items()]
