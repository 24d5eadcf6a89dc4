"""Steady states: of one cell in time, of the cells of a map, in parallel."""
