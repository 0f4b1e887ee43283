"""Optional features of trajectory configs and modules, and the registry of trajectories."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from runner.base.arrays import FloatArray
from runner.plugins.guard import WatchedTrajectory
from runner.plugins.registry import KindConfig, Registry
from runner.trajectories.trajectory import Trajectory

if TYPE_CHECKING:  # they import Pinocchio, which who reads a stored run does not need
    from runner.robots.robot import Robot
    from runner.trajectories.joint_motion import JointMotion


@runtime_checkable
class HasStart(Protocol):
    """A config of trajectories that may say where they start; else they do where the tip is at home."""

    start: list[float] | None
    """Tip position at t = 0, in m; None is the tip at home."""


@runtime_checkable
class HasGoal(Protocol):
    """A config of trajectories that end at a point, which must be within reach."""

    goal: list[float] | None
    """Tip position at the end, in m."""


@runtime_checkable
class MovesJoints(Protocol):
    """A module whose trajectories may be motions of the joints, from which that of the tip follows."""

    def joint_motion(self, config: KindConfig, robot: "Robot") -> "JointMotion | None":
        """Return the motion of a robot's joints; None where the config describes one of the tip."""
        ...


class Trajectories(Registry[KindConfig, [FloatArray], Trajectory]):
    """The kinds of trajectories; `build` gives each the tip position at t = 0, shape (3,), in m."""

    def __init__(self, modules: Mapping[str, str]) -> None:
        super().__init__("trajectory", modules, WatchedTrajectory)

    def joint_motion(self, config: KindConfig, robot: "Robot") -> "JointMotion | None":
        """Return the motion of a robot's joints, where a kind of ours has one; see MovesJoints.

        Raises:
            ConfigError: where the config does not fit the robot.
        """
        module = self.module(config.kind)
        if not (self.is_ours(config.kind) and isinstance(module, MovesJoints)):
            return None
        motion: JointMotion | None = module.joint_motion(config, robot)
        return motion
