"""Report that compares a recording of a real arm with a run."""
