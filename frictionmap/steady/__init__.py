"""Steady states: of one cell in time, and of all cells of a map in parallel."""
