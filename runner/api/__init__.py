"""Implementation of the public Python API: commands as functions, and handles on stored results.

A handle (`Run`, `Sweep`, `Tuning`) contains the data that another package reads from the disk, as `stored`. It adds a
short text, a page for a notebook, tables and figures. No other package imports this one.
"""
