"""Simulated motions under wrong and correct formulas of the xArm7 report."""
