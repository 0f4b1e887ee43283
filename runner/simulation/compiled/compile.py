"""Choice of the compiled parts of a closed loop, from its config."""

import sys
from collections.abc import Sequence
from functools import lru_cache

from runner.base.arrays import FloatArray
from runner.config.timing import Timing
from runner.controllers.controller import Loop
from runner.controllers.torque_law import TorqueLaw
from runner.plants.decoupled import Motion
from runner.plugins.guard import Guarded, unguarded
from runner.robots.robot import Robot
from runner.sensing import EncoderNoise
from runner.simulation.compiled.closed_loop import CompiledCommands, LoopProgram
from runner.simulation.compiled.commands import Commands, LoopCode
from runner.symbolic.engine import MOST_JOINTS, evaluator
from runner.symbolic.structure import CannotCompileError


def find_commands(
    robot: Robot,
    ignore_base_rotation: bool,
    loops: Sequence[Loop],
    tick: float,
    noise: EncoderNoise,
    limits: FloatArray,
) -> Commands | None:
    """Return control loops for compilation; None if one of them has no compiled form.

    Args:
        robot: The robot of the loops.
        ignore_base_rotation: True if mounted stages keep their orientation at home.
        loops: The loops.
        tick: Time between two ticks, in s.
        noise: Noise, bias and resolution of the encoders.
        limits: Torque limits, shape (nq,), in N m; infinite without a limit.
    """
    laws = [unguarded(loop.controller) for loop in loops]
    if not evaluator() or not all(isinstance(law, TorqueLaw) and law.compilable for law in laws):
        return None
    if len(limits) > MOST_JOINTS:
        _tell(f"the arm has {len(limits)} joints, and code is made for {MOST_JOINTS} or fewer: laws are not compiled")
        return None
    joints = range(len(limits))
    codes = [
        LoopCode(
            law, slice(*loop.joints.indices(len(joints))), round(loop.period / tick), loop.period, loop.follows_joints
        )
        for law, loop in zip(laws, loops, strict=True)
    ]
    guarded = any(isinstance(loop.controller, Guarded) for loop in loops)
    return Commands(robot, ignore_base_rotation, tuple(codes), noise, limits, guarded)


def compile_commands(commands: Commands | None) -> CompiledCommands | None:
    """Return compiled control loops; None if they cannot be compiled, after printing the reason."""
    if commands is None:
        return None
    try:
        return CompiledCommands(commands)
    except CannotCompileError as error:
        _tell(str(error))
        return None


def compile_program(commands: Commands | None, motion: Motion, timing: Timing) -> LoopProgram | None:
    """Return a closed loop compiled as a whole; None if it cannot be compiled, for example with varying delays."""
    if commands is None or timing.delay is None:
        return None
    loop_program = describe_program(commands, motion, timing)
    try:
        loop_program.program(1)
    except CannotCompileError:
        return None  # the commands have no compiled form either, and report the reason
    return loop_program


def describe_program(commands: Commands, motion: Motion, timing: Timing) -> LoopProgram:
    """Return a closed loop for compilation as a whole."""
    return LoopProgram(commands, motion, timing.tick, timing.step, timing.steps_per_tick, timing.late[0])


@lru_cache(maxsize=64)
def _tell(text: str) -> None:
    """Print a message once in a process."""
    print(f"runner: {text}", file=sys.stderr)
