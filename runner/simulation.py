"""The closed loop: plant, encoders, controller and desired motion, tick by tick, to a trace."""

import time
from dataclasses import dataclass

import numpy as np

from runner.controllers import Controller
from runner.plants import Plant
from runner.robots import RobotModel
from runner.sensing import JointEncoders
from runner.trace import Failure, FloatArray, Trace
from runner.trajectories import Trajectory

# Above this the equations still hold but no arm does: a run that gets there has diverged.
DIVERGED_SPEED = 1e6  # rad/s
_CHECK_EVERY = 64  # ticks between two looks for divergence, which the metrics never see


@dataclass(frozen=True)
class ClosedLoop:
    """One control loop around one arm.

    Attributes:
        model: The arm's rigid-body model, for its true tip position.
        plant: The simulated arm.
        controller: The control law.
        trajectory: The desired motion.
        limits: Torque limit of each joint, shape (nq,), in N m; infinite where there is none.
        period: Time between two ticks, in s.
        ticks: Number of ticks.
        q_start: Joint positions at t = 0, shape (nq,), in rad; the arm starts at rest.
    """

    model: RobotModel
    plant: Plant
    controller: Controller
    trajectory: Trajectory
    limits: FloatArray
    period: float
    ticks: int
    q_start: FloatArray


def simulate(loop: ClosedLoop, encoders: JointEncoders) -> Trace:
    """Run a closed loop once.

    At each tick the encoders are read, the controller is asked, its torques are clipped joint by joint and held
    while the plant advances by one period. The last row holds the final state, with the torque asked for there.

    Args:
        loop: The closed loop; its plant is reset here.
        encoders: The joint measurement, with a draw for each tick.

    Returns:
        The trace; one that ends early carries a failure.
    """
    n, nq = loop.ticks, loop.model.nq
    times: FloatArray = np.arange(n + 1, dtype=np.float64) * loop.period
    desired = loop.trajectory.sample(times)
    q_rows, dq_rows, tau_rows = (np.zeros((n + 1, nq)) for _ in range(3))
    clock = np.zeros(n + 1, dtype=np.int64)
    plant, measure, torque = loop.plant, encoders.measure, loop.controller.torque
    lower, upper = -loop.limits, loop.limits
    limited = bool(np.isfinite(upper).any())
    now = time.perf_counter_ns

    plant.reset(loop.q_start, np.zeros(nq))
    loop.controller.reset()
    failure = None
    rows = n + 1
    with np.errstate(over="ignore", invalid="ignore"):  # a diverging run ends as a failure, not as a warning
        for k in range(n + 1):
            clock[k] = now()
            q_rows[k] = q = plant.q
            dq_rows[k] = dq = plant.dq
            try:
                tau = torque(times[k], *measure(k, q, dq), desired[k])
            except np.linalg.LinAlgError as error:
                failure, rows = Failure(str(error), float(times[k])), k + 1
                break
            if limited:
                np.minimum(tau, upper, out=tau)
                np.maximum(tau, lower, out=tau)
            tau_rows[k] = tau
            if k % _CHECK_EVERY == 0 and (diverged := _find_divergence(q_rows, dq_rows, k)) is not None:
                break
            if k < n:
                plant.advance(tau)
        else:
            diverged = _find_divergence(q_rows, dq_rows, n)
    if failure is None and diverged is not None:
        rows, joint = diverged[0] + 1, loop.model.joint_names[diverged[1]]
        failure = Failure(f"diverged: not finite or above {DIVERGED_SPEED:g} rad/s", float(times[diverged[0]]), joint)
    kept = slice(0, rows)
    return Trace(
        t=times[kept],
        q=q_rows[kept],
        dq=dq_rows[kept],
        tau=tau_rows[kept],
        tip=loop.model.tip_positions(q_rows[kept]),
        desired=desired[kept],
        limits=loop.limits,
        joint_names=loop.model.joint_names,
        tick_seconds=np.diff(clock[kept]) * 1e-9,
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
