"""Checks that take too long for the tests, and programs that write docs and references."""
