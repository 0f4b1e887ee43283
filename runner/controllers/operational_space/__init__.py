"""Operational-space controllers of a whole arm."""
