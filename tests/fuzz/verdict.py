"""Output and exit of a run, its defects, and counts of defects by family."""

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

TRACEBACK = "traceback"
HANG = "hang"
SLOW = "took too long"
CRASH = "crash"
ACCEPTED = "taken without a word"
REFUSED = "refused though good"
STATUS = "other exit status"
LINES = "not one line"
VAGUE = "does not say what"
CHANGED = "lost or changed a file"
LEFT = "left a file behind"
ANSWER = "other answer"
UNSEEN = "changed values not seen"
NOISE = "warning of a library"
FOREIGN = "foreign error"

#: Examples kept of each kind in each family; the counts are of all.
_EXAMPLES = 3

#: Folders of this machine, in what was said: nobody else has them.
_FOLDERS = re.compile(r"/(?:[\w.+-]+/)+(?=[\w.-]+)")

#: Characters kept of what a run said.
_KEPT = 400


@dataclass(frozen=True)
class Said:
    """How a run ended."""

    status: int | None  # None: it did not end by itself
    out: str = ""
    err: str = ""
    escaped: str = ""  # the error that came out of `main`, if one did
    seconds: float = 0.0

    @property
    def lines(self) -> list[str]:
        """Lines on standard error."""
        return self.err.splitlines()

    @property
    def traceback(self) -> bool:
        """Whether a user would see a traceback."""
        return bool(self.escaped) or "Traceback (most recent call last)" in self.err

    def __str__(self) -> str:
        return f"status {self.status}: {self.escaped or self.err.strip() or self.out.strip()}"[-_KEPT:]


#: Each of these has to be in a message: one of some ways to say it.
Words = Sequence[Sequence[str]]


def unsaid(message: str, words: Words) -> bool:
    """Whether a message lacks a word that it must contain."""
    return not all(any(way in message for way in ways) for ways in words)


def wrong_refusal(said: Said, words: Words = (), statuses: Iterable[int] = (2,)) -> str | None:
    """Check the refusal of invalid input; return the defect, or None."""
    if said.traceback:
        return TRACEBACK
    if said.status == 0:
        return ACCEPTED
    if said.status not in set(statuses):
        return STATUS
    if len(said.lines) != 1:
        return LINES
    return VAGUE if unsaid(said.err, words) else None


def wrong_success(said: Said, lines: int = 0) -> str | None:
    """Check a run that must succeed, with at most the given lines on standard error."""
    if said.traceback:
        return TRACEBACK
    if said.status != 0:
        return REFUSED
    if "Warning" in said.err:
        return NOISE
    return LINES if len(said.lines) > lines else None


def wrong_answer_or_refusal(said: Said) -> str | None:
    """Check a run that may either succeed or be refused."""
    return wrong_success(said) if said.status == 0 else wrong_refusal(said)


@dataclass
class Family:
    """Counts of trials of one kind."""

    name: str
    tried: int = 0
    wrong: Counter[str] = field(default_factory=Counter)
    named: Counter[str] = field(default_factory=Counter)  # beyond our reach, counted by name
    examples: dict[str, list[dict[str, str]]] = field(default_factory=dict)

    def add(self, what: object, wrong: str | None, said: object = "", *, excused: bool = False) -> None:
        """Count one trial; `excused`: the defect is outside this package."""
        self.tried += 1
        if wrong is None:
            return
        (self.named if excused else self.wrong)[wrong] += 1
        kept = self.examples.setdefault(wrong, [])
        if len(kept) < _EXAMPLES:
            kept.append({"tried": str(what)[:_KEPT], "said": _FOLDERS.sub("", str(said))[:_KEPT]})

    def content(self) -> dict:
        """Content for the JSON file."""
        return {
            "tried": self.tried,
            "wrong": sum(self.wrong.values()),
            "wrong by kind": dict(self.wrong.most_common()),
            "beyond reach": dict(self.named.most_common()),
            "examples": self.examples,
        }
