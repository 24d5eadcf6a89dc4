"""Physical units: hertz and newtons for the frequency ratio r and the friction ratio beta.

==========  ============================================================================
module      what is in it
==========  ============================================================================
table       known units and their exact sizes
quantities  numbers with units, from text or from another package, as exact numbers
scales      `Units`: reference values that convert ratios to Hz and N
axes        conversion of values and ranges with units to ratios
structures  beams, plates and modes of a configuration, in SI units
dimensions  keys of [system] that have a dimension, and their conversion to ratios
==========  ============================================================================
"""
