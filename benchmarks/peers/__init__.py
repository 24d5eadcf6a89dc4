"""Other ways to the same answers: general-purpose ODE solvers, and time stepping as one would write it."""
