"""Operational space control of three joints: its equations, the linear error, singular configurations and purity."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq
from support.arms import model_of, tip_numbers, urdf_of
from support.physics import (
    assert_agree,
    assert_linear_design,
    assert_order,
    critically_damped,
    linear_design,
    torque_of,
)

from runner.base.errors import ConfigError
from runner.controllers.operational_space.operational_space import OperationalSpace, OperationalSpaceConfig, build
from runner.robots.model import RobotModel

REST = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
MODELS = {name: model_of(name) for name in ("macro", "mini")}
SCALE = {"macro": 1.0, "mini": 0.1}
STRETCHED, FOLDED, ON_AXIS = [0.3, 0.4, -np.pi / 2], [0.3, 0.4, np.pi / 2], [0.3, 0.4, np.pi / 2 - 0.8]


def law(name="macro", natural_frequency=None, damping_ratio=1.0, gravity=True, feedforward=True, damping=0.0):
    frequency = 30.0 / SCALE[name] if natural_frequency is None else natural_frequency
    return OperationalSpace(MODELS[name], tip_numbers(frequency, damping_ratio, gravity, feedforward, damping))


def tip_reference(model, q, error):
    """A desired tip at rest, off the present one by an error."""
    return np.array([model.tip_position(np.array(q)) + error, np.zeros(3), np.zeros(3)])


@st.composite
def states(draw, name=None):
    """A state away from the singular configurations, and a reference, in units of the arm's own scale."""
    name = draw(st.sampled_from(sorted(MODELS))) if name is None else name
    number, s = st.floats(-1.0, 1.0), SCALE[name]
    q = np.array([3.0 * draw(number), 3.0 * draw(number), draw(number)])
    if abs(np.cos(q[1]) - np.sin(q[1] + q[2])) < 0.2:  # distance to the base axis, in links
        q[1] += 0.8
    if abs(np.cos(q[1]) - np.sin(q[1] + q[2])) < 0.2:
        q[1] += 0.8
    dq = np.array([draw(number) for _ in range(3)]) * 3.0 / s
    reference = np.array([[draw(number) for _ in range(3)] for _ in range(3)])
    return name, q, dq, reference * np.array([[2.0 * s], [2.0], [10.0 / s]])


@given(states(), st.floats(0.2, 2.0))
def test_the_law_in_operational_space(state, damping_ratio):
    name, q, dq, reference = state
    model, wn = MODELS[name], 25.0 / SCALE[name]
    M, V, G, J = (
        model.mass_matrix(q),
        model.coriolis_torque(q, dq),
        model.gravity_torque(q),
        model.tip_jacobian(q)[:3],
    )
    J_inverse = np.linalg.inv(J)
    Lambda = J_inverse.T @ M @ J_inverse
    mu = J_inverse.T @ V - Lambda @ model.tip_bias_acceleration(q, dq)
    p = J_inverse.T @ G
    F = linear_design(reference, model.tip_position(q), J @ dq, wn, damping_ratio)
    controller = law(name, wn, damping_ratio)
    assert_agree(torque_of(controller, q, dq, reference), J.T @ (Lambda @ F + mu + p), 1e-9)


@given(states())
def test_without_gravity_compensation_exactly_the_gravity_term_is_missing(state):
    name, q, dq, reference = state
    full, bare = torque_of(law(name), q, dq, reference), torque_of(law(name, gravity=False), q, dq, reference)
    assert_agree(full - bare, MODELS[name].gravity_torque(q), 1e-12, of=[1.0, *full])  # J^T p = J^T J^-T G


def test_leaving_out_gravity_leaves_the_model_of_others_alone(macro):
    before = macro.gravity_torque(np.zeros(3))
    OperationalSpace(macro, tip_numbers(30.0, 1.0, False, True, 0.0))
    np.testing.assert_array_equal(macro.gravity_torque(np.zeros(3)), before)
    assert before[1] == pytest.approx(19.62)


@given(states())
def test_without_feedforward_the_desired_derivatives_are_zero(state):
    name, q, dq, reference = state
    goal = reference.copy()
    goal[1:] = 0.0
    np.testing.assert_array_equal(
        torque_of(law(name, feedforward=False), q, dq, reference), torque_of(law(name), q, dq, goal)
    )


@given(states(), st.floats(0.0, 10.0))
def test_the_same_call_gives_the_same_torques(state, time):
    name, q, dq, reference = state
    controller = law(name, damping=0.3)
    first = torque_of(controller, q, dq, reference)
    torque_of(controller, q + 0.1, dq - 0.2, reference + 0.3)
    np.testing.assert_array_equal(torque_of(controller, q, dq, reference, time), first)
    controller.reset()
    np.testing.assert_array_equal(torque_of(controller, q, dq, reference), first)


def test_inputs_are_only_read():
    arrays = np.array([0.1, 0.2, 0.3]), np.array([0.4, 0.5, 0.6]), np.ones((3, 3))
    for array in arrays:
        array.setflags(write=False)
    law(damping=0.3).torque(0.0, *arrays)


@given(states())
def test_the_closed_loop_is_linear_and_decoupled(state):
    # Eq. (3.34): the tip's acceleration under the law's torques is F* itself, whatever the posture and speed.
    name, q, dq, reference = state
    model, wn = MODELS[name], 30.0 / SCALE[name]
    ddq = model.forward_dynamics(q, dq, torque_of(law(name), q, dq, reference))
    J = model.tip_jacobian(q)[:3]
    found = J @ ddq + model.tip_bias_acceleration(q, dq)
    assert_linear_design(found, reference, model.tip_position(q), J @ dq, wn, 1.0)


@pytest.mark.parametrize(("robot", "scale"), [("macro", 1.0), ("mini", 0.1)])
def test_a_goal_step_follows_the_critically_damped_closed_form(simulated, robot, scale):
    # 0.17 of the arm's link away: only at a tiny period is the sampled loop the continuous one, to first order.
    step, wn = np.array([0.1, -0.1, -0.1]) * scale, 30.0 / scale
    goal = (np.array([0.0, 1.0, 1.0]) * scale + step).tolist()

    def deviation(period):
        trace = simulated(
            f"robot={robot}",
            "plant=rk4",
            f"controller.period={period!r}",
            f"duration={0.3 * scale!r}",
            f"trajectory.goal={goal}".replace(" ", ""),
        )
        closed_form = np.outer(critically_damped(trace.t, wn), step)
        return np.abs(trace.error - closed_form).max() / scale

    deviations = [deviation(scale * period) for period in (4e-4, 2e-4, 1e-4)]
    assert deviations[2] < 1e-4  # of 0.1
    assert_order(deviations, 1, within=0.055)


def test_a_singular_posture_has_no_answer_without_damping():
    q = [0.0, 0.0, np.pi / 2]  # folded, the tip on the base axis, exactly so in floating point
    reference = tip_reference(MODELS["macro"], q, np.array([0.1, 0.2, 0.1]))
    with pytest.raises(np.linalg.LinAlgError, match="singular"):
        torque_of(law(), q, np.zeros(3), reference)
    assert np.isfinite(torque_of(law(damping=0.3), q, np.zeros(3), reference)).all()


@pytest.mark.parametrize("name", ["macro", "mini"])
@pytest.mark.parametrize("q", [STRETCHED, FOLDED, ON_AXIS])
def test_torques_beside_a_singular_posture_are_bounded_by_the_damping(name, q):
    s = SCALE[name]
    error = 0.1 * s * np.array([1.0, -1.0, 1.0])
    reference = tip_reference(MODELS[name], q, error)
    for offset in (0.0, 1e-12, 1e-6, 1e-3):
        posture = np.add(q, [0.0, 0.0, offset])
        torque = torque_of(law(name, damping=0.3), posture, np.zeros(3), reference)
        # |ddq| is at most |F*| / (2 lambda), lambda = 0.3 |e| except for the fading; |F*| = wn^2 |e|.
        inertia = np.linalg.norm(MODELS[name].mass_matrix(posture), 2)
        bound = inertia * 900.0 / s**2 / (2.0 * 0.3) * 1.1
        assert np.linalg.norm(torque - MODELS[name].gravity_torque(posture)) < bound


def test_without_damping_torques_beside_a_singular_posture_are_not_bounded():
    reference = tip_reference(MODELS["macro"], STRETCHED, np.array([0.1, -0.1, 0.1]))
    beside = np.add(STRETCHED, [0.0, 0.0, 1e-9])
    assert np.linalg.norm(torque_of(law(), beside, np.zeros(3), reference)) > 1e9


@given(states())
def test_damping_has_no_influence_on_a_regular_posture(state):
    name, q, dq, reference = state
    model = MODELS[name]
    smallest = np.linalg.svd(model.tip_jacobian(q)[:3], compute_uv=False)[-1]
    # The law fades damping in by a lower bound of the smallest singular value, at a tenth of the reach.
    q = q if smallest > 0.3 * model.reach else np.zeros(3)
    np.testing.assert_array_equal(
        torque_of(law(name, damping=0.3), q, dq, reference), torque_of(law(name), q, dq, reference)
    )


@pytest.mark.parametrize("name", ["macro", "mini"])
@pytest.mark.parametrize("q", [STRETCHED, ON_AXIS])
def test_damping_has_no_influence_where_the_error_is_zero(name, q):
    s, posture = SCALE[name], np.add(q, [0.0, 0.0, 0.02])  # well inside the zone where damping is faded in
    dq = np.array([0.4, -0.3, 0.2]) / s
    reference = tip_reference(MODELS[name], posture, np.zeros(3))
    reference[1:] = [[0.1, 0.2, 0.3], np.array([1.0, 2.0, 3.0]) / s]
    damped, printed = (torque_of(law(name, damping=damping), posture, dq, reference) for damping in (0.3, 0.0))
    assert_agree(damped, printed, 1e-8)
    moved = reference.copy()
    moved[0] += 0.05 * s
    damped, printed = (torque_of(law(name, damping=damping), posture, dq, moved) for damping in (0.3, 0.0))
    assert np.linalg.norm(damped - printed) > 0.5 * np.linalg.norm(printed)


@given(states())
def test_damping_fades_in_without_a_jump(state):
    name, q, dq, reference = state
    model = MODELS[name]

    def margin(q3):
        J = model.tip_jacobian(np.array([q[0], 0.2, q3]))[:3]
        return 2.0 * abs(np.linalg.det(J)) / np.vdot(J, J) - 0.1 * model.reach

    border = brentq(margin, -np.pi / 2, -1.0, xtol=1e-13)
    outside, inside, deep = (
        torque_of(law(name, damping=0.3), [q[0], 0.2, border + d], dq, reference) for d in (1e-9, -1e-9, -0.1)
    )
    assert_agree(inside, outside, 1e-6)
    assert np.abs(deep - torque_of(law(name), [q[0], 0.2, border - 0.1], dq, reference)).max() > 0.0  # it is inside


def test_another_number_of_joints_is_refused():
    links = "".join(f'<link name="l{i}">{REST}</link>' for i in range(5))
    joints = "".join(
        f'<joint name="j{i}" type="revolute"><parent link="l{i}"/><child link="l{i + 1}"/><origin xyz="0 0 1"/>'
        '<axis xyz="1 0 0"/><limit lower="-9" upper="9" effort="9" velocity="9"/></joint>'
        for i in range(4)
    )
    model = RobotModel(f'<robot name="four">{links}{joints}</robot>', "l4")
    with pytest.raises(ConfigError, match=r"3 joints; the arm has 4 \(j0, j1, j2, j3\)"):
        OperationalSpace(model, tip_numbers(30.0, 1.0, True, True, 0.0))


def test_build_passes_every_value_on(one_stage):
    config = OperationalSpaceConfig(
        kind="operational_space",
        task="position",
        natural_frequency=20.0,
        damping_ratio=0.7,
        period=0.01,
        gravity_compensation=False,
        feedforward=False,
        singularity_damping=0.2,
        null_space_frequency=20.0,
    )
    q, dq, reference = np.array([0.1, 0.2, -1.5]), np.array([0.3, 0.2, 0.1]), np.ones((3, 3))
    expected = law("macro", 20.0, 0.7, gravity=False, feedforward=False, damping=0.2)
    robot = one_stage(urdf_of("macro"), MODELS["macro"])
    (loop,) = build(config, robot)
    assert (loop.period, loop.joints) == (0.01, slice(0, 3))
    np.testing.assert_array_equal(torque_of(loop.controller, q, dq, reference), torque_of(expected, q, dq, reference))
