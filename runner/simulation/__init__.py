"""Closed-loop simulation: assembly, control loops, compiled code, batches and recording."""
