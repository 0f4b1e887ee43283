"""Checked config of a stored run, and a repetition that is simulated again."""

import math
from collections.abc import Mapping

from runner.assembly.run_config import RunConfig
from runner.assembly.validation import validate
from runner.assembly.versions import versions
from runner.base.errors import ConfigError, RunnerError
from runner.base.machine import equal_up_to_rounding, read_machine, this_machine
from runner.base.trace import Trace
from runner.simulation.results import measure_repetition, metric_context
from runner.simulation.run import simulate_repetition
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


def simulate_again(run: Run, repetition: int) -> tuple[Trace, str]:
    """Return the trace of a repetition that is simulated again, and a warning; the warning is empty for equal metrics.

    The warning names the number of metrics that differ in the last digits, on another machine or with other versions.

    Raises:
        RunnerError: if code or robot has changed since the run, or a metric differs by more than rounding, or at all on
            the machine of the run.
    """
    config = checked_config(run, f"repetition {repetition} of {run.hash}")
    trace, found = measure_repetition(simulate_repetition(config, repetition), metric_context(config), [])
    return trace, _find_difference(run, repetition, found)


def _find_difference(run: Run, repetition: int, found: Mapping[str, float | None]) -> str:
    values = {name: float(run.values(name)[repetition]) for name in run.metrics}
    stored = {name: None if math.isnan(value) else value for name, value in values.items()}
    moved = [name for name, value in stored.items() if found.get(name) != value]
    here = (read_machine(run.provenance["machine"]), run.provenance["versions"]) == (this_machine(), versions())
    again = f"repetition {repetition} of {run.hash}, simulated again, differs"
    for name in moved:
        if here or not equal_up_to_rounding(stored[name], found.get(name)):
            cause = "its machine and library versions are these, so it is not reproducible" if here else (
                "another machine or library version rounds in another way"
            )  # fmt: skip
            raise RunnerError(f"{again}: {name} is {found.get(name)}, stored is {stored[name]}; {cause}")
    if not moved:
        return ""
    return f"{again} in the last digits of {len(moved)} metrics: its machine or library versions are others"
