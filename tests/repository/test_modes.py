"""The other modes of the kernels run unless the kernels are known to be those of the commit before."""

import os
import shutil
import subprocess

import pytest
from conftest import ROOT

NAME = {f"GIT_{who}_{what}": "a@b" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
pytestmark = pytest.mark.skipif(os.name == "nt" or not shutil.which("git"), reason="needs git and bash")


class Clone:
    """A repository with a kernel and a page."""

    def __init__(self, folder):
        self.folder = folder
        self.git("init", "-q")
        self.kernels = folder / "frictionmap" / "_kernels"
        self.kernels.mkdir(parents=True)
        self.commit(self.kernels / "one.py", folder / "page.md")
        self.commit(self.kernels / "one.py")

    def git(self, *arguments):
        subprocess.run(["git", *arguments], cwd=self.folder, env=os.environ | NAME, check=True)

    def commit(self, *paths):
        for path in paths:
            with path.open("a") as file:
                file.write("a = 1\n")
        self.git("add", ".")
        self.git("commit", "-qm", "change")

    def same(self, base=""):
        script, given = ROOT / ".ci" / "same-kernels", {"FRICTIONMAP_BASE": base}
        return subprocess.run([script], cwd=self.folder, env=os.environ | given).returncode == 0


@pytest.fixture
def clone(tmp_path):
    return Clone(tmp_path)


def test_it_is_known_what_a_change_has_changed(clone):
    clone.commit(clone.folder / "page.md")
    assert clone.same("HEAD^")
    assert not clone.same("HEAD^^")  # the kernel has changed since
    clone.commit(clone.folder / "page.md")
    clone.git("update-ref", "refs/remotes/origin/main", "HEAD^")
    assert clone.same()


def test_where_it_is_not_known_they_run(clone):
    clone.commit(clone.folder / "page.md")
    assert not clone.same()  # no remote branch
    assert not clone.same("0" * 40)
    assert not clone.same("HEAD")  # nothing precedes the change
    clone.git("update-ref", "refs/remotes/origin/main", "HEAD")
    assert not clone.same()


@pytest.mark.parametrize("name", ["one.py", "new.py"])
def test_changes_that_are_not_committed_count(clone, name):
    clone.commit(clone.folder / "page.md")
    (clone.kernels / name).write_text("b = 2\n")
    clone.git("add", ".")
    assert not clone.same("HEAD^")
