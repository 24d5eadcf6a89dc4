"""Benchmarks: what accuracy costs, what is faster than what, how cost grows, where numbers cease to be good.

python -m benchmarks NAME|all [--quick] [--results FOLDER]

NAME is accuracy, peers, scaling, startup, stress, steady, structures or bound.  Each one prints tables, and
writes JSON and a figure.  `python -m benchmarks readme` puts the numbers of the committed results into
README.md.

===============  ======================================================================================
module           what is in it
===============  ======================================================================================
accuracy         `accuracy`: error against run time, ours, time stepping and general-purpose solvers
solvers          every method of `accuracy` behind one form
baselines        time stepping: RK4 with sticking logic, Moreau-Jean
bracket          the search of S: by grid, by the kernel, in 40 digits
exact            references written from the equation of motion
sundials         CVODE as a peer
against          `peers`: one mass by every solver; solved against marched
peers            general-purpose ODE solvers doing the same job
batch_peer       one of them on many cells at a time
scaling          `scaling`: cost against cells, threads, low frequency, share of open cells
floor            nanoseconds per slide and stop, and what their closed forms take with no logic
startup          `startup`: import, --help, first run (compile), second run, in fresh processes
stress           `stress`: the numerical torture test against 40-digit arithmetic
stress_random    up to a million random cells: does every one end, with an answer or a status?
reference        40-digit closed forms, condition numbers and steady states
steady           `steady`: solved against marched, one answer for mu = 1, what stays unresolved undamped
structure_peers  the same solvers for chains of masses
structures       `structures`: cost against the number of masses; five masses against the peers
bound            `bound`: beta_lim, the thesis's sum of maxima and a slow simulation; docs/fig-5-55.png
readme           the tables of README.md, made from the committed results
quoted_errors    of these the ones about errors
quoting          how numbers are quoted in them
figures          drawn without a display, written beside the numbers they show
record           machine, versions, medians, tables; results as JSON; one processor
===============  ======================================================================================
"""
