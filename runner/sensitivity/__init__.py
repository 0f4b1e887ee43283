"""How a run's metrics change with its parameters: exact derivatives, through the compiled closed loop."""

from runner.sensitivity.analysis import Sensitivity, analyse
from runner.sensitivity.differences import differences
from runner.sensitivity.parameters import GROUPS
from runner.sensitivity.smooth_metrics import check_smooth
from runner.sensitivity.stored import of_run

__all__ = ["GROUPS", "Sensitivity", "analyse", "check_smooth", "differences", "of_run"]
