"""Control of the whole redundant arm: the law, its null space, and its largest tip speed."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from support import strangers
from support.arms import checked, model_of, tip_numbers
from support.physics import assert_agree, assert_passive, critically_damped, linear_design, torque_of

from runner.base.errors import ConfigError
from runner.controllers.operational_space.operational_space import OperationalSpace
from runner.controllers.operational_space.whole_body import WholeBody, WholeBodyConfig, build
from runner.plants.rk4 import Rk4
from runner.robots.model import RobotModel

COMBINED = checked("robot=combined").arm
MODEL = COMBINED.model
REST = np.array([0.1, -0.2, 0.3, -0.4, 0.5, -0.6])
INERTIAL = '<inertial><mass value="{m}"/><inertia ixx="{m}" ixy="0" ixz="0" iyy="{m}" iyz="0" izz="{m}"/></inertial>'


def config(**changes):
    values = {
        "kind": "whole_body",
        "natural_frequency": 25.0,
        "damping_ratio": 0.8,
        "period": 0.001,
        "gravity_compensation": True,
        "feedforward": True,
        "null_space_frequency": 12.0,
        "max_tip_speed": None,
        "singularity_damping": 0.0,
    }
    return WholeBodyConfig(**(values | changes))


@st.composite
def states(draw):
    """A state of the six joints away from the singular configurations, and a reference."""
    number = st.floats(-1.0, 1.0)
    q = np.array([np.pi * draw(number) for _ in range(6)])
    J = MODEL.tip_jacobian(q)[:3]
    assume(np.linalg.svd(J, compute_uv=False)[-1] > 0.3)
    assume(np.linalg.eigvalsh(MODEL.mass_matrix(q))[0] > 1e-5)
    dq = np.array([2.0 * draw(number) for _ in range(6)])
    reference = np.array([[draw(number) for _ in range(3)] for _ in range(3)]) * [[2.0], [2.0], [10.0]]
    return q, dq, reference


def terms(q, dq):
    M, J = MODEL.mass_matrix(q), MODEL.tip_jacobian(q)[:3]
    M_inverse = np.linalg.inv(M)
    Lambda = np.linalg.inv(J @ M_inverse @ J.T)
    J_bar = M_inverse @ J.T @ Lambda
    return M, J, M_inverse, Lambda, np.eye(6) - J.T @ J_bar.T, MODEL.tip_bias_acceleration(q, dq)


def null_space(q):
    """Joint velocities with the tip at rest, a column for each joint of the Mini."""
    J = MODEL.tip_jacobian(q)[:3]
    return np.vstack([-np.linalg.solve(J[:, :3], J[:, 3:]), np.eye(3)])


Z = null_space(REST)
INERTIA_AT_REST = np.zeros((6, 6))
INERTIA_AT_REST[3:, 3:] = Z.T @ MODEL.mass_matrix(REST) @ Z


def chain(axes, masses=None):
    """A model of joints about given axes, a metre apart."""
    count = len(axes)
    masses = [1.0] * (count + 1) if masses is None else masses
    links = "".join(f'<link name="l{i}">{INERTIAL.format(m=m)}</link>' for i, m in enumerate(masses))
    joints = "".join(
        f'<joint name="j{i}" type="revolute"><parent link="l{i}"/><child link="l{i + 1}"/><origin xyz="0 0 1"/>'
        f'<axis xyz="{axis}"/><limit lower="-9" upper="9" effort="9" velocity="9"/></joint>'
        for i, axis in enumerate(axes)
    )
    return RobotModel(f'<robot name="chain">{links}{joints}</robot>', f"l{count}")


@given(states())
def test_the_law_with_an_explicit_null_space(state):
    q, dq, reference = state
    M, J, _, Lambda, N_T, bias = terms(q, dq)
    h = MODEL.coriolis_torque(q, dq) + MODEL.gravity_torque(q)
    F = linear_design(reference, MODEL.tip_position(q), J @ dq, 25.0, 0.8)
    tau_0 = -2.0 * 12.0 * M @ dq - 12.0**2 * INERTIA_AT_REST @ (q - REST)
    expected = h + J.T @ Lambda @ (F - bias) + N_T @ tau_0
    found = torque_of(WholeBody(MODEL, config(), REST), q, dq, reference)
    assert_agree(found, expected, 1e-9)


@given(states())
def test_the_tip_accelerates_as_asked_whatever_the_null_space_does(state):
    q, dq, reference = state
    _, J, _, _, _, bias = terms(q, dq)
    F = linear_design(reference, MODEL.tip_position(q), J @ dq, 25.0, 0.8)
    for frequency in (0.0, 12.0, 100.0):
        tau = torque_of(WholeBody(MODEL, config(null_space_frequency=frequency), REST), q, dq, reference)
        acceleration = J @ MODEL.forward_dynamics(q, dq, tau) + bias
        assert_agree(acceleration, F, 1e-8, of=np.abs(F).max() + frequency**2 + 1.0)


@given(states())
def test_null_space_torque_causes_no_tip_acceleration(state):
    q, dq, reference = state
    _, J, M_inverse, _, N_T, _ = terms(q, dq)
    with_posture, without = (
        torque_of(WholeBody(MODEL, config(null_space_frequency=frequency), REST), q, dq, reference)
        for frequency in (50.0, 0.0)
    )
    null = with_posture - without
    assert np.abs(null).max() > 1e-3 or np.abs(q - REST).max() < 1e-3
    scale = np.abs(M_inverse @ null).max()
    np.testing.assert_allclose(J @ M_inverse @ null, 0.0, atol=1e-9 * max(scale, 1.0))
    assert_agree(N_T @ null, null, 1e-9, of=with_posture)  # it lies in the null space


@given(states())
def test_without_gravity_compensation_exactly_the_gravity_term_is_missing(state):
    q, dq, reference = state
    full, bare = (
        torque_of(WholeBody(MODEL, config(gravity_compensation=on), REST), q, dq, reference) for on in (True, False)
    )
    assert_agree(full - bare, MODEL.gravity_torque(q), 1e-11, of=[1.0, *full])


@given(states())
def test_without_feedforward_the_desired_derivatives_are_zero(state):
    q, dq, reference = state
    goal = reference.copy()
    goal[1:] = 0.0
    bare = torque_of(WholeBody(MODEL, config(feedforward=False), REST), q, dq, reference)
    expected = torque_of(WholeBody(MODEL, config(), REST), q, dq, goal)
    assert_agree(bare, expected, 1e-12, of=[1.0, *expected])


@pytest.mark.parametrize("name", ["macro", "mini"])
def test_with_three_joints_it_is_operational_space_control(name):
    model = model_of(name)
    scale = 1.0 if name == "macro" else 0.1
    generator, compared = np.random.default_rng(6), 0
    ours = WholeBody(model, config(natural_frequency=30.0 / scale), np.zeros(3))
    theirs = OperationalSpace(model, tip_numbers(30.0 / scale, 0.8, True, True, 0.0))
    while compared < 30:
        q, dq = generator.uniform(-3.0, 3.0, 3), generator.uniform(-3.0, 3.0, 3) / scale
        if np.linalg.svd(model.tip_jacobian(q)[:3], compute_uv=False)[-1] < 0.3 * scale:
            continue
        reference = generator.uniform(-1.0, 1.0, (3, 3)) * np.array([[scale], [1.0], [1.0 / scale]])
        assert_agree(torque_of(ours, q, dq, reference), torque_of(theirs, q, dq, reference), 1e-8)
        compared += 1


# The largest tip speed.


@given(states(), st.floats(0.05, 5.0))
def test_the_approach_saturates_at_the_largest_tip_speed(state, speed):
    q, dq, (x_d, xd_d, xdd_d) = state
    _, J, _, _, _, bias = terms(q, dq)
    k_p, k_v, error = 25.0**2, 2.0 * 0.8 * 25.0, x_d - MODEL.tip_position(q)
    nu = min(1.0, speed * k_v / (k_p * np.linalg.norm(error)))
    F = xdd_d - k_v * (J @ dq - xd_d - nu * k_p / k_v * error)
    controller = WholeBody(MODEL, config(max_tip_speed=speed, null_space_frequency=0.0), REST)
    acceleration = J @ MODEL.forward_dynamics(q, dq, torque_of(controller, q, dq, [x_d, xd_d, xdd_d])) + bias
    assert_agree(acceleration, F, 1e-8, of=np.abs(F).max() + 1.0)


def tip_speed(trace, period):
    return np.linalg.norm(np.diff(trace.tip, axis=0), axis=1).max() / period


@pytest.mark.parametrize("speed", [0.2, 0.5, 1.0])
def test_the_tip_is_never_faster(simulated, speed):
    # Held torques let the tip overshoot V by what the sampling leaves, of first order in the period: here 3e-3 of it.
    trace = simulated(
        "robot=combined",
        "controller=whole_body",
        "plant=rk4",
        "controller.period=1e-4",
        f"controller.max_tip_speed={speed}",
        "trajectory.goal=[0.5,0.7,1.3]",
        "duration=1.2",
    )
    found = tip_speed(trace, 1e-4)
    assert 0.97 * speed < found < 1.003 * speed


def test_a_largest_tip_speed_far_above_has_no_effect(simulated):
    overrides = ("robot=combined", "controller=whole_body", "trajectory.goal=[0.3,0.9,1.2]", "duration=0.5")
    free, limited = (simulated(*overrides, f"controller.max_tip_speed={speed}") for speed in ("null", "100"))
    np.testing.assert_allclose(free.q, limited.q, rtol=0.0, atol=1e-12)  # other code, with other roundings
    assert tip_speed(free, 1e-3) > 1.0


# Postures.


def test_the_mini_s_posture_is_held_at_rest(simulated):
    overrides = ("robot=combined", "controller=whole_body", "trajectory=quintic", "trajectory.goal=[0.3,0.9,1.2]")
    trace = simulated(*overrides, "trajectory.duration=1", "duration=3")
    assert np.abs(trace.error[-1]).max() < 1e-6
    assert np.abs(trace.q[:, 3:]).max() > 0.02
    np.testing.assert_allclose(trace.q[-1, 3:], 0.0, atol=1e-6)
    np.testing.assert_allclose(trace.dq[-1], 0.0, atol=1e-6)
    free = simulated(*overrides, "trajectory.duration=1", "duration=3", "controller.null_space_frequency=0")
    assert np.abs(free.q[-1, 3:]).max() > 0.1


def small_motion(frequency, start, ticks, tick=1e-3):
    """Let the arm go next to its rest posture, its tip commanded to stay; yield joint positions and velocities."""
    controller = WholeBody(MODEL, config(null_space_frequency=frequency), REST)
    reference = np.array([MODEL.tip_position(REST), np.zeros(3), np.zeros(3)])
    plant = Rk4(MODEL, tick, 1)
    plant.reset(REST + start, np.zeros(6))
    for _ in range(ticks):
        yield plant.q.copy(), plant.dq.copy()
        plant.advance(torque_of(controller, plant.q, plant.dq, reference))


@pytest.mark.parametrize("joint", range(3))
def test_beside_rest_each_joint_of_the_mini_returns_critically_damped(joint):
    size, wn, tick = 1e-4, 12.0, 1e-4
    found = np.array([q for q, _ in small_motion(wn, size * Z[:, joint], 3000, tick)]) - REST
    t = np.arange(3000) * tick
    expected = np.outer(critically_damped(t, wn), size * Z[:, joint])
    np.testing.assert_allclose(found, expected, atol=0.01 * size * np.abs(Z).max())


def test_at_rest_the_posture_only_loses_energy():
    # The spring is one: no way through the null space, however wide, gains energy from it.
    start = np.array([0.0, 0.0, 0.0, 0.8, -0.6, 0.7])
    K = 12.0**2 * INERTIA_AT_REST
    energies = []
    for q, dq in small_motion(12.0, start, 3000):
        energies.append(0.5 * dq @ MODEL.mass_matrix(q) @ dq + 0.5 * (q - REST) @ K @ (q - REST))
    settled = np.array(energies[500:])  # once the tip is back, 25 rad/s and 0.5 s
    assert_passive(settled, rounding=1e-9)
    assert settled[-1] < 1e-6 * energies[0]
    np.testing.assert_allclose(q, REST, atol=1e-3)


@pytest.mark.parametrize("damping", [0.0, 0.3])
def test_a_singular_mass_matrix_has_no_answer(damping):
    axes, masses = ["1 0 0", "0 1 0", "1 0 0", "0 1 0"], [1.0, 1.0, 1.0, 1.0, 0.0]
    controller = WholeBody(chain(axes, masses), config(singularity_damping=damping), np.zeros(4))
    with pytest.raises(np.linalg.LinAlgError, match="the mass matrix is singular"):
        torque_of(controller, [0.1, 0.2, 0.3, 0.4], np.zeros(4), np.ones((3, 3)))


def test_a_singular_jacobian_has_no_answer_without_damping():
    upright = chain(["1 0 0", "0 1 0"] * 2)  # stretched, it can neither lengthen nor shorten
    state = np.zeros(4), np.zeros(4), np.ones((3, 3))
    with pytest.raises(np.linalg.LinAlgError, match="the tip's Jacobian is singular"):
        torque_of(WholeBody(upright, config(), np.zeros(4)), *state)
    assert np.isfinite(torque_of(WholeBody(upright, config(singularity_damping=0.3), np.zeros(4)), *state)).all()


@given(states())
def test_damping_has_no_influence_on_a_regular_posture(state):
    q, dq, reference = state
    damped, printed = (
        torque_of(WholeBody(MODEL, config(singularity_damping=damping), REST), q, dq, reference)
        for damping in (0.3, 0.0)
    )
    np.testing.assert_array_equal(damped, printed)  # the smallest singular value is above a tenth of the reach


def test_torques_beside_the_stretched_posture_are_bounded_by_the_damping():
    stretched = np.array([0.3, 0.4, -np.pi / 2, 0.0, 0.0, 0.0])
    stretched[4:] = [np.pi / 2, -np.pi / 2]  # the Mini along link 3
    J = MODEL.tip_jacobian(stretched)[:3]
    assert np.linalg.svd(J, compute_uv=False)[-1] < 1e-9
    reference = np.array([MODEL.tip_position(stretched) * 0.95, np.zeros(3), np.zeros(3)])
    controller = WholeBody(MODEL, config(singularity_damping=0.3), np.zeros(6))
    for offset in (1e-9, 1e-6, 1e-3):
        posture = np.add(stretched, [0.0, 0.0, offset, 0.0, 0.01, 0.0])
        torque = torque_of(controller, posture, np.zeros(6), reference)
        assert np.linalg.norm(torque) < 1e5


# Purity.


@given(states(), st.floats(0.0, 10.0))
def test_the_same_call_gives_the_same_torques(state, time):
    q, dq, reference = state
    controller = WholeBody(MODEL, config(max_tip_speed=0.5), REST)
    first = torque_of(controller, q, dq, reference)
    torque_of(controller, q + 0.1, dq - 0.2, reference + 0.3)
    np.testing.assert_array_equal(torque_of(controller, q, dq, reference, time), first)
    controller.reset()
    np.testing.assert_array_equal(torque_of(controller, q, dq, reference), first)


def test_inputs_are_only_read():
    arrays = REST.copy(), np.ones(6), np.ones((3, 3))
    for array in arrays:
        array.setflags(write=False)
    WholeBody(MODEL, config(max_tip_speed=0.5, singularity_damping=0.3), np.zeros(6)).torque(0.0, *arrays)


def test_the_model_of_others_is_left_alone():
    before = MODEL.gravity_torque(np.zeros(6))
    WholeBody(MODEL, config(gravity_compensation=False), REST)
    np.testing.assert_array_equal(MODEL.gravity_torque(np.zeros(6)), before)


def test_fewer_joints_than_directions_are_refused():
    two = strangers.chain("two", [("revolute", strangers.X), ("revolute", strangers.Y)])
    with pytest.raises(ConfigError, match=r"3 joints or more.*the arm has 2"):
        WholeBody(RobotModel(two, "tip"), config(), np.zeros(2))


def test_build_makes_one_loop_that_rests_at_home():
    (loop,) = build(config(), COMBINED)
    assert (loop.joints, loop.period) == (slice(0, 6), 0.001)
    q, dq, reference = REST, np.ones(6), np.ones((3, 3))
    expected = torque_of(WholeBody(MODEL, config(), np.zeros(6)), q, dq, reference)
    np.testing.assert_array_equal(torque_of(loop.controller, q, dq, reference), expected)
