"""Printed equations of the thesis: entries, reference derivations and simulated consequences."""
