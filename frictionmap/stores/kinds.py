"""The kinds of contents that stores have, by their names in stores."""

from .contents import Contents
from .spectra import Spectra
from .study import Study

_KINDS: dict[str, type[Contents]] = {kind.kind: kind for kind in (Study, Spectra)}


def contents_of(kind: str) -> type[Contents]:
    """The contents of this name; an unknown one is a KeyError."""
    return _KINDS[kind]
