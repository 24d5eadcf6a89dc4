"""Steady states: of one cell in time, of all cells of a map in parallel, and along response curves.

===============  ======================================================================
module           what is in it
===============  ======================================================================
boundaries       `boundaries`: boundaries of the regimes over frequency, of any system
kernel_data      a structure as arrays for the kernels
quantity_data    quantities over a cycle: their positions in the results of the kernels
quantity_limits  values that kernels do not compute: r = 0, resonances without a load
cells            the data of cells, and the jobs that fill them
maps             cells in parallel: which of them are decided by formula, progress
refinement       change of the map of a reduced structure with all modes or many more
sweep            `sweep`: maps of one system, or of many along further axes
curves           `curves`: response curves over frequency
scattered        cells at a list of points (r, beta)
points           first harmonics at a list of points (r, beta)
motion           one steady state in time, as arrays
response         `response`: one steady state in time, as a dataset
cost             expected memory and time of a map
===============  ======================================================================
"""
