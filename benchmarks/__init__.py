"""Benchmarks: run time against peers, start-up, cost of a phase.

python -m benchmarks peers|startup|phases [--quick] [--results FOLDER]

============  ==========================================================================
module        what is in it
============  ==========================================================================
peers         general-purpose ODE solvers doing the same job
against       `peers`: the same cells by every solver, alternating, one thread each
startup       `startup`: --help, first run (compile), second run, in fresh processes
phases        `phases`: nanoseconds per slide and stop
record        machine, versions, medians; results as JSON
============  ==========================================================================
"""
