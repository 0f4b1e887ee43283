"""Audit of printed equations: entries, truths, verdicts and rollouts."""
