"""Motions on a belt without a load: all cycles of one mass, whose phases are damped oscillations; structures.

Time is counted over 1/omega_1.  x'' + 2 zeta x' + x = -f, and w = x' - v is the velocity over the belt.

========  ====================================================================================
module    what is in it
========  ====================================================================================
band      an oscillation within a band of velocities: when and where it leaves the band
orbit     one turn of the motion through its bands, forwards or backwards in time
cycles    all cycles without stops, as fixed points of the map from a maximum to the next one
portrait  steady sliding, the stick-slip cycle and the cycles without stops of one cell
fill      portraits of all cells; the fastest belt with a stick-slip cycle
ride      motions of structures: from maximum to maximum, until they are back; flights over a time
========  ====================================================================================
"""
