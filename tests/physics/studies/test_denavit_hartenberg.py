"""Denavit-Hartenberg tables against the thesis and the tip poses of models."""

import numpy as np
import pytest
from support.arms import model_of

from runner.base.errors import ConfigError
from runner.papers.studies.thesis.denavit_hartenberg import denavit_hartenberg, frames, transform
from runner.robots.model import RobotModel

ZERO_INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'


def thesis_arm(name: str) -> RobotModel:
    return model_of(name)


def serial_arm(joints, tip_origin) -> RobotModel:
    """An arm of revolute joints, each given as (xyz, rpy, axis), with a tip frame at (xyz, rpy) on the last link."""

    def numbers(values):
        return " ".join(repr(float(value)) for value in values)

    parts = [f'<link name="link0">{ZERO_INERTIAL}</link>']
    for index, (xyz, rpy, axis) in enumerate(joints, start=1):
        parts.append(
            f'<joint name="q{index}" type="revolute"><parent link="link{index - 1}"/><child link="link{index}"/>'
            f'<origin xyz="{numbers(xyz)}" rpy="{numbers(rpy)}"/><axis xyz="{numbers(axis)}"/>'
            f'<limit lower="-1000" upper="1000" effort="1" velocity="1"/></joint>'
            f'<link name="link{index}">{ZERO_INERTIAL}</link>'
        )
    xyz, rpy = tip_origin
    parts.append(
        f'<joint name="mount" type="fixed"><parent link="link{len(joints)}"/><child link="tip"/>'
        f'<origin xyz="{numbers(xyz)}" rpy="{numbers(rpy)}"/></joint><link name="tip">{ZERO_INERTIAL}</link>'
    )
    return RobotModel(f'<robot name="arm">{"".join(parts)}</robot>', "tip")


def random_arm(generator: np.random.Generator, joints: int) -> RobotModel:
    """Joint 1 about the base's z; then axes along x, y, z or anywhere; a tip that one D-H step from z reaches."""
    directions = [*np.eye(3), generator.normal(size=3)]
    chain = [((0.0, 0.0, generator.uniform()), np.zeros(3), (0.0, 0.0, 1.0))]
    for _ in range(joints - 2):
        axis = directions[generator.integers(4)]
        xyz = generator.uniform(-1.0, 1.0, 3) * generator.integers(0, 2, 3)
        rpy = generator.choice([0.0, np.pi / 2, generator.uniform(-3.0, 3.0)], 3)
        chain.append((xyz, rpy, axis / np.linalg.norm(axis)))
    chain.append((generator.uniform(-1.0, 1.0, 3), generator.uniform(-3.0, 3.0, 3), (0.0, 0.0, 1.0)))
    theta, alpha, a, d = generator.uniform(-1.5, 1.5, 4)
    tip = ((a * np.cos(theta), a * np.sin(theta), d), (alpha, 0.0, theta))  # Rz(theta) Tz(d) Tx(a) Rx(alpha)
    return serial_arm(chain, tip)


def product_error(model: RobotModel, generator: np.random.Generator, samples: int) -> float:
    rows = denavit_hartenberg(model)
    worst = 0.0
    for q in generator.uniform(-np.pi, np.pi, (samples, model.nq)):
        worst = max(worst, float(np.abs(frames(rows, q)[-1] - model.tip_pose(q)).max()))
    return worst


@pytest.mark.parametrize(("name", "L"), [("macro", 1.0), ("mini", 0.1)])
def test_thesis_tables_3_1_and_4_1(name, L):
    rows = denavit_hartenberg(thesis_arm(name))
    values = [(row.theta, row.d, row.a, row.alpha) for row in rows]
    half = np.pi / 2
    np.testing.assert_allclose(values, [(half, 0, 0, half), (0, 0, L, 0), (half, 0, L, half)], rtol=1e-15, atol=0)


@pytest.mark.parametrize("name", ["macro", "mini"])
def test_product_is_the_tip_pose_of_the_thesis_arms(name):
    assert product_error(thesis_arm(name), np.random.default_rng(0), 1000) < 1e-12


@pytest.mark.parametrize("seed", range(20))
def test_product_is_the_tip_pose_of_a_generic_arm(seed):
    generator = np.random.default_rng(seed)
    model = random_arm(generator, joints=3 + seed % 5)
    assert product_error(model, generator, 1000 if seed == 0 else 50) < 1e-12


def test_z_axes_are_the_joint_axes():
    model = random_arm(np.random.default_rng(3), joints=7)
    q = np.random.default_rng(4).uniform(-np.pi, np.pi, 7)
    z = frames(denavit_hartenberg(model), q)[:-1, :3, 2]
    np.testing.assert_allclose(z, model.tip_jacobian(q)[3:].T, atol=1e-12)


def test_parallel_axes_have_no_offset():
    joints = [((0, 0, 0.3), (0, 0, 0), (0, 0, 1)), ((0.5, 0.2, 0.1), (0, 0, 0), (0, 0, 1))]
    rows = denavit_hartenberg(serial_arm(joints, ((1, 0, 0.4), (0, 0, 0))))
    np.testing.assert_allclose([row.d for row in rows], [0.0, 0.8], atol=1e-15)
    np.testing.assert_allclose(rows[0].a, np.hypot(0.5, 0.2), rtol=1e-14)


def test_the_last_axis_may_be_the_tool_axis():
    joints = [((0, 0, 0.3), (0, 0, 0), (0, 0, 1)), ((0.5, 0, 0.1), (0, 0, 0), (1, 0, 0))]
    rows = denavit_hartenberg(serial_arm(joints, ((0.2, 0, 0), (0, np.pi / 2, 0))))
    assert (rows[-1].a, rows[-1].alpha) == pytest.approx((0.0, 0.0), abs=1e-15)


def test_transform_is_the_product_of_its_elementary_steps():
    row = denavit_hartenberg(thesis_arm("macro"))[2]
    q = 0.4
    np.testing.assert_allclose(
        transform(row, q),
        [
            [-np.sin(q), 0, np.cos(q), -np.sin(q)],
            [np.cos(q), 0, np.sin(q), np.cos(q)],
            [0, 1, 0, 0],
            [0, 0, 0, 1],
        ],
        atol=1e-15,
    )


def test_a_tip_frame_out_of_reach_says_how_to_turn_it():
    joints = [((0, 0, 0), (0, 0, 0), (0, 0, 1)), ((0, 0, 1), (0, 0, 0), (1, 0, 0))]
    with pytest.raises(ConfigError, match=r"robot\.tip: .* joint 'q2' at a right angle"):
        denavit_hartenberg(serial_arm(joints, ((0, 1, 0), (0.3, 0.2, 0.1))))


def test_a_first_axis_beside_the_base_axis_is_refused():
    with pytest.raises(ConfigError, match=r"joint 'q1' turns about \[1.0, 0.0, 0.0\]"):
        denavit_hartenberg(serial_arm([((0, 0, 0), (0, 0, 0), (1, 0, 0))] * 2, ((1, 0, 0), (0, 0, 0))))


def test_a_tip_inside_the_chain_is_refused():
    joints = [((0, 0, 0), (0, 0, 0), (0, 0, 1)), ((0, 1, 0), (0, 0, 0), (1, 0, 0))]
    urdf_model = serial_arm(joints, ((1, 0, 0), (0, 0, 0)))
    urdf_model.tip_frame = urdf_model.pin_model.getFrameId("link1")
    with pytest.raises(ConfigError, match="joint q2 does not move the tip"):
        denavit_hartenberg(urdf_model)
