"""Reference derivations of the thesis equations, two of each."""
