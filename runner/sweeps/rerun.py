"""Checked config of a stored run, to simulate it again."""

from runner.assembly.run_config import RunConfig
from runner.assembly.validation import validate
from runner.base.errors import ConfigError, RunnerError
from runner.store.identity import run_hash
from runner.store.run import Run


def checked_config(run: Run, what: str = "") -> RunConfig:
    """Return the config of a run, if code and robot are still those of the run.

    Args:
        run: The run.
        what: What is to be simulated again, for messages; empty for the run.

    Raises:
        RunnerError: if the code or the robot has changed since the run.
    """
    cannot = f"{what or run.hash} cannot be simulated again: "
    if run_hash(run.config, run.urdf) != run.hash:
        raise RunnerError(
            f"{cannot}the code has changed since the run (the runner, a plug-in, or the version of an engine), or one "
            "of its plug-ins is not loaded; simulate it again with runner.run"
        )
    try:
        config = validate(run.composed)
    except ConfigError as error:
        raise RunnerError(f"{cannot}{'; '.join(error.problems)}") from None
    if config.arm.urdf != run.urdf:
        raise RunnerError(f"{cannot}the file of its robot has changed since the run; simulate it again with runner.run")
    return config
