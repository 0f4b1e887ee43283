"""Printed equations of the xArm7 report: entries, reference derivations and simulated consequences."""
