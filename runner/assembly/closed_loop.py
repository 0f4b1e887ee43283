"""Closed loop of one run: plant, control loops, desired motion and limits."""

from dataclasses import dataclass

from runner.assembly.compiled import commands as code
from runner.assembly.compiled.loops import DrawnRow
from runner.base.arrays import FloatArray
from runner.controllers import Loop
from runner.environments.external_wrench import Interaction
from runner.plants import Plant
from runner.plants.flexible_joints import MotorSide
from runner.plants.motor_limits import TorqueLimits
from runner.plugins.features import Commands
from runner.robots.robot import Robot
from runner.trajectories import Trajectory


@dataclass(frozen=True)
class ClosedLoop:
    """The control loops around one robot.

    Attributes:
        robot: The robot, for its true end points.
        plant: The simulated robot, driven by the loops.
        loops: The control loops; together they command every joint once.
        trajectory: The desired motion of the tip.
        limits: Torque limits of all joints.
        tick: Time between two ticks of the fastest loop, in s; every loop's period is a multiple of it.
        ticks: Number of ticks.
        commands: Quantity that the loops command: joint torques, or joint positions for a position plant.
        interaction: External wrench on the tip; None without contact.
        q_start: Joint positions at t = 0, shape (nq,), in rad; the robot starts at rest.
        ignore_base_rotation: True if mounted stages keep their orientation at home, as in the plant.
        delay: Ticks from a command until it acts; None if delays differ, see CommandTiming.
        motor_side: Encoders and drives at the motors of flexible joints; None for rigid joints.
        nominal: The nominal robot of the controllers.
        compiled: The control loops for compiled code; None if they are interpreted.
        drawn: Drawn nominal model of `compiled`; None if the nominal model is not drawn with others.
    """

    robot: Robot
    plant: Plant
    loops: tuple[Loop, ...]
    trajectory: Trajectory
    limits: TorqueLimits
    tick: float
    ticks: int
    commands: Commands
    interaction: Interaction | None
    q_start: FloatArray
    ignore_base_rotation: bool
    delay: int | None
    nominal: Robot
    motor_side: MotorSide | None = None
    compiled: code.Commands | None = None
    drawn: DrawnRow | None = None

    def close(self) -> None:
        """Release the resources of the plant."""
        self.plant.close()

    def every(self, loop: Loop) -> int:
        """Return the number of ticks in a loop's period."""
        return round(loop.period / self.tick)
