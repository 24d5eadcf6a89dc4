"""The only home of jitted code: numbers and arrays in, numbers and codes out.

==============  =========================================================================
room            what is in it
==============  =========================================================================
compiler        the decorators that all kernels are compiled under, how kernels are linked and
                kept on disk, and the fall-back to plain numba
closed_form     trigonometry of pi/(2R); decay and damping functions of a mode
boundary        V, U, G, H, S of one mass and of structures
one_mass        scan step, events, return map and sliding orbit of one mass
structure       the same of any structure, with its oscillators and states
many_harmonics  one mass under a load of several harmonics, for records of tests
engine          one driver for both: follow, recognise a return, solve, measure, fill
==============  =========================================================================
"""
