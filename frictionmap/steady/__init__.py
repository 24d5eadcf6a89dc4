"""Steady states: of one cell in time, of all cells of a map in parallel, and along response curves.

===============  ===================================================================
module           what is in it
===============  ===================================================================
kernel_data      a structure as arrays for the kernels
quantity_data    quantities over a cycle: their places in what kernels fill
quantity_limits  those that kernels do not compute: r = 0, resonances without a load
cells            the data of cells, and the jobs that fill them
maps             cells in parallel: which of them are decided by formula, progress
refinement       what the reduction of a structure may change in its map
sweep            `sweep`: maps of one system, or of many along further axes
curves           `curves`: response curves over frequency
points           first harmonics at a list of points (r, beta)
motion           one steady state in time, as arrays
response         `response`: the same as a dataset
cost             memory and time that a map will take
===============  ===================================================================
"""
