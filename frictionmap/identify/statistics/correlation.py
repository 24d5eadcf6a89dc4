"""Inflation of standard errors by residuals that are correlated over many samples."""

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft

from .least_squares import inflation

#: Lag at which the sum ends, in correlation times (Sokal 1997, section 3).
_WINDOW = 5.0

#: Standard errors above 1 from which a correlation time is significant.
_SIGNIFICANT = 3.0


def long_inflation(residual: np.ndarray) -> float:
    """Factor of standard errors: the root of the integrated autocorrelation time, in samples.

    It is the larger one of two estimates: by the lag-1 correlation alone, and by the sum of the correlations
    at all lags up to a window, which also sees a slow part below white noise.
    """
    by_lag_1 = inflation(residual)[1]
    power = float(residual @ residual)
    if power == 0.0:
        return by_lag_1
    size = residual.size
    spectrum = rfft(residual, next_fast_len(2 * size, real=True))
    correlation = irfft(np.abs(spectrum) ** 2, next_fast_len(2 * size, real=True))[1 : size // 2] / power
    times = 1.0 + 2.0 * np.cumsum(correlation)
    lags = np.arange(1, times.size + 1)
    ended = np.flatnonzero(lags >= _WINDOW * times)
    if not ended.size:
        return by_lag_1
    lag = int(lags[ended[0]])
    time = float(times[ended[0]])
    scatter = time * np.sqrt(2.0 * (2.0 * lag + 1.0) / size)  # Sokal 1997, (3.19)
    return max(by_lag_1, float(np.sqrt(time)) if time - 1.0 > _SIGNIFICANT * scatter else 1.0)
