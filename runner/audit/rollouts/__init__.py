"""Wrong formulas run beside the right ones: what a robot does that believes them. One module for each work."""
