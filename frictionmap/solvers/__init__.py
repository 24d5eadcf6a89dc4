"""The engines behind one interface: what can be asked of a system, whichever engine answers.

===============  ======================================================================
module           what is in it
===============  ======================================================================
interface        what an engine answers
general          the engine of any number of contacts, springs, belts and periodic loads
phases           the engine of contacts that open, and of piecewise linear springs
banks            the engine of banks of elastic elements, each bank one contact
varying          the engine of systems that change with r: belts and shakers in physical units
single           the engine of one rigid contact under one harmonic load
choose           the engine of a system
===============  ======================================================================
"""
