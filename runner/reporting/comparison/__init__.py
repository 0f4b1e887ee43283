"""Comparison of stored results: levels of a sweep axis, or several runs or sweeps."""
