"""What is made of measurements: JSON, tables, figures, and the numbers that README.md quotes."""
