"""Compiled runs side by side: a block of runs begins at rest, whatever the block before left in its lanes."""

import numpy as np
import pytest

from runner.assembly.assemble import assemble_program
from runner.assembly.compiled.loop_program import run_all
from runner.symbolic.engine import evaluator
from runner.symbolic.program import LANES, Frame

pytestmark = pytest.mark.skipif(not evaluator(), reason="runs are compiled as a whole by llvmlite")


@pytest.fixture(scope="module")
def sliding(checked_config):
    """A closed loop with dry friction, whose code remembers the way that each joint slides."""
    config = checked_config("robot=macro", "plant=rk4", "controller=operational_space", "trajectory=goal",
                            "duration=0.1", "torque_limits.max=200", "plant.friction.coulomb=[0,8,1]")  # fmt: skip
    return config, *assemble_program(config)


def together(sliding, count):
    """Return the signals of equal runs, each from its own start."""
    config, loop_program, q_start = sliding
    times = np.arange(config.timing.ticks + 1) * config.timing.tick
    q = q_start + 0.05 * np.arange(count)[:, None]
    still = np.zeros((count, len(times), 3))
    shared = loop_program.commands.shared(times, config.path.sample(times))
    values = np.repeat([loop_program.values], count, axis=0)
    return run_all(loop_program, values, shared, [still], loop_program.commands.start(q, [still[:, 0]]))


def test_no_joint_slides_before_a_block_begins(sliding, monkeypatch):
    begun, ended, call = [], [], Frame.call
    _, loop_program, q_start = sliding
    known = loop_program.commands.start(q_start[None], [np.zeros((1, 3))]).shape[1]

    def noted(frame):
        begun.append(frame.state[known:].copy())
        call(frame)
        ended.append(frame.state[known:].copy())

    monkeypatch.setattr(Frame, "call", noted)
    together(sliding, LANES + 1)
    assert len(begun) == 2
    assert np.any(ended[0] != 0.0)  # some slide in the end, so that the next block would begin with it
    np.testing.assert_array_equal(begun, np.zeros_like(begun))


@pytest.mark.parametrize("count", [LANES, LANES + 1, 2 * LANES])
def test_the_last_run_has_the_bits_of_a_shorter_list(sliding, count):
    found, fewer = together(sliding, count), together(sliding, 2)
    for name in ("q", "dq", "command"):
        np.testing.assert_array_equal(getattr(found, name)[:2], getattr(fewer, name))
