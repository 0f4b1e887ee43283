"""Walk over the options of a run: each one changes the result, is rejected, or is told to have no effect."""
