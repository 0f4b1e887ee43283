"""Control loops with the nominal models of several repetitions, drawn as arrays."""

from collections.abc import Sequence
from dataclasses import replace

from runner.assembly.assemble import build_loops
from runner.assembly.closed_loop import ClosedLoop
from runner.assembly.compiled.commands import Commands, find_commands
from runner.assembly.compiled.loops import DrawnRow
from runner.assembly.run_config import RunConfig
from runner.config.parsing import require
from runner.controllers import CONTROLLERS
from runner.robots.mismatch import build_drawn
from runner.sensing.streams import MISMATCH, generators


def draws_together(config: RunConfig) -> bool:
    """Return True if the nominal models of several repetitions are drawn as arrays, for laws that take such models."""
    error = config.model_error
    return error is not None and error.varies and CONTROLLERS.features(config.controller.kind).TAKES_DRAWN


def draw_commands(config: RunConfig, repetitions: Sequence[int]) -> Commands:
    """Return the control loops with the nominal models of several repetitions, which are DrawnModels.

    Args:
        config: The checked config of a run with compiled control laws; see draws_together.
        repetitions: Numbers of the repetitions.
    """
    streams = generators([(config.settings.seed, repetition, MISMATCH) for repetition in repetitions])
    nominal = build_drawn(require(config.model_error), config.arm, streams)
    return require(find_commands(config, build_loops(config, nominal)))


def with_drawn(closed: ClosedLoop, config: RunConfig, repetitions: Sequence[int]) -> list[ClosedLoop] | None:
    """Return a closed loop with the nominal model of each repetition; None if they are not drawn together."""
    if closed.compiled is None or not draws_together(config):
        return None
    drawn = draw_commands(config, repetitions)
    values = closed.compiled.drawn_values(drawn)
    return [replace(closed, drawn=DrawnRow(drawn, values, row)) for row in range(len(repetitions))]
