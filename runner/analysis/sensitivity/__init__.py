"""Sensitivity of a run's metrics to its parameters: exact derivatives through the compiled closed loop."""

from runner.analysis.sensitivity.analysis import Sensitivity, analyse
from runner.analysis.sensitivity.differences import differences
from runner.analysis.sensitivity.parameters import GROUPS
from runner.analysis.sensitivity.smooth_metrics import check_smooth
from runner.analysis.sensitivity.stored import of_run

__all__ = ["GROUPS", "Sensitivity", "analyse", "check_smooth", "differences", "of_run"]
