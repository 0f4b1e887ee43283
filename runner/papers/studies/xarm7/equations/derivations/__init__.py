"""Reference derivations of the xArm7 report's equations, two of each."""
