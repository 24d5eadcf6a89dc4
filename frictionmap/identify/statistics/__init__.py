"""Fits and their errors: least squares, outliers, correlated residuals, estimates as a dataset.

=============  ===========================================================================
module         what is in it
=============  ===========================================================================
least_squares  least squares with bounds; standard errors, intervals, correlations
robust         least squares in which outliers have little weight
weights        errors where variances of lags, or of amplitudes, follow from the residuals
correlation    whether residuals are correlated over many samples, and by how much at the most
coloured       spectrum of correlated noise, and covariances of estimates from it
levels         thresholds of significance: standard errors, probabilities, correlations
cautions       warnings about any fit
estimates      estimates with their errors as a dataset
=============  ===========================================================================
"""
