"""Pictures of maps, curves, motions and fits; `frictionmap.plot` is the public interface.

===========  ========================================================================
module       what is in it
===========  ========================================================================
options      options of pictures, as all functions that draw take them
palette      one colour for each class of cells, one style for each curve
classes      the class of every cell, cells per class, labels of the legend
grids        axes of cells: edges, limits, linear or logarithmic
marks        positions of names, rings and labels, so that they do not overlap
words        titles, captions, names of loads
sizes        sizes of figures, texts and lines; settings of matplotlib
drawing      options of pictures, applied to all functions that draw
styles       settings from a file; figures written to files
panels       figures, panels, axes, legends
second_axes  axes in hertz, newtons, millimetres in addition to ratios
shapes       datasets in the form that pictures require
features     natural frequencies and other features of a system on the frequency axis
structures   structures with their points, contacts, loads and supports
mode_shapes  modes of structures
maps         regimes, boundaries and probabilities over frequency and friction
curves       response curves over frequency
motions      one steady state: in time, as phase portrait, as friction loop
fits         measured data with the fitted curves
designs      answers to design questions
===========  ========================================================================
"""
