"""Runs of arms with flexible joints, from the config to the metrics."""

import numpy as np
import pytest
from support.arms import checked
from support.physics import assert_order

from runner.assembly.flexibility import with_nominal_flexibility
from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.plants.flexible_joints import links_of
from runner.robots.robot import with_armature
from runner.store import simulated_part

MACRO = ("robot=macro", "plant=rk4_flexible", "noise=none", "torque_limits=none")
MOVE = ("trajectory=quintic", "trajectory.duration=1", "trajectory.goal=[0.4,0.7,0.6]", "duration=1.5")
KEY = "plant.flexible_joints"


def problems(*overrides):
    with pytest.raises(ConfigError) as caught:
        checked(*overrides)
    return str(caught.value)


def test_stiffer_joints_bring_the_arm_nearer_to_its_path(simulated):
    soft, stiff = (
        np.linalg.norm(simulated(*MACRO, *MOVE, "plant.step=0.001", f"{KEY}.stiffness={K}").error, axis=1).max()
        for K in (1e3, 1e4)
    )
    assert 9.0 < soft / stiff < 13.0


def test_under_control_the_distance_to_the_rigid_arm_falls_as_one_over_the_stiffness(simulated):
    rigid = simulated("robot=macro", "plant=rk4", "noise=none", "torque_limits=none", *MOVE).error
    stiffness = np.array([1e4, 2e4, 4e4])
    flexible = [simulated(*MACRO, *MOVE, "plant.step=0.001", f"{KEY}.stiffness={K}").error for K in stiffness]
    distances = [np.linalg.norm(error - rigid, axis=1).max() for error in flexible]
    assert np.polyfit(np.log(stiffness), np.log(distances), 1)[0] == pytest.approx(-1.0, abs=0.05)


def test_encoders_at_the_links_make_the_rigid_law_unstable(simulated):
    trace = simulated(*MACRO, *MOVE, f"{KEY}.encoders=link")
    assert trace.failure is not None
    assert "diverged" in trace.failure.reason


def test_at_rest_the_known_deflection_leaves_an_error_of_second_order(simulated):
    def rest(K, known):
        keys = (f"{KEY}.stiffness={K}", f"{KEY}.static_deflection={known}", f"{KEY}.damping_ratio=0.2")
        trace = simulated(*MACRO, "trajectory=goal", "trajectory.goal=[0,1,1]", "duration=6", "plant.step=0.002", *keys)
        return np.abs(trace.error[-1]).max()

    assert_order([rest(K, "unknown") for K in (2e3, 4e3)], 1, within=0.13)  # in the compliance
    assert_order([rest(K, "known") for K in (2e3, 4e3)], 2, within=0.13)


def test_a_stage_with_null_stays_rigid():
    config = validate(
        compose(
            [
                "robot=combined",
                "plant=rk4_flexible",
                f"{KEY}.stiffness={{macro: 1000, mini: null}}",
                f"{KEY}.motor_inertia={{macro: 2, mini: null}}",
            ]
        )
    )
    flexibility = config.plant.flexible_joints.by_joint(config.arm)
    assert flexibility.flexible.tolist() == [True] * 3 + [False] * 3
    M = config.arm.model.mass_matrix(config.arm.home)
    gained = with_armature(config.arm, flexibility.motors).model.mass_matrix(config.arm.home) - M
    assert gained == pytest.approx(np.diag([2.0] * 3 + [0.0] * 3), abs=1e-12)


def test_the_names_of_rigid_runs_know_nothing_of_flexible_joints():
    assert "flexible_joints" not in simulated_part(compose(["robot=macro", "plant=rk4"]).resolved)["plant"]
    assert "flexible_joints" in simulated_part(compose(["robot=macro", "plant=rk4_flexible"]).resolved)["plant"]


@pytest.mark.parametrize(
    ("overrides", "expected"),
    [
        ((f"{KEY}.stiffness=0",), f"{KEY}.stiffness: must be a number above 0, null for rigid joints"),
        ((f"{KEY}.stiffness=-5",), "found -5"),
        ((f"{KEY}.motor_inertia=-1",), f"{KEY}.motor_inertia: must be a number above 0"),
        ((f"{KEY}.damping_ratio=-0.1",), f"{KEY}.damping_ratio: must be 0 or more"),
        ((f"{KEY}.stiffness=[1,2]",), "2 values for 3 joints (q1, q2, q3)"),
        ((f"{KEY}.stiffness=null",), "null for every joint"),
        ((f"{KEY}.motor_inertia=null",), "null takes robot.armature, which is 0 for q1"),
        ((f"{KEY}.motor_inertia=[null,2,2]",), "null takes robot.armature, which is 0 for q1"),
        ((f"{KEY}.stiffness=[null,1,1]",), "q1 has a motor and no spring"),
        ((f"{KEY}.stiffness=1e6",), "Hz at home; allowed: up to 0.0003"),
        ((f"{KEY}.encoders=motr",), "did you mean motor?"),
        (("robot.armature=0.1",), "q1 has robot.armature=0.1, too, and both are its motor; give null"),
        ((f"{KEY}.brake_time={{mini: 0}}",), f"{KEY}.brake_time: no such stage: 'mini'"),
        (("environment=wall",), "a wall is met by arms with rigid joints"),
        (("joint_torque_sensor=ideal",), "joint_torque_sensor.noise=null"),
        (("robot.payload.schedule=[{at: 1.0, mass: 0.5}]",), "robot.payload.schedule=[]"),
    ],
)
def test_what_does_not_fit_is_refused(overrides, expected):
    assert expected in problems("robot=macro", "plant=rk4_flexible", *overrides)


def test_a_blind_mini_is_no_better_than_the_macro_that_carries_it(simulated):
    trace = simulated(
        *("robot=combined", "plant=rk4_flexible", "noise=none", "torque_limits=none", "trajectory=quintic"),
        *("trajectory.duration=1", "trajectory.goal=[0.4,0.8,0.7]", "duration=1"),
        *(f"{KEY}.stiffness={{macro: 1000, mini: null}}", f"{KEY}.motor_inertia={{macro: 2, mini: null}}"),
    )
    carried = trace.end_points[0] + trace.offsets[0] - trace.desired[:, 0]
    macro, tip = (np.linalg.norm(error, axis=1).max() for error in (carried, trace.error))
    assert tip == pytest.approx(macro, rel=0.12)
    assert tip == pytest.approx(8.9e-3, rel=0.12)  # m, of a simulation apart from this one


def test_damping_the_springs_lets_encoders_at_the_links_do(simulated):
    """Spong's composite control; without it, or with springs as slow as the law, the same law is unstable."""
    by_links = (*MACRO, *MOVE, f"{KEY}.encoders=link", "plant.step=0.0005")
    damped = f"{KEY}.torsion_damping=0.7"
    assert simulated(*by_links, f"{KEY}.stiffness=10000").failure is not None
    assert simulated(*by_links, f"{KEY}.stiffness=1000", damped).failure is not None
    trace = simulated(*by_links, f"{KEY}.stiffness=10000", damped)
    assert np.linalg.norm(trace.error[-1]) < 1e-6


def test_a_motor_swings_against_a_held_link_with_the_damping_that_is_asked_for():
    config = checked(*MACRO, f"{KEY}.stiffness=1000", f"{KEY}.motor_inertia=2", f"{KEY}.torsion_damping=0.3")
    flexibility = config.plant.flexible_joints.by_joint(config.arm)
    for m, d, k in zip(flexibility.motors, flexibility.torsion_feedback, flexibility.stiffness, strict=True):
        swing = np.roots([m, d, k])[0]
        assert (-swing.real / abs(swing), abs(swing)) == pytest.approx((0.3, np.sqrt(k / m)))


def test_brakes_hold_the_motors_and_a_push_bends_the_arm(simulated):
    braked = (*MACRO, "gravity=0", f"{KEY}.brake_time={{macro: 0}}", f"{KEY}.damping_ratio=0.3", "environment=push",
              "environment.force=[2.0,0.0,0.0]", "environment.start_time=0", "duration=8")  # fmt: skip
    trace = simulated(*braked)
    arm = checked(*MACRO).arm.model
    J = arm.tip_jacobian(np.zeros(3))[:3]
    assert trace.tip[-1] - trace.tip[0] == pytest.approx(J @ J.T @ [2.0, 0.0, 0.0] / 1000.0, abs=2e-5)  # m


def test_the_motors_of_tomeis_law_bring_the_links_exactly_to_rest(simulated):
    def rest(*law):
        keys = (
            f"{KEY}.stiffness=1000",
            f"{KEY}.damping_ratio=0.3",
            "plant.step=0.001",
            "controller.natural_frequency=5",
        )
        trace = simulated(*MACRO, "trajectory=goal", "trajectory.goal=[0.1,0.9,0.9]", "duration=12", *keys, *law)
        return np.abs(trace.error[-1]).max()

    by_motors = rest("controller=motor_pd", f"{KEY}.static_deflection=unknown")
    assert by_motors < 1e-8
    assert rest("controller=joint_pd") > 1e4 * by_motors  # off by the second order of 1/K
    believed_stiffer = ("controller=motor_pd", f"{KEY}.static_deflection=unknown", "controller.joint_stiffness=2000")
    assert rest(*believed_stiffer) > 1e-3


@pytest.mark.parametrize(
    ("overrides", "expected"),
    [
        (
            ("plant=rk4", "controller=motor_pd", "controller.joint_stiffness=1000"),
            "motor_pd turns motors behind springs",
        ),
        (("plant=rk4_flexible", "controller=motor_pd"), "motor_pd reads theta unchanged"),
        (("plant=rk4_flexible", "controller=motor_pd", "controller.joint_stiffness=[1,2]"), "2 values for 3 joints"),
    ],
)
def test_motor_pd_wants_motors(overrides, expected):
    assert expected in problems("robot=macro", *overrides)


def test_without_a_motor_inertia_the_armature_is_the_motor(simulated):
    move = (*MACRO, *MOVE, "plant.step=0.001")
    named = simulated(*move, f"{KEY}.motor_inertia=[2,1.5,1]")
    armature = simulated(*move, f"{KEY}.motor_inertia=null", "robot.armature=[2,1.5,1]")
    np.testing.assert_array_equal(named.q, armature.q)
    np.testing.assert_array_equal(named.tau, armature.tau)


def test_the_armature_of_rigid_joints_stays_where_it_is():
    both = ("robot=combined", "plant=rk4_flexible", f"{KEY}.stiffness={{macro: 1000, mini: null}}",
            f"{KEY}.motor_inertia=null", "robot.stages.macro.armature=2",
            "robot.stages.mini.armature=1e-4")  # fmt: skip
    config = checked(*both)
    flexibility = config.plant.flexible_joints.by_joint(config.arm)
    assert flexibility.motors.tolist() == [2.0] * 3 + [0.0] * 3
    links = links_of(config.arm.model, flexibility.flexible)
    assert links.armature.tolist() == [0.0] * 3 + [1e-4] * 3
    nominal = with_nominal_flexibility(config, config.arm).model
    assert nominal.armature.tolist() == [2.0] * 3 + [1e-4] * 3
