"""Force along a wall's normal, motion along its face."""

import numpy as np
import pytest
from support.physics import critically_damped

from runner.controllers.stability import force_loop_limit
from runner.sweeps.job import run

POSTURE = "[0.3,0.4,-0.5]"
NORMAL = np.array([0.0, -1.0, 0.0])
TILTED = np.array([0.0, -np.cos(0.5), -np.sin(0.5)])
LAW = ("controller=hybrid_force", "plant=rk4", "environment.distance=0", "environment.damping=0")
ARMS = {
    "macro": ("robot=macro", f"robot.home={POSTURE}", "controller.force=10", "plant.step=1e-3"),
    "mini": ("robot=mini", f"robot.home={POSTURE}", "controller.force=2", "plant.step=2.5e-4"),
    "combined": (
        "robot=combined",
        f"robot.stages.macro.home={POSTURE}",
        f"robot.stages.mini.home={POSTURE}",
        "controller.force=2",
        "plant.step=2.5e-4",
    ),
}


@pytest.fixture(scope="module")
def push(checked_config, simulated):
    """Let an arm push on a wall at its home tip; return the trace and the force along the normal."""

    def made(arm, stiffness, *overrides, normal=NORMAL):
        model = checked_config(*ARMS[arm], *LAW).arm
        goal = model.model.tip_position(model.home).tolist()
        given = (f"environment.normal={normal.tolist()}", f"environment.stiffness={stiffness}")
        trace = simulated(*ARMS[arm], *LAW, *given, f"trajectory.goal={goal}", *overrides)
        return trace, trace.contact.external[:, :3] @ normal

    return made


def rise_time(trace, force):
    """Return the time of a force from 10 % to 90 % of its last value, in ms."""
    reached = [np.argmax(force >= share * force[-1]) for share in (0.1, 0.9)]
    return 1e3 * (trace.t[reached[1]] - trace.t[reached[0]])


@pytest.mark.parametrize("normal", [NORMAL, TILTED], ids=["upright", "tilted"])
def test_the_force_comes_to_what_is_asked_without_overshoot(push, normal):
    trace, force = push("mini", 1e4, "duration=0.1", normal=normal)
    assert force[-1] == pytest.approx(2.0, rel=1e-9)
    assert force.max() < 2.0 * (1.0 + 1e-6)
    np.testing.assert_allclose(trace.end_points[-1, -1] - trace.end_points[-1, 0], -2.0 / 1e4 * normal, atol=1e-9)


def test_it_comes_as_a_critically_damped_mass_on_the_wall_does(push, checked_config):
    """m d'' + 2 m w d' + k (1 + k_f) d = (1 + k_f) f_d from rest: f = f_d (1 - (1 + w t) exp(-w t))."""
    trace, force = push("mini", 300.0, "duration=0.2", "controller.period=1e-4", "plant.step=1e-4")
    model = checked_config(*ARMS["mini"], *LAW).arm.model
    q = trace.q[0]
    J = model.tip_jacobian(q)[:3]
    mass = 1.0 / (NORMAL @ J @ np.linalg.solve(model.mass_matrix(q), J.T @ NORMAL))
    w = np.sqrt(2.0 * 300.0 / mass)
    np.testing.assert_allclose(force, 2.0 * (1.0 - critically_damped(trace.t, w)), atol=0.02)


def test_the_macro_is_slower_than_the_mini_by_the_root_of_their_masses(push):
    macro = rise_time(*push("macro", 900.0, "duration=1.0", "controller.period=1e-3"))
    mini = rise_time(*push("mini", 900.0, "duration=0.3", "controller.period=1e-3"))
    assert 2.8 < macro / mini < 3.6


@pytest.mark.parametrize("acts", ["last_stage", "whole"])
@pytest.mark.parametrize("stiffness", [1e3, pytest.param(1e4, marks=pytest.mark.slow), 4e4])  # it lies between
def test_a_mini_on_a_macro_pushes_as_fast_as_alone(push, acts, stiffness):
    alone = rise_time(*push("mini", stiffness, "duration=0.1"))
    riding = rise_time(*push("combined", stiffness, "duration=0.1", f"controller.actuated_stages={acts}"))
    assert abs(riding - alone) <= max(1.0, 0.1 * alone) + 1e-6  # a tick, or a tenth


@pytest.mark.parametrize("engine", ["bullet", "mujoco"])
def test_another_engine_gives_the_same_rise(push, engine):
    own = rise_time(*push("mini", 1e4, "duration=0.1"))
    other = rise_time(*push("mini", 1e4, "duration=0.1", f"plant={engine}", "plant.step=1e-4"))
    assert abs(other - own) <= 2.0 + 1e-6


@pytest.mark.parametrize("delay", [0, 1])
@pytest.mark.parametrize("arm", ["macro", "mini"])
def test_the_stiffest_wall_is_that_of_the_sampled_map(push, checked_config, arm, delay):
    config = checked_config(*ARMS[arm], *LAW)
    model, q, period = config.arm.model, config.arm.home, config.controller.period
    J = model.tip_jacobian(q)[:3]
    mass = 1.0 / (NORMAL @ J @ np.linalg.solve(model.mass_matrix(q), J.T @ NORMAL))
    stiffest = mass * force_loop_limit(1.0, 1.0, delay) ** 2 / (2.0 * period**2)
    for share, stays in ((0.85, True), (1.15, False)):
        trace, force = push(arm, share * stiffest, f"duration={200 * period}", f"plant.computation.delay={delay}")
        ripple = np.ptp(force[-20:]) if trace.failure is None else np.inf
        assert (ripple < 0.05 * force.mean()) == stays


def test_a_reading_by_joint_torques_finds_the_force(push):
    trace, force = push(
        "mini", 1e4, "duration=0.1", "controller.force_source=joint_torque", "joint_torque_sensor=ideal"
    )
    assert force[-1] == pytest.approx(2.0, rel=1e-9)
    felt, mean = trace.contact.felt[2:, :3] @ NORMAL, 0.5 * (force[:-2] + force[1:-1])  # felt in the tick before
    np.testing.assert_allclose(felt[1:], mean[1:], atol=0.02)  # in the first period the force begins, and bends


def test_an_integral_takes_away_what_a_wrong_bias_of_the_posture_leaves(push):
    """The law assumes a weightless arm, so a part of its weight lies on the wall, which tilts upwards."""
    weightless = ("controller.gravity_compensation=false", "duration=0.5")
    _, without = push("mini", 1e4, *weightless, normal=TILTED)
    _, with_integral = push("mini", 1e4, *weightless, "controller.integral_gain=50", normal=TILTED)
    assert abs(without[-1] - 2.0) > 0.1
    assert with_integral[-1] == pytest.approx(2.0, rel=1e-6)


def test_it_goes_to_the_wall_slides_along_it_and_pushes(push, checked_config):
    model = checked_config(*ARMS["mini"], *LAW).arm
    start = model.model.tip_position(model.home)
    goal = (start + np.array([0.03, 0.0, 0.0])).tolist()
    trace, force = push(
        "mini",
        1e4,
        "environment.distance=0.002",
        "environment.friction=0.3",
        "environment.damping=5",
        "trajectory=quintic",
        f"trajectory.goal={goal}",
        "trajectory.duration=0.5",
        "duration=0.8",
    )
    contact = trace.contact.external
    sliding = (trace.t > 0.2) & (trace.t < 0.4)
    assert force[0] == 0.0
    assert force[sliding] == pytest.approx(np.full(sliding.sum(), 2.0), abs=0.1)
    np.testing.assert_allclose(contact[sliding, 0], -0.3 * force[sliding], rtol=0.02)
    assert abs(trace.end_points[-1, -1, 0] - goal[0]) < 1e-4


@pytest.mark.parametrize(("stiffness", "told"), [(4e4, False), (6e4, True)])
def test_a_wall_that_is_too_stiff_is_told_before_it_is_found_out(tmp_path, stiffness, told):
    made = run(
        *("robot=mini", f"robot.home={POSTURE}", *LAW, f"environment.normal={NORMAL.tolist()}", "duration=0.01"),
        f"environment.stiffness={stiffness}",
        *("trajectory.goal=[-0.03,0.0975,0.138]", f"outputs={tmp_path}"),
    )
    assert ("unstable_contact" in {caveat["rule"] for caveat in made.caveats}) == told


@pytest.mark.parametrize(
    ("overrides", "text"),
    [
        (
            ("environment=free",),
            "controller.normal: it refers to environment.normal, which the chosen environment",
        ),
        (("controller.normal=[0,0,2]",), "controller.normal: must be a unit vector"),
        (("environment.normal=[0,0,2]",), "environment.normal: must be a unit vector"),
        (
            ("controller.force_source=joint_torque",),
            "controller.force_source: joint_torque needs torque sensors in the joints",
        ),
        (("controller.actuated_stages=last",), "controller.actuated_stages"),
        (("robot=planar", "controller.normal=[0,1,0]"), "controller.normal: planar cannot push along [0.0, 1.0, 0.0]"),
        (("disturbance_observer=momentum",), "disturbance_observer.bandwidth: it takes a touch for a disturbance"),
        (("plant=kinematic",), "plant.kind: kinematic follows joint positions"),
    ],
)
def test_bad_input_names_what_is_wrong(cli, overrides, text):
    ending = cli("robot=mini", "controller=hybrid_force", *overrides)
    assert ending.code == 2
    assert text in ending.err
