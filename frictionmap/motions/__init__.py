"""Motions in time under records: earthquakes, pulses, run-ups, random loads.

===============  ================================================================================
module           what is in it
===============  ================================================================================
pieces           polynomials over the intervals of a record: interpolation, derivatives, integrals
baseline         what is taken off the samples of a record
formats          files of records, one module per format
quantities       numbers of records that may have units
formulas         pulses and sweeps
densities        spectral densities of random loads
generators       random records of a spectral density
record           `Record`: a load or a base motion over time
channels         what a record drives: loads on the masses, walls, normal loads
origins          where records come from; bases that drift at their end
scaling          what makes a record dimensionless; friction as a force or as an acceleration
bed              the structure with all contacts held under no load: place of rest, asleep or not
structure        a system under channels as arrays for the kernels, and what is watched of it
starts           states at the beginning: at rest, given, or where another motion ended
energies         energies of one motion over time
cells            the motions of a grid of records, scales and friction, on several threads
phase_beds       one phase of contacts that open and springs, under no load: its place of rest, asleep
opening          motions of systems with such contacts and piecewise linear springs
bank_motions     motions of systems whose contacts are banks of elastic elements
statistics       medians, quantiles, exceedance over records; means of stationary motions over time
averages         statistics of stationary motions beside their histories
ring_down        `ring_down`: frequency and damping of a decay over its amplitude, from its turning points
holding          the largest forces in contacts that all hold: the friction from which nothing moves
opening_holding  the same of contacts that open, and beside piecewise linear springs
further_axes     motions and spectra along further axes in one dataset
dataset          `history`: motions in time as labelled variables
bounds           how far motions with other friction, or under another record, can be
choice           `least_median`: the friction with the least median of a peak over records
lanes            oscillators with friction under one record, eight at a time
elastic_spectra  spectra of one mass whose contact has a spring
spectra          friction response spectra of one mass
table            the table [record] of a configuration
configuration    the tables [record], [history] and [spectrum] of a configuration
===============  ================================================================================
"""
