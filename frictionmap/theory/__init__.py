"""Closed forms over frequency: boundaries, and the motion that never sticks."""
