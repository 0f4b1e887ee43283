"""Simulated motions under wrong and correct formulas of the Meca500 report."""
