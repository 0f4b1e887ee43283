"""The report that holds several sweeps against each other."""
