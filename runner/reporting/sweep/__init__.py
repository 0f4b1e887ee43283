"""Report on a sweep, from its stored runs."""
