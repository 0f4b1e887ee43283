"""Implementation of the public Python API: commands as functions, and public classes of stored results.

`Run`, `Sweep` and `Tuning` inherit from the stored classes, so that other packages take them as they are. They add a
short text, a page for a notebook, tables and figures. No other package imports this one.
"""
