"""Analyses of stored runs beyond their metrics."""
