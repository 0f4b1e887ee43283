"""Many runs at once on rk4, only the compiled code: neither the draws of their noise nor their metrics are timed."""

import numpy as np

from bench.arms import Arm, assembled
from bench.turns import Block
from runner.assembly.assemble import assemble_program
from runner.assembly.compiled.loop_program import run_all
from runner.simulation.sensors import make_encoders

SIZES = (1, 40, 1000)
TICKS = 400


def batches(arm: Arm, law: str) -> dict[int, Block]:
    """Return batches of runs of a law by their size, each run with different noise; none if it is not compiled."""
    config, closed = assembled(arm, law, "rk4", 1, TICKS)
    found = assemble_program(config)
    if found is None:
        return {}
    loop_program = found[0]
    commands, times = loop_program.commands, np.arange(TICKS + 1, dtype=np.float64) * closed.tick
    shared = commands.shared(times, closed.trajectory.sample(times))
    runs = [make_encoders(closed, config.noise, config.settings.seed, run) for run in range(max(SIZES))]
    errors = [np.array([encoder.errors for encoder in loop]) for loop in zip(*runs, strict=True)]
    start = commands.start(np.tile(closed.q_start, (len(runs), 1)), [each[:, 0] for each in errors])

    def block(size: int) -> Block:
        values, own = np.tile(loop_program.values, (size, 1)), [each[:size] for each in errors]
        return Block(lambda: run_all(loop_program, values, shared, own, start[:size]), size * TICKS)

    return {size: block(size) for size in SIZES}
