"""A tool on the flange."""

import numpy as np
import pinocchio as pin
import pytest

from runner.base.errors import ConfigError
from runner.robots.model import RobotModel
from runner.robots.mounting import find_tool, holding_wrench, mount_tool
from runner.schema.values import ToolConfig

TOOL = ToolConfig(
    mass=0.25, centre_of_mass=[0.01, 0.0, 0.04], inertia=[2e-4, 2e-4, 3e-5], tip=[0.02, 0.0, 0.1], tip_radius=0.005
)


@pytest.fixture(scope="module")
def bare(checked_config):
    return checked_config("robot=meca500", "robot.tool=null").arm


@pytest.fixture(scope="module")
def equipped(bare):
    return RobotModel(mount_tool(bare.urdf, "flange", TOOL), "tool_tip")


def test_the_tip_lies_where_the_tool_ends(bare, equipped):
    for q in np.random.default_rng(0).uniform(-1.0, 1.0, (20, 6)):
        flange = bare.model.tip_pose(q)
        np.testing.assert_allclose(equipped.tip_position(q), flange[:3, 3] + flange[:3, :3] @ TOOL.tip, atol=1e-12)


def test_the_arm_bears_the_tools_weight_and_inertia(bare, equipped):
    """By virtual work: M and G grow by those of a body at the flange, J^T I J and -J^T m g."""
    body = pin.Inertia(TOOL.mass, np.array(TOOL.centre_of_mass), np.diag(TOOL.inertia))
    for q in np.random.default_rng(1).uniform(-1.0, 1.0, (20, 6)):
        J = pin.computeFrameJacobian(
            bare.model.pin_model, bare.model.pin_model.createData(), q, bare.model.tip_frame, pin.LOCAL
        )
        np.testing.assert_allclose(
            equipped.mass_matrix(q), bare.model.mass_matrix(q) + J.T @ body.matrix() @ J, atol=1e-12
        )
        R = bare.model.tip_pose(q)[:3, :3]
        weight = pin.Force(TOOL.mass * R.T @ [0.0, 0.0, -9.81], np.zeros(3))
        weight.angular = np.cross(TOOL.centre_of_mass, weight.linear)
        np.testing.assert_allclose(
            equipped.gravity_torque(q), bare.model.gravity_torque(q) - J.T @ weight.vector, atol=1e-12
        )


def test_the_holding_wrench_at_rest_is_the_weight_reversed(equipped):
    model, data = equipped.pin_model, equipped.pin_model.createData()
    flange = model.getFrameId("flange")
    for q in np.random.default_rng(2).uniform(-1.0, 1.0, (20, 6)):
        pin.forwardKinematics(model, data, q, np.zeros(6), np.zeros(6))
        R = pin.updateFramePlacement(model, data, flange).rotation
        held = holding_wrench(model, data, flange, find_tool(model, flange), equipped.gravity)
        force = R.T @ [0.0, 0.0, 0.25 * 9.81]
        np.testing.assert_allclose(held, [*force, *np.cross(TOOL.centre_of_mass, force)], atol=1e-12)


def test_the_holding_wrench_in_motion_is_the_rate_of_change_of_momentum(equipped):
    """By finite differences of the tool's linear and angular momentum in the base frame."""
    model, flange = equipped.pin_model, equipped.pin_model.getFrameId("flange")
    generator = np.random.default_rng(3)
    body, h = find_tool(model, flange), 1e-6
    q, dq, ddq = generator.uniform(-1.0, 1.0, (3, 6))

    def momentum(time: float) -> np.ndarray:
        data = model.createData()
        pin.forwardKinematics(model, data, q + time * dq + 0.5 * time**2 * ddq, dq + time * ddq)
        placement = pin.updateFramePlacement(model, data, flange)
        return placement.act(body * pin.getFrameVelocity(model, data, flange)).vector

    data = model.createData()
    pin.forwardKinematics(model, data, q, dq, ddq)
    placement = pin.updateFramePlacement(model, data, flange)
    held = placement.act(pin.Force(holding_wrench(model, data, flange, body, np.zeros(3)))).vector
    np.testing.assert_allclose(held, (momentum(h) - momentum(-h)) / (2.0 * h), atol=1e-8)


def test_a_flange_that_is_no_link_is_refused(bare):
    with pytest.raises(ConfigError, match=r"robot\.tool: the flange 'hand' is not a link"):
        mount_tool(bare.urdf, "hand", TOOL)


@pytest.mark.parametrize("moments", [[1.0, 1e-3, 1e-3], [1e-3, 1e-3, 2.1e-3]])
def test_a_tool_whose_inertia_no_body_has_is_refused(bare, moments):
    with pytest.raises(ConfigError, match=r"robot\.tool\.inertia: principal moments .* no body has one above the sum"):
        mount_tool(bare.urdf, "flange", TOOL.model_copy(update={"inertia": moments}))


@pytest.mark.parametrize("plant", ["bullet", "rk4"])
def test_a_run_with_a_tool_whose_inertia_no_body_has_is_refused(cli, tmp_path, plant):
    overrides = ("controller=computed_torque", "trajectory=line", "duration=0.05", "robot.tool.inertia=[1,0.001,0.001]")
    ending = cli("robot=meca500", f"plant={plant}", *overrides)
    assert ending.code == 2
    assert "  - robot.tool.inertia: principal moments of inertia of 0.001, 0.001, 1 kg m^2" in ending.err
    assert list(tmp_path.iterdir()) == []


def test_two_tools_are_refused(bare):
    with pytest.raises(ConfigError, match=r"robot\.tool: the URDF already has a link 'tool'"):
        mount_tool(mount_tool(bare.urdf, "flange", TOOL), "flange", TOOL)
