"""Several free decays and records of one mass, fitted at once.

======  ===============================================================
module  what is in it
======  ===============================================================
parts   each decay and record as a part, with parameters that all share
fit     the fit of all parts
joint   `joint`: from several measurements to estimates
======  ===============================================================
"""
