"""`spectrum`: friction response spectra in memory, or block by block in a store."""

import os
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import xarray as xr
from numpy.typing import ArrayLike

from .. import checks
from ..errors import InputError
from ..jobs import Progress, Watch
from ..motions.further_axes import spectra_along
from ..motions.record import Record
from ..motions.spectra import Asked, at_once, checked_spectra, described


def spectrum(
    records: Record | Sequence[Record],
    period: ArrayLike,
    friction: Any,
    *,
    mu: ArrayLike = 1.0,
    damping: float = 0.0,
    contact_stiffness: float | None = None,
    scale: ArrayLike = 1.0,
    axes: Mapping[str, Any] | None = None,
    store: str | Path | None = None,
    overwrite: bool = False,
    threads: int | None = None,
    progress: Progress | None = None,
    watch: Watch | None = None,
) -> xr.Dataset:
    """Compute friction response spectra: peaks of one mass with friction, over its natural period.

    The mass is held by a spring, a damper and a contact that move with the base, or stands on the ground
    under a force.  It starts at rest, and is followed after the record until it rests permanently.
    Everything is exact to rounding for the interpolated record.

    Parameters
    ----------
    records : Record or sequence of Record
        Motions of the base, or forces over the mass.
    period : array_like
        Natural periods, > 0, increasing, in the unit of time of the records, or with a unit ("0.5 s");
        ``inf`` is a block without a spring.
    friction : array_like
        Kinetic friction forces over the mass, >= 0, increasing; with a unit, such as ``"0.05 g"``, if the
        records have one.
    mu : array_like
        Ratios of static to kinetic friction [-], >= 1, increasing.
    damping : float
        Damping ratio [-], >= 0.
    contact_stiffness : float, optional
        Stiffness of a spring in series with the contact, over that of the mass's spring, > 0; default:
        rigid.  `stops` are then ends of slips.  It takes about a hundred times as long.
    scale : array_like
        Factors of the records, increasing.
    axes : mapping, optional
        Further axes, whose dimensions come first: values of ``damping_ratios`` or ``contact_stiffness``, in
        the place of `damping` and `contact_stiffness`.
    store : str or Path, optional
        A store NAME.zarr, into which the spectra are written block by block (needs `frictionmap[zarr]`).  A
        call that was stopped goes on where it was if it is repeated.  Stores may be larger than memory.
    overwrite : bool
        Whether a store of other spectra is replaced.
    threads : int, optional
        Number of threads; default: all processors.  The result is equal to the bit for any number.
    progress, watch : callable, optional
        As in `sweep`.

    Returns
    -------
    xarray.Dataset
        Over (record, scale, mu, period, beta): largest displacement and absolute acceleration, residual
        displacement, sliding distance, stops, turns.  Of a store it is read when it is used.

    Raises
    ------
    InputError
        An argument has the wrong type or is out of range, or the store holds something else.
    OSError
        The store cannot be written; what is done is kept.

    Examples
    --------
    A block that slides without a spring, under a push of 1 for 2 s against friction of 0.3:

    >>> import frictionmap as fm
    >>> push = fm.Record([1.0, 1.0], dt=1.0, quantity="force", interpolation="hold")
    >>> float(fm.spectrum(push, float("inf"), 0.3).amplitude.squeeze().round(12))
    4.666666666667
    """
    given: dict[str, Any] = {
        "mu": mu,
        "damping": damping,
        "contact_stiffness": contact_stiffness,
        "scale": scale,
    }

    def at_point(progress: Progress | None = None, **point: Any) -> xr.Dataset:
        return at_once(
            checked_spectra(records, period, friction, **(given | point)), threads, progress, watch
        )

    if axes is not None and store is not None:
        raise InputError("cannot use", "axes", "with store: a store is of one damping ratio; omit one")
    if axes is not None:
        return spectra_along(axes, at_point, progress)
    if not isinstance(overwrite, bool):
        raise InputError("overwrite", f"must be true or false; got {checks.one_line(overwrite)}")
    if store is None:
        return at_point(progress)
    if watch is not None:
        raise InputError("cannot use", "watch", "with store: a stopped call is repeated; omit watch")
    wanted = checked_spectra(records, period, friction, **given)
    return _in_store(wanted, _path(store), overwrite, threads, progress)


def _path(given: object) -> Path:
    if not isinstance(given, (str, os.PathLike)) or Path(given).suffix != ".zarr":
        raise InputError("store", f"must be a path that ends in .zarr; got {checks.one_line(given)}")
    return Path(given)


def _in_store(
    wanted: Asked, path: Path, overwrite: bool, threads: int | None, progress: Progress | None
) -> xr.Dataset:
    """Spectra in a store, which is made or resumed."""
    from .cuts import cut_by_cost
    from .run import fill_store, in_this_process
    from .spectra import spectra_of

    used = checks.threads(threads)
    contents = spectra_of(wanted)
    fill_store(
        path, contents, str(described(wanted.grid.records)["title"]), in_this_process(used), overwrite,
        progress, partial(cut_by_cost, threads=used),
    )  # fmt: skip
    return xr.open_zarr(path, consolidated=False, chunks=None)
