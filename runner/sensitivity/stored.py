"""The derivatives of stored runs."""

from collections.abc import Mapping, Sequence
from typing import Any

from runner.config.run import RunConfig
from runner.config.validation import validate
from runner.errors import ConfigError, RunnerError
from runner.sensitivity.analysis import Sensitivity, analyse
from runner.sensitivity.parameters import GROUPS
from runner.store import Run


def of_run(run: Run, groups: Sequence[str] = GROUPS, repetition: int = 0) -> Sensitivity:
    """Return the derivatives of a stored run's smooth metrics by its parameters; see analyse.

    Args:
        run: The run.
        groups: Which parameters, some of GROUPS.
        repetition: Number of the repetition.

    Raises:
        RunnerError: where there is no such repetition, the run cannot be made again, or it has no derivatives.
    """
    count = int(run.record["repetitions"])
    if not 0 <= repetition < count:
        raise RunnerError(f"no repetition {repetition} of {run.hash}; allowed: 0 to {count - 1}")

    def validated(resolved: Mapping[str, Any]) -> RunConfig:
        return validate(resolved, run.config_dirs)

    try:
        config = validated(run.config)
    except ConfigError as error:
        raise RunnerError(f"run {run.hash} cannot be made again: {'; '.join(error.problems)}") from None
    if config.arm.urdf != run.urdf:
        raise RunnerError(f"the file of the robot of {run.hash} has changed since the run; make the run anew")
    return analyse(config, validated, groups, repetition)
