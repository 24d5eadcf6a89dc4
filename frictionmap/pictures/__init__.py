"""Modules that draw pictures; `frictionmap.plot` is the public interface.

==============  ==========================================================================
module          what is in it
==============  ==========================================================================
palette         one colour for each class of cells, one style for each curve
classes         the class of every cell, cells per class, labels of the legend
grids           axes of cells: edges, limits, linear or logarithmic
raster          cells to pixels, without losing small features
marks           positions of names, rings and labels, so that they do not overlap
words           titles and captions
panels          figures, panels, axes, legends
second_axes     axes in hertz, newtons, millimetres in addition to ratios
boundary_curves boundaries over a map, at the resolution of the picture
regime_map      maps of regimes and stops
boundary_map    maps of the boundaries alone
history         one steady state in time
orbit           one steady state: phase portrait, friction loop, harmonics
families        the parameter in which the lines of response curves differ
curve_lines     lines of response curves: pieces by regime, phases without jumps
curve_axes      their axes, cut-off peaks, arrangement of panels
invariants      points that friction does not change, resonances that it makes finite
motions         amplitude and phase over frequency
harmonics       harmonics over frequency
works           work, distances and forces over frequency
curves          choice among these pictures
fit_data        measured samples with their errors, and residuals
fit_picture     the parts of a picture of a fit
fit_samples     fits to any data
fit_decay       free decays with their envelope
fit_sweep       sweeps of two masses
fit_position    measured motions among the regimes of their structure
fit_responses   panels of amplitudes and phase lags over frequency
fit_chain       sweeps of chains
fit_forced      forced responses with the curves of their sets
fit_record      records in time, and their cycles superimposed
fits            choice among these pictures
==============  ==========================================================================
"""
