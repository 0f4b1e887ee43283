"""Run for a comparison with recordings: its trace, and the context of its metrics."""

from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError, RunnerError
from runner.base.trace import Trace
from runner.config.run import RunConfig
from runner.config.validation import validate
from runner.metrics import MetricContext
from runner.recordings.columns_map import Signal
from runner.robots.robot import end_points
from runner.simulation.assembly import metric_context
from runner.simulation.recorder import describe
from runner.store import Run

AXES = ("x", "y", "z")


@dataclass(frozen=True)
class Setting:
    """A run that recordings are compared with.

    Attributes:
        config: Its checked config.
        trace: Its repetition 0.
        context: What its metrics need to know.
    """

    config: RunConfig
    trace: Trace
    context: MetricContext

    def signal(self, wanted: Signal) -> FloatArray:
        """Return a signal of the run, shape (T,)."""
        if wanted.kind == "tip":
            values: FloatArray = self.trace.tip[:, AXES.index(wanted.of)]
            return values
        place = self.trace.joint_names.index(wanted.of)
        return (self.trace.q if wanted.kind == "position" else self.trace.tau)[:, place]


def setting_of(run: Run) -> Setting:
    """Return the run that a recording is compared with.

    Raises:
        RunnerError: if the run failed, is damaged, or can no longer be made by its config.
    """
    if run.failure is not None:
        raise RunnerError(f"{run.folder}: {run.failure}; a recording is compared with a run that ended well")
    try:
        config = validate(run.composed)
    except ConfigError as error:
        raise RunnerError(f"run {run.hash} cannot be made again: {'; '.join(error.problems)}") from None
    if config.arm.urdf != run.urdf:
        raise RunnerError(f"the file of the robot of {run.hash} has changed since the run; make the run again")
    return Setting(config, _stored_trace(run, config), metric_context(config))


def _stored_trace(run: Run, config: RunConfig) -> Trace:
    q, dq, tau, t = run.joints("q"), run.joints("dq"), run.joints("tau"), run.t
    points = end_points(config.arm, q, config.ignore_base_rotation)
    points[-1] = run.vector("tip")
    desired = np.stack([run.vector(stem) for stem in ("desired", "desired_velocity", "desired_acceleration")], axis=1)
    return Trace(
        t=t,
        q=q,
        dq=dq,
        tau=tau,
        end_points=points,
        desired=desired,
        limits=config.torque_limits.applied(tau, dq),
        tick_seconds=np.zeros(len(t) - 1),
        **describe(config.arm, config.ignore_base_rotation),
    )
