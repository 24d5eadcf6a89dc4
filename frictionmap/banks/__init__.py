"""Systems whose contacts are banks of elastic elements (Iwan, Masing), each bank one contact.

=========  ================================================================================
module     what is in it
=========  ================================================================================
system     a structure with banks, in one form
arrays     the same as arrays for the kernels
given      the same of a system of the model; what is refused
motion     one motion in time, from the Taylor terms of its steps
solve      steady motions over r and beta
dataset    boundaries and maps as labelled variables
cycle      a steady motion at the points of integrals over a cycle
responses  sizes of steady motions on a grid and at points, of which designs are
response   one steady motion in time, as labelled variables
curves     response curves
=========  ================================================================================
"""
