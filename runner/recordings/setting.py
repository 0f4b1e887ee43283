"""Run for a comparison with recordings: its trace, and the metrics of both over the same times."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pinocchio as pin

from runner.assembly.long_motion import with_long_motion
from runner.assembly.run_config import RunConfig
from runner.assembly.validation import validate
from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError, RunnerError
from runner.base.trace import Trace
from runner.metrics import effort, positioning, tracking
from runner.metrics.family import MetricContext
from runner.metrics.summary import measure, of_run
from runner.recordings.columns_map import Holds, Side, Signal, stacked
from runner.recordings.smoothing import derivative
from runner.robots.robot import end_points
from runner.simulation.recorder import describe
from runner.simulation.results import metric_context
from runner.store import Run

AXES = ("x", "y", "z")


@dataclass(frozen=True)
class ComparedRun:
    """A run that recordings are compared with.

    Attributes:
        config: Its checked config.
        trace: Its repetition 0.
        context: What its metrics need to know.
    """

    config: RunConfig
    trace: Trace
    context: MetricContext

    def torques(self, holds: Holds, side: Side) -> FloatArray:
        """Return the torques of the run as sensors of a kind would measure them, shape (T, nq), in N m; see Column."""
        model, q, dq, tau = self.config.arm.model, self.trace.q, self.trace.dq, self.trace.tau
        if side == "link":
            ddq = derivative(dq, float(np.median(np.diff(self.trace.t))))
            rigid = model.with_armature(np.zeros(model.nq)).pin_model
            tau = np.array([pin.rnea(rigid, rigid.createData(), *row) for row in zip(q, dq, ddq, strict=True)])
        if holds == "without_gravity":
            tau = tau - np.array([model.gravity_torque(row) for row in q])
        return tau

    @cached_property
    def desired_joints(self) -> FloatArray | None:
        """Desired joint positions, shape (T, nq), in rad; None if the desired motion is one of the tip."""
        motion = self.config.path.sample_joints(self.trace.t)
        return None if motion is None else motion[:, 0]

    def signal(self, wanted: Signal) -> FloatArray:
        """Return a signal of the run, shape (T,); of a reference the desired position."""
        if wanted.kind == "tip":
            values: FloatArray = self.trace.tip[:, AXES.index(wanted.of)]
            return values
        place = self.trace.joint_names.index(wanted.of)
        if wanted.kind == "reference":
            assert self.desired_joints is not None  # noqa: S101 - a caller compares no commands without
            return self.desired_joints[:, place]
        return (self.trace.q if wanted.kind == "position" else self.trace.tau)[:, place]


def setting_of(run: Run) -> ComparedRun:
    """Return the run that a recording is compared with.

    Raises:
        RunnerError: if the run failed, is damaged, or can no longer be made by its config.
    """
    if run.failure is not None:
        raise RunnerError(f"{run.folder}: {run.failure}; a recording is compared with a run that ended well")
    try:
        config = with_long_motion(validate(run.composed))
    except ConfigError as error:
        raise RunnerError(f"run {run.hash} cannot be made again: {'; '.join(error.problems)}") from None
    if config.arm.urdf != run.urdf:
        raise RunnerError(f"the file of the robot of {run.hash} has changed since the run; make the run again")
    return ComparedRun(config, _stored_trace(run, config), metric_context(config))


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


_OF_POSITIONS = ("max_joint_error", "rms_joint_error", "peak_joint_speed", "peak_sliding_speed")
# From tick to tick: a recording of another rate has other ticks.
_OF_TICKS = ("torque_chatter", "force_chatter")


def both_metrics(
    setting: ComparedRun,
    ticks: slice,
    recorded: Mapping[Signal, FloatArray],
    speeds: FloatArray | None,
    whole_torques: bool = True,
) -> dict[str, tuple[float | None, float | None]]:
    """Return each metric of the run and of the recording, by name, over some ticks of the run.

    A metric is left out where the recording lacks a signal that it is computed from, and where it counts changes
    from tick to tick. The tip is the recorded one, or follows from all joints by the run's model.

    Args:
        setting: The run.
        ticks: The ticks of the run that the recording covers.
        recorded: Its signals at these, shape (T,).
        speeds: Its joint speeds there, shape (T, nq), in rad/s; None where not all positions are recorded.
        whole_torques: Whether its torques are those of the motors, with gravity.
    """
    run = setting.trace.during(ticks)
    joints = run.joint_names
    q, tau = (stacked(recorded, [Signal(kind, joint) for joint in joints]) for kind in ("position", "torque"))
    tip = stacked(recorded, [Signal("tip", axis) for axis in AXES])
    config = setting.config
    points = run.end_points.copy() if q is None else end_points(config.arm, q, config.ignore_base_rotation)
    if tip is not None:
        points[-1] = tip
    known = {
        **dict.fromkeys((*positioning.UNITS, *tracking.UNITS), tip is not None or q is not None),
        **dict.fromkeys(effort.UNITS, q is not None and tau is not None and whole_torques),
        **dict.fromkeys(_OF_POSITIONS, q is not None),
        **dict.fromkeys(_OF_TICKS, False),
        "saturation_fraction": tau is not None and whole_torques and bool(np.isfinite(run.limits).any()),
    }
    other = replace(
        run,
        q=run.q if q is None else q,
        dq=run.dq if speeds is None else speeds,
        tau=run.tau if tau is None else tau,
        end_points=points,
    )
    of_both = [of_run(measure(trace[None], setting.context), 0) for trace in (run, other)]
    return {
        name: (value, of_both[1][name])
        for name, value in of_both[0].items()
        if known.get(_base(name, known), q is not None)
    }


def _base(name: str, known: Mapping[str, bool]) -> str:
    """Return the metric that a name is of; the name itself where it is of a stage or of none of these."""
    return max((base for base in known if f"{name}_".startswith(f"{base}_")), key=len, default=name)
