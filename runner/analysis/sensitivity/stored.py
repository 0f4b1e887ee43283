"""Derivatives of the metrics of stored runs."""

from collections.abc import Sequence

from runner.analysis.sensitivity.analysis import Sensitivity, analyse
from runner.analysis.sensitivity.parameters import GROUPS
from runner.base.errors import ConfigError, RunnerError
from runner.config.compose.compose import compose
from runner.config.validation import validate
from runner.store import Run, simulated_part


def of_run(run: Run, groups: Sequence[str] = GROUPS, repetition: int = 0) -> Sensitivity:
    """Return the derivatives of a stored run's smooth metrics by its parameters; see analyse.

    Args:
        run: The run.
        groups: Which parameters, some of GROUPS.
        repetition: Number of the repetition.

    Raises:
        RunnerError: where there is no such repetition, its command gives another run today, or it has no derivatives.
    """
    count = int(run.record["repetitions"])
    if not 0 <= repetition < count:
        raise RunnerError(f"no repetition {repetition} of {run.hash}; allowed: 0 to {count - 1}")
    try:
        composed = compose(run.overrides, run.config_dirs)
        arm = validate(composed.resolved, run.config_dirs).arm
    except ConfigError as error:
        raise RunnerError(f"run {run.hash} cannot be rerun: {'; '.join(error.problems)}") from None
    if arm.urdf != run.urdf:
        raise RunnerError(f"the file of the robot of {run.hash} has changed since the run; rerun it")
    before, now = simulated_part(run.config), simulated_part(composed.resolved)
    changed = sorted(key for key in {**before, **now} if before.get(key) != now.get(key))
    if changed:
        raise RunnerError(f"the command of run {run.hash} gives another {', '.join(changed)} today; rerun it")
    return analyse(composed, groups, repetition)
