"""The report on the equations of the three sources."""
