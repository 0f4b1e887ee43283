"""Truths of the thesis equations, each evaluated in two ways."""
