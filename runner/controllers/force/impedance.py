"""Impedance control without a force sensor: the tip's own mass on a spring and a damper."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat

from runner.base.arrays import FloatArray
from runner.controllers.controller import Controller, Loop
from runner.controllers.force.tip_force import TipForce, TipForceConfig, find_force_task
from runner.robots.robot import Robot
from runner.schema.units import Damping, Stiffness

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


class Impedance(Controller):
    r"""Spring and damper at the tip, with its natural inertia (Hogan 1985).

    .. math::

        \tau = J^T [\Lambda (\ddot x_d - \dot J \dot q) + K_d (x_d - x) + D_d (\dot x_d - \dot x)] + V + G + N^T \tau_0

    so that under an external force f, with M_d = Lambda,

    .. math:: \Lambda (\ddot x - \ddot x_d) + D_d (\dot x - \dot x_d) + K_d (x - x_d) = f

    Another M_d would require a measurement of f.

    Args:
        tip: TipForce of the compliant stage.
        config: Config of the law.
    """

    def __init__(self, tip: TipForce, config: ImpedanceConfig) -> None:
        self._tip = tip
        self._stiffness, self._damping = np.diag(config.tip_stiffness), np.diag(config.tip_damping)

    def reset(self) -> None:
        """Do nothing: the law has no state."""

    def torque(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the torques of the law above; see Controller.torque."""
        state = self._tip.task_state(q, dq, reference)
        axes = state.axes
        force = axes @ self._stiffness @ axes.T @ state.error + axes @ self._damping @ axes.T @ state.lag
        return self._tip.torque(state, state.desired, force)


CONFIG = ImpedanceConfig


def build(config: ImpedanceConfig, robot: Robot) -> tuple[Loop, ...]:
    """Build the loops of a config: one, or one for each stage if only the last stage is compliant.

    Raises:
        ConfigError: if a value is missing for a stage, or the arm has too few joints.
    """
    task = find_force_task(config, robot)
    return task.loops(Impedance(task.tip, config), uses_wrench=False)
