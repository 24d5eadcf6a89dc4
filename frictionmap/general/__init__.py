"""Systems of the general engine: several contacts, springs in contacts, belts, periodic loads.

==========  =====================================================================================
module      what is in it
==========  =====================================================================================
problem     a system over r as arrays for the kernels
held        forces in contacts that do not slide, and the boundaries that follow from them
no_stop     friction up to which no contact stops, found with the engine itself
maps        the cells of a map
==========  =====================================================================================
"""
