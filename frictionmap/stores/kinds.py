"""The kinds of contents that stores have, by their names in stores.

A kind is imported when a store has it: each needs a part of the program that the other does without.
"""

from .contents import Contents


def contents_of(kind: str) -> type[Contents]:
    """The contents of this name; an unknown one is a KeyError."""
    if kind == "map":
        from .study import Study

        return Study
    if kind == "spectrum":
        from .spectra import Spectra

        return Spectra
    raise KeyError(kind)
