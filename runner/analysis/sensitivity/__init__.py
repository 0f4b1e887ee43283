"""Sensitivity of the metrics of a run to its parameters: exact derivatives by the compiled closed loop."""

from runner.analysis.sensitivity.analysis import Sensitivity, analyse, of_run
from runner.analysis.sensitivity.differences import differences
from runner.analysis.sensitivity.parameters import GROUPS
from runner.analysis.sensitivity.smooth_metrics import check_smooth

__all__ = ["GROUPS", "Sensitivity", "analyse", "check_smooth", "differences", "of_run"]
