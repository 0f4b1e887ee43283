"""A robot that knows its motors."""

from dataclasses import replace

from runner.robots.model import FloatArray, RobotModel
from runner.robots.robot import Robot


def with_motors(robot: Robot, motors: FloatArray) -> Robot:
    """Return a robot whose mass matrices are M + diag(B), the limit of flexible joints with stiff springs.

    Compiled code knows nothing of motors: a law on such a robot is not to be compiled.

    Args:
        robot: The robot.
        motors: B, inertia of each motor after its gear, shape (nq,), in kg m^2.
    """
    stages = tuple(replace(stage, model=motorised(stage.model, motors[stage.joints])) for stage in robot.stages)
    whole = stages[0].model if len(stages) == 1 else motorised(robot.model, motors)
    return replace(robot, model=whole, stages=stages)


def motorised(model: RobotModel, motors: FloatArray) -> RobotModel:
    """Return a model with motors whose spin alone adds to its inertia; see with_motors."""
    own = model.copy()
    own.pin_model.armature = motors.copy()
    own._data = own.pin_model.createData()
    return own
