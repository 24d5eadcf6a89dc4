"""One design question: everything that the program states about it and draws of it."""

from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, NamedTuple

from ...datasets.labels import Label
from ...files.key import Key

if TYPE_CHECKING:
    import xarray as xr

#: Rows of a summary: name and text.
Rows = Callable[["xr.Dataset"], Iterator[tuple[str, str]]]

#: Sentences of a summary.
Sentences = Callable[["xr.Dataset"], Iterator[str]]


#: Ranges of friction, from and to.
Ranges = list[tuple[float, float]]


class Goal(NamedTuple):
    """A question as a goal on the page."""

    label: str  # in the menu
    #: Ranges of friction that meet it, from the answer, and a function that asks at most which friction gives
    #: a response within a limit.
    ranges: "Callable[[xr.Dataset, Callable[[float], xr.Dataset]], Ranges]"


class Question(NamedTuple):
    """A design question."""

    name: str
    title: str  # of an answer
    function: "Callable[..., xr.Dataset]"
    needed: tuple[Key, ...]  # of the table [design]
    optional: tuple[Key, ...]
    rows: tuple[Rows, ...]  # of a summary, after the friction and before the boundaries of the band
    panels: tuple[str, ...]  # of a picture, by their names in `pictures/designs`
    labels: Mapping[str, Label] = {}  # of its own variables
    mark: str = ""  # what stands for the answer in a picture of boundaries
    goal: Goal | None = None  # on the page
    sentences: tuple[Sentences, ...] = ()  # the answer in words, before the rows

    @property
    def of_response(self) -> bool:
        """Whether it is about a response."""
        return any(key.name == "response" for key in self.optional)

    @property
    def has_limit(self) -> bool:
        """Whether it needs a limit of the response."""
        return any(key.name == "limit" for key in self.needed)
