"""Studies: reproductions of published papers, and built-in comparisons."""
