"""Folders for the trials: their content before, and the changes by a run."""

import hashlib
import os
import shutil
import stat
from dataclasses import dataclass
from pathlib import Path

#: One mass, two mu, six cells: everything about it is quick.
CONFIG = """\
title = "A small map"

[system]
contact = "fixed-wall"
damping_ratios = 0.05

[grid]
r = [0.4, 0.9]
beta = [0.2, 0.5, 1.2]
mu = [1.0, 1.5]
"""

#: The same of two masses.
CONFIG_TWO = CONFIG.replace(
    "damping_ratios", "mass_ratios = [1.0, 1.0]\nstiffness_ratios = [1.0, 1.0]\ndamping_ratios"
)

#: The same of two masses with two contacts, one of them elastic, and a design question.
CONFIG_CONTACTS = (
    CONFIG_TWO.replace('contact = "fixed-wall"\n', "")
    .replace("mu = [1.0, 1.5]", "mu = [1.0]")
    .replace(
        "[grid]",
        """[[system.contacts]]
kind = "fixed-wall"
masses = [1]

[[system.contacts]]
kind = "between-masses"
masses = [1, 2]
stiffness = 3.0
ratio = 0.5

[design]
question = "least-peak"
band = [0.5, 1.5]
response = { quantity = "amplitude", mass = 2 }

[grid]""",
    )
)

OUTPUTS = (
    "regime", "stops_per_cycle", "contact_amplitude", "stuck_fraction", "period", "origin", "cycles",
    "status", "multiplier", "asymmetry", "also_reachable", "sliding_limit", "amplitude",
)  # fmt: skip
EVERYTHING = "solver.outputs=[" + ", ".join(f'"{name}"' for name in OUTPUTS) + "]"


_MADE_ANEW = ("fifo", "hard.toml")


def _entry(path: Path) -> tuple[str, str]:
    """Kind, permissions and content."""
    mode = path.lstat().st_mode
    if stat.S_ISLNK(mode):
        return "link", str(path.readlink())
    content = hashlib.sha256(path.read_bytes()).hexdigest() if stat.S_ISREG(mode) else ""
    return stat.filemode(mode), content


def snapshot(folder: Path) -> dict[str, tuple[str, str]]:
    """Everything below a folder."""
    return {str(path.relative_to(folder)): _entry(path) for path in sorted(folder.rglob("*"))}


@dataclass(frozen=True)
class Change:
    """Differences between two snapshots."""

    lost: list[str]  # changed or gone
    new: list[str]

    @classmethod
    def between(cls, before: dict, after: dict) -> "Change":
        """Differences from one snapshot to the other."""
        lost = [name for name in before if after.get(name) != before[name]]
        return cls(lost, [name for name in after if name not in before])

    def __bool__(self) -> bool:
        return bool(self.lost or self.new)

    def __str__(self) -> str:
        return "; ".join(
            f"{word}: {', '.join(names)}"
            for word, names in (("changed or gone", self.lost), ("left", self.new))
            if names
        )


def fresh(template: Path, folder: Path) -> Path:
    """Copy a prepared folder with its links, and with a pipe and a hard link, which copies do not keep."""
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(template, folder, symlinks=True, ignore=shutil.ignore_patterns(*_MADE_ANEW))
    os.mkfifo(folder / "fifo")
    (folder / "hard.toml").hardlink_to(folder / "c.toml")
    return folder
