"""Benchmarks: what accuracy costs, what is faster than what, how cost grows, where numbers cease to be good,
what bad input, interrupts and damaged files do.

python -m benchmarks NAME|all [--quick] [--results FOLDER]

NAME is accuracy, peers, scaling, startup, stress, steady, structures, bound, faults, large, coupling or
coverage: each one is a module of that name in `measures`.  It prints tables, and writes JSON and a figure.
`python -m benchmarks page` puts the numbers of the committed results into docs/results.md.

=============================  ========================================================================
`measures/`                    one module for each sub-command
  accuracy                     error against run time, ours, time stepping and general-purpose solvers
  methods                      every method of `accuracy` behind one form
  search_of_s                  the search of S: by grid, by the kernel, in 40 digits
  peers                        one mass by every solver; solved against marched
  scaling                      cost against cells, threads, low frequency, share of open cells
  own_entry                    how functions here call kernels
  floor                        nanoseconds per slide and stop, and what their closed forms take with no logic
  startup                      import, --help, first run (compile), second run, in fresh processes
  stress                       the numerical torture test against 40-digit arithmetic
  steady                       solved against marched, one answer for mu = 1, what stays unresolved undamped
  structures                   cost against the number of masses; five masses against the peers
  bound                        beta_lim, the thesis's sum of maxima and a simulation; docs/fig-5-55.png
  faults                       bad input, interrupts, malformed files, damaged caches: what a user sees
  large                        stores: overhead, memory, workers, random variations, kills
  explore                      the page in a browser: slider to picture, hover to motion; `browser` finds one
  coupling                     what it costs to leave out the coupling of modes by damping
  coverage                     how often the 95 % intervals of `identify` hold the truth
`peers/`                       other ways to do the same job: each for one mass and for chains of masses
  solve_ivp, heyoka, cvode     general-purpose ODE solvers; `heyoka_batch`: one on many cells at a time
  fixed_step                   time stepping: RK4 with sticking logic, Moreau-Jean
  body, peer, one_mass, chain  what all of them solve, are asked for, and share
  check                        they against a table of known steady states
`references/`                  what is right, with nothing of the package in it; the tests use it too
  closed_forms                 boundaries and continuous motions in 40 digits, condition numbers
  steady_states                steady states of one mass in 40 digits
  periodic_orbit               periodic orbits of any structure in 40 digits
  settled                      event-exact steady states of one mass in doubles, for many cells
  shaken                       steady motions of one mass on a base with several harmonics, in doubles
  chains                       chains on a shaken base: without friction, and in continuous motion
  naive                        any structure from the equations of motion, in doubles
`report/`                      what is made of the measurements
  record                       machine, versions, medians, tables; results as JSON; one processor
  figures                      drawn without a display, written beside the numbers they show
  page                         the tables of docs/results.md, made from the committed results
  quoted_errors                of these the ones about errors; `quoted_faults`: about bad input and bad days;
                               `quoted_coverage`: about the intervals of `identify`
  quoting                      how numbers are quoted in them
`results/`                     the committed results, and `results/local` of runs on this machine
=============================  ========================================================================
"""

from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RESULTS = ROOT / "benchmarks" / "results"
