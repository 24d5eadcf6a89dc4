"""Kernels for one mass: scan step, events, return map, sliding orbit.

=============  ======================================================================
module         what is in it
=============  ======================================================================
scan_step      motion between events: one step as a fixed map, and its Taylor series
events         the end of a slide, and what follows it: a turn, a stop, sticking
newton         periodic orbits by Newton's method on the return map
sliding_orbit  the distance from the continuous orbit within which no motion can stop
=============  ======================================================================
"""
