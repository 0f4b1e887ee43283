"""Printed equations of the xArm7 report: entries, truths and rollouts."""
