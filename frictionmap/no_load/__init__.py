"""Structures on belts without a load: steady sliding, its stability, and all cycles of one mass.

==========  ==================================================================================
module      what is in it
==========  ==================================================================================
sliding     steady sliding of any structure: growth of small vibrations, slope at which they grow
one_mass    all steady motions of one mass over mu, belt speed and beta
sweep       these motions as a dataset
==========  ==================================================================================
"""
