"""Sweeps: many runs from one command, and what they give together."""
