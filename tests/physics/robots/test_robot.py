"""Chains of stages: where each one's base and end point are, how they move, and what an arm carries."""

import numpy as np
import pinocchio as pin
import pytest
import yaml

from runner.assembly.assemble import assemble
from runner.assembly.validation import validate
from runner.base.paths import conf_dir
from runner.config.compose.compose import compose
from runner.robots.robot import StageBase, end_points
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_encoders

P = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # from the Mini's base into the Macro's tip frame
TOP = {
    "urdf": "mini.urdf",
    "tip": "tip",
    "home": [0.1, 0.2, 0.3],
    "inertials": None,
    "masses": {"link2": 0.01},
    "armature": 0.0,
    "velocity_limits": {},
    "mount": {"frame": "tip", "translation": [0.0, 0.0, 0.01], "rotation": [np.pi / 2, 0.0, np.pi / 2]},
}


@pytest.fixture(scope="module")
def three(tmp_path_factory):
    """The Macro, the Mini, and a second Mini on top: one YAML of the user's."""
    own = tmp_path_factory.mktemp("own")
    (own / "robot").mkdir()
    content = yaml.safe_load((conf_dir() / "robot" / "combined.yaml").read_text())
    robot = content["robot"]
    for value in robot.values():
        if isinstance(value, dict) and isinstance(value.get("mini"), float):
            value["top"] = value["mini"]
    robot["name"], robot["stages"]["top"] = "three", TOP
    (own / "robot" / "three.yaml").write_text(f"# @package _global_\n{yaml.safe_dump(content, sort_keys=False)}")
    overrides = ["robot=three", "controller.period.top=0.0005", "duration=0.02"]
    return validate(compose(overrides, [own]))


def postures(robot, count=8, seed=0):
    return np.random.default_rng(seed).uniform(-np.pi, np.pi, (count, robot.model.nq))


def test_stages_divide_the_joints(combined):
    assert combined.stage_names == ("macro", "mini")
    assert [stage.joints for stage in combined.stages] == [slice(0, 3), slice(3, 6)]
    assert combined.model.joint_names == ("q1", "q2", "q3", "mini_q1", "mini_q2", "mini_q3")
    np.testing.assert_array_equal(combined.home, np.zeros(6))
    np.testing.assert_allclose(combined.stages[1].home_offset, [0.0, 0.1, 0.1], atol=1e-15)


def test_end_points_are_the_carrier_s_tip_and_the_rest_turned_with_it(combined):
    macro, mini = (stage.model for stage in combined.stages)
    q = postures(combined)
    found = end_points(combined, q)
    assert found.shape == (2, 8, 3)
    for row, (wrist, tip) in zip(q, found.transpose(1, 0, 2), strict=True):
        pose = macro.tip_pose(row[:3])
        np.testing.assert_allclose(wrist, pose[:3, 3], atol=1e-12)
        np.testing.assert_allclose(tip, pose[:3, 3] + pose[:3, :3] @ P @ mini.tip_position(row[3:]), atol=1e-12)


def test_parallel_end_points_are_turned_as_at_home(combined):
    macro, mini = (stage.model for stage in combined.stages)
    q = postures(combined)
    found = end_points(combined, q, ignore_base_rotation=True)
    for row, (wrist, tip) in zip(q, found.transpose(1, 0, 2), strict=True):
        np.testing.assert_allclose(wrist, macro.tip_position(row[:3]), atol=1e-12)
        np.testing.assert_allclose(tip, wrist + mini.tip_position(row[3:]), atol=1e-12)  # R = I at q = 0
    np.testing.assert_allclose(end_points(combined, np.zeros((1, 6)), True), end_points(combined, np.zeros((1, 6))))


def test_one_stage_has_one_end_point(checked_config, macro):
    q = np.random.default_rng(0).uniform(-1.0, 1.0, (4, 3))
    found = end_points(checked_config("robot=macro").arm, q)
    np.testing.assert_array_equal(found, macro.tip_positions(q)[None])


# Bases.


def test_the_base_is_where_the_macro_s_tip_is(combined):
    base = StageBase(combined, 1, ignore_base_rotation=False)
    for q in postures(combined):
        base.update(q, np.zeros(6))
        pose = combined.stages[0].model.tip_pose(q[:3])
        np.testing.assert_allclose(base.position, pose[:3, 3], atol=1e-12)
        np.testing.assert_allclose(base.rotation, pose[:3, :3] @ P, atol=1e-12)
    base.update(np.zeros(6), np.zeros(6))
    np.testing.assert_allclose(base.rotation, np.eye(3), atol=1e-15)


@pytest.mark.parametrize("ignore_base_rotation", [False, True])
def test_the_base_moves_at_the_difference_quotient_of_its_place(combined, ignore_base_rotation):
    base, h = StageBase(combined, 1, ignore_base_rotation), 1e-5
    for q, dq in zip(postures(combined), postures(combined, seed=1), strict=True):
        places = []
        for sign in (-1.0, 1.0):
            base.update(q + sign * h * dq, dq)
            places.append((base.position.copy(), base.rotation.copy()))
        base.update(q, dq)
        linear, angular = base.velocity()
        (before, R_before), (after, R_after) = places
        np.testing.assert_allclose(linear, (after - before) / (2.0 * h), atol=1e-8)
        np.testing.assert_allclose(angular, pin.log3(R_after @ R_before.T) / (2.0 * h), atol=1e-8)
        assert np.linalg.norm(linear) > 0.1
        assert (np.linalg.norm(angular) > 0.1) != ignore_base_rotation


def test_a_parallel_base_keeps_the_orientation_of_home(combined):
    base = StageBase(combined, 1, ignore_base_rotation=True)
    for q in postures(combined):
        base.update(q, q)
        np.testing.assert_allclose(base.rotation, np.eye(3), atol=1e-15)
        np.testing.assert_array_equal(base.velocity()[1], 0.0)


def test_the_base_does_not_depend_on_the_joints_above_it(combined):
    base = StageBase(combined, 1, ignore_base_rotation=False)
    q = postures(combined)[0]
    found = []
    for own in (q, np.concatenate([q[:3], [3.0, -2.0, 1.0]])):
        base.update(own, own)
        found.append((base.position.copy(), base.rotation.copy(), base.velocity()[0].copy()))
    for one, other in zip(*found, strict=True):
        np.testing.assert_array_equal(one, other)


# Three stages.


def test_a_third_stage_is_one_more_entry_in_the_yaml(three, mini):
    robot = three.arm
    assert robot.stage_names == ("macro", "mini", "top")
    assert robot.model.nq == 9
    assert robot.model.joint_names[6:] == ("top_q1", "top_q2", "top_q3")
    assert robot.stages[2].base_frame == "top_base"
    np.testing.assert_array_equal(robot.home[6:], [0.1, 0.2, 0.3])
    step = np.eye(4)
    step[:3, :3], step[:3, 3] = P, [0.0, 0.0, 0.01]
    for q in postures(robot):
        pose = robot.stages[0].model.tip_pose(q[:3])
        for joints, mounting in ((slice(3, 6), None), (slice(6, 9), step)):
            place = np.block([[P, np.zeros((3, 1))], [np.zeros((1, 3)), 1.0]]) if mounting is None else mounting
            pose = pose @ place @ mini.tip_pose(q[joints])
        np.testing.assert_allclose(robot.model.tip_pose(q), pose, atol=1e-12)
        points = end_points(robot, q[None])[:, 0]
        np.testing.assert_allclose(points[-1], pose[:3, 3], atol=1e-12)
        middle = robot.model.frame_poses(q, ("top_base",))[0]
        np.testing.assert_allclose(points[1], middle[:3, 3], atol=1e-12)
    assert robot.model.mass == pytest.approx(2.2 + 0.01 + 0.1)


def test_three_stages_run(three):
    loop = assemble(three)
    try:
        trace = simulate(loop, make_encoders(loop, three.noise, three.settings.seed, 0))
    finally:
        loop.plant.close()
    assert trace.failure is None
    assert trace.q.shape == (41, 9)
    assert len(loop.loops) == 3


# Payload.


@pytest.mark.parametrize("mass", [0.2, 5.0])
def test_a_payload_is_a_point_mass_at_the_tip(macro, mass):
    loaded, g = macro.with_payload(mass), macro.gravity
    for q in np.random.default_rng(0).uniform(-2.0, 2.0, (6, 3)):
        J = macro.tip_jacobian(q)[:3]
        np.testing.assert_allclose(loaded.mass_matrix(q), macro.mass_matrix(q) + mass * J.T @ J, atol=1e-12)
        np.testing.assert_allclose(loaded.gravity_torque(q), macro.gravity_torque(q) - mass * J.T @ g, atol=1e-12)
        dq = q[::-1].copy()
        added = mass * J.T @ macro.tip_bias_acceleration(q, dq)
        np.testing.assert_allclose(loaded.coriolis_torque(q, dq), macro.coriolis_torque(q, dq) + added, atol=1e-11)
        np.testing.assert_array_equal(loaded.tip_position(q), macro.tip_position(q))
    assert loaded.mass == pytest.approx(macro.mass + mass)


def test_a_payload_leaves_the_arm_itself_alone(macro):
    before = macro.mass_matrix(np.ones(3)), macro.mass
    macro.with_payload(3.0).mass_matrix(np.zeros(3))
    np.testing.assert_array_equal(macro.mass_matrix(np.ones(3)), before[0])
    assert macro.mass == before[1]
