"""Truths of the xArm7 report's equations, each evaluated in two ways."""
