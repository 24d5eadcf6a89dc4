"""Measured signals: samples, turning points, harmonics of one frequency, noise.

==============  ====================================================================
module          what is in it
==============  ====================================================================
turning_points  extremes of a record, its noise and resolution, the linear decrement
samples         samples checked: times, the window, gaps
plateaus        flat ends: clipped by the measuring range, or a mass that sticks
noise           noise of a record near its harmonics, slow wander of its zero
phasors         harmonics of a record, by least squares on one frequency
integration     `displacements`: from velocities and accelerations
==============  ====================================================================
"""
