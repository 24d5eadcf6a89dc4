"""The commands of README, guides and gallery run as they stand, in order, and print what a guide says."""

import re
import shutil

import pytest
from conftest import ROOT
from test_readme import BLOCKS, GUIDES, blocks, commands

from frictionmap.command_line.cli import main

#: Commands that a page takes for granted: files that it names, of other pages, or of the reader.
BEFORE = {
    "README.md": ["init --rig free-decay"],
    "figures.md": ["init", "map map.toml"],
    "large-maps.md": ["init"],
    "plot_12_for_papers.py": [
        "map configs/fig-3-12.toml",
        "map configs/fig-3-12.toml --set grid.r.step=0.1 --set grid.beta.step=0.1"
        ' --set solver.outputs=["regime","contact_amplitude"] -o amplitudes.nc',
        "boundaries configs/fig-3-12.toml -o boundaries.nc",
        "curves configs/fig-6-8.toml",
        "response configs/fig-3-12.toml --r 0.5 --beta 0.2 --mu 1 -o motion.nc",
        "identify configs/rigs/free-decay.toml",
        "design configs/design/brace-damper.toml",
        "history configs/motions/ring-down.toml",
        "spectrum configs/motions/spectra.toml",
    ],
}

#: What names in capitals stand for, by command; the files of README's list are those of its own commands.
STANDS_FOR = {
    "design": {"CONFIG.toml": "configs/design/brace-damper.toml"},
    "identify": {"RIG.toml": "rig.toml"},
    "history": {"CONFIG.toml": "configs/motions/ring-down.toml"},
    "spectrum": {"CONFIG.toml": "configs/motions/spectra.toml"},
    "": {"CONFIG.toml": "map.toml", "FILE.nc": "map.nc", "OUT.zarr": "out.zarr"},
}

#: More than a test has time for: an hour of cells is computed on a coarser grid.
COARSER = {"configs/studies/five-masses.toml": ["--set", "grid.r.num=2", "--set", "grid.beta.num=2"]}

#: Rows of this file of variations that are kept: each costs, and a thousand say no more than a hundred.
VARIATIONS, KEPT = "configs/studies/five-masses.csv", 100

#: Not run: a page that stays open, a cluster that is nowhere, the shell, a question of half a minute.
NOT_RUN = {"explore", "--scheduler", "completion", "design.question=two-forces"}

#: The extra that a command needs.
NEEDS = {"--workers": "distributed", "out.zarr": "zarr", "five-masses.zarr": "zarr"}


def of_gallery(path):
    """Commands in the comments of a script of the gallery."""
    lines = re.findall(r"^# +(frictionmap [a-z]+ .*)$", path.read_text(encoding="utf-8"), re.MULTILINE)
    return list(commands([("sh", "\n".join(lines))]))


def of_page(path):
    return list(commands(blocks(path.read_text(encoding="utf-8"))))


PAGES = {"README.md": list(commands(BLOCKS))}
PAGES |= {path.name: found for path in GUIDES if (found := of_page(path))}
PAGES |= {path.name: found for path in sorted(ROOT.glob("docs/gallery/*.py")) if (found := of_gallery(path))}


def made_real(words):
    """Words of a command with real files in place of names in capitals."""
    names = STANDS_FOR[""] | STANDS_FOR.get(words[0], {})
    return [names.get(word, word) for word in words] + COARSER.get(words[1] if words[1:] else "", [])


def before(page):
    return [line.split() for line in BEFORE.get(page, [])]


@pytest.fixture
def printed(request, tmp_path, monkeypatch, capsys):
    """What the commands of a page print, run in a folder with the configurations."""
    page = request.param
    shutil.copytree(ROOT / "configs", tmp_path / "configs")
    monkeypatch.chdir(tmp_path)
    lines = (tmp_path / VARIATIONS).read_text().splitlines(keepends=True)
    (tmp_path / VARIATIONS).write_text("".join(lines[: 1 + KEPT]))
    for words in [*before(page), *map(made_real, PAGES[page])]:
        if NOT_RUN & set(words):
            continue
        for word in NEEDS.keys() & set(words):
            pytest.importorskip(NEEDS[word])
        try:
            status = main(words)
        except SystemExit as ending:  # after --version
            status = ending.code
        said = capsys.readouterr()
        assert status in (0, None), f"{' '.join(words)}: {said.err}"
        print(said.out, end="")
    return page, capsys.readouterr().out


@pytest.mark.parametrize("printed", sorted(PAGES), indirect=True)
def test_commands_run_and_print_the_output_on_the_page(printed):
    page, out = printed
    shown = [text for path in GUIDES if path.name == page for text in _outputs(path)]
    seen = {" ".join(line.split()) for line in out.splitlines()}
    for text in shown:
        for line in text.splitlines():
            assert " ".join(line.split()) in seen, f"{page}: not printed: {line}"


def _outputs(path):
    """Blocks of printed text that follow a command on a page; others are examples."""
    found = blocks(path.read_text(encoding="utf-8"))
    return [text for language, text in found if language == "text"] if path.name in OUTPUTS else []


#: Pages with the output of their own commands.
OUTPUTS = {"choosing-friction.md", "first-map.md"}
