"""Other ways to the same answers: general-purpose ODE solvers, and time stepping as one would write it.

A peer (`peer.Peer`) is made for one `body.Body`, runs its cells from rest, and reports the last excitation
periods; `solve_ivp`, `heyoka` and `cvode` each have a function `peer(body, **settings)` that makes the one
for a single mass or for a chain.

=============  ==============================================================================================
body           what all solve: bodies, cells, outcomes, the load in the contact, matrices
peer           what is asked of every peer
one_mass       the logic of one mass: slides are integrated, stops end where an arccos says
chain          the logic of chains: slides and stops are integrated
solve_ivp      explicit Runge-Kutta pairs of scipy
heyoka         a compiled Taylor integrator
heyoka_batch   the same one on many cells at a time
cvode          CVODE of SUNDIALS
fixed_step     RK4 with sticking logic, Moreau-Jean
=============  ==============================================================================================
"""
