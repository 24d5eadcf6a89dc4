"""Motions on belts without a load: steady sliding, its stability, and cycles.

=============  ==================================================================================
module         what is in it
=============  ==================================================================================
belts          what moves with the belt, and what has no meaning without a load
sliding        growth of small vibrations about steady sliding of any structure
one_mass       all steady motions of one mass over mu, belt speed and beta
limits         friction and belt speeds at which steady sliding loses stability
dataset        motions as datasets: labels, units, provenance
steady         steady sliding of a structure: its stability, and a proof that a motion ends there
structure      cycles of structures: marched from a start, and closed by Newton's method
structure_map  these motions over mu, belt speed and beta
opening        motions of contacts that open, and beside piecewise linear springs
response       one motion in time, over one cycle
sweep          all motions over mu, belt speed and beta; their limits alone
quiet          belt speeds from which steady sliding is the only end of a motion
=============  ==================================================================================
"""
