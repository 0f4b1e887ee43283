"""The closed loop: plant, encoders, controllers and desired motion, tick by tick, to a trace."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from runner.controllers import Loop
from runner.errors import SimulationError
from runner.interaction import Interaction, Touch
from runner.plants import Plant, PositionPlant, innermost
from runner.robots.robot import Robot, end_points
from runner.sensing import ForceTorqueSensor, JointEncoders
from runner.trace import Failure, FloatArray, Trace
from runner.trajectories import Trajectory

# Above this the equations still hold but no arm does: a run that gets there has diverged.
DIVERGED_SPEED = 1e6  # rad/s, or m/s of a joint that slides
_CHECK_EVERY = 64  # ticks between two looks for divergence, which the metrics never see


@dataclass(frozen=True)
class ClosedLoop:
    """The control loops around one robot.

    Attributes:
        robot: The robot, for its true end points.
        plant: The simulated robot, which takes what the loops give.
        loops: The control loops; together they command every joint once.
        trajectory: The desired motion of the tip.
        limits: Torque limit of each joint, shape (nq,), in N m; infinite where there is none.
        tick: Time between two ticks of the fastest loop, in s; every loop's period is a multiple of it.
        ticks: Number of ticks.
        commands: Whether the loops give joint torques, or joint positions to a plant that follows them.
        interaction: What the tip feels of the world; None where there is nothing to feel.
        q_start: Joint positions at t = 0, shape (nq,), in rad; the robot starts at rest.
        parallel: Whether riding stages keep the orientation of home, as the plant has it.
        delay: Ticks from a command until it acts.
    """

    robot: Robot
    plant: Plant | PositionPlant
    loops: tuple[Loop, ...]
    trajectory: Trajectory
    limits: FloatArray
    tick: float
    ticks: int
    commands: Literal["torque", "position"]
    interaction: Interaction | None
    q_start: FloatArray
    parallel: bool
    delay: int

    def every(self, loop: Loop) -> int:
        """Return the number of ticks in a loop's period."""
        return round(loop.period / self.tick)


def simulate(closed: ClosedLoop, encoders: Sequence[JointEncoders], wrist: ForceTorqueSensor | None = None) -> Trace:
    """Run the control loops once.

    At each of its ticks a loop reads the encoders of every joint afresh, asks its controller, and its torques are
    clipped joint by joint and held until its next tick, while the plant advances. They act, and stand in the trace, by
    the delay later; the first act from the start. The last row holds the final state, with the torques that would act
    from there. Joint positions are handed on as they are; the torques are then the plant's, and the last row repeats
    those of the last tick.

    Args:
        closed: The control loops; plant and controllers are reset here.
        encoders: The joint measurement of each loop, with a draw for each of its ticks.
        wrist: The force/torque sensor, with a draw for each tick; needed where there is something to feel.

    Returns:
        The trace; one that ends early carries a failure.
    """
    n, nq = closed.ticks, closed.robot.model.nq
    times: FloatArray = np.arange(n + 1, dtype=np.float64) * closed.tick
    desired: FloatArray = np.zeros((n + 1, 3, 3))
    q_rows, dq_rows, tau_rows, held_rows = (np.zeros((n + 1, nq)) for _ in range(4))
    clock = np.zeros(n + 1, dtype=np.int64)
    plant: Any = closed.plant  # a Plant or PositionPlant, as `commands` says
    now = time.perf_counter_ns
    positions = closed.commands == "position"
    held = closed.q_start.copy() if positions else np.zeros(nq)
    touch, moved = None, innermost(plant)
    load: FloatArray | None = None
    limited = not positions and bool(np.isfinite(closed.limits).any())
    failure = None
    rows = n + 1
    q_rows[0] = closed.q_start
    try:
        desired[:] = closed.trajectory.sample(times)
        laws = [_reset(loop, closed) for loop in closed.loops]
        loops = [
            (closed.every(loop), sensor.measure, law, loop.joints, closed.limits[loop.joints])
            for loop, sensor, law in zip(closed.loops, encoders, laws, strict=True)
        ]
        if closed.interaction is not None and wrist is not None:
            feeling: Any = [loop.controller for loop in closed.loops if loop.feels]
            touch = Touch(closed.interaction, wrist, feeling, closed.q_start, n + 1)
        plant.reset(closed.q_start, np.zeros(nq))
    except SimulationError as error:
        failure, rows = Failure(error.reason, 0.0), 1
    with np.errstate(over="ignore", invalid="ignore"):  # a diverging run ends as a failure, not as a warning
        for k in range(n + 1 if failure is None else 0):
            clock[k] = now()
            q_rows[k] = q = plant.q
            dq_rows[k] = dq = plant.dq
            try:
                if touch is not None:
                    load = touch.update(k, times[k], q, dq, moved)
                for every, measure, law, joints, limits in loops:
                    if k % every == 0:
                        asked = law(times[k], *measure(k // every, q, dq), desired[k])
                        if limited:
                            np.minimum(asked, limits, out=asked)
                            np.maximum(asked, -limits, out=asked)
                        held[joints] = asked
            except (np.linalg.LinAlgError, SimulationError) as error:
                diverged = _find_divergence(q_rows, dq_rows, k)  # then the law had nothing to answer
                if diverged is None:
                    reason = error.reason if isinstance(error, SimulationError) else str(error)
                    failure, rows = Failure(reason, float(times[k])), k + 1
                break
            held_rows[k] = held
            if k % _CHECK_EVERY == 0 and (diverged := _find_divergence(q_rows, dq_rows, k)) is not None:
                break
            if k == n:
                continue
            acting = held_rows[max(k - closed.delay, 0)]
            try:
                if positions:
                    if load is not None:
                        plant.load[:] = load
                    plant.advance(acting)
                    tau_rows[k] = tau_rows[k + 1] = plant.tau
                else:
                    plant.advance(acting if load is None else acting + load)
            except SimulationError as error:
                failure, rows = Failure(error.reason, float(times[k])), k + 1
                break
        else:
            diverged = _find_divergence(q_rows, dq_rows, n)
    if failure is None and diverged is not None:
        rows, model = diverged[0] + 1, closed.robot.model
        speed = f"{DIVERGED_SPEED:g} {model.joint_units[diverged[1]]}/s"
        joint = model.joint_names[diverged[1]]
        failure = Failure(f"diverged: not finite or above {speed}", float(times[diverged[0]]), joint)
    kept = slice(0, rows)
    home = end_points(closed.robot, closed.robot.home[None], closed.parallel)[:, 0]
    return Trace(
        t=times[kept],
        q=q_rows[kept],
        dq=dq_rows[kept],
        tau=(tau_rows if positions else held_rows[np.maximum(np.arange(n + 1) - closed.delay, 0)])[kept],
        q_command=held_rows[kept] if positions else None,
        touch=None if touch is None else touch.signals(kept),
        end_points=end_points(closed.robot, q_rows[kept], closed.parallel),
        offsets=home[-1] - home,
        stage_names=closed.robot.stage_names,
        desired=desired[kept],
        limits=closed.limits,
        joint_names=closed.robot.model.joint_names,
        joint_units=closed.robot.model.joint_units,
        tick_seconds=np.diff(clock[:rows]) * 1e-9,
        failure=failure,
    )


def _reset(loop: Loop, closed: ClosedLoop) -> Callable[..., FloatArray]:
    """Reset a loop's controller, and return its law."""
    controller: Any = loop.controller  # one or the other, as `commands` says
    law: Callable[..., FloatArray]
    if closed.commands == "torque":
        controller.reset()
        law = controller.torque
    else:
        controller.reset(closed.q_start)
        law = controller.joint_positions
    return law


def _find_divergence(q: FloatArray, dq: FloatArray, until: int) -> tuple[int, int] | None:
    """Return row and joint of the first state up to a row that is not finite or faster than any arm."""
    first = max(0, until - _CHECK_EVERY)
    wild = ~(np.isfinite(q[first : until + 1]) & (np.abs(dq[first : until + 1]) < DIVERGED_SPEED))
    if not wild.any():
        return None
    row = int(np.argmax(wild.any(axis=1)))
    return first + row, int(np.argmax(wild[row]))
