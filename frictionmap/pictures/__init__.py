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
regime_map      maps of regimes and stops
boundary_map    what the boundaries alone tell
history         one steady state in time
==============  ==========================================================================
"""
