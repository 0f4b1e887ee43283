"""The external wrench from a wrist sensor's reading against statics about the sensor, and Newton's law for the tool."""

import numpy as np
import pytest

from runner.controllers.force.force_reading import ToolCompensation
from runner.sensing.force_torque import IDEAL

MASS, CENTRE, TIP = 0.3, np.array([0.02, -0.01, 0.05]), np.array([0.01, 0.03, 0.12])  # kg, m, m
BIAS = [1.0, -2.0, 0.5, 0.02, 0.01, -0.03]
TURN, HEIGHT, PERIOD = 0.4, 0.025, 0.004  # rad, m, s
PUSH, TWIST = np.array([3.0, -4.0, 2.0]), np.array([0.1, 0.3, -0.2])  # N and N m, along the base's axes


@pytest.fixture(scope="module")
def robot(checked_config):
    tool = f"robot.tool.mass={MASS}", f"robot.tool.centre_of_mass={CENTRE.tolist()}", f"robot.tool.tip={TIP.tolist()}"
    return checked_config("experiment=meca500/weighing", *tool).arm


@pytest.fixture(scope="module")
def postures(robot):
    return robot.home + np.random.default_rng(4).uniform(-1.0, 1.0, (12, 6))


def sensor(bias=BIAS):
    return IDEAL.model_copy(update={"bias": bias, "rotation": TURN, "height": HEIGHT})


def flange_of(robot, q):
    pose = robot.model.frame_poses(q, (robot.flange,))[0]
    return pose[:3, :3], pose[:3, 3]


def reading(robot, q, push=0.0 * PUSH, twist=0.0 * TWIST, on_tool=0.0 * PUSH):
    """Return the sensor's reading under a wrench on the tip and a force on the tool's centre of mass."""
    R, p = flange_of(robot, q)
    c, s = np.cos(TURN), np.sin(TURN)
    axes = R @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    origin, borne = p + HEIGHT * R[:, 2], MASS * robot.model.gravity + on_tool
    moment = twist + np.cross(p + R @ TIP - origin, push) + np.cross(p + R @ CENTRE - origin, borne)
    return np.concatenate([axes.T @ (push + borne), axes.T @ moment]) + BIAS


def test_a_tool_that_nothing_touches_feels_nothing_in_any_posture(robot, postures):
    wrist = ToolCompensation(robot, sensor(), "gravity", PERIOD)
    for q in [*postures, *postures[::-1]]:
        for wrench in wrist.external(q, np.zeros(6), reading(robot, q)):
            np.testing.assert_allclose(wrench, 0.0, atol=1e-12)


def test_a_push_on_the_tip_is_itself_there_and_has_its_lever_at_the_flange(robot, postures):
    wrist = ToolCompensation(robot, sensor(), "gravity", PERIOD)
    for q in postures:
        at_tip, at_flange = wrist.external(q, np.zeros(6), reading(robot, q, PUSH, TWIST))
        R, _ = flange_of(robot, q)
        np.testing.assert_allclose(at_tip, [*PUSH, *TWIST], atol=1e-12)
        np.testing.assert_allclose(at_flange, [*PUSH, *(TWIST + np.cross(R @ TIP, PUSH))], atol=1e-12)


def test_without_compensation_bias_and_weight_stay(robot, postures):
    wrist, q = ToolCompensation(robot, sensor(), "none", PERIOD), postures[0]
    R, _ = flange_of(robot, q)
    at_tip, _ = wrist.external(q, np.zeros(6), reading(robot, q) - BIAS)
    np.testing.assert_allclose(at_tip[:3], MASS * robot.model.gravity, atol=1e-12)
    np.testing.assert_allclose(at_tip[3:], np.cross(R @ (CENTRE - TIP), MASS * robot.model.gravity), atol=1e-12)
    biased = ToolCompensation(robot, sensor([10.0, 0.0, 0.0, 0.0, 0.0, 0.0]), "none", PERIOD)
    np.testing.assert_array_equal(biased.external(q, np.zeros(6), reading(robot, q)),
                                  wrist.external(q, np.zeros(6), reading(robot, q)))  # fmt: skip


def test_the_tool_s_inertia_is_that_of_the_difference_of_two_velocities(robot, postures):
    """Arms that stop: dq is 0 at the second reading, so that no term is in the square of the speeds."""
    wrist = ToolCompensation(robot, sensor(), "gravity_and_inertia", PERIOD)
    for q, dq in zip(postures, 0.1 * postures[::-1], strict=True):
        wrist.reset()
        wrist.external(q, dq, reading(robot, q))
        ddq, h = -dq / PERIOD, 1e-6
        (before, from_), (after, to) = (flange_of(robot, q + way * h * ddq) for way in (-1, 1))
        centre = (to + after @ CENTRE - from_ - before @ CENTRE) / (2.0 * h)
        at_tip, _ = wrist.external(q, 0.0 * dq, reading(robot, q, on_tool=-MASS * centre))
        np.testing.assert_allclose(at_tip[:3], 0.0, atol=1e-6 * np.abs(MASS * centre).max())
        assert np.abs(MASS * centre).max() > 0.1


@pytest.mark.parametrize("forgets", [True, False])
def test_the_velocity_before_is_forgotten_at_a_reset_alone(robot, postures, forgets):
    wrist, q = ToolCompensation(robot, sensor(), "gravity_and_inertia", PERIOD), postures[0]
    wrist.external(q, np.ones(6), reading(robot, q))
    if forgets:
        wrist.reset()
    at_tip, _ = wrist.external(q, np.zeros(6), reading(robot, q))
    assert np.allclose(at_tip, 0.0, atol=1e-12) == forgets
