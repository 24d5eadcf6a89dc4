"""Pictures of the answers to design questions.

===========  ======================================================================
module       what is in it
===========  ======================================================================
performance  the largest response over friction, and response curves of the answer
limits       boundaries over the band, with the answer or the working point
speeds       growth of small vibrations over the belt speed
figure       `plot_design`: choice of these pictures, and their layout
===========  ======================================================================
"""
