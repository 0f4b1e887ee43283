"""Requests of the control loops of Macro and Mini to their laws, for every option, against the rules of the thesis."""

import itertools

import numpy as np
import pytest
from support.covers import every_case, pairwise

from runner.controllers import CONTROLLERS
from runner.robots.robot import StageBase

CHOICES = {
    "coupling": ("independent", "one_way", "two_way", "mini_held", "independent_base"),
    "macro_target": ("minus_home", "tip_goal"),
    "mini_reference_velocity": ("full", "zero"),
    "wrist_rotation": ("real", "parallel"),
    "schedule": ("both", "turns"),
    "beyond_reach": ("hold", "stretch"),
}
EVERY = every_case(CHOICES)
SAMPLE = [EVERY[index] for index in np.random.default_rng(0).choice(len(EVERY), 60, replace=False)]
HOME_OFFSET = np.array([0.0, 0.1, 0.1])


class Recorder:
    """Stands in for a stage's law and notes what it receives."""

    def move(self, arm, numbers, q, dq, reference, gravity=None):
        self.told, self.gravity = ("move", reference.copy()), gravity
        return np.zeros(3)

    def hold(self, arm, numbers, q, dq, posture, gravity=None):
        self.told, self.gravity = ("hold", posture.copy()), gravity
        return np.zeros(3)


@pytest.fixture(scope="module")
def riding(checked_config):
    return checked_config("robot=combined")


def expected(flags, robot, base, reach, time, q, reference):
    """Return the requests to both laws: to move by a reference, or to hold a posture."""
    R, (velocity, spin) = base.rotation, base.velocity()
    r = reference[0] - base.position
    within, mini_turn = np.linalg.norm(r) <= reach, int(time / 0.01 + 1e-9) % 2 == 1
    turns, full = flags["schedule"] == "turns", flags["mini_reference_velocity"] == "full"
    target, aim = reference.copy(), np.zeros((3, 3))
    if flags["coupling"] == "two_way":
        target[0] -= R @ robot.stages[1].model.tip_position(q[3:])
    elif (flags["coupling"], flags["macro_target"]) != ("one_way", "tip_goal"):
        target[0] -= HOME_OFFSET
    macro = ("hold", q[:3]) if turns and mini_turn and within else ("move", target)
    if flags["coupling"] == "mini_held":
        return macro, ("hold", np.zeros(3))
    if flags["coupling"] in ("independent", "independent_base"):
        aim[0] = HOME_OFFSET
        if flags["coupling"] == "independent_base" and flags["wrist_rotation"] == "real":
            aim[0] = R.T @ HOME_OFFSET
            aim[1] = -R.T @ np.cross(spin, HOME_OFFSET) if full else 0.0
        return macro, ("move", aim)
    if (turns and not mini_turn) or (not within and flags["beyond_reach"] == "hold"):
        return macro, ("hold", q[3:])
    aim[0] = R.T @ r
    if not within:
        aim[0] *= reach / np.linalg.norm(r)
    elif full:
        aim[1] = R.T @ (reference[1] - velocity - np.cross(spin, r))
    return macro, ("move", aim)


def assert_told_alike(riding, flags, generator):
    controller = riding.controller.model_copy(update=flags)
    loops = CONTROLLERS.build(controller, riding.arm)
    for time, near in itertools.product((0.0, 0.013), (0.05, 0.4)):
        q, dq = generator.uniform(-1.0, 1.0, (2, 6))
        base = StageBase(riding.arm, 1, flags["wrist_rotation"] == "parallel")
        base.update(q, dq)
        direction = generator.normal(size=3)
        reference = generator.uniform(-1.0, 1.0, (3, 3))
        reference[0] = base.position + near * direction / np.linalg.norm(direction)
        both = expected(flags, riding.arm, base, controller.reach, time, q, reference)
        for loop, (action, what) in zip(loops, both, strict=True):
            loop.controller.reset()
            loop.controller._law = law = Recorder()
            loop.controller.torque(time, q, dq, reference)
            assert law.told[0] == action, flags
            np.testing.assert_allclose(law.told[1], what, atol=1e-12, err_msg=str(flags))
        gravity = base.rotation.T @ riding.arm.model.gravity
        np.testing.assert_allclose(law.gravity, gravity, atol=1e-12, err_msg=str(flags))


def test_both_laws_are_asked_for_what_the_options_say(riding):
    for number, flags in enumerate([*SAMPLE, *pairwise(CHOICES)]):
        assert_told_alike(riding, flags, np.random.default_rng(number))


@pytest.mark.slow
def test_both_laws_are_asked_for_what_every_option_says(riding):
    """All cases; each session takes a sample and a pairwise cover."""
    for number, flags in enumerate(EVERY):
        assert_told_alike(riding, flags, np.random.default_rng(number))
