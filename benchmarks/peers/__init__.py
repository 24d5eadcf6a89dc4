"""Other solvers for the same steady states: general-purpose ODE solvers, and simple time stepping.

A peer (`peer.Peer`) is made for one `body.Body`, runs its cells from rest, and reports the last excitation
periods; `solve_ivp`, `heyoka` and `cvode` each have a function `peer(body, **settings)` that makes the one
for a single mass or for a chain.  Solvers for several contacts and periodic loads are made for a
`contacts.ContactBody`, by functions `contact_peer(body, **settings)` of `solve_ivp` and `heyoka`.

================  ===========================================================================================
body              problem: bodies, cells, outcomes, the load in the contact, matrices
peer              interface of every solver
one_mass          one mass: slides are integrated, the end of a stop is an arccos
chain             chains: slides and stops are integrated
contacts          problem with several contacts and a periodic load: bodies, cells, outcomes
periodic_load     one mass under several harmonics: slides are integrated, stops end on samples of the load
speed_law         one mass under friction over speed: slides are integrated from break point to break point
slider            one mass on a slider with any force law: contacts that open, belts without a load
switching         several contacts: which of them slide after an event; each phase is integrated
solve_ivp         explicit Runge-Kutta pairs of scipy
heyoka            a compiled Taylor integrator
heyoka_batch      heyoka on many cells at a time
cvode             CVODE of SUNDIALS
fixed_step        RK4 with sticking logic, Moreau-Jean
moreau            Moreau-Jean time stepping for several contacts
shaken            motions under records, one contact: OpenSees, scipy and heyoka with events
harmonic_balance  harmonic balance with alternating frequency and time for one elastic contact
curve             problem of programs that follow response curves by harmonic balance
pyharm, nlvib     two such programs; the second under Octave
siconos           time stepping by Siconos, for one mass with a rigid contact
================  ===========================================================================================
"""
