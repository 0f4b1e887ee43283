"""Printed equations of the Meca500 report: entries, reference derivations and simulated consequences."""
