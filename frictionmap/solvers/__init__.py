"""The engines behind one interface: what can be asked of a system, whichever engine answers.

===============  ======================================================================
module           what is in it
===============  ======================================================================
interface        what an engine answers
single           the engine of one rigid contact under one harmonic load
general          the engine of any number of contacts, springs, belts and periodic loads
choose           the engine of a system
===============  ======================================================================
"""
