"""Impedance control without a force sensor: the tip's own mass on a spring and a damper."""

from typing import Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field, NonNegativeFloat

from runner.controllers.controller import Loop
from runner.controllers.force.tip_force import ForceTask, TipForce, TipForceConfig, TipMotion, find_force_task
from runner.controllers.operational_space.whole_body import WholeBodyParameters
from runner.robots.robot import Robot
from runner.schema.units import Damping, Stiffness
from runner.symbolic.maths import Array, Backend

Three = Annotated[list[NonNegativeFloat], Field(min_length=3, max_length=3)]


class ImpedanceConfig(TipForceConfig):
    """Config of impedance control; lists hold values along x, y, z of the base.

    Natural frequency and damping ratio apply to the stages below the compliant one; see actuated_stages.

    Attributes:
        kind: Registry name of the controller.
        tip_stiffness: K_d, in N/m; 0 leaves an axis free.
        tip_damping: D_d, in N s/m.
    """

    kind: Literal["impedance"]
    tip_stiffness: Stiffness[Three]
    tip_damping: Damping[Three]


class ImpedanceParameters(NamedTuple):
    """The parameters of impedance control."""

    law: WholeBodyParameters
    gravity: Array  # in the robot's base frame, shape (3,), in m/s^2
    stiffness: Array  # K_d along the base's axes, shape (3,), in N/m
    damping: Array  # D_d, shape (3,), in N s/m


class Impedance(TipForce[ImpedanceParameters]):
    r"""Spring and damper at the tip, with its natural inertia (Hogan 1985).

    .. math::

        \tau = J^T [\Lambda (\ddot x_d - \dot J \dot q) + K_d (x_d - x) + D_d (\dot x_d - \dot x)] + V + G + N^T \tau_0

    so that under an external force f, with M_d = Lambda,

    .. math:: \Lambda (\ddot x - \ddot x_d) + D_d (\dot x - \dot x_d) + K_d (x - x_d) = f

    Another M_d would require a measurement of f.

    Args:
        task: Force task of the robot.
        config: Config of the law.
    """

    def __init__(self, task: ForceTask, config: ImpedanceConfig) -> None:
        values = np.array(config.tip_stiffness), np.array(config.tip_damping)
        super().__init__(task, ImpedanceParameters(task.law.parameters, task.robot.model.gravity, *values))

    def command(
        self, backend: Backend, parameters: ImpedanceParameters, tip: TipMotion, state: Array
    ) -> tuple[Array, Array, Array]:
        """Return the desired acceleration and the force of spring and damper; see TipForce."""
        axes = tip.axes
        spring = (axes * parameters.stiffness).dot(axes.T).dot(tip.error)
        return tip.desired, spring + (axes * parameters.damping).dot(axes.T).dot(tip.lag), state


TAKES_DRAWN = True
CONFIG = ImpedanceConfig


def build(config: ImpedanceConfig, robot: Robot) -> tuple[Loop, ...]:
    """Build the loops of a config: one, or one for each stage if only the last stage is compliant.

    Raises:
        ConfigError: if a value is missing for a stage, or the arm has too few joints.
    """
    task = find_force_task(config, robot)
    return task.loops(Impedance(task, config), uses_wrench=False)
