"""Study of what the thesis leaves open: bending, force, three stages, and computers that take time."""
