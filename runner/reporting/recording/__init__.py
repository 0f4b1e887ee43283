"""The report that holds a recording of a real arm against a run."""
