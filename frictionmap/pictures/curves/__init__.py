"""Pictures of response curves over frequency.

==========  =================================================================================
module      what is in it
==========  =================================================================================
families    the parameter in which the lines differ: friction ratio or mu
invariants  points that friction does not change; resonances whose peak friction makes finite
lines       pieces of lines by regime, phases without jumps
axes        axes, cut-off peaks, arrangement of panels
amplitudes  amplitude and phase of masses and contact
harmonics   harmonics, in decibels
works       work, distances and forces
figure      choice of these pictures, and the number of panels
==========  =================================================================================
"""
