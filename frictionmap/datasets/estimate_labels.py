"""Names, types and valid values of a dataset of estimates, for every kind of data.

A kind of data adds variables of its own, scalars or over samples; they are numbers or texts.
"""

import numpy as np

from .. import checks
from .labels import Label

_PARAMETER, _SAMPLE = ("parameter",), ("sample",)
_FLAG = Label(np.int8, "", _PARAMETER, least=0, most=1)
_NUMBER = Label(np.float64, "number", ())

#: Required variables of a dataset of estimates.
OF_PARAMETERS = {
    "estimate": Label(np.float64, "estimate", _PARAMETER),
    "standard_error": Label(np.float64, "standard error", _PARAMETER, least=0.0, nan=True),
    "lower": Label(np.float64, "lower end of the 95 % interval", _PARAMETER, inf=True),
    "upper": Label(np.float64, "upper end of the 95 % interval", _PARAMETER, inf=True),
    "unit": Label(np.str_, "unit", _PARAMETER),
    "known": _FLAG,
    "at_bound": _FLAG,
}

_OF_SAMPLES = {
    name: Label(np.float64, name, _SAMPLE) for name in ("data", "model", "residual", "time", "base")
}

ESTIMATES = {
    **OF_PARAMETERS,
    "correlation": Label(np.float64, "correlation of errors", ("parameter", "parameter2")),
    **_OF_SAMPLES,
    "sigma": Label(np.float64, "standard error of a sample", _SAMPLE, least=0.0),
    "frequency": Label(np.float64, "frequency", _SAMPLE, least=0.0),
    "frequency_ratio": Label(np.float64, "frequency ratio", _SAMPLE, least=0.0, most=checks.LARGEST_RATIO),
    "friction_ratio": Label(np.float64, "friction ratio", _SAMPLE, least=0.0),
    "quantity": _FLAG._replace(dims=_SAMPLE),
    "mass": Label(np.int16, "mass, counted from 1", _SAMPLE, least=1),
    "set": Label(np.str_, "test, of one friction force", _SAMPLE),
    "base_frequency": _NUMBER._replace(least=0.0),
    "reduced_chi_square": _NUMBER._replace(least=0.0),
    "residual_rms": _NUMBER._replace(least=0.0),
    "residual_correlation": _NUMBER,
    "error_inflation": _NUMBER._replace(least=1.0),
    "verdict": Label(np.int8, "what the data show", (), least=0),
    "parameter": Label(np.str_, "parameter", _PARAMETER),
    "parameter2": Label(np.str_, "parameter", ("parameter2",)),
    "sample": Label(np.int64, "sample fitted", _SAMPLE),
}

#: Global attributes that are text, in addition to those of every file.
ESTIMATE_TEXTS = ("warnings", "data_file", "data_form")
