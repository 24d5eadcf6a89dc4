"""What is right, computed with nothing of the package: benchmarks and tests compare with it."""
