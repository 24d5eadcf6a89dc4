"""Reports of measurements: JSON, tables, figures, and the tables of docs/results.md."""
