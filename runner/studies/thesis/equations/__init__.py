"""Printed equations of the thesis: entries, truths and rollouts."""
