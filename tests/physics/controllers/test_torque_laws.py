"""Torque laws of a tip, on built-in and third-party arms, against their linear design and their model's terms.

A session takes the twelve laws of EACH_SESSION: every law, task and kind of arm. The slow ones take all.
"""

import functools
import itertools

import numpy as np
import pinocchio as pin
import pytest
from scipy.optimize import minimize
from support import strangers
from support.arms import checked
from support.physics import assert_agree, assert_order, critically_damped, linear_design, torque_of

from runner.controllers.joint_space.computed_torque import ComputedTorqueConfig
from runner.controllers.joint_space.computed_torque import build as build_computed_torque
from runner.controllers.operational_space.operational_space import OperationalSpaceConfig
from runner.controllers.operational_space.operational_space import build as build_operational_space
from runner.controllers.operational_space.whole_body import WholeBody, WholeBodyConfig
from runner.controllers.operational_space.whole_body import build as build_whole_body
from runner.plants.rk4 import Rk4
from runner.robots.task_space import task_basis

ROBOTS = ["macro", "mini", "combined", "xarm7", "meca500", "planar"]
# Third-party arms from the doctor: spatial, planar, prismatic, and of 30 joints.
STRANGE = [
    *((name, "position") for name in ("kuka", "franka", "xarm6", "planar_two", "pendulum", "crane", "mixed", "snake")),
    *((name, "pose") for name in ("kuka", "pendulum", "scara", "gantry", "mixed")),
]
REDUNDANT = [
    ("whole_body", "combined", "position"),
    ("operational_space", "xarm7", "position"),
    ("operational_space", "xarm7", "pose"),
    ("operational_space", "meca500", "position"),
    ("operational_space", "kuka", "pose"),
    ("operational_space", "pendulum", "position"),
    ("operational_space", "mixed", "position"),
    ("whole_body", "franka", "position"),
]
TIP_LAWS = [
    *REDUNDANT,
    ("operational_space", "macro", "position"),
    ("operational_space", "mini", "position"),
    ("operational_space", "planar", "position"),
    ("operational_space", "meca500", "pose"),
    *(law for name, task in STRANGE if (law := ("operational_space", name, task)) not in REDUNDANT),
    ("whole_body", "planar_two", "position"),
    ("whole_body", "crane", "position"),
]
JOINT_LAWS = [
    ("computed_torque", name, task)
    for name, task in itertools.product(ROBOTS, ("position", "pose"))
    if task == "position" or name in ("xarm7", "meca500")  # the combined arm's pose is singular at home
] + [("computed_torque", name, task) for name, task in STRANGE]
LAWS = TIP_LAWS + JOINT_LAWS
EACH_SESSION = [
    ("operational_space", "macro", "position"),
    ("operational_space", "planar", "position"),
    ("operational_space", "mixed", "position"),  # sliding and turning, redundant
    ("operational_space", "meca500", "pose"),
    ("operational_space", "xarm7", "pose"),  # redundant
    ("whole_body", "combined", "position"),  # redundant
    ("whole_body", "crane", "position"),  # sliding
    ("whole_body", "planar_two", "position"),
    ("computed_torque", "mini", "position"),
    ("computed_torque", "planar", "position"),
    ("computed_torque", "xarm7", "pose"),  # redundant
    ("computed_torque", "scara", "pose"),  # sliding, with one direction less than a pose
]
XI, OMEGA_N = 0.8, 12.0


@functools.cache
def arm_of(name):
    if name in strangers.STRANGERS:
        return strangers.config(name).arm
    controller = "whole_body" if name == "combined" else "operational_space"
    return checked(f"robot={name}", f"controller={controller}", "trajectory=goal").arm


def scale_of(name):
    """Length of the arm against the Macro's; its speeds are as much higher."""
    return arm_of(name).model.reach / 2.0


def omega_of(name):
    return 25.0 / scale_of(name)


def of(laws):
    """Return laws as parameters of a test; those that a session leaves out are slow."""
    assert any(law in EACH_SESSION for law in laws)
    return pytest.mark.parametrize(
        ("kind", "name", "task"),
        [pytest.param(*law, id="-".join(law), marks=() if law in EACH_SESSION else pytest.mark.slow) for law in laws],
    )


def law(kind, name, task, **changes):
    values = {
        "natural_frequency": omega_of(name),
        "damping_ratio": XI,
        "period": 1e-3,
        "gravity_compensation": True,
        "feedforward": True,
        "singularity_damping": 0.0,
        "null_space_frequency": OMEGA_N,
    } | changes
    if kind == "whole_body":
        (loop,) = build_whole_body(WholeBodyConfig(kind=kind, max_tip_speed=None, **values), arm_of(name))
    elif kind == "operational_space":
        (loop,) = build_operational_space(OperationalSpaceConfig(kind=kind, task=task, **values), arm_of(name))
    else:
        (loop,) = build_computed_torque(
            ComputedTorqueConfig(kind=kind, task=task, integral_gain=0.0, **values), arm_of(name)
        )
    assert loop.joints == slice(0, arm_of(name).model.nq)
    return loop.controller


@functools.cache
def directions(name, task):
    return task_basis(arm_of(name).model, task == "pose")


def jacobian(name, task, q):
    return directions(name, task) @ arm_of(name).model.tip_jacobian(q)[: 3 if task == "position" else 6]


def in_lengths(name, task, J):
    return np.where(directions(name, task)[:, :3].any(axis=1), 1.0, arm_of(name).model.reach)[:, None] * J


def smallest(name, task, q):
    return np.linalg.svd(in_lengths(name, task, jacobian(name, task, q)), compute_uv=False)[-1]


def bias(name, task, q, dq):
    """dJ/dt dq by differences of J along dq."""
    h = 1e-6
    return (jacobian(name, task, q + h * dq) - jacobian(name, task, q - h * dq)) @ dq / (2.0 * h)


def states(name, task, count=12):
    """States around home, away from the singular configurations, with references, in the arm's own units."""
    arm, s = arm_of(name), scale_of(name)
    generator, found = np.random.default_rng(4), []
    regular = min(0.15 * arm.model.reach, 0.5 * smallest(name, task, arm.home))
    while len(found) < count:
        q = arm.home + generator.uniform(-0.7, 0.7, arm.model.nq)
        if smallest(name, task, q) < regular:
            continue
        dq = generator.uniform(-1.0, 1.0, arm.model.nq) / s
        reference = generator.uniform(-1.0, 1.0, (3, 3)) * np.array([[s], [1.0], [5.0 / s]])
        found.append((q, dq, reference + np.array([arm.model.tip_position(q), np.zeros(3), np.zeros(3)])))
    return found


def asked_acceleration(name, task, q, dq, reference, feedforward=True):
    """F*, only from the reference and the state."""
    arm, wn = arm_of(name), omega_of(name)
    pose, velocity = arm.model.tip_pose(q), jacobian(name, task, q) @ dq
    desired = reference * np.array([[1.0], [feedforward], [feedforward]])
    F = linear_design(desired, pose[:3, 3], np.zeros(3), wn, XI)
    if task == "pose":
        turn = pin.log3(arm.model.tip_pose(arm.home)[:3, :3] @ pose[:3, :3].T)
        F = np.concatenate([F, wn**2 * turn])
    return directions(name, task) @ F - 2.0 * XI * wn * velocity


def ask(controller, q, dq, reference):
    controller.reset()
    return torque_of(controller, q, dq, reference)


# The error's dynamics


@pytest.mark.parametrize("feedforward", [True, False])
@of(TIP_LAWS)
def test_the_tip_s_error_obeys_the_linear_design(kind, name, task, feedforward):
    controller = law(kind, name, task, feedforward=feedforward)
    for q, dq, reference in states(name, task):
        ddq = arm_of(name).model.forward_dynamics(q, dq, ask(controller, q, dq, reference))
        found = jacobian(name, task, q) @ ddq + bias(name, task, q, dq)
        assert_agree(found, asked_acceleration(name, task, q, dq, reference, feedforward), 1e-6)  # of the differences


@of(JOINT_LAWS)
def test_each_joint_s_error_obeys_the_linear_design(kind, name, task):
    # The rest of the joints' acceleration without feedback is the joint motion's, whatever is measured.
    k_v, k_p = 2.0 * XI * omega_of(name), omega_of(name) ** 2
    controller, start = law(kind, name, task), states(name, task, 1)[0]

    def driven(q, dq):
        ask(controller, *start)  # the joint motion starts alike each time
        ddq = arm_of(name).model.forward_dynamics(q, dq, controller.torque(1e-3, q, dq, start[2]))
        return ddq + k_v * dq + k_p * q

    expected = driven(start[0], np.zeros(len(start[0])))
    for q, dq, _ in states(name, task):
        assert_agree(driven(q, dq), expected, 1e-9)


@pytest.mark.parametrize("feedforward", [True, False])
@of(JOINT_LAWS)
def test_the_joint_motion_starts_with_the_tip_s_linear_design(kind, name, task, feedforward):
    controller = law(kind, name, task, feedforward=feedforward)
    for q, _, reference in states(name, task):
        rest = np.zeros(len(q))
        ddq = arm_of(name).model.forward_dynamics(q, rest, ask(controller, q, rest, reference))
        assert_agree(
            jacobian(name, task, q) @ ddq, asked_acceleration(name, task, q, rest, reference, feedforward), 1e-9
        )


# The null space


@of([*REDUNDANT, *(law for law in JOINT_LAWS if law[1] == "xarm7")])
def test_null_space_torques_do_not_move_the_tip(kind, name, task):
    model = arm_of(name).model
    for q, dq, reference in states(name, task):
        with_posture, without = (
            ask(law(kind, name, task, null_space_frequency=frequency), q, dq, reference) for frequency in (50.0, 0.0)
        )
        null, J = with_posture - without, jacobian(name, task, q)
        M_inverse = np.linalg.inv(model.mass_matrix(q))
        felt = np.linalg.norm(J, 2) * np.linalg.norm(M_inverse, 2)
        assert np.linalg.norm(null) > 1e-3 * np.linalg.norm(with_posture)
        np.testing.assert_allclose(J @ M_inverse @ null, 0.0, atol=1e-12 * felt * np.linalg.norm(with_posture))


@of(REDUNDANT)
def test_the_projector_is_dynamically_consistent(kind, name, task):
    for q, _, _ in states(name, task):
        J, M_inverse = jacobian(name, task, q), np.linalg.inv(arm_of(name).model.mass_matrix(q))
        mobility = J @ M_inverse @ J.T
        N_T = np.eye(len(q)) - J.T @ np.linalg.solve(mobility, J @ M_inverse)
        size = np.linalg.norm(J) * np.linalg.norm(M_inverse) * np.linalg.cond(mobility)
        np.testing.assert_allclose(J @ M_inverse @ N_T, 0.0, atol=1e-12 * size)
        # The remainder of the law after h and J^T Lambda (F* - dJ/dt dq) lies in the range of N^T.
        dq, reference = (
            np.zeros(len(q)),
            np.array([arm_of(name).model.tip_position(q) + 0.01, np.zeros(3), np.zeros(3)]),
        )
        F = asked_acceleration(name, task, q, dq, reference)
        task_torque = J.T @ np.linalg.solve(mobility, F) + arm_of(name).model.gravity_torque(q)
        null = ask(law(kind, name, task), q, dq, reference) - task_torque
        assert_agree(N_T @ null, null, 1e-8)


# The model's terms


@of(LAWS)
def test_the_torque_is_the_inverse_dynamics_of_the_acceleration_it_causes(kind, name, task):
    model = arm_of(name).model
    for q, dq, reference in states(name, task, 4):
        tau = ask(law(kind, name, task), q, dq, reference)
        ddq = model.forward_dynamics(q, dq, tau)
        assert_agree(model.mass_matrix(q) @ ddq + model.coriolis_torque(q, dq) + model.gravity_torque(q), tau, 1e-7)


@of(LAWS)
def test_without_gravity_compensation_exactly_the_gravity_term_is_missing(kind, name, task):
    for q, dq, reference in states(name, task, 4):
        full, bare = (ask(law(kind, name, task, gravity_compensation=on), q, dq, reference) for on in (True, False))
        assert_agree(full - bare, arm_of(name).model.gravity_torque(q), 1e-11, of=full)


@of(LAWS)
def test_without_feedforward_the_desired_derivatives_are_zero(kind, name, task):
    for q, dq, reference in states(name, task, 4):
        goal = reference * np.array([[1.0], [0.0], [0.0]])
        bare = ask(law(kind, name, task, feedforward=False), q, dq, reference)
        assert_agree(bare, ask(law(kind, name, task), q, dq, goal), 1e-12)


@of(LAWS)
def test_gravity_off_leaves_the_model_of_others_alone(kind, name, task):
    before = arm_of(name).model.gravity_torque(arm_of(name).home)
    law(kind, name, task, gravity_compensation=False)
    np.testing.assert_array_equal(arm_of(name).model.gravity_torque(arm_of(name).home), before)


# Singular configurations


@functools.cache
def singular_posture(name, task):
    """The nearest posture to home's neighbourhood where the task's Jacobian loses its rank, to 1e-6 of the reach."""

    start = arm_of(name).home + np.linspace(0.05, 0.25, arm_of(name).model.nq)
    found = minimize(
        functools.partial(smallest, name, task),
        start,
        method="Nelder-Mead",
        options={"xatol": 1e-10, "fatol": 1e-12, "maxiter": 20000},
    )
    assert found.fun < 1e-6 * arm_of(name).model.reach
    return found.x


# The stretched combined arm, whose mass matrix is singular, too, is in test_whole_body.
# Prismatic joints are never singular, and the search does not find a singular configuration of 30 joints.
@of([law for law in LAWS[1:] if law[1] not in ("gantry", "snake")])
def test_torques_at_a_singular_posture_are_bounded_by_the_damping_alone(kind, name, task):
    model, q = arm_of(name).model, singular_posture(name, task)
    rows = np.linalg.svd(in_lengths(name, task, jacobian(name, task, q)))[0][:, -1]
    lost = (directions(name, task).T @ rows)[:3]  # the direction that is lost
    reference = np.array([model.tip_position(q) + 0.05 * model.reach * lost, np.zeros(3), np.zeros(3)])
    if np.linalg.norm(lost) < 0.1:  # a turn that is lost; home's orientation is away by one
        reference[0] = model.tip_position(q) + 0.05 * model.reach
    laws = [law(kind, name, task, singularity_damping=damping) for damping in (0.3, 0.0)]
    undamped = 0.0
    for offset in (1e-9, 1e-7, 1e-5):
        beside, rest = q + offset, np.zeros(model.nq)
        M, G = model.mass_matrix(beside), model.gravity_torque(beside)
        # |J^#| <= 1 / (2 lambda), lambda = 0.3 |e| except for the fading, and |F*| = wn^2 |e|: an acceleration.
        posture = OMEGA_N**2 * np.linalg.norm(beside - arm_of(name).home)
        bound = np.linalg.norm(M, 2) * (1.2 * omega_of(name) ** 2 / 0.6 + posture)
        assert np.linalg.norm(ask(laws[0], beside, rest, reference) - G) < bound
        try:
            undamped = max(undamped, np.linalg.norm(ask(laws[1], beside, rest, reference) - G) / bound)
        except np.linalg.LinAlgError:
            undamped = np.inf
    assert undamped > 10.0


# Convergence


@of(LAWS)
def test_a_small_step_follows_the_critically_damped_closed_form(kind, name, task):
    arm, wn = arm_of(name), omega_of(name)
    within = directions(name, "position")  # the plane of a planar arm
    step = 0.01 * arm.model.reach * within.T @ within @ np.array([1.0, -1.0, -1.0])
    reference = np.array([arm.model.tip_position(arm.home) + step, np.zeros(3), np.zeros(3)])

    def deviation(period):
        controller = law(kind, name, task, damping_ratio=1.0, period=period)
        plant, count = Rk4(arm.model, period, 1), round(4.0 / wn / period)
        plant.reset(arm.home, np.zeros(arm.model.nq))
        controller.reset()
        tips = []
        for tick in range(count):
            tips.append(arm.model.tip_position(plant.q))
            plant.advance(controller.torque(tick * period, plant.q, plant.dq, reference))
        t = np.arange(count) * period
        return np.abs(reference[0] - tips - np.outer(critically_damped(t, wn), step)).max()

    deviations = [deviation(period / wn) for period in (0.02, 0.01, 0.005)]
    assert deviations[2] < 0.01 * np.abs(step).max()
    assert_order(deviations, 1, within=0.08)


@pytest.mark.parametrize("kind", ["operational_space", "computed_torque"])
@pytest.mark.parametrize("name", ["xarm7", "meca500"])
def test_a_turned_tip_returns_about_its_axis_critically_damped(kind, name):
    arm, wn, period, angle = arm_of(name), omega_of(name), 0.004 / omega_of(name), 0.3
    q = arm.home.copy()
    q[-1] += angle  # about the tip's own axis, where the tip stays
    reference = np.array([arm.model.tip_position(arm.home), np.zeros(3), np.zeros(3)])
    controller, plant = law(kind, name, "pose", damping_ratio=1.0, period=period), Rk4(arm.model, period, 1)
    plant.reset(q, np.zeros(arm.model.nq))
    controller.reset()
    home, axis = arm.model.tip_pose(arm.home)[:3, :3], arm.model.tip_jacobian(arm.home)[3:, -1]
    for tick in range(round(4.0 / wn / period)):
        turn = pin.log3(arm.model.tip_pose(plant.q)[:3, :3] @ home.T)
        np.testing.assert_allclose(turn, angle * critically_damped(tick * period, wn) * axis, atol=0.01 * angle)
        plant.advance(controller.torque(tick * period, plant.q, plant.dq, reference))
    np.testing.assert_allclose(arm.model.tip_position(plant.q), reference[0], atol=1e-4 * arm.model.reach)


@of([law for law in LAWS if law[1] in ("xarm7", "meca500")])
def test_runs_are_alike_after_a_reset(kind, name, task):
    controller, (q, dq, reference) = law(kind, name, task), states(name, task, 1)[0]

    def run():
        controller.reset()
        return np.array([controller.torque(k * 1e-3, q + 1e-3 * k, dq, reference).copy() for k in range(5)])

    np.testing.assert_array_equal(run(), run())


def test_three_joints_take_the_square_law_and_more_the_whole_body_s():
    assert not isinstance(law("operational_space", "macro", "position"), WholeBody)
    assert isinstance(law("operational_space", "xarm7", "position"), WholeBody)
