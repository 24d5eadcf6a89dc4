"""What a dataset holds: labels, legal values, and how it was made."""
