"""Measurements: one module per sub-command, with `run(quick, results)`; see the package `benchmarks`."""
