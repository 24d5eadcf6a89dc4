"""Matrices of structures: read from the files of finite-element programs, and reduced.

==============  ====================================================================
module          what is in it
==============  ====================================================================
entries         a matrix as a file has it, entry by entry, and the labels of its rows
market          Matrix Market
abaqus          text of Abaqus
harwell_boeing  Harwell-Boeing, and Rutherford-Boeing
nastran         OP4 and punch (DMIG), through the extra `fe`
arrays          several arrays in a file: NPZ and MAT
files           the door: M, K and C of whatever was given, their rows in one order
dofs            degrees of freedom by the numbers and labels of a file
structure       what was given, checked
craig_bampton   reduction to a few degrees of freedom
accuracy        what it costs
reduction       both together: a reduction held to its promise
==============  ====================================================================
"""
