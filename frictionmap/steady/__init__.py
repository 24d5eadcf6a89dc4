"""Steady states: of one cell in time, of all cells of a map in parallel, and along response curves.

===============  ======================================================================
module           what is in it
===============  ======================================================================
configured       a configuration in the place of a system and its axes
refinement       change of boundaries and maps of a reduced structure with all modes or many more
reduced          matrices of a reduced structure as a file, and what they cost
boundaries       `boundaries`: boundaries of the regimes over frequency, of any system
sweep            `sweep`: maps of one system, or of many along further axes
curves           `curves`: response curves over frequency
points           first harmonics at a list of points (r, beta)
response         `response`: one steady state in time, as a dataset
cost             expected memory and time of a map
===============  ======================================================================
"""
