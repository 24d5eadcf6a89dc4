"""The spring in a contact: fitted as a compliance, reported as a stiffness.

Motions depend smoothly on the compliance k1/kt, which is 0 for a rigid contact.  So its estimate is nearly
normal, and an interval that reaches the rigid contact is one of all stiffnesses above a value.
"""

import math

import numpy as np
import xarray as xr

from .parameters import SOFTEST, STIFFEST
from .statistics.estimates import number, with_error
from .statistics.least_squares import Errors

#: A mass that a spring in the contact holds may lead a base that has a damper, by up to this many degrees.
LEAD = 20.0


def with_stiffness(values: np.ndarray, found: Errors, index: int, fitted: bool) -> tuple[np.ndarray, Errors]:
    """Estimates and errors with the stiffness in the place of the compliance.

    Where the interval holds a rigid contact it ends at infinity, and there is no standard error.  For a rigid
    contact itself the estimate is that of the stiffest spring.

    index : of the compliance
    fitted : whether it was fitted
    """
    compliance, lower, upper = (float(part[index]) for part in (values, found.lower, found.upper))
    changed = values.copy()
    changed[index] = 1.0 / max(compliance, STIFFEST)
    if not fitted:
        return changed, found._replace(
            lower=_put(found.lower, index, changed[index]), upper=_put(found.upper, index, changed[index])
        )
    open_end = lower <= STIFFEST
    upper = max(upper, STIFFEST)  # between that and a rigid contact no motion is computed
    error = math.nan if open_end else float(found.standard_error[index]) / compliance**2
    correlation = found.correlation.copy()
    correlation[index] *= -1.0
    correlation[:, index] *= -1.0  # twice of its own, which stays 1
    return changed, found._replace(
        standard_error=_put(found.standard_error, index, error),
        lower=_put(found.lower, index, 1.0 / upper if upper < SOFTEST else 0.0),
        upper=_put(found.upper, index, math.inf if open_end else 1.0 / lower),
        correlation=correlation,
    )


def _put(values: np.ndarray, index: int, value: float) -> np.ndarray:
    result = values.copy()
    result[index] = value
    return result


def spring_warnings(lower: float, upper: float) -> list[str]:
    """Warn of a stiffness that the data do not determine, by its interval."""
    if math.isfinite(upper):
        return []
    known = f"any value from {lower:.3g} up to a rigid contact" if lower > 0.0 else "any value"
    return [
        f"the data do not determine contact_stiffness: {known} explains them. Measure nearer to the friction "
        "at which the contact stops slipping, measure phase lags and amplitudes, or hold contact_stiffness"
    ]


def spring_in_newtons(
    values: np.ndarray, found: Errors, index: int, stiffness: float
) -> dict[str, xr.Variable]:
    """Stiffness of a spring [N/m] with its error, or the lower end of its interval if that has no upper end.

    values, found, index : estimates and errors `with_stiffness`, and which of them it is
    stiffness : k1 [N/m]
    """
    words = "stiffness of the spring in the contact"
    value, error, lower = (float(part[index]) for part in (values, found.standard_error, found.lower))
    if math.isnan(error):
        least = number(stiffness * lower, f"lower end of the 95 % interval of the {words}", "N/m")
        return {"spring_stiffness_lower": least}
    return with_error("spring_stiffness", stiffness * value, stiffness * error, words, "N/m")
