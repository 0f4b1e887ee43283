"""What a run is judged by: named numbers with units, computed from its trace alone.

A metric family is a module with `UNITS`, the unit of each metric it may give, and `evaluate`: those of plug-ins take a
trace, ours the traces of several runs.
Names of single joints or axes carry a suffix (`peak_torque_q1`, `max_tracking_error_x`) and share the unit.
"""

from runner.metrics.context import MetricContext
from runner.metrics.summary import Columns, Summary, evaluate, measure, of_run, summarize_arrays

__all__ = [
    "Columns",
    "MetricContext",
    "Summary",
    "evaluate",
    "measure",
    "of_run",
    "summarize_arrays",
]
