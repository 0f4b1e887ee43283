"""Admittance control of the Meca500, in free space, under pushes, at a wall and by hand."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.step_response import step_response

from runner.store import open_run

STILL = ("robot=meca500", "trajectory.start=[0.18,0.01,0.06]", "trajectory.goal=[0.18,0.01,0.06]")
PUSH = (*STILL, "environment=push", "environment.start_time=0.1", "duration=1.2")


def turned(model, rows) -> np.ndarray:
    """Return the tip's rotation vector since the first row."""
    first = model.tip_pose(rows[0])[:3, :3]
    return np.array([Rotation.from_matrix(model.tip_pose(q)[:3, :3] @ first.T).as_rotvec() for q in rows])


@pytest.mark.parametrize(
    "load", [[2.0, -1.5, 1.0, 0.0, 0.0, 0.0], *(0.05 * np.eye(6)[axis] for axis in (3, 4, 5))],
    ids=["force", "moment x", "moment y", "moment z"],
)  # fmt: skip
def test_each_axis_answers_a_push_as_its_mass_damper_and_spring(simulated, checked_config, load):
    """Rotations add up only to first order, so each of them has its own run."""
    load = np.array(load)
    axes = np.flatnonzero(load)
    overrides = (*PUSH, f"environment.force={load[:3].tolist()}", f"environment.moment={load[3:].tolist()}")
    trace, config = simulated(*overrides), checked_config(*overrides)
    expected = step_response(config.controller.law, load, np.maximum(trace.t - 0.1, 0.0))[:, axes]
    displaced = np.hstack([trace.tip - trace.tip[0], turned(config.arm.model, trace.q)])
    gaps = np.abs(displaced[:, axes] - expected).max(axis=0)
    assert (gaps < 1e-5 * np.abs(expected).max(axis=0)).all()


def test_a_force_through_the_tip_turns_nothing(simulated, checked_config):
    trace = simulated(*PUSH, "environment.force=[3,-2,4]")
    assert np.abs(turned(checked_config(*PUSH).arm.model, trace.q)).max() < 1e-9
    assert np.abs(trace.contact.felt[:, 3:]).max() < 1e-12


def test_taken_at_the_flange_the_same_force_turns_the_tool(simulated, checked_config):
    trace = simulated(*PUSH, "environment.force=[3,-2,4]", "controller.wrench_frame=flange")
    assert np.abs(turned(checked_config(*PUSH).arm.model, trace.q)).max() > 0.01


def test_a_moving_tool_is_felt_as_nothing_when_it_is_compensated_and_as_itself_when_not(simulated):
    moving = ("robot=meca500", "trajectory=circle", "trajectory.duration=2", "duration=2", "controller.tip_speed=1")
    assert np.abs(simulated(*moving).contact.felt).max() < 1e-9
    weight = simulated(*moving, "controller.compensation=none").contact.felt
    assert weight[1, 2] == pytest.approx(-0.25 * 9.81)  # of the first tick, before the arm yields to it
    gravity_only = simulated(*moving, "controller.compensation=gravity")
    inertial = 0.25 * np.linalg.norm(gravity_only.desired[:, 2], axis=1).max()  # m a of the desired motion
    felt = np.linalg.norm(gravity_only.contact.felt[:, :3], axis=1).max()
    assert 0.5 * inertial < felt < 2.0 * inertial


@pytest.mark.parametrize(
    ("stiffness", "plant", "tolerance"),
    [
        *((stiffness, "kinematic", 1e-6) for stiffness in (1e3, 1e5)),
        pytest.param(1e4, "kinematic", 1e-6, marks=pytest.mark.slow),  # between the other two
        *(pytest.param(stiffness, "bullet", 0.01, marks=pytest.mark.slow) for stiffness in (1e3, 1e4)),
        (1e5, "bullet", 0.01),
    ],
)
def test_at_a_wall_it_reads_the_force_of_the_springs_in_series(simulated, plant, stiffness, tolerance):
    damping = 20.0 if stiffness < 1e5 else 200.0
    wall = ("environment=wall", f"environment.stiffness={stiffness}", f"environment.damping={damping}")
    step = () if plant == "kinematic" else ("plant.step=0.001",)
    trace = simulated(
        "robot=meca500",
        "trajectory.start=[0.18,0.01,0.06]",
        "trajectory.goal=[0.19,0.01,0.06]",
        "controller.damping=[160,160,160,0.8,0.8,0.8]",
        f"plant={plant}",
        *wall,
        *step,
        "duration=3",
    )
    depth = trace.tip[-1, 0] - 0.185
    assert -trace.contact.external[-1, 0] == pytest.approx(stiffness * depth, rel=1e-3)
    assert -trace.contact.felt[-1, 0] == pytest.approx(stiffness * depth, rel=0.01)
    if plant == "kinematic":
        series = 800.0 * stiffness / (800.0 + stiffness)
        assert -trace.contact.felt[-1, 0] == pytest.approx(series * 0.005, rel=tolerance)


def test_guided_by_hand_it_comes_along_and_stays(simulated):
    free = ("controller.stiffness=[0,0,0,8,8,8]", "controller.damping=[20,20,20,0.8,0.8,0.8]")
    trace = simulated(*STILL, *free, "environment=hand_guiding", "duration=6")
    np.testing.assert_allclose(trace.tip[-1] - trace.tip[0], [0.0, 0.05, 0.03], atol=5e-4)


def test_a_push_against_a_joint_limit_stops_the_joint_smoothly_and_is_told(cli, checked_config):
    hard = (
        *STILL,
        "controller.stiffness=[0,0,0,8,8,8]",
        "environment=push",
        "environment.force=[0,0,30]",
        "duration=4",
    )
    ending = cli(*hard)
    assert ending.code == 0
    assert "has held the tool back, first at t =" in ending.err
    trace, model = open_run(ending.folder).trace(), checked_config(*hard).arm.model
    q, dq = (trace[[f"{name}{joint}" for joint in range(1, 7)]].to_numpy() for name in ("q", "dq"))
    assert (q >= model.position_limits[0]).all()
    assert (q <= model.position_limits[1]).all()
    assert (np.abs(dq) <= model.velocity_limits * (1.0 + 1e-9)).all()


def test_a_goal_that_jumps_is_approached_without_a_jump(simulated):
    trace = simulated("robot=meca500")
    speed = np.linalg.norm(np.diff(trace.tip, axis=0), axis=1) / 0.001
    assert speed.max() < 0.1 * 1.01
    assert np.abs(np.diff(speed)).max() < 0.002
    np.testing.assert_allclose(trace.tip[-1], [0.19, 0.05, 0.08], atol=1e-9)


@pytest.mark.parametrize(
    ("overrides", "text"),
    [
        (("robot=macro", "controller=admittance"), "admittance leads the tool's pose, 6 dimensions, and the arm has 3"),
        (("robot=meca500", "controller.mass=[0,1,1,1,1,1]"), "controller.mass: M must be positive definite"),
        (("robot=meca500", "environment=wall", "environment.stiffness=1e7"), "predicted bound:"),
        (("robot=meca500", "wrist_sensor.range=[1,1]"), "wrist_sensor.range"),
    ],
)
def test_bad_input_names_what_is_wrong(cli, overrides, text):
    ending = cli(*overrides)
    assert ending.code == 2
    assert text in ending.err


def test_a_tool_beyond_the_rating_and_an_overloaded_sensor_are_warned_of(cli):
    ending = cli(*STILL, "robot.tool.mass=0.7", "wrist_sensor=mini40", "environment=push", "environment.force=[30,0,0]")
    assert ending.code == 0
    assert "times the 0.5 kg that meca500 is rated for" in ending.err
    assert "beyond the sensor's range of 20 N" in ending.err
