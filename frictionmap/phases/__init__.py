"""Systems whose phases are linear: normal forces that move with the structure, separation, gaps, springs.

==========  ==================================================================================
module      what is in it
==========  ==================================================================================
system      matrices, contacts, springs and loads in one form, from a system or from arrays
arrays      the same as arrays for the kernels
quantities  outputs of cells: names, what they are computed from
motion      one motion in time, from the Taylor terms of its steps
solve       steady motions over mu, r and beta
given       the same of a system of the model
responses   sizes of steady motions on a grid and at scattered points, for designs
dataset     maps as labelled variables
cycle       harmonics, works and phases of a steady motion
response    one steady motion in time, as labelled variables
curves      response curves
sliding     steady sliding on belts: its place, and the growth of small vibrations
attraction  a proof that a motion without a load ends in steady sliding
free        steady motions without a load over mu, belt speed and beta
==========  ==================================================================================
"""
