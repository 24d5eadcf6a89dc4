"""What pictures are made of; `frictionmap.plot` is the door.

==============  ==========================================================================
module          what is in it
==============  ==========================================================================
palette         one colour for each class of answers, one style for each curve
classes         the class of every cell, how many cells a class has, what a legend calls it
grids           axes of cells: edges, limits, linear or logarithmic
raster          cells to pixels: nothing is lost, however many cells a pixel has
marks           where to write names, draw rings, put labels so that they lie apart
words           titles and captions
panels          figures, panels, axes, legends
second_axes     axes in hertz, newtons, millimetres beside those of ratios
boundary_curves boundaries over a map, as fine as the picture
regime_map      maps of regimes and stops
boundary_map    what the boundaries alone tell
history         one steady state in time
orbit           one steady state without time: phase portrait, friction loop, harmonics
families        what the lines of response curves differ in
curve_lines     their lines: pieces by regime, phases without jumps
curve_axes      their axes, what is cut off, how panels lie
invariants      points that friction leaves alone, resonances that it makes finite
motions         amplitude and phase over frequency
harmonics       harmonics over frequency
works           works, distances and forces over frequency
curves          which of these is drawn
fit_data        measured samples with their errors, and residuals
fit_picture     what a picture of a fit consists of
fit_samples     fits to any data
fit_decay       free decays with their envelope
fit_sweep       sweeps of two masses
fit_position    where motions lie among the regimes of their structure
fit_responses   panels of amplitudes and lags over frequency
fit_chain       sweeps of chains
fit_forced      forced responses with the curves of their sets
fit_record      records in time, and their cycles over each other
fits            which of these is drawn
==============  ==========================================================================
"""
