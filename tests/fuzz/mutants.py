"""Thousands of malformed files, read by `info` and `plot`: a result or a refusal, and nothing else."""

from pathlib import Path

from .child import Child, Ended
from .folders import CONFIG, CONFIG_CONTACTS, CONFIG_TWO, EVERYTHING
from .malformed import BYTES, SLICES, STRUCTURE, VALUES
from .verdict import CRASH, HANG, UNSEEN, Family, Said, wrong_answer_or_refusal

#: Files of each family, in full and quick.
_COUNTS = {STRUCTURE: (2000, 6), VALUES: (1000, 4), BYTES: (1600, 6), SLICES: (800, 4)}

#: One file in so many is drawn, too: more of the slices, which are meant to be drawn.
_DRAWN = {STRUCTURE: 12, VALUES: 12, BYTES: 20, SLICES: 3}

#: Seconds after which reading and drawing one hangs, also on a busy machine.
_LIMIT = 90.0

_CELL = ["--r", "0.4", "--beta", "0.2", "--mu", "1.5"]

#: The good files: name, configuration, arguments.
_BASES: tuple[tuple[str, str, list[str]], ...] = (
    ("map", CONFIG, ["map"]),
    ("map-everything", CONFIG, ["map", "--set", EVERYTHING]),
    ("map-two", CONFIG_TWO, ["map", "--set", EVERYTHING]),
    ("boundaries", CONFIG, ["boundaries"]),
    ("boundaries-two", CONFIG_TWO, ["boundaries"]),
    ("response", CONFIG, ["response", *_CELL]),
    ("response-two", CONFIG_TWO, ["response", *_CELL]),
    ("curves", CONFIG, ["curves"]),
    ("borders", CONFIG, ["boundaries", "--borders", "--set", "grid.mu=[1.0]"]),
    ("contacts", CONFIG_CONTACTS, ["map"]),
    ("contacts-curves", CONFIG_CONTACTS, ["curves"]),
    ("contacts-response", CONFIG_CONTACTS, ["response", *_CELL[:4]]),
    ("design", CONFIG_CONTACTS, ["design"]),
)


def bases(child: Child, folder: Path, quick: bool) -> list[Path]:
    """Valid files, written by the tested package; in the quick form one of every kind."""
    folder.mkdir()
    found = []
    for name, config, (verb, *rest) in _BASES[:7:3] if quick else _BASES:
        (folder / "c.toml").write_text(config)
        path = folder / f"{name}.nc"
        said = child.main([verb, "c.toml", "-o", path.name, "--quiet", *rest], folder, limit=1800.0)
        if said.status != 0:
            raise RuntimeError(f"{verb} of {name}: {said}")
        found.append(path)
    return found


def _judge(family: Family, answer: dict) -> None:
    """Check the results of `info` and `plot` for one file; the first defect counts."""
    for verb in ("info", "plot"):
        if verb in answer:
            said = Said(**answer[verb])
            wrong = wrong_answer_or_refusal(said)
            if wrong is not None:
                family.add(f"{verb}: {answer['what']}", wrong, said)
                return
    if answer.get("unseen"):
        family.add(answer["what"], UNSEEN)
        return
    family.add(answer["what"], None)


def _try(name: str, count: int, child: Child, good: list[Path], folder: Path) -> Family:
    family = Family(f"malformed files: {name}")
    for seed in range(count):
        base = good[seed % len(good)]
        plot = seed // len(good) % _DRAWN[name] == 0
        request = {"base": str(base), "family": name, "seed": seed, "folder": str(folder), "plot": plot}
        try:
            _judge(family, child.ask(limit=_LIMIT, do="mutant", **request))
        except Ended as end:
            kind = HANG if end.hang else CRASH
            what = f"{base.name}, {name}, seed {seed}"
            words = f"{kind} inside the HDF5 library" if end.in_library else kind
            family.add(what, words, end.stack, excused=end.in_library)
    return family


def run(child: Child, folder: Path, quick: bool) -> list[Family]:
    """Run all families of malformed files."""
    good = bases(child, folder / "good", quick)
    work = folder / "mutants"
    work.mkdir()
    return [_try(name, counts[quick], child, good, work) for name, counts in _COUNTS.items()]
