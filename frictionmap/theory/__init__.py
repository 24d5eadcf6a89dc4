"""Closed forms over frequency: boundaries of the regimes, and the continuous motion."""
