"""Closed loop of one run: plant, control loops, desired motion and limits."""

from dataclasses import dataclass

from runner.base.arrays import FloatArray
from runner.controllers import Loop
from runner.environments.external_wrench import Interaction
from runner.plants import Plant
from runner.plants.motors import MotorSide
from runner.plugins.features import Commands
from runner.robots.robot import Robot
from runner.simulation.compiled.closed_loop import CompiledCommands, LoopProgram
from runner.trajectories import Trajectory


@dataclass(frozen=True)
class ClosedLoop:
    """The control loops around one robot.

    Attributes:
        robot: The robot, for its true end points.
        plant: The simulated robot, which takes what the loops give.
        loops: The control loops; together they command every joint once.
        trajectory: The desired motion of the tip.
        limits: Torque limit of each joint, shape (nq,), in N m; infinite where there is none.
        tick: Time between two ticks of the fastest loop, in s; every loop's period is a multiple of it.
        ticks: Number of ticks.
        commands: Whether the loops give joint torques, or joint positions to a plant that follows them.
        interaction: What the tip feels of the world; None where there is nothing to feel.
        q_start: Joint positions at t = 0, shape (nq,), in rad; the robot starts at rest.
        ignore_base_rotation: Whether riding stages keep the orientation of home, as the plant has it.
        delay: Ticks from a command until it acts; None where they differ, see CommandTiming.
        motor_side: What drives and encoders know of the motors of flexible joints; None where joints are rigid.
        nominal: The nominal robot, which its controllers use.
        compiled: The closed loop as compiled code, or what its loops ask; None where neither is to be had.
    """

    robot: Robot
    plant: Plant
    loops: tuple[Loop, ...]
    trajectory: Trajectory
    limits: FloatArray
    tick: float
    ticks: int
    commands: Commands
    interaction: Interaction | None
    q_start: FloatArray
    ignore_base_rotation: bool
    delay: int | None
    nominal: Robot
    motor_side: MotorSide | None = None
    compiled: LoopProgram | CompiledCommands | None = None

    def close(self) -> None:
        """Release what the plant holds."""
        self.plant.close()

    def every(self, loop: Loop) -> int:
        """Return the number of ticks in a loop's period."""
        return round(loop.period / self.tick)
