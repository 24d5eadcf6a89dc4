"""Reference results, computed without the package; benchmarks and tests compare with them."""
