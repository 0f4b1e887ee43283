"""What `import runner` gives: the commands as functions, and handles on what is stored.

A handle (`Run`, `Sweep`, `Tuning`) holds what another room reads from the disk, as `stored`, and adds what a person
wants who looks at it: a short text, a page for a notebook, tables, figures. No other room knows this one.
"""
