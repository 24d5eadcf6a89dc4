"""Physical units: hertz and newtons for the frequency ratio r and the friction ratio beta.

==========  ============================================================================
module      what is in it
==========  ============================================================================
table       every unit that is understood, and its exact size
quantities  a number with its unit, from text or from another package, as an exact number
scales      `Units`: what r = 1 and beta = 1 are; lengths and forces that follow from it
axes        values and ranges with units as ratios
==========  ============================================================================
"""
