"""Control loops and whole closed loops as machine code."""
