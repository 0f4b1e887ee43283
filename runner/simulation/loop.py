"""Closed-loop simulation of one run, tick by tick: plant, encoders, controllers and desired motion."""

from collections.abc import Mapping, Sequence

import numpy as np

from runner.base.errors import SimulationError
from runner.base.ticks import track_ticks
from runner.base.trace import Trace
from runner.sensing import Encoders, TorqueSensors, WristSensor
from runner.simulation.closed_loop import ClosedLoop
from runner.simulation.command import Command, make_plant_input
from runner.simulation.compiled.closed_loop import CompiledCommands, LoopProgram
from runner.simulation.compiled_loop import run_commands, run_program
from runner.simulation.contact import Contact
from runner.simulation.recorder import CommandTiming, Recorder, constant_delay
from runner.simulation.sensors import JointTorques, MeasuredTip

__all__ = ["ClosedLoop", "simulate"]


def simulate(
    closed: ClosedLoop,
    encoders: Sequence[Encoders],
    wrist: WristSensor | None = None,
    torques: TorqueSensors | None = None,
    tips: Mapping[str, MeasuredTip] | None = None,
    timing: CommandTiming | None = None,
) -> Trace:
    """Run the control loops once.

    At each of its ticks, a loop reads the encoders of every joint and calls its controller. The torques are clipped
    joint by joint and held until the loop's next tick. They act after the delay, and the trace contains the acting
    torques; the first command acts from the start. The last row contains the final state and the torques that would act
    next. Position commands are not clipped. The trace then contains the plant's torques, and the last row repeats those
    of the last tick.

    Args:
        closed: The control loops; plant and controllers are reset here.
        encoders: Joint measurement of each loop, with a draw for each of its ticks.
        wrist: Force/torque sensor, with a draw for each tick; required for contact.
        torques: Torque sensors in the joints, with a draw for each tick; required if a control law reads them.
        timing: Command that acts in each tick; None for the constant delay of the closed loop.
        tips: Tip measurements besides the encoders, by loop; required if a loop reads a tip sensor.

    Returns:
        The trace; it contains a failure if the run ends early.
    """
    recorder = Recorder(closed, timing or constant_delay(closed.robot.model.nq, closed.delay or 0, closed.ticks + 1))
    contact = None
    try:
        recorder.desired[:] = closed.trajectory.sample(recorder.times)
        recorder.joints = closed.trajectory.sample_joints(recorder.times)
        if closed.interaction is not None and wrist is not None:
            contact = Contact(closed, closed.interaction, wrist)
        # A diverging run ends as a failure, not as a warning.
        with track_ticks(recorder.clock, closed.ticks), np.errstate(over="ignore", invalid="ignore"):
            if isinstance(closed.compiled, LoopProgram):
                run_program(closed.compiled, closed, encoders, recorder)
            elif isinstance(closed.compiled, CompiledCommands):
                run_commands(closed.compiled, closed, encoders, contact, recorder)
            else:
                each = zip(closed.loops, encoders, strict=True)
                commands = [Command(closed, *own, recorder, (tips or {}).get(own[0].name)) for own in each]
                _run(closed, commands, contact, JointTorques(closed, torques, recorder), recorder)
    except (np.linalg.LinAlgError, SimulationError) as error:
        recorder.stop(0, error)
    return recorder.trace(contact)


def _run(
    closed: ClosedLoop,
    commands: Sequence[Command],
    contact: Contact | None,
    torques: JointTorques,
    recorder: Recorder,
) -> None:
    """Run control loops that are called one by one."""
    drive, load, k, now = make_plant_input(closed, recorder), None, 0, recorder.now
    recorder.asked = asked = np.zeros_like(recorder.clock)
    closed.plant.reset(closed.q_start, np.zeros_like(closed.q_start))
    try:
        for k in range(closed.ticks + 1):
            q, dq = recorder.observe(k)
            if contact is not None:
                load = contact.update(k, recorder.times[k], q, dq)
            torques.tell(k)
            q, dq = (q, dq) if closed.motor_side is None else closed.motor_side.read()
            begun = now()
            for command in commands:
                if k % command.every == 0:
                    command.update(k, q, dq)
            asked[k] = now() - begun
            recorder.keep_command(k)
            if k < closed.ticks:
                drive.advance(k, load)
                torques.keep(k)
        recorder.check_divergence(closed.ticks)
    except (np.linalg.LinAlgError, SimulationError) as error:
        recorder.stop(k, error)
