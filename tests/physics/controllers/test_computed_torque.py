"""Computed-torque control: its joint motion, its memory, and whole runs."""

import numpy as np
import pytest
from support.arms import checked
from support.covers import covered
from support.physics import assert_order

from runner.base.errors import ConfigError
from runner.controllers.joint_space.computed_torque import ComputedTorque, ComputedTorqueConfig, build

ARMS = {
    name: checked(f"robot={name}", "controller=computed_torque", "trajectory=goal").arm
    for name in ("macro", "mini", "xarm7")
}
XARM7 = ARMS["xarm7"]


def law(name="xarm7", **changes):
    values = {
        "kind": "computed_torque",
        "task": "position",
        "natural_frequency": 30.0,
        "damping_ratio": 1.0,
        "period": 0.01,
        "gravity_compensation": True,
        "feedforward": True,
        "singularity_damping": 0.3,
        "null_space_frequency": 30.0,
        "integral_gain": 0.0,
    }
    return ComputedTorque(ARMS[name].model, ComputedTorqueConfig(**(values | changes)), ARMS[name].home)


def circle(t, centre, radius=0.05, speed=3.0):
    """A circle at constant speed, entered at its own speed."""
    c, s = np.cos(speed * t), np.sin(speed * t)
    position = centre + radius * np.array([c - 1.0, s, 0.0])
    velocity, acceleration = np.array([-s, c, 0.0]) * speed, np.array([-c, -s, 0.0]) * speed**2
    return np.array([position, radius * velocity, radius * acceleration])


def joint_motion(controller, model, q, reference, ticks, period=0.01):
    """Return the joint motion q_d that a controller imagines, and its speed, whatever the arm does."""
    motions = []
    for tick in range(ticks):
        controller.torque(tick * period, q, np.zeros(model.nq), reference(tick * period))
        motions.append(np.split(controller.state, 2))
    return motions


def test_the_joint_motion_leads_the_tip_along_the_reference():
    centre = XARM7.model.tip_position(XARM7.home)
    errors = []
    for period in (0.01, 0.005, 0.0025):
        motions = joint_motion(
            law(period=period), XARM7.model, XARM7.home, lambda t: circle(t, centre), round(4.0 / period), period
        )
        tips = np.array([XARM7.model.tip_position(q) for q, _ in motions])
        expected = np.array([circle((tick + 1) * period, centre)[0] for tick in range(len(motions))])
        errors.append(np.linalg.norm(tips - expected, axis=1)[round(2.0 / period) :].max())  # entered from rest
    assert errors[0] < 1e-4
    assert_order(errors, 1, within=0.13)


def test_nothing_measured_enters_the_joint_motion_but_its_start():
    centre, generator = XARM7.model.tip_position(XARM7.home), np.random.default_rng(1)
    calm, shaken = law(), law()
    for tick in range(50):
        reference = circle(0.01 * tick, centre)
        calm.torque(0.01 * tick, XARM7.home, np.zeros(7), reference)
        disturbed = XARM7.home if tick == 0 else XARM7.home + generator.normal(size=7)
        shaken.torque(0.01 * tick, disturbed, generator.normal(size=7), reference)
    np.testing.assert_array_equal(calm.state, shaken.state)
    other = law()
    other.torque(0.0, XARM7.home + 0.1, np.zeros(7), circle(0.0, centre))
    assert np.abs(other.state[:7] - XARM7.home - 0.1).max() < 0.01


def test_the_joint_motion_ends_where_it_is_nearest_to_home():
    goal = XARM7.model.tip_position(XARM7.home) + np.array([-0.1, 0.1, 0.1])
    reference = np.array([goal, np.zeros(3), np.zeros(3)])
    q, dq = joint_motion(law(), XARM7.model, XARM7.home, lambda t: reference, 300)[-1]
    np.testing.assert_allclose(XARM7.model.tip_position(q), goal, atol=1e-9)
    np.testing.assert_allclose(dq, 0.0, atol=1e-7)
    J = XARM7.model.tip_jacobian(q)[:3]  # then q - home has no part that leaves the tip where it is
    away = q - XARM7.home
    np.testing.assert_allclose(away - np.linalg.pinv(J) @ J @ away, 0.0, atol=1e-7)
    assert np.abs(away).max() > 0.05


def test_the_integral_holds_what_the_model_does_not_know(simulated):
    command = "robot=macro", "controller=computed_torque", "controller.gravity_compensation=false", "duration=6"
    sagging, held = (simulated(*command, f"controller.integral_gain={gain}") for gain in (0.0, 2000.0))
    assert np.abs(sagging.error[-1]).max() > 1e-3
    np.testing.assert_allclose(held.error[-1], 0.0, atol=1e-7)
    np.testing.assert_allclose(held.tau[-1], ARMS["macro"].model.gravity_torque(held.q[-1]), atol=1e-4)


def test_the_integral_sums_the_joint_errors_tick_by_tick():
    goal = np.array([XARM7.model.tip_position(XARM7.home), np.zeros(3), np.zeros(3)])
    plain, ours = law(), law(integral_gain=500.0)
    q, off = XARM7.home, np.full(7, 0.01)
    for controller in (plain, ours):
        controller.torque(0.0, q, np.zeros(7), goal)
        controller.torque(0.01, q - off, np.zeros(7), goal)
    more = ours.torque(0.02, q, np.zeros(7), goal) - plain.torque(0.02, q, np.zeros(7), goal)
    np.testing.assert_allclose(more, XARM7.model.mass_matrix(q) @ (500.0 * 0.01 * off), rtol=1e-6)
    ours.reset()
    again = law(integral_gain=500.0).torque(0.0, q, np.zeros(7), goal)
    np.testing.assert_array_equal(ours.torque(0.0, q, np.zeros(7), goal), again)


def test_inputs_are_only_read():
    arrays = XARM7.home.copy(), np.ones(7), np.ones((3, 3))
    for array in arrays:
        array.setflags(write=False)
    controller = law()
    controller.torque(0.0, *arrays)
    controller.torque(0.01, *arrays)


def test_a_singular_posture_has_no_answer_without_damping():
    stretched = np.array([0.0, 0.0, np.pi / 2])  # folded, the tip on the base axis
    reference = np.array([[0.1, 0.2, 0.3], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    with pytest.raises(np.linalg.LinAlgError, match="the tip's Jacobian is singular"):
        law("macro", singularity_damping=0.0).torque(0.0, stretched, np.zeros(3), reference)
    assert np.isfinite(law("macro").torque(0.0, stretched, np.zeros(3), reference)).all()


def test_a_pose_is_too_much_for_three_joints():
    with pytest.raises(ConfigError, match=r"task: pose has 6 dimensions, and the arm 3 joints \(q1, q2, q3\)"):
        law("macro", task="pose")


def test_build_makes_one_loop_that_commands_every_joint():
    config = checked("robot=macro", "controller=computed_torque").controller
    (loop,) = build(config, ARMS["macro"])
    assert (loop.joints, loop.period) == (slice(0, 3), 0.01)


# Runs


@pytest.mark.parametrize("name", ["macro", "mini"])
def test_a_goal_across_the_base_axis_is_reached(simulated, name):
    trace = simulated(f"robot={name}", "controller=computed_torque", f"duration={2.0 if name == 'macro' else 0.2}")
    assert trace.failure is None
    np.testing.assert_allclose(trace.error[-1], 0.0, atol=1e-9)


@pytest.mark.parametrize(("name", "period", "bound"), [("macro", 0.01, 1.1e-3), ("mini", 0.001, 2e-7)])
def test_a_thesis_arm_s_tracking_error_is_the_sampling_s(simulated, name, period, bound):
    # Of first order in the period, and of the size that operational-space control has: 0.7e-3 and 1.4e-7 m.
    errors = [
        np.abs(
            simulated(
                f"robot={name}",
                "controller=computed_torque",
                "trajectory=quintic",
                "plant=rk4",
                f"controller.period={period / split}",
                "duration=2",
            ).error
        ).max()
        for split in (1, 2)
    ]
    assert errors[0] < bound
    assert_order(errors, 1, within=0.13)


LINE = {"kind": ("operational_space", "computed_torque"), "task": ("position", "pose"), "period": (0.01, 0.004, 0.002)}


@pytest.mark.parametrize("case", covered(LINE))
def test_the_xarm7_tracks_its_line_within_its_limits(simulated, case):
    task, keys = case["task"], (f"controller.task={case['task']}", f"controller.period={case['period']}")
    trace = simulated("robot=xarm7", f"controller={case['kind']}", *keys, "plant=default")
    assert trace.failure is None
    assert np.linalg.norm(trace.error, axis=1).max() < 2e-5  # required: 1e-4
    np.testing.assert_array_less(np.abs(trace.tau).max(axis=0), 0.62 * XARM7.model.effort_limits)
    assert XARM7.model.limit_margins(trace.q).min() > 1.0
    orientations = [XARM7.model.tip_pose(q)[:3, :3] for q in trace.q[:: len(trace.q) // 20]]
    home = XARM7.model.tip_pose(XARM7.home)[:3, :3]
    turned = np.abs(np.array(orientations) - home).max()
    assert (turned < 1e-4) == (task == "pose")


@pytest.mark.parametrize("kind", ["operational_space", "computed_torque"])
def test_the_line_lasts_up_to_a_payload_of_2_9_kg(simulated, kind):
    light, heavy = (
        simulated("robot=xarm7", f"controller={kind}", "plant=default", f"robot.payload.mass={mass}", "duration=5")
        for mass in (2.9, 3.5)
    )
    limits = XARM7.model.effort_limits
    assert np.linalg.norm(light.error, axis=1).max() < 2e-5
    np.testing.assert_array_less(np.abs(light.tau).max(axis=0), limits)
    assert np.abs(heavy.tau[:, 1]).max() == limits[1]
    assert np.linalg.norm(heavy.error, axis=1).max() > 1e-2


@pytest.mark.bullet  # which goes on beyond joint limits
def test_without_a_posture_task_the_arm_drifts_into_a_joint_stop(simulated):
    free, held = (
        simulated(
            "robot=xarm7", "controller=operational_space", "plant=default", f"controller.null_space_frequency={w}"
        )
        for w in (0.0, 30.0)
    )
    assert XARM7.model.limit_margins(free.q).min() < 0.0
    assert np.abs(held.q[-1] - held.q[0]).max() < 0.02  # after a period it is back
