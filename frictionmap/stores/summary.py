"""What is in a store, in words; read block by block."""

from collections import Counter

import numpy as np

from .. import regimes
from ..files.summary import in_causes, in_cells
from .store import Store


def describe_store(store: Store) -> list[str]:
    """How many cells of each regime are done, and why some are unresolved, line by line."""
    counted: dict[str, Counter[int]] = {"regime": Counter(), "status": Counter()}
    for name, counter in counted.items():
        for values in store.blocks_of(name):
            codes, counts = np.unique(values, return_counts=True)
            counter.update(dict(zip(codes.tolist(), counts.tolist(), strict=True)))
    cells = sum(counted["status"].values())
    found = [
        (code, counted["regime"][code.value]) for code in regimes.REGIMES if counted["regime"][code.value]
    ]
    causes = [
        (code, counted["status"][code.value]) for code in regimes.STATUSES if counted["status"][code.value]
    ]
    return [in_cells(cells, found), *in_causes(causes)]
