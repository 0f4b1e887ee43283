"""Reference derivations of the Meca500 report's equations, two of each."""
