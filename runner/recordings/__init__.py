"""Recordings of real arms, held against stored runs: read, aligned in time, compared, and their friction identified."""

BAGS = (".bag", ".mcap", ".db3")
"""Suffixes of ROS bags; other recordings are CSV files."""
