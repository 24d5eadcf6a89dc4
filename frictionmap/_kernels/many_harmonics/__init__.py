"""Kernels for one mass under a load of several harmonics: slides and stops, one cycle, steady state."""
