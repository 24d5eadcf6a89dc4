"""Division of contents into blocks by computing time, so that workers share them and a stop loses few.

The cost is counted, not timed (`cell_seconds`): contents are cut alike whenever they are begun, for any
number of workers up to `_WORKERS`.  A store keeps the cut that it was made with.
"""

from .contents import Contents, Cut

#: Seconds of a block on average; the most expensive ones, at low frequency, take about three times as long.
_SECONDS = 10.0

#: Seconds below which a block is not worth its files: to write them takes some hundredths.
_FEWEST_SECONDS = 0.5

#: Blocks for every worker: at the end of a run few of them wait for the last one.
_PER_WORKER = 4

#: Workers that every study is cut for, if it takes long enough; for more of them it is cut more finely.
_WORKERS = 16


def cut_by_cost(contents: Contents, workers: int = 0, threads: int | None = None) -> Cut:
    """Cut contents into blocks of about ten seconds, and at least four for every worker.

    workers : for which a new store is made, if that is known
    threads : of this process, which may look at some cells
    """
    of_cell = contents.cell_seconds(threads)
    share = of_cell * contents.cells / (_PER_WORKER * max(workers, _WORKERS))
    return contents.cut_at(int(min(_SECONDS, max(_FEWEST_SECONDS, share)) / of_cell))
