"""One mass under a load of several harmonics: slides and stops, one cycle, the steady state."""
