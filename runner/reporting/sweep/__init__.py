"""The report on a sweep, made from its stored runs alone."""
