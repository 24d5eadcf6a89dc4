"""Other solvers for the same steady states: general-purpose ODE solvers, and simple time stepping.

A peer (`peer.Peer`) is made for one `body.Body`, runs its cells from rest, and reports the last excitation
periods; `solve_ivp`, `heyoka` and `cvode` each have a function `peer(body, **settings)` that makes the one
for a single mass or for a chain.

=============  ==============================================================================================
body           problem: bodies, cells, outcomes, the load in the contact, matrices
peer           interface of every solver
one_mass       one mass: slides are integrated, the end of a stop is an arccos
chain          chains: slides and stops are integrated
solve_ivp      explicit Runge-Kutta pairs of scipy
heyoka         a compiled Taylor integrator
heyoka_batch   heyoka on many cells at a time
cvode          CVODE of SUNDIALS
fixed_step     RK4 with sticking logic, Moreau-Jean
=============  ==============================================================================================
"""
