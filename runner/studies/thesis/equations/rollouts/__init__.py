"""Wrong formulas run beside the right ones."""
