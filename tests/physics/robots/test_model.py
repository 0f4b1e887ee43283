"""Rigid-body model: Jacobians, mass matrix, gravity and energy against differences and the thesis."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support import strangers
from support.arms import model_of

from runner.base.errors import ConfigError
from runner.robots.model import RobotModel

MODELS = {name: model_of(name) for name in ("macro", "mini")}
LENGTH = {"macro": 1.0, "mini": 0.1}
INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
LIMITS = '<limit lower="-9" upper="9" effort="7" velocity="9"/>'

names = st.sampled_from(sorted(MODELS))
postures = st.lists(st.floats(-3.0, 3.0), min_size=3, max_size=3).map(np.array)


def one_joint(kind="revolute", limits=LIMITS, mount="0 0 0"):
    return (
        f'<robot name="one"><link name="base">{INERTIAL}</link><link name="hand">{INERTIAL}</link>'
        f'<joint name="turn" type="{kind}"><parent link="base"/><child link="hand"/><origin xyz="{mount}"/>'
        f'<axis xyz="0 0 1"/>{limits}</joint></robot>'
    )


def gradient(function, q, h):
    """Central differences of a function along each joint, the joint last."""
    return np.stack([(function(q + h * e) - function(q - h * e)) / (2.0 * h) for e in np.eye(3)], axis=-1)


# Kinematics.


@given(names, postures)
def test_the_tip_is_where_the_thesis_puts_it(name, q):
    s1, c1, s2, c2 = np.sin(q[0]), np.cos(q[0]), np.sin(q[1]), np.cos(q[1])
    s23, c23 = np.sin(q[1] + q[2]), np.cos(q[1] + q[2])
    expected = LENGTH[name] * np.array([s1 * (s23 - c2), c1 * (c2 - s23), c23 + s2])
    np.testing.assert_allclose(MODELS[name].tip_position(q), expected, atol=1e-14)


@given(names, postures)
def test_the_linear_jacobian_is_the_gradient_of_the_tip(name, q):
    model = MODELS[name]
    np.testing.assert_allclose(model.tip_jacobian(q)[:3], gradient(model.tip_position, q, 1e-6), atol=1e-9)


@given(names, postures)
def test_the_angular_jacobian_is_the_rate_of_the_tip_s_rotation(name, q):
    model = MODELS[name]
    rotation = model.tip_pose(q)[:3, :3]
    rates = gradient(lambda q: model.tip_pose(q)[:3, :3], q, 1e-6)
    for joint in range(3):
        skew = rates[:, :, joint] @ rotation.T
        omega = [skew[2, 1], skew[0, 2], skew[1, 0]]
        np.testing.assert_allclose(model.tip_jacobian(q)[3:, joint], omega, atol=1e-9)


@given(names, postures, postures)
def test_the_bias_acceleration_is_the_jacobian_s_rate_times_the_speed(name, q, dq):
    model, h = MODELS[name], 1e-6
    rate = (model.tip_jacobian(q + h * dq)[:3] - model.tip_jacobian(q - h * dq)[:3]) / (2.0 * h)
    np.testing.assert_allclose(model.tip_bias_acceleration(q, dq), rate @ dq, atol=3e-8)


@given(names, postures)
def test_poses_agree(name, q):
    model = MODELS[name]
    pose = model.tip_pose(q)
    np.testing.assert_array_equal(pose[:3, 3], model.tip_position(q))
    np.testing.assert_array_equal(model.tip_positions(np.array([q, 0.0 * q]))[0], model.tip_position(q))
    tip, base = model.frame_poses(q, ("tip", "base"))
    np.testing.assert_array_equal(tip, pose)
    np.testing.assert_array_equal(base, np.eye(4))
    np.testing.assert_allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-14)


# Dynamics.


@given(names, postures)
def test_the_mass_matrix_is_symmetric_and_positive(name, q):
    M = MODELS[name].mass_matrix(q)
    np.testing.assert_array_equal(M, M.T)
    lowest = np.linalg.eigvalsh(M)[0]
    folded_or_on_axis = min(abs(np.cos(q[2])), abs(np.cos(q[1]) - np.sin(q[1] + q[2]))) < 0.05
    assert lowest > (-1e-12 if folded_or_on_axis else 1e-6) * LENGTH[name] ** 3


@given(names, postures, postures)
def test_the_mass_matrix_is_the_second_derivative_of_the_kinetic_energy(name, q, dq):
    model = MODELS[name]
    rest = model.energy(q, np.zeros(3))

    def kinetic(speed):
        return model.energy(q, speed) - rest

    scale = LENGTH[name] ** 3
    assert kinetic(dq) == pytest.approx(0.5 * dq @ model.mass_matrix(q) @ dq, abs=1e-12 * scale * 20)
    E = np.eye(3)  # the energy is a quadratic form of the speeds, so that this difference is exact
    second = [[kinetic(a + b) - kinetic(a) - kinetic(b) for a in E] for b in E]
    np.testing.assert_allclose(model.mass_matrix(q), second, atol=1e-12 * scale * 20)


@given(names, postures)
def test_the_gravity_torque_is_the_gradient_of_the_potential(name, q):
    model = MODELS[name]
    slope = gradient(lambda q: np.array(model.energy(q, np.zeros(3))), q, 1e-5)
    np.testing.assert_allclose(model.gravity_torque(q), slope, atol=1e-8 * LENGTH[name] ** 2)


@given(names, postures)
def test_the_gravity_torque_is_the_thesis(name, q):
    c2, s23 = np.cos(q[1]), np.sin(q[1] + q[2])
    expected = LENGTH[name] ** 2 * np.array([0.0, 19.62 * c2 - 9.81 * s23, -9.81 * s23])
    np.testing.assert_allclose(MODELS[name].gravity_torque(q), expected, atol=1e-14)


@given(names, postures, postures)
def test_the_coriolis_torque_does_no_work_of_its_own(name, q, dq):
    # dq' (dM/dt - 2 C) dq = 0: it only moves the kinetic energy that M's change asks for.
    model, h = MODELS[name], 1e-5
    rate = (model.mass_matrix(q + h * dq) - model.mass_matrix(q - h * dq)) / (2.0 * h)
    scale = LENGTH[name] ** 3
    assert dq @ model.coriolis_torque(q, dq) == pytest.approx(0.5 * dq @ rate @ dq, abs=1e-6 * scale)


@given(names, postures, postures, postures)
def test_power_in_is_the_rate_of_the_energy(name, q, dq, tau):
    model, scale = MODELS[name], LENGTH[name] ** 3
    q = np.array([q[0], q[1], 0.4 * q[2]])  # where M is regular
    if abs(np.cos(q[1]) - np.sin(q[1] + q[2])) < 0.2:
        q[1] += 1.0
    tau = scale * tau
    ddq = model.forward_dynamics(q, dq, tau)
    h = 1e-6 / (1.0 + np.abs(ddq).max())
    rate = (
        model.energy(q + h * dq + 0.5 * h**2 * ddq, dq + h * ddq)
        - model.energy(q - h * dq + 0.5 * h**2 * ddq, dq - h * ddq)
    ) / (2.0 * h)
    rounding = 1e-15 * abs(model.energy(np.zeros(3), np.zeros(3)) + 1.0) / h
    assert rate == pytest.approx(tau @ dq, abs=1e-6 * scale + 4.0 * rounding)


@given(names, postures, postures, postures)
def test_forward_dynamics_inverts_the_equation_of_motion(name, q, dq, tau):
    model, scale = MODELS[name], LENGTH[name] ** 3
    q = np.array([q[0], q[1], 0.4 * q[2]])
    if abs(np.cos(q[1]) - np.sin(q[1] + q[2])) < 0.2:
        q[1] += 1.0
    ddq = model.forward_dynamics(q, dq, scale * tau)
    back = model.mass_matrix(q) @ ddq + model.coriolis_torque(q, dq) + model.gravity_torque(q)
    np.testing.assert_allclose(back, scale * tau, atol=1e-10 * scale * (1.0 + np.abs(ddq).max()))


def test_gravity_is_an_argument(macro_urdf):
    q = np.array([0.1, 0.2, 0.3])
    earth, moon, space = (RobotModel(macro_urdf, "tip", gravity) for gravity in (9.81, 1.62, 0.0))
    np.testing.assert_allclose(moon.gravity_torque(q), 1.62 / 9.81 * earth.gravity_torque(q), rtol=1e-12)
    np.testing.assert_array_equal(space.gravity_torque(q), np.zeros(3))
    np.testing.assert_array_equal(space.mass_matrix(q), earth.mass_matrix(q))


def test_results_are_new_arrays():
    model = MODELS["macro"]
    q, dq, tau = np.array([[0.1, 0.2, 0.3], [0.4, 0.5, 0.6], [0.7, 0.8, 0.9]])
    other = -2.0 * q
    methods = {
        "tip_position": (q,),
        "tip_pose": (q,),
        "tip_jacobian": (q,),
        "tip_bias_acceleration": (q, dq),
        "mass_matrix": (q,),
        "gravity_torque": (q,),
        "coriolis_torque": (q, dq),
        "forward_dynamics": (q, dq, tau),
    }
    for name, arguments in methods.items():
        method = getattr(model, name)
        first = method(*arguments)
        kept = first.copy()
        for others in methods.values():
            method(*(other,) * len(arguments))
            getattr(model, next(key for key, value in methods.items() if value is others))(*(other,) * len(others))
        np.testing.assert_array_equal(first, kept, err_msg=name)
        np.testing.assert_array_equal(method(*arguments), kept, err_msg=name)


# Constants.


@pytest.mark.parametrize("name", ["macro", "mini"])
def test_reach_and_shoulder(name):
    assert MODELS[name].reach == pytest.approx(2.0 * LENGTH[name], rel=1e-14)
    np.testing.assert_array_equal(MODELS[name].shoulder, np.zeros(3))


@given(names, postures)
def test_no_posture_is_beyond_the_reach(name, q):
    model = MODELS[name]
    assert np.linalg.norm(model.tip_position(q) - model.shoulder) <= model.reach * (1.0 + 1e-12)


def test_the_reach_counts_from_the_shoulder():
    model = RobotModel(one_joint(mount="0.3 0.4 5"), "hand")
    np.testing.assert_array_equal(model.shoulder, [0.3, 0.4, 5.0])
    assert model.reach == 0.0
    np.testing.assert_array_equal(model.effort_limits, [7.0])


def test_another_tip_is_another_place_and_reach(checked_config):
    arm = checked_config("robot=combined").arm
    base = str(arm.stages[1].base_frame)
    whole = arm.model.reach
    moved, q = arm.model.with_tip(base), np.array([0.3, -0.5, 0.7, 0.2, -0.4, 0.9])
    np.testing.assert_array_equal(moved.tip_pose(q), arm.model.frame_poses(q, (base,))[0])
    assert (moved.tip_name, moved.nq) == (base, 6)
    assert (arm.model.reach, arm.model.tip_name) == (whole, "mini_tip")
    assert moved.reach != whole


def test_limits_are_read():
    limits = '<limit lower="-0.5" upper="2" effort="3" velocity="4"/>'
    model = RobotModel(one_joint(limits=limits), "hand")
    np.testing.assert_array_equal(model.position_limits, [[-0.5], [2.0]])
    np.testing.assert_array_equal(model.velocity_limits, [4.0])
    np.testing.assert_array_equal(model.effort_limits, [3.0])


@pytest.mark.parametrize(
    ("lower", "upper", "usual"),
    [(-0.5, 9.0, (-0.5, np.pi)), (-1e6, 1e6, (-np.pi, np.pi)), (5.0, 6.0, (5.0, 6.0)),
     (5.0, 1e6, (5.0, 5.0 + 2.0 * np.pi)), (-1e6, -5.0, (-5.0 - 2.0 * np.pi, -5.0))],
)  # fmt: skip
def test_the_usual_range_is_finite_and_at_most_a_turn_without_limits(lower, upper, usual):
    limits = f'<limit lower="{lower}" upper="{upper}" effort="3" velocity="4"/>'
    found = RobotModel(one_joint(limits=limits), "hand").usual_range
    np.testing.assert_array_equal(found[:, 0], usual)


def test_a_million_and_more_is_no_limit():
    limits = '<limit lower="-1e6" upper="2e7" effort="1e6" velocity="1e9"/>'
    model = RobotModel(one_joint(limits=limits), "hand")
    np.testing.assert_array_equal(model.position_limits, [[-np.inf], [np.inf]])
    np.testing.assert_array_equal([model.velocity_limits, model.effort_limits], np.inf)
    np.testing.assert_array_equal(model.limit_margins(np.array([5.0])), [np.inf])


def test_margins_count_to_the_nearer_limit():
    model = RobotModel(one_joint(limits='<limit lower="-0.5" upper="2" effort="3" velocity="4"/>'), "hand")
    np.testing.assert_array_equal(
        model.limit_margins(np.array([[0.0], [1.5], [2.5], [-1.0]])), [[0.5], [0.5], [-0.5], [-0.5]]
    )


def test_joint_names(macro):
    assert macro.joint_names == ("q1", "q2", "q3")
    assert macro.nq == 3


# Refused input.


@pytest.mark.parametrize("kind", ["continuous", "floating"])
def test_only_joints_that_turn_or_slide_within_limits(kind):
    allowed = r"allowed: revolute \(with wide limits\) or prismatic"
    with pytest.raises(ConfigError, match=rf"joint 'turn' has another type; {allowed}"):
        RobotModel(one_joint(kind), "hand")


def test_a_joint_slides_between_limits_alone():
    endless = '<limit lower="-1e6" upper="1e6" effort="1" velocity="1"/>'
    with pytest.raises(ConfigError, match=r"joint 'turn' slides without limits; give it a <limit> with lower"):
        RobotModel(one_joint("prismatic", endless), "hand")


def test_an_unknown_tip_is_named_with_the_nearest(macro_urdf):
    with pytest.raises(ConfigError, match=r"robot\.tip: no frame 'tpi' \(did you mean tip\?\); frames: .*link3"):
        RobotModel(macro_urdf, "tpi")


@pytest.mark.parametrize("urdf", ["", "no robot", "<robot name='x'/>", "<robot name='x'><link name='a'/>"])
def test_what_pinocchio_cannot_build(urdf):
    with pytest.raises(ConfigError, match=r"robot\.urdf: Pinocchio cannot build it|robot\.tip"):
        RobotModel(urdf, "tip")


def test_a_shape_that_pinocchio_does_not_know_is_no_part_of_a_model(macro_urdf, capfd):
    capsule = "<collision><geometry><capsule radius='0.1' length='1'/></geometry></collision>"
    model = RobotModel(macro_urdf.replace('<link name="link2">', f'<link name="link2">{capsule}'), "tip")
    q = np.array([0.1, 0.2, 0.3])
    np.testing.assert_array_equal(model.mass_matrix(q), RobotModel(macro_urdf, "tip").mass_matrix(q))
    assert capfd.readouterr() == ("", "")


def test_what_pinocchio_says_of_a_body_is_told(macro_urdf, capfd):
    bare = macro_urdf.replace("<inertia ", "<inertial ")
    with pytest.raises(ConfigError, match="Pinocchio does not accept it: Error:   Inertial element must have iner"):
        RobotModel(bare, "tip")
    assert capfd.readouterr() == ("", "")


def test_a_tip_that_is_a_link_and_a_joint_is_refused(macro_urdf):
    with pytest.raises(ConfigError, match=r"robot\.tip: 'tip' is the name of 2 links and joints; rename all but one"):
        RobotModel(macro_urdf.replace('name="q3"', 'name="tip"'), "tip")


def test_the_jacobian_of_one_joint_is_a_column():
    text = strangers.chain("lift", [("prismatic", strangers.Z)])
    arm = RobotModel(text, "tip")
    np.testing.assert_array_equal(arm.tip_jacobian(np.zeros(1)), np.array([[0.0, 0.0, 1.0, 0.0, 0.0, 0.0]]).T)
