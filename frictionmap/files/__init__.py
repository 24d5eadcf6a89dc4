"""Files: reading of configurations and datasets, atomic writing, summaries."""
