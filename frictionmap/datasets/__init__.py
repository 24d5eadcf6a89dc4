"""Datasets: labels of variables, schema and checks, SI units, provenance."""
