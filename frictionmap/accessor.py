"""`ds.frictionmap`: names of regimes, cells of one regime, and pictures, as an accessor of xarray datasets.

It is registered when xarray and this package are both loaded and one of its functions is used.
"""

from typing import TYPE_CHECKING, Unpack

import numpy as np
import xarray as xr

from . import checks, regimes
from .datasets.labels import regime_of_choice
from .errors import InputError
from .model.html import Text

if TYPE_CHECKING:
    from .pictures.options import FigureOptions
    from .pictures.panels import AxesArray

_NAMES = {
    code.value: code.name.replace("_", "-") for code in (*regimes.BELT_REGIMES, *regimes.NO_LOAD_REGIMES)
}


@xr.register_dataset_accessor("frictionmap")
class FrictionAccessor:
    """Summaries and pictures of a dataset of this package.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `sweep`, `curves`, `response` or any other function, or a part of one.
    """

    def __init__(self, ds: xr.Dataset) -> None:
        self._ds = ds

    @property
    def labels(self) -> xr.DataArray:
        """Name of the regime of every cell, such as "stick-slip"; dimensions are those of `regime`.

        If one contact was chosen, with `isel` or `sel`, they are its regimes, else those of all together.

        Raises
        ------
        InputError
            The dataset has no variable `regime`.
        """
        regime = self._regime()
        words = np.full(regime.shape, _NAMES[regimes.UNRESOLVED], dtype=object)
        for value, name in _NAMES.items():
            words[regime.values == value] = name
        named = xr.DataArray(words.astype(str), regime.coords, regime.dims, "regime")
        return named.assign_attrs(long_name="motion regime of the steady state")

    def where_regime(self, name: str) -> xr.Dataset:
        """The dataset with NaN in all cells of other regimes; the regimes are those of `labels`.

        Parameters
        ----------
        name : str
            "continuous", "stick-slip", "permanent-sticking", "one-way-sliding" or "unresolved"; hyphens may
            be underscores or spaces.

        Raises
        ------
        InputError
            There is no such regime, or the dataset has no variable `regime`.
        """
        words = name.replace("_", "-").replace(" ", "-") if isinstance(name, str) else name
        valid = [*_NAMES.values()]
        if words not in valid:
            hint = checks.nearest(words, valid) if isinstance(words, str) else ""
            raise InputError(f"unknown regime {checks.one_line(name)}{hint}; valid: {', '.join(valid)}")
        code = next(value for value, known in _NAMES.items() if known == words)
        there = self._regime() == code
        ds = self._ds
        cells = {key: ds[key].where(there) for key in ds.data_vars if set(there.dims) <= set(ds[key].dims)}
        return ds.assign(cells)

    def summary(self) -> Text:
        """Describe the dataset as `frictionmap info` does: its system, its axes, and the results in words.

        An answer of `fm.design` is described by its friction, its peaks and its warnings.

        Examples
        --------
        >>> import frictionmap as fm
        >>> answer = fm.design.stuck(fm.System(damping_ratios=0.05), [0.5, 1.5])
        >>> print(answer.frictionmap.summary().splitlines()[0])
        Least friction that holds [design]
        """
        from .files.summary import describe_file

        return Text(describe_file(self._ds))

    def plot(
        self, quantity: str | None = None, *, log: bool = False, **options: Unpack["FigureOptions"]
    ) -> "AxesArray":
        """Draw the dataset as `frictionmap plot` does: its first quantity, or another one.

        Parameters
        ----------
        quantity : str, optional
            Such as "contact_amplitude" for a map, or "harmonics" for response curves.
        log : bool
            Logarithmic axis of amplitudes, or scale of colours.
        options : keyword arguments of the functions that draw, such as size="85mm"

        Returns
        -------
        An array of the axes.

        Raises
        ------
        InputError
            The dataset has no such quantity, or an option is invalid.
        """
        from .plot import draw

        return draw(self._ds, quantity, log=log, **options)

    def _regime(self) -> xr.DataArray:
        name = regime_of_choice(self._ds)
        if name not in self._ds:
            raise InputError(
                "cannot find regimes: the dataset has no variable regime; compute it with that output"
            )
        return self._ds[name]
