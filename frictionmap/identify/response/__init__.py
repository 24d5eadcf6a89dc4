"""Amplitudes and lags of forced responses with friction.

===============  =====================================================================
module           what is in it
===============  =====================================================================
model            amplitudes and lags by the exact steady states, and their derivatives
data             tables of forced responses, checked
balance          harmonic balance of a contact with a spring: approximate, to begin with
start            where the fit begins
fit              the steady states nearest to the data
extremes         extremes of sampled functions between their samples
phase_inversion  `friction_ratio`: friction ratios from single lags
lags             friction ratios from the single lags of a table
labels           the dataset of the fit
alternatives     whether the model explains a table, and what else does
cautions         warnings about the fit
forced           `forced`: from amplitudes and lags to estimates
===============  =====================================================================
"""
