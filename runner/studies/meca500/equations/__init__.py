"""Printed equations of the Meca500 report: entries, truths and rollouts."""
