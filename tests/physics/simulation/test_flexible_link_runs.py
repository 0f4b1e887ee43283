"""Runs of arms whose links bend, from the config to the metrics."""

from itertools import islice, pairwise

import numpy as np
import pytest
from support.arms import checked
from support.physics import assert_order

from runner.assembly.assemble import assemble
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.papers.studies.thesis_beyond.cantilever import cantilever_roots
from runner.plants import PLANTS
from runner.robots.robot import with_armature
from runner.robots.vibration import Mode, stiffen_robot
from runner.store import simulated_part
from runner.trajectories.shaped import zero_vibration

MACRO = ("robot=macro", "plant=rk4_flexible_links", "noise=none", "torque_limits=none")
MOVE = ("trajectory=quintic", "trajectory.duration=1", "trajectory.goal=[0.4,0.7,0.6]", "duration=1.5")
# Without gravity, whose stiffness is not in the modes. Motors so heavy that their law leads them as if nothing pulled
# at them; only link 3 bends, across the way of joint 1.
LED = (
    *MACRO, "plant.links.link2=null", "plant.motor_inertia=1e5", "plant.damping_ratio=0.02", "gravity=0", "duration=1",
    "controller=computed_torque", "controller.period=0.001", "trajectory=joint_quintic",
    "trajectory.goal_configuration=[0.02,0,0]", "trajectory.duration=0.1",
)  # fmt: skip
F0 = np.sqrt(3.0 * 300.0 / 0.75) / (2.0 * np.pi)  # Hz, 3 EI/(m L^3) over 1 - 1/(4 n^2), n = 1


def stiff(EI):
    return (f"plant.links.link2.EI={EI}", f"plant.links.link3.EI={EI}")


def test_the_tip_of_the_trace_is_that_of_the_bent_links(simulated):
    """At rest at home with the motors held by a law without error, the sag is that of beams with loads and slopes."""
    trace = simulated(
        *MACRO, "trajectory=goal", "trajectory.goal=[0,1,1]", "duration=0.01", "plant.step=0.0005", *stiff(30000)
    )
    force = 2.0 * 9.81  # on the end of link 2; the other end mass is above it
    sag = 0.75 * force / (3.0 * 30000)
    slope = force / (2.0 * 30000)  # of the end of link 2, by which link 3 leans
    assert trace.tip[0] == pytest.approx([0.0, 1.0 + slope, 1.0 - sag], abs=2e-5)
    assert trace.tip[0] != pytest.approx([0.0, 1.0, 1.0], abs=1e-4)


def test_stiffer_links_bring_the_arm_nearer_to_its_path(simulated):
    errors = [
        np.linalg.norm(simulated(*MACRO, *MOVE, *stiff(EI), "plant.step=0.0005").error, axis=1).max()
        for EI in (3e3, 6e3)
    ]
    assert_order(errors, 1, within=0.13)  # in the compliance


def test_more_parts_change_the_motion_less_and_less(simulated):
    """Distances of 1 to 2, 2 to 3 parts and so on fall as 1/n^2 does."""
    keys = ("plant.links.link2.mass=0.3", "plant.links.link3.mass=0.3", *stiff(1000), "plant.step=0.0001")
    move = ("trajectory=quintic", "trajectory.duration=0.4", "trajectory.goal=[0.1,0.9,0.9]", "duration=0.4")
    tips = [simulated(*MACRO, *move, *keys, f"plant.segments={parts}").tip for parts in (1, 2, 3)]
    first, second = (np.abs(after - before).max() for before, after in pairwise(tips))
    assert second / first == pytest.approx((1 / 4 - 1 / 9) / (1 - 1 / 4), rel=0.4)


def test_a_link_of_the_macro_with_mass_along_it_is_a_cantilever_of_the_second_order():
    """Link 3 with its end mass of 1 kg, all motors held: the first two modes in each plane."""
    errors = []
    for parts in (4, 8, 16):
        keys = ("plant.links.link2=null", "plant.links.link3.mass=0.5", f"plant.segments={parts}", "plant.step=1e-6")
        config = checked(*MACRO, *keys)
        omega = [2.0 * np.pi * mode.frequency for mode in PLANTS.modes(config.plant, config.arm, config.arm.home)]
        exact = np.array(list(islice(cantilever_roots(2.0), 2))) ** 2 * np.sqrt(300.0 / 0.5)
        assert omega[0] == pytest.approx(omega[1], rel=1e-6)
        errors.append(np.array([omega[0], omega[2]]) / exact - 1.0)
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert np.all(np.abs(orders - 2.0) < 0.1)


def test_laws_believe_a_rigid_arm_of_the_same_masses_and_motors():
    config = checked(*MACRO, "plant.links.link3.mass=0.2")
    closed = assemble(config)
    closed.close()
    (law,) = (loop.controller for loop in closed.loops)
    expected = with_armature(stiffen_robot(config.arm, config.plant.beams(config.arm)), np.full(3, 2.0)).model
    q = np.array([0.1, 0.2, 0.3])
    assert law.models[0].mass_matrix(q) == pytest.approx(expected.mass_matrix(q))
    assert law.models[0].mass == pytest.approx(2.2)


@pytest.mark.parametrize(("kind", "ratio"), [("zv", 0.8), ("zv", 1.2), ("zvd", 0.7), ("zvd", 1.3)])
def test_the_residual_vibration_of_a_bending_link_is_the_closed_form(simulated, kind, ratio):
    impulses = zero_vibration(kind, F0 * ratio, 0.02)
    keys = (f"input_shaper={kind}", f"input_shaper.frequency={F0 * ratio}", "input_shaper.damping_ratio=0.02")
    alone, left = ringing(simulated(*LED), 0.1), ringing(simulated(*LED, *keys), 0.1 + impulses.delay)
    assert left / alone == pytest.approx(impulses.residual(F0, 0.02), rel=0.03)


def test_a_mode_of_the_links_rests_by_its_name(simulated):
    config = checked(*LED, "input_shaper=zv")
    assert config.path.duration - 0.1 == pytest.approx(0.5 / (F0 * np.sqrt(1 - 0.02**2)), rel=1e-9)
    left = ringing(simulated(*LED, "input_shaper=zv"), config.path.duration)
    assert left < 0.01 * ringing(simulated(*LED), 0.1)


def ringing(trace, end):
    """Return the amplitude at an end of the tip's vibration along x after it, in m."""
    return Mode(F0, 0.02).amplitude(trace.t, trace.tip[:, 0], end)


def test_a_mini_rides_on_links_that_bend(simulated):
    trace = simulated(
        *("robot=combined", "plant=rk4_flexible_links", "noise=none", "torque_limits=none", "trajectory=quintic"),
        *("plant.motor_inertia={macro: 2, mini: null}", "trajectory.goal=[0.4,0.8,0.7]", "duration=0.3"),
    )
    assert trace.failure is None
    reach = np.linalg.norm(trace.end_points[1] - trace.end_points[0], axis=1)  # of the Mini, which does not bend
    assert np.all(reach < np.sqrt(0.02) * 1.01)
    assert np.abs(trace.end_points[0, 0] - [0.0, 1.0, 1.0]).max() > 0.01


def test_a_run_ends_where_links_bend_too_far(simulated):
    failure = simulated(*MACRO, "trajectory=goal", "duration=0.5").failure
    assert "a spring of the links bends by more than 0.5 rad" in failure.reason
    assert 0.0 < failure.time < 0.2


def test_a_sensor_of_the_tip_sees_what_links_bend(simulated):
    """The sag stays if only encoders are read; of a measured sag the springs of the law leave their share."""
    rest = ("trajectory=goal", "trajectory.goal=[0,1,1]", "plant.damping_ratio=0.2", "duration=3.5")
    arm = (*MACRO, *rest, *stiff(3000))

    def error(natural_frequency, by):
        keys = (f"controller.natural_frequency={natural_frequency}", f"endpoint_sensor.read_by={by}")
        return np.abs(simulated(*arm, *keys).error[-1]).max()

    sag = 2.0 * 9.81 / (2.0 * 3000)  # m: link 3 leans by the slope of the end of link 2
    assert error(6, "[]") > sag
    assert error(6, "[macro]") < 0.15 * sag
    assert_order([error(omega, "[macro]") for omega in (3, 6)], 2, within=0.07)  # in the period of the law


def test_a_mini_that_sees_the_tip_errs_by_the_desired_acceleration_whatever_bends_below_it(simulated):
    """|e| = 5.774 |D|/t_f^2 / omega_n^2, as on flexible joints; the sag of the start is gone after 0.1 s."""
    trace = simulated(
        *("robot=combined", "plant=rk4_flexible_links", "noise=none", "torque_limits=none", *stiff(3000)),
        *("trajectory=quintic", "trajectory.duration=1", "trajectory.goal=[0.4,0.8,0.7]", "duration=1"),
        *("plant.motor_inertia={macro: 2, mini: null}", "plant.step=0.0005", "endpoint_sensor.read_by=[mini]"),
    )
    error = np.linalg.norm(trace.error[trace.t > 0.1], axis=1).max()
    assert error == pytest.approx(5.774 * np.linalg.norm([0.4, -0.3, -0.4]) / 300.0**2, rel=0.05)


def test_runs_on_other_plants_know_nothing_of_it():
    assert "links" not in simulated_part(compose(["robot=macro", "plant=rk4"]).resolved)["plant"]


@pytest.mark.parametrize(
    ("overrides", "expected"),
    [
        (("plant.links.link2.EI=0",), "plant.links.link2.EI: must be above 0; found 0"),
        (("plant.links.link2.EI=-3",), "plant.links.link2.EI: must be above 0; found -3"),
        (("plant.links.link2.mass=-1",), "plant.links.link2.mass: must be 0 or more; found -1"),
        (("plant.segments=0",), "plant.segments: must be 1 or more; found 0"),
        (("plant.segments=2",), "plant.links.link3.mass: 0 found with plant.segments=2"),
        (
            ("+plant.links.lnk3={EI: 300, mass: 0}",),
            "plant.links.lnk3: no such link (did you mean link3?); links: link1",
        ),
        (("+plant.links.link1={EI: 300, mass: 0}",), "plant.links.link1: the link has no length"),
        (("plant.links.link2=null", "plant.links.link3=null"), "null for every link; take plant=rk4"),
        (("plant.step=0.01",), "11.9 Hz at home; allowed: up to 0.00671 s, such as 0.005"),
        (
            ("plant.segments=2", "plant.links.link2.mass=1e-11", "plant.links.link3.mass=1e-11", "input_shaper=zv"),
            "plant.links: parts between springs have next to no inertia",
        ),
        (("plant.motor_inertia=null",), "a link without mass turns only with its motor; give each joint one"),
        (("plant.motor_inertia=[1,2]",), "plant.motor_inertia: 2 values for 3 joints"),
        (("plant.motor_inertia=0",), "must be a number above 0, null for a joint whose motor has none"),
        (("plant.damping_ratio=-1",), "plant.damping_ratio: must be 0 or more"),
        (("robot.payload.schedule=[{at: 1.0, mass: 0.5}]",), "robot.payload.schedule=[]"),
        (("joint_torque_sensor=ideal",), "joint_torque_sensor.noise=null"),
        (("environment=wall", "environment.stiffness=100"), "a force on the tip would act on rigid links"),
        (("robot=combined",), "plant.motor_inertia: needs a value for each stage (macro, mini)"),
        (("input_shaper=zv", "input_shaper.frequency=mode_9"), "mode_9 found; the plant has mode_1 (2.13 Hz)"),
    ],
)
def test_what_does_not_fit_is_refused(overrides, expected):
    with pytest.raises(ConfigError) as caught:
        checked(*MACRO, *overrides)
    assert expected in str(caught.value)
