"""Kernels for any structure: oscillators, states, events, return map, sliding orbit.

=============  ==============================================================================
module         what is in it
=============  ==============================================================================
oscillators    oscillators under one load, and when a sum of them leaves a range
block          the same for eight scan steps at once
state          free and held oscillators at one frequency; conversion between them
events         the end of a slide, and what follows it
newton         periodic orbits by Newton's method on the return map
event_margin   how far from an orbit a motion may be and still have the orbit's events
sliding_orbit  the continuous orbit, and the distance from it within which no motion can stop
=============  ==============================================================================
"""
