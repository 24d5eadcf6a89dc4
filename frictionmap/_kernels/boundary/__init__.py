"""Response functions V, U, G, H, S and the boundaries of the regimes."""
