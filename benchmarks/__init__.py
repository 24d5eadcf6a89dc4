"""Benchmarks: accuracy, speed compared with other solvers, growth of the computing time, numerical limits.

python -m benchmarks NAME|all [--quick] [--results FOLDER]

NAME is accuracy, peers, scaling, startup, stress, steady, structures, general, continuation, laws, design,
static, bound, large, explore, first_minute, coupling, coverage, consistency, spectrum, histories, banks,
many_contacts or second_starts: each is a module of that name in `measures`.  It prints tables, and writes
JSON and perhaps a figure.  `all` states how long it will take, and continues after an interruption.
`python -m benchmarks page` writes the numbers of the committed results into docs/results.md.

=============================  ========================================================================
`measures/`                    one module per sub-command
  accuracy                     error against run time: frictionmap, time stepping, general-purpose solvers
  methods                      every method of `accuracy` with one interface
  search_of_s                  the search of S: by grid, by the kernel, in 40 digits
  peers                        one mass by every solver; solved against marched
  scaling                      cost against cells, threads, low frequency, share of open cells
  own_entry                    how functions here call kernels
  floor                        nanoseconds per slide and stop, and those of the closed forms alone
  startup                      import, --help, first run (compile), second run, in new processes
  stress                       the numerical torture test against 40-digit arithmetic
  steady                       solved against marched, uniqueness for mu = 1, unresolved undamped cells
  structures                   time against the number of masses; five masses against other solvers
  general                      several contacts, elastic contacts, periodic loads: cost, against other solvers
  continuation                 response curves by programs for harmonic balance: time against error
  laws                         friction over speed, contacts that open, belts: cost, against other solvers
  design                       design questions: time, against whole maps; borders of stop counts
  static                       maps at mu > 1 against those of another checkout, in turn
  bound                        beta_lim, the thesis's sum of maxima and a simulation; docs/fig-5-55.png
  large                        stores: overhead, memory, workers, random variations, kills
  explore                      response times of the interactive page; `browser` finds a browser
  first_minute                 fresh clone to running motion: what the page shows, second by second
  coupling                     error if the coupling of modes by damping is neglected
  coverage                     how often the 95 % intervals of `identify` contain the true value
  consistency                  what every map of several contacts must fulfil, in random cells
  spectrum                     friction response spectra: a sample, an event, a whole spectrum
  histories                    motions in time under records: time against error, beside other solvers
  banks                        banks of elastic elements: time against their number, as one contact or not
  many_contacts                time of a cell against the number of contacts, up to 64: frames and loops
  second_starts                steady states of 9 to 64 contacts from two starts: are they the same?
`peers/`                       other solvers: each for one mass and for chains of masses
  solve_ivp, heyoka, cvode     general-purpose ODE solvers; `heyoka_batch`: many cells at a time
  fixed_step                   time stepping: RK4 with sticking logic, Moreau-Jean
  moreau, harmonic_balance     several contacts by time stepping; an elastic contact by harmonic balance
  body, peer, one_mass, chain  problem, interface, and common code of these solvers
  shaken                       motions under records: OpenSees, solve_ivp, heyoka
  contacts, periodic_load,     the same for several contacts and loads of several harmonics
  switching
  speed_law, slider            the same for friction over speed; contacts that open, belts without a load
  curve, pyharm, nlvib         programs for harmonic balance that follow response curves
  siconos                      time stepping by Siconos, for one mass
`references/`                  reference results without code of the package; the tests use them, too
  closed_forms                 boundaries and continuous motions in 40 digits, condition numbers
  steady_states                steady states of one mass in 40 digits
  periodic_orbit               periodic orbits of any structure in 40 digits
  settled                      event-exact steady states of one mass in doubles, for many cells
  shaken                       steady motions of one mass on a base with several harmonics, in doubles
  chains                       chains on a shaken base: without friction, and in continuous motion
  naive                        any structure from the equations of motion, in doubles
`report/`                      reports of the measurements
  record                       machine, versions, medians, tables; results as JSON; one processor
  figures                      figures, drawn without a display
  results_page                 the tables of docs/results.md, from the committed results
  quoted_errors                tables about errors; `quoted_coverage`: about the intervals of `identify`;
                               `quoted_general`: about several contacts and periodic loads;
                               `quoted_design`: about designs; `quoted_first_minute`: about the page;
                               `quoted_histories`: about motions in time;
                               `quoted_curves`: about programs for harmonic balance, laws, opening contacts
  quoting                      format of the numbers
`results/`                     the committed results; `results/local` has those of local runs
=============================  ========================================================================
"""

from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RESULTS = ROOT / "benchmarks" / "results"
