"""Simulated motions under wrong and correct formulas of the thesis."""
