"""Metrics of a run: named numbers with units, computed from its trace.

A metric family is a module with `UNITS`, the unit of each metric that it can return, and `evaluate`. The `evaluate` of
a plug-in takes one trace. The `evaluate` of a built-in family takes the traces of several runs.

Metrics of single joints or axes have a suffix (`peak_torque_q1`, `max_tracking_error_x`) and the same unit.
"""
