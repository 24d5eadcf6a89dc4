"""Division of a study into blocks by computing time, so that workers share them and a stop loses few.

The cost is counted, not timed (`seconds_of_cells`): a study is cut alike whenever it is begun, for any number
of workers up to `_WORKERS`.  A store keeps the cut that it was made with.
"""

from ..steady.cost import seconds_of_cells
from .study import Cut, Study

#: Seconds of a block on average; the most expensive ones, at low frequency, take about three times as long.
_SECONDS = 10.0

#: Seconds below which a block is not worth its files: to write them takes some hundredths.
_FEWEST_SECONDS = 0.5

#: Blocks for every worker: at the end of a run few of them wait for the last one.
_PER_WORKER = 4

#: Workers that every study is cut for, if it takes long enough; for more of them it is cut more finely.
_WORKERS = 16


def cut_by_cost(study: Study, workers: int = 0, threads: int | None = None) -> Cut:
    """Cut a study into blocks of about ten seconds, and at least four for every worker.

    workers : for which a new store is made, if that is known
    threads : of this process, which looks at some cells of the study
    """
    axes = {"mu": study.mu, "r": study.r, "beta": study.beta}
    of_cell = seconds_of_cells(study.system, axes, study.solver, threads)
    share = of_cell * study.cells / (_PER_WORKER * max(workers, _WORKERS))
    return study.cut_at(int(min(_SECONDS, max(_FEWEST_SECONDS, share)) / of_cell))
