"""Limits of Newton's method on the return map, of one mass and of structures."""

MAX_NEWTON = 16  # steps

#: Newton steps below this share of the motion must shrink quadratically.
NEAR_END = 1e-6

#: Longest slide of an orbit, in periods of the slower of oscillator and load; no resolved orbit has a longer
#: one.
LONGEST_SLIDE = 100.0
