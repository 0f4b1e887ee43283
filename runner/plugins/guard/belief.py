"""Runtime check of the robot model from a mismatch plug-in."""

from typing import TYPE_CHECKING, Any

import numpy as np

from runner.base.errors import ConfigError

if TYPE_CHECKING:
    from runner.robots.robot import Robot


def watch_belief(believed: Any, _: Any, robot: "Robot", *__: object) -> "Robot":
    """Return the robot that a mismatch of the user's made.

    Args:
        believed: What it made.
        robot: The robot as it is.

    Raises:
        ConfigError: if that is no robot of the same stages and joints, or its masses and lengths are not finite.
    """
    from runner.robots.robot import Robot

    if not isinstance(believed, Robot):
        raise ConfigError([f"mismatch.kind: build gave {believed!r:.200}; it must give a Robot"])
    if believed.stage_names != robot.stage_names or believed.model.joint_names != robot.model.joint_names:
        raise ConfigError(
            [
                "mismatch.kind: build gave a robot with other stages or joints: "
                f"{', '.join(believed.model.joint_names)}; they must be {', '.join(robot.model.joint_names)}"
            ]
        )
    for model in (believed.model, *(stage.model for stage in believed.stages)):
        lengths = [placement.translation for placement in model.pin_model.jointPlacements]
        if not all(np.isfinite(part).all() for part in (model.inertial_parameters, model.gravity, np.array(lengths))):
            raise ConfigError(["mismatch.kind: build gave a robot with masses or lengths that are not finite"])
    return believed
