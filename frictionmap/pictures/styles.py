"""Settings of matplotlib from a file, and figures written to files: fonts, texts and resolution."""

import contextlib
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from ..errors import InputError

#: Pixels per inch of files, unless the options or the setting savefig.dpi say otherwise.
_DPI = 160.0

#: TrueType fonts in PDF files, which journals ask for; letters instead of outlines in SVG files.
_FONTS: Any = {"pdf.fonttype": 42, "svg.fonttype": "none"}


@contextlib.contextmanager
def settings_of(style: Path | None) -> Iterator[None]:
    """Use the settings of a file FILE.mplstyle for a while.

    Raises
    ------
    InputError
        The file cannot be read.
    """
    if style is None:
        yield
        return
    if style.suffix != ".mplstyle":
        raise InputError(f"style must be a file that ends in .mplstyle; got {style}")
    try:
        settings = mpl.rc_params_from_file(style, use_default_template=False)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "it is not a style of matplotlib"
        raise InputError(
            f"cannot read style {style}: {reason}; give a file of settings of matplotlib"
        ) from None
    with mpl.rc_context(settings):
        yield


def written(figure: Figure, file: BytesIO, form: str, dpi: float | None) -> None:
    """Write a figure: fonts are embedded, cells of large maps have `dpi` pixels per inch."""
    own = mpl.rcParams["savefig.dpi"]
    resolution = dpi or (_DPI if own == "figure" else float(own))
    with mpl.rc_context(_FONTS):
        figure.savefig(file, format=form, dpi=resolution)
