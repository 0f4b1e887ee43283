"""Studies: reproductions of published papers, and comparisons of our own."""
