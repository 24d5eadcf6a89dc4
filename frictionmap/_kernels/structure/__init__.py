"""Kernels for any structure: scan step, events, return map, sliding orbit."""
