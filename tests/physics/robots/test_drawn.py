"""Nominal models drawn as arrays against Pinocchio models that are made one by one."""

from dataclasses import replace

import numpy as np
import pytest

from runner.assembly.assemble import describe_program, start_of
from runner.assembly.drawn_loops import draw_commands
from runner.robots.drawn import DrawnModel, by_run, each_run, over_runs
from runner.robots.mismatch import MismatchConfig, build, build_drawn
from runner.sensing.streams import MISMATCH
from runner.simulation.run import simulate_repetition, simulate_run
from runner.symbolic.engine import evaluator
from tools.laws import LAWS

RUNS = 4
ALL = {
    "mass": 1.1, "centre_of_mass": 0.9, "length": 1.05, "gravity": 0.95, "payload": 0.2, "spread": 0.2,
    "link": {"link2": {"mass": 1.3, "inertia": 0.8, "inertia_spread": 0.5, "centre_of_mass_spread": 0.0}},
}  # fmt: skip
compiled = pytest.mark.skipif(not evaluator(), reason="runs are compiled as a whole by llvmlite")


def generators(seed=3):
    return [np.random.default_rng([seed, run, MISMATCH]) for run in range(RUNS)]


@pytest.fixture(params=["macro", "xarm7", "combined"])
def drawn(request, checked_config):
    """Return a robot with drawn models, and the robots that are made one by one."""
    robot, config = checked_config(f"robot={request.param}").arm, MismatchConfig(**ALL)
    return build_drawn(config, robot, generators()), [build(config, robot, generator) for generator in generators()]


def test_inertias_weight_and_mass_of_every_stage_are_those_of_single_models(drawn):
    robot, single = drawn
    for place, stage in enumerate([robot, *robot.stages]):
        model, q = stage.model, np.random.default_rng(1).uniform(-1.0, 1.0, stage.model.nq)
        own = [[each, *each.stages][place].model for each in single]
        assert isinstance(model, DrawnModel)
        for name, value in (
            ("mass_matrix", model.mass_matrix(q)),
            ("gravity_torque", model.gravity_torque(q)),
        ):
            expected = np.array([getattr(each, name)(q) for each in own])
            found = by_run(value.ravel()).reshape(expected.shape)
            np.testing.assert_allclose(found, expected, rtol=0, atol=1e-13 * np.abs(expected).max())
        expected = np.array([each.inertial_parameters for each in own])
        np.testing.assert_allclose(by_run(model.inertial_parameters), expected, rtol=0, atol=1e-13 * expected.max())
        np.testing.assert_allclose(model.mass, [each.mass for each in own], rtol=1e-14)


def test_a_payload_may_differ_from_arm_to_arm(drawn):
    robot, single = drawn
    masses, position, q = np.array([0.0, 0.5, 1.0, 2.0]), np.array([0.1, 0.2, -0.3]), np.ones(robot.model.nq)
    found = by_run(robot.model.with_payload(masses, position).gravity_torque(q))
    pairs = zip(single, masses, strict=True)
    expected = [each.model.with_payload(mass, position).gravity_torque(q) for each, mass in pairs]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)


def test_each_arm_may_have_its_own_posture(drawn):
    robot, single = drawn
    q = np.random.default_rng(2).uniform(-1.0, 1.0, (RUNS, robot.model.nq))
    expected = [each.model.gravity_torque(own) for each, own in zip(single, q, strict=True)]
    np.testing.assert_allclose(by_run(robot.model.gravity_torque(over_runs(q))), expected, rtol=0, atol=1e-12)


def test_a_tip_and_an_armature_change_the_common_arm(drawn):
    model = drawn[0].model
    other = model.with_armature(np.full(model.nq, 2.0)).with_tip(model.tip_name)
    q = np.zeros(model.nq)
    more = by_run((other.mass_matrix(q) - model.mass_matrix(q)).ravel()).reshape(-1, model.nq, model.nq)
    np.testing.assert_allclose(more, np.broadcast_to(2.0 * np.eye(model.nq) - np.diag(model.armature), more.shape))


def test_functions_of_arrays_over_runs_are_those_of_each_run():
    values = np.random.default_rng(0).normal(size=(5, 3, 3))
    np.testing.assert_array_equal(by_run(each_run(np.linalg.inv, over_runs(values)).ravel()).reshape(5, 3, 3),
                                  np.linalg.inv(values))  # fmt: skip
    np.testing.assert_array_equal(each_run(np.linalg.inv, values[0]), np.linalg.inv(values[0]))
    np.testing.assert_array_equal(by_run([1.0, 2.0]), [1.0, 2.0])


CASES = {
    # Laws that learn over periods are not compiled.
    **{law.name: law.overrides for law in LAWS.values() if law.takes_drawn and not law.periodic},
    "adaptive_friction": ("robot=macro", "controller=adaptive", "controller.friction=true"),
    "adaptive_scaled": ("robot=macro", "controller=adaptive", "controller.scale=parameter"),
    "observer": ("robot=macro", "controller=adaptive", "disturbance_observer.bandwidth=20", "noise.position=1e-3"),
    "notch": ("robot=macro", "notch=torques"),
    "redundant": ("robot=xarm7", "controller=operational_space"),
    "whole_body_in_stages": ("robot=combined", "controller=whole_body"),
    "known": ("robot=combined", "controller=macro_mini", "controller.payload=known"),
    "inertial_damping": ("robot=combined", "controller=macro_mini", "controller.coupling=inertial_damping"),
    "last_stage": ("robot=combined", "controller=impedance", "controller.actuated_stages=last_stage"),
}


@compiled
@pytest.mark.parametrize("overrides", CASES.values(), ids=CASES)
def test_every_law_has_the_numbers_and_the_start_of_single_models(checked_config, overrides):
    link = "mismatch.link.link2={mass: 1.3, inertia_spread: 0.5}"
    config = checked_config(*overrides, "plant=rk4", "mismatch=sampled", link)
    single = [describe_program(config, repetition) for repetition in range(RUNS)]
    commands = draw_commands(config, range(RUNS))
    expected = np.array([each.numbers for each in single])
    found = replace(single[0], commands=commands).numbers
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)
    assert len(np.unique(found, axis=0)) == RUNS
    kept = single[0].drawn_values(commands)
    np.testing.assert_allclose(kept[0], single[0].values, rtol=1e-9, atol=1e-12)
    q = start_of(config) + np.random.default_rng(0).normal(0.0, 0.01, (RUNS, config.arm.model.nq))
    errors = [np.zeros_like(q)] * len(commands.loops)
    pairs = zip(single, q, strict=True)
    starts = [each.commands.start(own[None], [np.zeros((1, len(own)))] * len(errors))[0] for each, own in pairs]
    np.testing.assert_allclose(commands.start(q, errors), starts, rtol=1e-12, atol=1e-12)


@compiled
def test_on_a_plant_of_python_repetitions_are_those_that_are_made_alone(checked_config):
    few = ("robot=macro", "plant=mujoco", "trajectory=quintic", "duration=0.1", "repetitions=3", "noise=thesis")
    config = checked_config(*few, "controller=adaptive", "disturbance_observer.bandwidth=20", "mismatch.spread=0.3")
    whole = simulate_run(config)
    peaks = []
    for repetition in range(3):
        peaks.append(np.abs(simulate_repetition(config, repetition).tau).max())
    np.testing.assert_array_equal(whole.metrics["peak_torque"].values, peaks)
    assert len(set(peaks)) == 3


@compiled
@pytest.mark.parametrize("term", ["mass", "centre_of_mass", "inertia"])
def test_a_spread_of_one_link_draws_for_that_link_alone(macro, term):
    config = MismatchConfig(**(ALL | {"spread": 0.0, "link": {"link3": {f"{term}_spread": 0.4}}}))
    factors = config.draw(macro.link_names, [np.random.default_rng(run) for run in range(500)])
    place = ("mass", "centre_of_mass", "inertia").index(term)
    own = factors[:, 2, place] - 1.0
    assert 0.39 < np.abs(own).max() < 0.4
    assert abs(own.mean()) < 4.0 * 0.4 / np.sqrt(3.0 * 500)
    factors[:, 2, place] = 1.0
    assert (factors == 1.0).all()


@pytest.mark.parametrize("plant", ["rk4", "mujoco"])
def test_draws_that_change_no_number_change_no_run(checked_config, plant):
    """The links of the Macro are point masses: factors on their inertia change nothing."""
    task = ("robot=macro", f"plant={plant}", "trajectory=quintic", "duration=0.05")
    drawn = simulate_run(checked_config(*task, "mismatch.link.link3.inertia_spread=0.2", "repetitions=40"))
    plain = simulate_run(checked_config(*task))
    for name, metric in drawn.metrics.items():
        assert metric.min == metric.max == plain.metrics[name].median
