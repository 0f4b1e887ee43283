"""Sensitivity of the metrics of a run to its parameters: exact derivatives by the compiled closed loop."""

from runner.analysis.parameters import GROUPS
from runner.analysis.sensitivity import Sensitivity, analyse, differences, of_run
from runner.analysis.smooth_metrics import check_smooth

__all__ = ["GROUPS", "Sensitivity", "analyse", "check_smooth", "differences", "of_run"]
