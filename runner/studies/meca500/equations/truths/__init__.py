"""Truths of the Meca500 report's equations, each evaluated in two ways."""
