"""Reaction of engines in the tool's mount against the tool's own balance."""

import numpy as np
import pinocchio as pin
import pytest

from runner.assembly.assemble import assemble
from runner.plants import PLANTS
from runner.robots.mounting import find_tool, holding_wrench

ORIENTATIONS = 100
WEIGHT = 0.25 * 9.81  # N, of the tool


@pytest.fixture(scope="module", params=["bullet", "mujoco"])
def arm(checked_config, request):
    """A Meca500 under torque control, with what loads its sensor."""
    loop = assemble(checked_config("experiment=meca500/weighing", f"plant={request.param}"))
    yield loop
    loop.plant.close()


def test_at_rest_in_100_orientations_the_tool_is_weighed_exactly(arm):
    model, plant, interaction = arm.robot.model, arm.plant, arm.interaction
    lower, upper = np.clip(model.position_limits, -np.pi, np.pi)
    directions = []
    for q in np.random.default_rng(1).uniform(lower, upper, (ORIENTATIONS, 6)):
        plant.reset(q, np.zeros(6))
        interaction.reset(q)
        plant.advance(model.gravity_torque(q))
        interaction.update(0.0, plant.q, plant.dq, plant.contact_wrench())
        reaction = interaction.to_flange_axes(plant.tool_reaction())
        np.testing.assert_allclose(reaction, interaction.load, atol=1e-9)
        assert np.linalg.norm(reaction[:3]) == pytest.approx(WEIGHT, abs=1e-9)
        directions.append(reaction[:3] / WEIGHT)
    assert np.linalg.matrix_rank(np.array(directions), tol=1.0) == 3  # they are spread over all directions


def test_sign_and_moment_are_those_of_the_tool_on_the_flange(arm):
    model, plant, interaction = arm.robot.model, arm.plant, arm.interaction
    q = arm.robot.home
    plant.reset(q, np.zeros(6))
    interaction.reset(q)
    plant.advance(model.gravity_torque(q))
    force = plant.tool_reaction()[:3]  # along the base's axes: the tool pulls down
    np.testing.assert_allclose(force, [0.0, 0.0, -WEIGHT], atol=1e-9)
    flange = model.frame_poses(q, ("flange",))[0]
    lever = flange[:3, :3] @ [0.01, 0.0, 0.04]
    np.testing.assert_allclose(plant.tool_reaction()[3:], np.cross(lever, force), atol=1e-9)


def test_in_motion_mujoco_s_reaction_is_the_tool_s_balance_at_the_beginning_of_the_step(checked_config):
    config = checked_config("experiment=meca500/weighing", "plant=mujoco")
    arm, plant = config.arm, PLANTS.build(config.plant, config.arm, 1e-5, 1)
    draw = np.random.default_rng(2)
    model = arm.model.pin_model
    data, flange = model.createData(), model.getFrameId(arm.flange)
    tool = find_tool(model, flange)
    for q, dq, tau in draw.uniform(-0.5, 0.5, (20, 3, 6)) * [[1.0], [6.0], [4.0]]:
        plant.reset(q, dq)
        plant.advance(tau)
        pin.forwardKinematics(model, data, q, dq, arm.model.forward_dynamics(q, dq, tau))
        pose = pin.updateFramePlacement(model, data, flange)
        held = pin.Force(holding_wrench(model, data, flange, tool, arm.model.gravity))
        expected = -np.concatenate([pose.rotation @ held.linear, pose.rotation @ held.angular])
        np.testing.assert_allclose(plant.tool_reaction(), expected, rtol=1e-9, atol=1e-9)
