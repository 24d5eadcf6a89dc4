"""Several free decays and records of one mass, fitted at once.

======  ===============================================================
module  what is in it
======  ===============================================================
fit     the fit of all parts
joint   `joint`: from several measurements to estimates
======  ===============================================================
"""
