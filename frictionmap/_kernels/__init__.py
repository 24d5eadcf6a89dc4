"""The only home of jitted code: numbers and arrays in, numbers and codes out.

==============  =========================================================================
room            what is in it
==============  =========================================================================
jit, kinds      the decorators that all kernels are compiled under; one function for several
                kinds of motion, chosen by class
linking         each kernel compiled once and called by name, or part of its callers
cache           compiled kernels on disk, and the folders they are kept in
closed_form     trigonometry of pi/(2R); decay and damping functions of a mode
boundary        V, U, G, H, S of one mass and of structures
one_mass        scan step, events, return map and sliding orbit of one mass
structure       the same of any structure, with its oscillators and states
many_harmonics  one mass under a load of several harmonics, for records of tests
engine          one driver for both: follow, recognise a return, solve, measure, fill
==============  =========================================================================
"""
