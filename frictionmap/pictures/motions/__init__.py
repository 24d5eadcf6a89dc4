"""Pictures of one steady state.

=======  =========================================
module   what is in it
=======  =========================================
history  motion, friction force and events in time
orbit    phase portrait, friction loop, harmonics
=======  =========================================
"""
