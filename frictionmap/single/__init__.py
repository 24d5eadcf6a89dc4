"""One rigid contact under one harmonic load: cells, maps, cycles and motions by the engine made for it.

===============  ======================================================================
module           what is in it
===============  ======================================================================
kernel_data      a structure as arrays for the kernels
quantity_data    quantities over a cycle: their positions in the results of the kernels
quantity_limits  values that kernels do not compute: r = 0, resonances without a load
cells            the data of cells, and the jobs that fill them
maps             cells in parallel: which of them are decided by formula, progress
scattered        cells at a list of points (r, beta)
responses        sizes of steady states on a grid and at scattered points
points           first harmonics at a list of points (r, beta)
dataset          maps as labelled variables
curves           response curves as labelled variables
motion           one steady state in time, as arrays
response         the same as labelled variables
===============  ======================================================================
"""
