"""time_series"""
