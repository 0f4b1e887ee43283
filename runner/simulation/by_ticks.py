"""Simulation of one repetition tick by tick, for runs that are not compiled as a whole."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from runner.assembly.assemble import assemble
from runner.assembly.closed_loop import ClosedLoop
from runner.assembly.drawn_loops import with_drawn
from runner.assembly.run_config import RunConfig
from runner.base.arrays import FloatArray
from runner.base.trace import Trace
from runner.sensing.force_torque import ForceTorqueSensor
from runner.sensing.streams import ENVIRONMENT
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_sensors


def simulate_by_ticks(
    config: RunConfig, repetition: int, ticks: int, start: Callable[[FloatArray], FloatArray]
) -> Trace:
    """Simulate one repetition.

    Args:
        config: The checked config.
        repetition: Number of the repetition.
        ticks: Number of ticks.
        start: Function of the run's initial joint positions that returns those of the simulation, shapes (nq,), in rad.

    Raises:
        ConfigError: see assemble.
    """
    closed = assemble(config, repetition)
    try:
        (own,) = with_drawn(closed, config, [repetition]) or [closed]
        return simulate_assembled(replace(own, ticks=ticks, q_start=start(own.q_start)), config, repetition)[0]
    finally:
        closed.close()


def simulate_assembled(closed: ClosedLoop, config: RunConfig, repetition: int) -> tuple[Trace, list[str]]:
    """Simulate one repetition; return its trace, and the warnings of the controllers and of the wrist sensor."""
    made = make_sensors(closed, config, repetition)
    if closed.interaction is not None:
        closed.interaction.begin(np.random.default_rng([config.settings.seed, repetition, ENVIRONMENT]))
    trace, wrist = simulate(closed, *made), made[1]
    users = [loop.wrench_feedback for loop in closed.loops if loop.wrench_feedback is not None]
    told = [message for controller in users for message in controller.messages()]
    return trace, told + (wrist.overloads() if isinstance(wrist, ForceTorqueSensor) else [])
