"""A compiled loop that is slower than the ticks: between its own ticks it asks nothing, so that nothing goes wrong."""

from types import SimpleNamespace

import numpy as np
import pytest

from runner.assembly.compiled.commands import Commands, LoopCode
from runner.assembly.compiled.loops import CompiledLoops
from runner.plants.motor_limits import TorqueLimits
from runner.sensing.encoders import EncoderNoise
from runner.symbolic.engine import evaluator

pytestmark = pytest.mark.skipif(not evaluator(), reason="laws are compiled by llvmlite")
BENT, FOLDED = np.array([0.3, 0.4, 0.2]), np.array([0.0, 0.0, np.pi / 2])  # rad; the tip's Jacobian is singular folded


@pytest.fixture(scope="module")
def law(checked_config):
    config = checked_config("robot=macro", "trajectory=goal", "controller.singularity_damping=0")
    return config.loops[0].controller


def torques(law, every, postures):
    """Return the torques in each tick of a loop that acts every `every` ticks."""
    ticks, exact = len(postures), EncoderNoise(*np.zeros((3, 3)), "none", "exact")
    robot = SimpleNamespace(model=law.models[0], stages=(None,))
    loop = LoopCode(law, slice(0, 3), every, 0.01 * every)
    reference = np.zeros((ticks, 3, 3))
    reference[:, 0] = law.models[0].tip_position(BENT + 0.02)
    commands = Commands(robot, False, (loop,), exact, TorqueLimits.constant(np.full(3, np.inf)))
    run = CompiledLoops(commands, ticks, [np.zeros((-(-ticks // every), 3))])
    run.start(0.01 * np.arange(ticks), reference, None, postures[0])
    for tick, q in enumerate(postures):
        run.update(tick, q, np.zeros(3))
    return run.rows.command


def test_a_posture_without_an_answer_between_its_ticks_is_no_fault_and_the_torque_stands(law):
    found = torques(law, 3, [BENT, FOLDED, FOLDED, BENT, FOLDED])
    np.testing.assert_array_equal(found, np.repeat(found[:1], 5, axis=0))
    assert np.abs(found).max() > 0.1


@pytest.mark.parametrize("every", [1, 2, 3])
def test_in_a_tick_of_its_own_it_is_one(law, every):
    regular = torques(law, every, [BENT] * (2 * every))
    assert np.isfinite(regular).all()
    with pytest.raises(np.linalg.LinAlgError, match="the tip's Jacobian is singular"):
        torques(law, every, [*[BENT] * every, FOLDED])
