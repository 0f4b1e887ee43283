"""The closed loop: plant, encoders, controllers and desired motion, tick by tick, to a trace."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from runner.controllers import Loop
from runner.plants import Plant
from runner.robots.robot import Robot, end_points
from runner.sensing import JointEncoders
from runner.trace import Failure, FloatArray, Trace
from runner.trajectories import Trajectory

# Above this the equations still hold but no arm does: a run that gets there has diverged.
DIVERGED_SPEED = 1e6  # rad/s
_CHECK_EVERY = 64  # ticks between two looks for divergence, which the metrics never see


@dataclass(frozen=True)
class ClosedLoop:
    """The control loops around one robot.

    Attributes:
        robot: The robot, for its true end points.
        plant: The simulated robot.
        loops: The control loops; together they command every joint once.
        trajectory: The desired motion of the tip.
        limits: Torque limit of each joint, shape (nq,), in N m; infinite where there is none.
        tick: Time between two ticks of the fastest loop, in s; every loop's period is a multiple of it.
        ticks: Number of ticks.
        q_start: Joint positions at t = 0, shape (nq,), in rad; the robot starts at rest.
        parallel: Whether riding stages keep the orientation of home, as the plant has it.
    """

    robot: Robot
    plant: Plant
    loops: tuple[Loop, ...]
    trajectory: Trajectory
    limits: FloatArray
    tick: float
    ticks: int
    q_start: FloatArray
    parallel: bool

    def every(self, loop: Loop) -> int:
        """Return the number of ticks in a loop's period."""
        return round(loop.period / self.tick)


def simulate(closed: ClosedLoop, encoders: Sequence[JointEncoders]) -> Trace:
    """Run the control loops once.

    At each of its ticks a loop reads the encoders of every joint afresh, asks its controller, and its torques are
    clipped joint by joint and held until its next tick, while the plant advances. The last row holds the final state,
    with the torques asked for there.

    Args:
        closed: The control loops; plant and controllers are reset here.
        encoders: The joint measurement of each loop, with a draw for each of its ticks.

    Returns:
        The trace; one that ends early carries a failure.
    """
    n, nq = closed.ticks, closed.robot.model.nq
    times: FloatArray = np.arange(n + 1, dtype=np.float64) * closed.tick
    desired = closed.trajectory.sample(times)
    q_rows, dq_rows, tau_rows = (np.zeros((n + 1, nq)) for _ in range(3))
    clock = np.zeros(n + 1, dtype=np.int64)
    plant, now, tau = closed.plant, time.perf_counter_ns, np.zeros(nq)
    loops = [
        (closed.every(loop), sensor.measure, loop.controller.torque, loop.joints, closed.limits[loop.joints])
        for loop, sensor in zip(closed.loops, encoders, strict=True)
    ]
    limited = bool(np.isfinite(closed.limits).any())

    plant.reset(closed.q_start, np.zeros(nq))
    for loop in closed.loops:
        loop.controller.reset()
    failure = None
    rows = n + 1
    with np.errstate(over="ignore", invalid="ignore"):  # a diverging run ends as a failure, not as a warning
        for k in range(n + 1):
            clock[k] = now()
            q_rows[k] = q = plant.q
            dq_rows[k] = dq = plant.dq
            try:
                for every, measure, torque, joints, limits in loops:
                    if k % every == 0:
                        asked = torque(times[k], *measure(k // every, q, dq), desired[k])
                        if limited:
                            np.minimum(asked, limits, out=asked)
                            np.maximum(asked, -limits, out=asked)
                        tau[joints] = asked
            except np.linalg.LinAlgError as error:
                diverged = _find_divergence(q_rows, dq_rows, k)  # then the law had nothing to answer
                if diverged is None:
                    failure, rows = Failure(str(error), float(times[k])), k + 1
                break
            tau_rows[k] = tau
            if k % _CHECK_EVERY == 0 and (diverged := _find_divergence(q_rows, dq_rows, k)) is not None:
                break
            if k < n:
                plant.advance(tau)
        else:
            diverged = _find_divergence(q_rows, dq_rows, n)
    if failure is None and diverged is not None:
        rows, joint = diverged[0] + 1, closed.robot.model.joint_names[diverged[1]]
        failure = Failure(f"diverged: not finite or above {DIVERGED_SPEED:g} rad/s", float(times[diverged[0]]), joint)
    kept = slice(0, rows)
    home = end_points(closed.robot, closed.robot.home[None], closed.parallel)[:, 0]
    return Trace(
        t=times[kept],
        q=q_rows[kept],
        dq=dq_rows[kept],
        tau=tau_rows[kept],
        end_points=end_points(closed.robot, q_rows[kept], closed.parallel),
        offsets=home[-1] - home,
        stage_names=closed.robot.stage_names,
        desired=desired[kept],
        limits=closed.limits,
        joint_names=closed.robot.model.joint_names,
        tick_seconds=np.diff(clock[:rows]) * 1e-9,
        failure=failure,
    )


def _find_divergence(q: FloatArray, dq: FloatArray, until: int) -> tuple[int, int] | None:
    """Return row and joint of the first state up to a row that is not finite or faster than any arm."""
    first = max(0, until - _CHECK_EVERY)
    wild = ~(np.isfinite(q[first : until + 1]) & (np.abs(dq[first : until + 1]) < DIVERGED_SPEED))
    if not wild.any():
        return None
    row = int(np.argmax(wild.any(axis=1)))
    return first + row, int(np.argmax(wild[row]))
