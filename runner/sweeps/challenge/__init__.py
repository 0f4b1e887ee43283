"""Challenge of a comparison: the same question with one choice changed at a time."""
