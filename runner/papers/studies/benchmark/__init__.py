"""Benchmark study: comparison of arm controllers."""
