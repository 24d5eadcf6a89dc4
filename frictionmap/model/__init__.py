"""Systems: structure, damping, load and contact; their matrices and modes; settings of the solver."""
