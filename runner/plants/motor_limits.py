"""Torque limits of motors, constant or falling with the speed of the joint."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class TorqueLimits:
    r"""Torque limits of some joints.

    The limit of a motor that drives its joint falls with the speed, down to zero at the no-load speed. A motor that
    brakes its joint has the whole limit:

    .. math:: |\tau| \le \tau_{max} \max(0, 1 - |\dot q| / \omega_0) \quad (\tau \dot q > 0), \qquad
        |\tau| \le \tau_{max} \quad (\tau \dot q \le 0)

    Attributes:
        max: Largest magnitude of the torques, shape (nq,), in N m; infinite without a limit.
        no_load_speed: omega_0 of each joint, shape (nq,), in rad/s; infinite for a constant limit.
    """

    max: FloatArray
    no_load_speed: FloatArray

    @classmethod
    def constant(cls, limits: FloatArray) -> "TorqueLimits":
        """Return constant limits."""
        return cls(limits, np.full(len(limits), np.inf))

    @cached_property
    def depend_on_speed(self) -> bool:
        """True if the limit of a joint depends on its speed."""
        return bool(np.isfinite(self.no_load_speed).any())

    @property
    def joints_with_speed(self) -> list[int]:
        """Indices of the joints whose limit depends on the speed."""
        found: list[int] = np.flatnonzero(np.isfinite(self.no_load_speed)).tolist()
        return found

    def of(self, joints: slice) -> "TorqueLimits":
        """Return the limits of some of the joints."""
        return TorqueLimits(self.max[joints], self.no_load_speed[joints])

    def bounds(self, dq: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the lowest and the highest torques at true joint velocities, shapes (..., nq)."""
        if not self.depend_on_speed:
            return -self.max, self.max
        return torque_bounds(np.maximum, self.max, self.no_load_speed, dq)

    def applied(self, tau: FloatArray, dq: FloatArray, held: Sequence[tuple[slice, int]] = ()) -> FloatArray:
        """Return the limits of commanded torques in each tick, shape (..., T, nq), or `max` if these are constant.

        Args:
            tau: Commanded torques, shape (..., T, nq), in N m. A torque of zero counts as driving.
            dq: True joint velocities, shape (..., T, nq), in rad/s.
            held: Joints of each loop, and the number of ticks for which it holds a torque.
        """
        if not self.depend_on_speed:
            return self.max
        at_command = dq.copy()
        for joints, every in held:
            ticks = np.arange(dq.shape[-2]) // every * every
            at_command[..., joints] = dq[..., ticks, joints]
        lowest, highest = self.bounds(at_command)
        return np.where(np.where(tau == 0.0, at_command, tau) > 0.0, highest, -lowest)


def torque_bounds(maximum: Callable[[Any, Any], Any], limit: Any, no_load_speed: Any, dq: Any) -> tuple[Any, Any]:
    """Return the lowest and the highest torque of a motor, over floats, arrays or expressions; see TorqueLimits.

    Args:
        maximum: Function for the larger of two values.
        limit: Limit at rest, in N m.
        no_load_speed: No-load speed, in rad/s.
        dq: True joint velocity, in rad/s.
    """
    share = dq / no_load_speed
    return -limit * maximum(0.0, 1.0 - maximum(0.0, -share)), limit * maximum(0.0, 1.0 - maximum(0.0, share))
