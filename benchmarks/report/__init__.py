"""What is made of measurements: JSON, tables, figures, and the numbers that docs/results.md quotes."""
