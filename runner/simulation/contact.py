"""Contact of the tip in one run: wall in the plant or the simulation loop, external wrench, and wrist sensor."""

import math

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.trace import ContactSignals
from runner.config.run import RunConfig
from runner.controllers import ChecksStability
from runner.controllers.stability import check_wall
from runner.environments import Environment
from runner.environments.external_wrench import Interaction
from runner.environments.wall import Wall
from runner.plants import PLANTS, Plant
from runner.sensing import WristSensor
from runner.simulation.closed_loop import ClosedLoop


def touches_by_tip(config: RunConfig) -> bool:
    """Return True if the tip, a point, touches a wall in the plant's steps: no tool, and a torque plant.

    Raises:
        ConfigError: if the tip does not move as in rigid bodies, or the plant's contacts do not support armature.
    """
    if config.ignore_base_rotation:
        raise ConfigError(
            "environment.kind: a wall is touched where rigid bodies bring the tip, and "
            "plant.wrist_rotation=parallel leaves the rider's base unturned; set plant.wrist_rotation=real, or "
            "environment=free"
        )
    if config.plant.kind == "bullet" and config.arm.model.armature.any():
        raise ConfigError(
            "environment.kind: a wall found together with robot.armature, which PyBullet's contacts do not know; "
            "take plant=mujoco, robot.armature=0, or environment=free"
        )
    return config.robot.tool is None and PLANTS.commands(config.plant.kind) == "torque"


def add_wall(wall: Wall, config: RunConfig, plant: Plant) -> Environment | None:
    """Add a wall to a plant; return the wall if the loop must compute the contact, None if the plant does.

    Raises:
        ConfigError: if the controller would be unstable on it with ideal joints, or the plant does not support
            friction.
    """
    ideal = PLANTS.commands(config.plant.kind) == "position"
    if ideal and isinstance(config.controller, ChecksStability) and config.controller.check_stability:
        late = math.ceil(config.timing.late[0] * config.timing.tick / config.controller.period - 1e-9)
        controller, values = config.controller, wall.config
        check_wall(controller.law, controller.period, values.stiffness, values.damping, late)
    wall.reset(config.path.start)
    tool = config.robot.tool
    ball = (0.0 if tool is None else tool.tip_radius) * wall.normal  # the trajectory is that of the ball's centre
    if not plant.add_wall(wall.point - ball, wall.normal.copy(), wall.config.stiffness, wall.config.damping):
        return wall
    if wall.config.friction:
        raise ConfigError(
            f"environment.friction: {wall.config.friction:g} found, and plant={config.plant.kind} makes the "
            "contact of a tool without friction; take 0, robot.tool=null (the tip touches), or plant=rk4"
        )
    return None


_NOTHING = np.zeros(6)


class Contact:
    """The contact of one run: it loads the sensor, passes readings to the controllers, and records signals.

    Args:
        closed: The closed loop.
        interaction: Interaction of arm and environment; reset here.
        wrist: Force/torque sensor, with a draw for each tick.

    Attributes:
        signals: Record of the run.
    """

    def __init__(self, closed: ClosedLoop, interaction: Interaction, wrist: WristSensor) -> None:
        self._plant = closed.plant
        self._interaction = interaction
        self._wrist = wrist
        self._controllers = [loop.wrench_feedback for loop in closed.loops if loop.wrench_feedback is not None]
        self.signals = ContactSignals(*(np.zeros((closed.ticks + 1, 6)) for _ in range(5)))
        interaction.reset(closed.q_start)

    def update(self, k: int, time: float, q: FloatArray, dq: FloatArray) -> FloatArray:
        """Update with the state of tick k; return the external joint torques. See Interaction.update."""
        interaction, signals = self._interaction, self.signals
        contact = self._plant.contact_wrench()
        torques = interaction.update(time, q, dq, _NOTHING if contact is None else contact)
        reading = self._wrist.read(k, interaction.load)
        signals.external[k], signals.load[k], signals.reading[k] = interaction.external, interaction.load, reading
        reaction = self._plant.tool_reaction()
        if reaction is not None:
            signals.reaction[k] = interaction.to_flange_axes(reaction)
        for controller in self._controllers:
            controller.update_wrench(reading)
        if self._controllers:
            signals.felt[k] = self._controllers[0].external_wrench  # at its last tick
        return torques
