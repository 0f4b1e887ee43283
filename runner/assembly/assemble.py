"""Assembly of a closed loop from a checked config."""

import math
from contextlib import ExitStack

import numpy as np

from runner.assembly.closed_loop import ClosedLoop
from runner.assembly.compiled.commands import Commands, compiled, find_commands
from runner.assembly.compiled.loop_program import LoopProgram
from runner.assembly.desired_motion import check_feasible, find_start
from runner.assembly.flexibility import find_motor_side, is_flexible, with_nominal_flexibility
from runner.assembly.run_config import RunConfig
from runner.assembly.wall import add_wall, touches_by_tip
from runner.base.arrays import FloatArray
from runner.base.memory import Memory
from runner.controllers import CONTROLLERS, Loop, tell_limits
from runner.controllers.disturbance_observer import add_observers
from runner.controllers.notch import add_notch
from runner.environments import ENVIRONMENTS
from runner.environments.external_wrench import Interaction
from runner.environments.wall import Wall
from runner.plants import PLANTS, Plant, options_of
from runner.plants.servo import JointServo
from runner.plants.wrappers import PayloadChanges, WithTipContact
from runner.robots.mismatch import MISMATCHES
from runner.robots.robot import Robot
from runner.sensing.streams import MISMATCH
from runner.symbolic.structure import CannotCompileError

_MEMORY = Memory(256)  # for starts


def assemble(config: RunConfig, repetition: int = 0) -> ClosedLoop:
    """Build the closed loop of a config; `ClosedLoop.close` releases it.

    Controllers and servos use the nominal model of a repetition. Plant, path and start use the true arm.

    Args:
        config: The checked config.
        repetition: Number of the repetition, which determines the nominal model.

    Raises:
        ConfigError: if the start of the trajectory cannot be reached, position-controlled joints cannot follow it, or a
            component rejects its config.
    """
    arm, path, timing = config.arm, config.path, config.timing
    q_start = start_of(config)
    nominal, loops = _build_nominal(config, repetition)
    environment = ENVIRONMENTS.build(config.environment)
    with ExitStack() as on_error:
        wall = environment if type(environment) is Wall else None  # the plants know no other environment
        touched = wall if wall is not None and touches_by_tip(config) else None
        plant = _make_plant(config, nominal, loops[0].period, touched)
        on_error.callback(plant.close)
        if wall is not None:
            environment = None if touched else add_wall(wall, config, plant)
        interaction = Interaction(arm, environment, timing.tick) if config.has_contact else None
        code = compiled(_find_commands(config, loops))
        on_error.pop_all()
    return ClosedLoop(
        robot=arm,
        plant=plant,
        loops=loops,
        trajectory=path,
        limits=config.torque_limits,
        tick=timing.tick,
        ticks=timing.ticks,
        commands=config.commands,
        interaction=interaction,
        q_start=q_start,
        ignore_base_rotation=config.ignore_base_rotation,
        delay=timing.delay,
        nominal=nominal,
        motor_side=find_motor_side(config, plant, nominal),
        compiled=code,
    )


def assemble_program(config: RunConfig, repetition: int = 0) -> tuple[LoopProgram, FloatArray] | None:
    """Return a closed loop compiled as a whole, and its start, shape (nq,), in rad; None if it is not compiled.

    Arguments and errors are those of assemble.
    """
    loop_program = describe_program(config, repetition)
    try:
        if loop_program is not None:
            loop_program.program(1)
    except CannotCompileError:
        return None  # the control loops have no compiled form either, and report the reason
    return None if loop_program is None else (loop_program, start_of(config))


def describe_program(config: RunConfig, repetition: int = 0) -> LoopProgram | None:
    """Return a closed loop that may be compiled as a whole, without compiling it; None if it cannot; see assemble."""
    timing, steps = config.timing, (config.timing.step, config.timing.steps_per_tick)
    if config.commands != "torque" or config.has_contact or config.loaded or not config.compilable:
        return None
    motion = PLANTS.motion(config.plant, config.arm, *steps) if timing.delay is not None else None
    commands = None if motion is None else _find_commands(config, _build_nominal(config, repetition)[1])
    if motion is None or commands is None:
        return None
    return LoopProgram(commands, motion, timing.tick, *steps, timing.late[0])


def check_assembly(config: RunConfig) -> None:
    """Assemble a run once.

    Raises:
        ConfigError: see assemble.
    """
    if assemble_program(config) is None:
        assemble(config).close()


def start_of(config: RunConfig) -> FloatArray:
    """Return the initial joint positions, shape (nq,), in rad, after the check that the arm can follow the path.

    The result, which runs with the same desired motion share, must not be changed.

    Raises:
        ConfigError: if it cannot, or if it cannot reach the start.
    """
    if CONTROLLERS.is_user_supplied(config.controller.kind):  # it may have state
        return _checked_start(config)
    decides = config.controller, config.arm, config.path, config.ignore_base_rotation, config.robot.settling_band
    end = config.timing.ticks * config.timing.tick
    return _MEMORY.known((*decides, end), lambda: _checked_start(config))


def _checked_start(config: RunConfig) -> FloatArray:
    q_start = find_start(config.controller, config.arm, config.path, config.ignore_base_rotation)
    check_feasible(config, q_start)
    return q_start


def _build_nominal(config: RunConfig, repetition: int) -> tuple[Robot, tuple[Loop, ...]]:
    draw = np.random.default_rng([config.settings.seed, repetition, MISMATCH])
    robot = with_nominal_flexibility(config, MISMATCHES.build(config.mismatch, config.arm, draw))
    return robot, build_loops(config, robot)


def build_loops(config: RunConfig, nominal: Robot) -> tuple[Loop, ...]:
    """Return the loops of the controllers with a nominal robot."""
    loops = tell_limits(config.loops_for(nominal), config.torque_limits.max)
    if config.notch is not None:
        loops = add_notch(nominal, loops, config.notch.by_joint(config.arm), config.notch.width)
    observer, timing = config.disturbance_observer, config.timing
    return add_observers(observer, nominal, loops, config.torque_limits.max, timing.tick, timing.late)


def _find_commands(config: RunConfig, loops: tuple[Loop, ...]) -> Commands | None:
    """Return the control loops for compilation; None if they cannot be compiled."""
    fits = config.commands == "torque" and not config.endpoint_sensor.read_by and not is_flexible(config)
    return find_commands(config, loops) if fits else None


def _make_plant(config: RunConfig, nominal: Robot, period: float, touched: Wall | None = None) -> Plant:
    """Return the plant, with joint servos if it takes torques and loops of a period command joint positions."""
    arm, timing = config.arm, config.timing
    ticks_per_command = round(period / timing.tick)
    if not config.takes_torques:
        return PLANTS.build(config.plant, arm, timing.tick, ticks_per_command)
    plant = _make_torque_plant(config) if touched is None else _make_touched_plant(config, touched)
    servo = options_of(config.plant).servo
    if config.commands == "torque" or servo is None:
        return plant
    with ExitStack() as on_error:
        on_error.callback(plant.close)
        driven = JointServo(
            plant, nominal.model, servo, arm.home, config.torque_limits, ticks_per_command, timing.late[0]
        )
        on_error.pop_all()
    return driven


def _make_torque_plant(config: RunConfig) -> Plant:
    """Return the plant; one for each payload if the payload changes during the motion."""
    timing = config.timing
    with ExitStack() as on_error:
        plants: list[Plant] = []
        for arm in (config.arm, *(robot for _, robot in config.loaded)):
            plants.append(PLANTS.build(config.plant, arm, timing.step, timing.steps_per_tick))
            on_error.callback(plants[-1].close)
        ticks = [math.ceil(at / timing.tick - 1e-9) for at, _ in config.loaded]
        on_error.pop_all()
    return PayloadChanges(plants, ticks) if ticks else plants[0]


def _make_touched_plant(config: RunConfig, wall: Wall) -> Plant:
    """Return the plant of an arm without a tool, whose tip touches a wall in its integration steps."""
    timing = config.timing
    plant = PLANTS.build(config.plant, config.arm, timing.step, 1)
    lead = 0.5 if PLANTS.features(config.plant.kind).moves_exactly(config.plant) else 0.0
    return WithTipContact(plant, config.arm.model, wall, timing.step, timing.steps_per_tick, lead)
