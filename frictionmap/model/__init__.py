"""What is simulated: systems, their matrices and modes, and how steady states are looked for."""
