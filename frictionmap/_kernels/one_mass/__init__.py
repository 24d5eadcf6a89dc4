"""Kernels for one mass: scan step, events, return map, sliding orbit."""
