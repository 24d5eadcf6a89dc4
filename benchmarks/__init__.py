"""Benchmarks: run time against peers, start-up, cost of a phase and of a mass, a formula against simulation.

python -m benchmarks peers|startup|phases|structures|bound|all [--quick] [--results FOLDER]

===============  ======================================================================================
module           what is in it
===============  ======================================================================================
peers            general-purpose ODE solvers doing the same job
against          `peers`: the same cells by every solver, alternating, one thread each
startup          `startup`: --help, first run (compile), second run, in fresh processes
phases           `phases`: nanoseconds per slide and stop
structure_peers  the same solvers for chains of masses
structures       `structures`: cost against the number of masses; five masses against the peers
bound            `bound`: beta_lim, the thesis's sum of maxima and a slow simulation; docs/fig-5-55.png
figures          drawn without a display, written beside the numbers they show
record           machine, versions, medians, tables; results as JSON; one processor
===============  ======================================================================================
"""
