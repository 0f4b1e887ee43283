"""Runs with compiled code: the control loops of each tick, or a whole run at once."""

import time
from collections.abc import Sequence
from typing import cast

import numpy as np

from runner.base.errors import SimulationError
from runner.sensing import Encoders, JointEncoders
from runner.simulation.closed_loop import ClosedLoop
from runner.simulation.command import make_plant_input
from runner.simulation.compiled.closed_loop import CompiledCommands, LoopProgram, run_all
from runner.simulation.contact import Contact
from runner.simulation.failures import find_failure
from runner.simulation.recorder import CHECK_EVERY, Recorder


def run_commands(
    compiled: CompiledCommands,
    closed: ClosedLoop,
    encoders: Sequence[Encoders],
    contact: Contact | None,
    recorder: Recorder,
) -> None:
    """Run a closed loop with compiled control loops.

    Args:
        compiled: The compiled control loops.
        closed: The closed loop.
        encoders: Built-in joint measurement of each loop.
        contact: Contact of the tip; None without contact.
        recorder: Recorder with times and reference, which stores the rows.
    """
    errors = [cast(JointEncoders, each).errors for each in encoders]
    run = compiled.begin(recorder.times, recorder.desired, errors, closed.q_start, recorder.joints)
    recorder.q, recorder.dq, recorder.commands, recorder.end_points = run.q, run.dq, run.torque, run.end_points
    drive, plant, tick, clock, now = (
        make_plant_input(closed, recorder),
        closed.plant,
        run.tick,
        recorder.clock,
        recorder.now,
    )
    load, k = None, 0
    recorder.asked = asked = np.zeros_like(clock)
    plant.reset(closed.q_start, np.zeros_like(closed.q_start))
    try:
        for k in range(closed.ticks + 1):
            clock[k] = now()
            q, dq = plant.q, plant.dq
            if contact is not None:
                load = contact.update(k, recorder.times[k], q, dq)
            begun = now()
            tick(k, q, dq)
            asked[k] = now() - begun
            if k % CHECK_EVERY == 0:
                recorder.check_divergence(k)
            if k < closed.ticks:
                drive.advance(k, load)
        recorder.check_divergence(closed.ticks)
    except (np.linalg.LinAlgError, SimulationError) as error:
        recorder.stop(k, error)


def run_program(
    loop_program: LoopProgram, closed: ClosedLoop, encoders: Sequence[Encoders], recorder: Recorder
) -> None:
    """Run a closed loop that is compiled as a whole.

    Args:
        loop_program: The compiled closed loop.
        closed: The closed loop.
        encoders: Built-in joint measurement of each loop.
        recorder: Recorder with times and reference, which stores the rows.
    """
    began, commands = time.perf_counter_ns(), loop_program.commands
    errors = [cast(JointEncoders, each).errors for each in encoders]
    signals = run_all(
        loop_program,
        loop_program.values[None],
        commands.shared(recorder.times, recorder.desired, recorder.joints),
        [wrong[None] for wrong in errors],
        commands.start(closed.q_start[None], [wrong[:1] for wrong in errors]),
    )
    recorder.clock[:] = np.linspace(began, time.perf_counter_ns(), len(recorder.times))
    recorder.q, recorder.dq, recorder.commands = signals.q[0], signals.dq[0], signals.torque[0]
    recorder.end_points = signals.end_points[:, 0]
    recorder.end(find_failure(signals, 0, recorder.times, closed.robot.model))
