"""Matrices and modes of structures: from files of finite-element programs, reduced; beams and plates.

==============  ===================================================
module          what is in it
==============  ===================================================
entries         matrices in files: entries, and labels of the rows
market          Matrix Market
abaqus          text of Abaqus
harwell_boeing  Harwell-Boeing, and Rutherford-Boeing
nastran         OP4 and punch (DMIG), through the extra `fe`
arrays          files with several arrays: NPZ and MAT
files           M, K and C from files or arrays, with the same rows
dofs            degrees of freedom by number and label
structure       checked matrices
craig_bampton   reduction to a few degrees of freedom
accuracy        error of a reduction
reduction       reduction, checked against the allowed error
modes           modes at named points, checked
mode_files      modes from NPZ, MAT, CSV and universal files
beam            bending of uniform beams: modes, compliance
plate           bending of rectangular plates: modes, compliance
uniform         beams and plates with their dimensions
==============  ===================================================
"""
