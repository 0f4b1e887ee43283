"""Runtime checks of controller plug-ins."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError, SimulationError
from runner.plugins.guard.faults import ask, checked
from runner.plugins.guard.read_only import read_only

if TYPE_CHECKING:
    from runner.controllers.controller import Loop
    from runner.robots.robot import Robot


class WatchedController:
    """A controller of the user's; it ends the run as a failure where it raises, or gives no finite numbers of its size.

    Args:
        controller: What is watched.
        size: How many joints it commands.
    """

    def __init__(self, controller: Any, size: int) -> None:
        self._controller, self._size = controller, size
        self._time = 0.0

    @property
    def watched(self) -> Any:
        """What is watched."""
        return self._controller

    def reset(self, *start: FloatArray) -> None:
        """Reset it; see Controller and PositionController."""
        self._time = 0.0
        ask(lambda: self._controller.reset(*map(read_only, start)), self._time)

    def torque(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return its torques; see Controller."""
        return self._command(self._controller.torque, time, q, dq, reference)

    def joint_positions(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return its joint positions; see PositionController."""
        return self._command(self._controller.joint_positions, time, q, dq, reference)

    @property
    def external_wrench(self) -> FloatArray:
        """The estimate of the external wrench; see WrenchFeedbackController."""
        external_wrench = ask(lambda: self._controller.external_wrench, self._time)
        return checked(external_wrench, (6,), self._controller.update_wrench, self._time)

    def update_wrench(self, reading: FloatArray) -> None:
        """Pass on the reading; see WrenchFeedbackController."""
        ask(self._controller.update_wrench, self._time, read_only(reading))

    def messages(self) -> list[str]:
        """Return its messages; see WrenchFeedbackController."""
        try:
            return [str(notice) for notice in ask(lambda: self._controller.messages(), self._time)]
        except SimulationError as error:
            return [error.reason]

    def _command(self, law: Any, time: float, *measured: FloatArray) -> FloatArray:
        self._time = time
        return checked(ask(law, time, time, *map(read_only, measured)), (self._size,), law, time)


def watch_loops(loops: Any, _: Any, robot: "Robot") -> "tuple[Loop, ...]":
    """Return the loops that a module of the user's built, with their controllers watched.

    Args:
        loops: What it built.
        robot: The robot that they command.

    Raises:
        ConfigError: if they are no loops, or do not command every joint once.
    """
    from runner.controllers.controller import Loop

    if not (isinstance(loops, Sequence) and loops and all(isinstance(loop, Loop) for loop in loops)):
        raise ConfigError([f"controller.kind: build gave {loops!r:.200}; it must give a tuple of Loop"])
    joints = [index for loop in loops for index in range(robot.model.nq)[loop.joints]]
    if sorted(joints) != list(range(robot.model.nq)):
        raise ConfigError(
            [
                f"controller.kind: its loops command the joints {sorted(joints)}; together they must command each of "
                f"the {robot.model.nq} once"
            ]
        )
    return tuple(
        replace(loop, controller=WatchedController(loop.controller, len(range(robot.model.nq)[loop.joints])))
        for loop in loops
    )
