"""Sweeps: many runs from one command, with their execution, results and tunings."""
