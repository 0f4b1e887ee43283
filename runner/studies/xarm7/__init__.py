"""The report that reproduces the xArm7 path-planning report, and makes its second part work."""
