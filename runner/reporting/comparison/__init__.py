"""Fair comparisons of what is stored: levels of an axis of one sweep, and several runs or sweeps with each other."""
