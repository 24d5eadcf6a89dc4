"""Kernels for one mass under a load of several harmonics.

======  ===============================================================================
module  what is in it
======  ===============================================================================
slides  slides and stops, upwards and downwards
cycle   one excitation period, with the derivative of its end with respect to its start
steady  cycles followed until the state repeats
======  ===============================================================================
"""
