"""Audit of printed equations: entries, reference derivations, verdicts and simulated consequences."""
