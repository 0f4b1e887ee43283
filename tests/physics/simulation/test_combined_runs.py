"""Mini on a Macro, from config to metrics: accuracy, options, repeatability and singular situations."""

import hashlib
import json

import numpy as np
import pytest
from support.arms import last_of_each
from support.covers import name_of, pairwise
from support.printed import without_caveats, without_results

from runner.assembly.assemble import assemble
from runner.metrics.summary import evaluate
from runner.simulation.loop import simulate
from runner.simulation.results import metric_context
from runner.simulation.sensors import make_encoders
from runner.store import open_run

TRACKING = ("robot=combined", "preset=full_equations", "trajectory=quintic", "trajectory.duration=3", "duration=3")
OPTIONS = {
    "controller.coupling": ("one_way", "two_way", "independent", "independent_base", "mini_held"),
    "controller.macro_target": ("minus_home", "tip_goal"),
    "controller.mini_reference_velocity": ("zero", "full"),
    "controller.wrist_rotation": ("real", "parallel"),
    "controller.gravity_compensation": ("true", "false"),
    "controller.feedforward": ("true", "false"),
    "controller.schedule": ("both", "turns"),
    "controller.reach": ("0.05", "10"),
    "controller.beyond_reach": ("hold", "stretch"),
    "controller.payload": ("unknown", "known"),
    "controller.singularity_damping": ("0", "0.3"),
    "plant": ("bullet", "rk4"),
    "noise": ("none", "thesis"),
    "noise.velocity": ("exact", "finite_difference"),
    "noise.bias.macro": ("-1e-3", "1e-3"),
    "noise.distribution": ("uniform", "gaussian", "none"),
    "torque_limits": ("none", "thesis"),
    "preset": (
        "full_equations",
        "full_equations plant.dynamics=decoupled",
        "as_reported",
    ),  # as_reported is decoupled, too
    "gravity": ("0", "9.81"),
}
WHOLE_BODY = {
    "controller.null_space_frequency": ("0", "100"),
    "controller.max_tip_speed": ("null", "0.5"),
    "controller.singularity_damping": ("0", "0.3"),
    "controller.gravity_compensation": ("true", "false"),
    "controller.feedforward": ("true", "false"),
    "controller.period": ("0.002",),
    "plant": ("bullet", "rk4"),
    "noise": ("none", "thesis"),
}


@pytest.fixture(scope="session")
def measured(checked_config):
    """Simulate one repetition, and evaluate it."""

    def make(*overrides, repetition=0):
        config = checked_config(*overrides)
        loop = assemble(config)
        try:
            trace = simulate(loop, make_encoders(loop, config.noise, config.settings.seed, repetition))
        finally:
            loop.plant.close()
        return trace, evaluate(trace, metric_context(config))

    return make


def fingerprint(trace):
    digest = hashlib.sha256()
    for array in (trace.t, trace.q, trace.dq, trace.tau, trace.end_points, trace.desired):
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


# Bounds that the runs must keep.


@pytest.mark.bullet
def test_bullet_and_rk4_agree_on_the_tip_error_of_six_joints(measured):
    # Noise-free one-way tracking, the Mini following a series of goals, thesis limits: at most 7.6e-3 m.
    overrides = (*TRACKING, "torque_limits=thesis", "controller.mini_reference_velocity=zero", "plant.step=5e-5")
    overrides = (*overrides, "duration=1.8")  # the Macro is fastest at 1.5 s
    runs = {plant: measured(*overrides, f"plant={plant}") for plant in ("rk4", "bullet")}
    largest = {plant: metrics["max_axis_error"] for plant, (_, metrics) in runs.items()}
    assert largest["rk4"] == pytest.approx(7.6e-3, rel=0.01)
    apart = np.abs(runs["rk4"][0].error - runs["bullet"][0].error).max()
    assert apart < 0.02 * largest["rk4"]


@pytest.mark.parametrize("repetition", [0, 1, *(pytest.param(n, marks=pytest.mark.slow) for n in range(2, 5))])
def test_one_way_coupling_tracks_fifty_times_closer_than_the_macro(measured, repetition):
    overrides = (*TRACKING, "noise=thesis", "torque_limits=thesis")
    trace, tip = measured(*overrides, repetition=repetition)
    _, held = measured(*overrides, "controller.coupling=mini_held", repetition=repetition)
    assert trace.failure is None
    assert 50.0 * tip["max_axis_error"] < held["macro_max_axis_error"]


def test_without_noise_the_mini_s_reference_velocity_is_worth_a_hundred(measured):
    overrides = (*TRACKING, "torque_limits=thesis")
    zero, full = (
        measured(*overrides, f"controller.mini_reference_velocity={velocity}")[1]["max_axis_error"]
        for velocity in ("zero", "full")
    )
    assert full < 0.01 * zero
    assert full < 1e-4


def test_the_tip_is_as_good_as_the_macro_s_encoders(measured):
    # The rest under noise is from the Macro's 1e-3 rad, which moves its end point by up to 2.2e-3 m.
    def largest(*overrides):
        return measured(*TRACKING, "torque_limits=thesis", "noise=thesis", *overrides)[1]["max_axis_error"]

    full = largest()
    assert full == pytest.approx(largest("noise.position.mini=0"), rel=0.1)
    assert largest("noise.position.macro=0") < 0.1 * full
    assert largest("noise.position.macro=1e-4") < 0.2 * full


def test_metrics_of_the_macro_stand_beside_the_tip_s(measured):
    trace, metrics = measured(*TRACKING, "torque_limits=thesis")
    error = trace.desired[:, 0] - [0.0, 0.1, 0.1] - trace.end_points[0]
    assert metrics["macro_max_axis_error"] == pytest.approx(np.abs(error).max())
    assert metrics["macro_max_tracking_error"] == pytest.approx(np.linalg.norm(error, axis=1).max())
    assert metrics["max_axis_error"] == pytest.approx(np.abs(trace.desired[:, 0] - trace.tip).max())
    way = np.linalg.norm(trace.desired[:, 0] - trace.end_points[0], axis=1)
    assert metrics["reach_loss_fraction"] == (way > 0.2).mean()
    assert {"macro_rms_tracking_error", "macro_cross_track_error", "macro_settling_time"} <= set(metrics)
    assert "mini_max_tracking_error" not in metrics


# Every option.


def assert_runs(measured, controller, options):
    """Assert that a short run of chosen options gives finite numbers at every tick."""
    changes = [part for key, value in options.items() for part in f"{key}={value}".split()]
    overrides = ("robot=combined", f"controller={controller}", "trajectory=quintic", "duration=0.1")
    trace, metrics = measured(*last_of_each(*overrides, *changes))
    assert trace.failure is None
    assert len(trace.t) == len(trace.q) == round(0.1 / trace.t[1]) + 1
    for array in (trace.q, trace.dq, trace.tau, trace.end_points, trace.error):
        assert np.isfinite(array).all()
    assert all(value is None or np.isfinite(value) for value in metrics.values())


@pytest.mark.parametrize("options", pairwise(OPTIONS), ids=name_of)
def test_every_two_options_of_macro_and_mini_run(measured, options):
    assert_runs(measured, "macro_mini", options)


@pytest.mark.parametrize("options", pairwise(WHOLE_BODY), ids=name_of)
def test_every_two_options_of_the_whole_body_run(measured, options):
    assert_runs(measured, "whole_body", options)


@pytest.mark.parametrize("controller", ["macro_mini", "whole_body"])
def test_a_goal_runs(measured, controller):
    assert_runs(measured, controller, {"trajectory": "goal"})


@pytest.mark.parametrize("plant", ["bullet", "rk4"])
def test_bases_that_stay_parallel_run(measured, plant):
    keys = {"plant": plant, "plant.dynamics": "decoupled", "plant.wrist_rotation": "parallel"}
    assert_runs(measured, "macro_mini", keys)


def test_the_stored_run_tells_its_stages(cli):
    ending = cli("robot=combined", "duration=0.05")
    assert (ending.code, without_caveats(without_results(ending.err))) == (0, "")
    run = open_run(ending.folder)
    columns = set(run.trace().columns)
    assert {"q6", "dq6", "tau6", "tip_x", "error_z", "macro_tip_x", "macro_error_z"} <= columns
    assert "mini_tip_x" not in columns
    assert run.provenance["stages"] == {"macro": None, "mini": "mini_base"}
    error = run.trace()["macro_error_y"] - (run.trace()["desired_y"] - 0.1 - run.trace()["macro_tip_y"])
    assert np.abs(error).max() < 1e-12


# The same again.


@pytest.mark.parametrize("plant", ["bullet", "mujoco", "rk4"])
@pytest.mark.parametrize("controller", ["macro_mini", "whole_body"])
def test_the_same_config_and_seed_are_bit_identical(simulated, plant, controller):
    overrides = ("robot=combined", f"controller={controller}", f"plant={plant}", "noise=thesis", "duration=0.2")
    first = fingerprint(simulated(*overrides))
    assert fingerprint(simulated(*overrides)) == first
    assert fingerprint(simulated(*overrides, repetition=1)) != first
    assert fingerprint(simulated(*overrides, "seed=1")) != first


@pytest.mark.parametrize("preset", ["full_equations", "as_reported"])
def test_a_repetition_does_not_depend_on_those_before(cli, preset):
    base = ("robot=combined", f"preset={preset}", "noise=thesis", "torque_limits=thesis", "duration=0.2")
    base = (*base, "controller.schedule=turns", "controller.coupling=two_way")  # loops with a memory
    both, single = (
        json.loads((cli(*base, f"repetitions={count}").folder / "metrics.json").read_text())["metrics"]
        for count in (2, 1)
    )
    for name, metric in single.items():
        assert both[name]["values"][0] == metric["values"][0]
    assert both["peak_joint_speed"]["values"][0] != both["peak_joint_speed"]["values"][1]


# Singular situations.

FOLDING = ("controller.macro_target=tip_goal", "preset=full_equations")
SINGULAR = {
    "Mini folded, tracking": (*FOLDING, "trajectory=quintic"),
    "Mini folded, goal": (*FOLDING, "trajectory=goal"),
    "Mini folded, thesis limits": (*FOLDING, "trajectory=quintic", "torque_limits=thesis", "noise=thesis"),
    "Mini folded, with rotors": (*FOLDING, "trajectory=quintic", "robot.stages.mini.armature=1e-5"),
    "Mini stretched": (
        "preset=as_reported",
        "controller.beyond_reach=stretch",
        "controller.coupling=two_way",
        "trajectory=quintic",
    ),
    "Mini beyond its reach": ("controller.reach=10", "trajectory=goal", "torque_limits=thesis"),
    "all stretched out": ("trajectory=goal", "trajectory.goal=[0,0,2.2]"),
    "through the base axis": ("trajectory=goal", "torque_limits=thesis"),
    "on the base axis": ("trajectory=quintic", "trajectory.goal=[0,0,1.5]"),
    "as reported": ("preset=as_reported", "noise=thesis", "torque_limits=thesis", "trajectory=goal"),
}
PLANTS = ("bullet", "mujoco", "rk4")


def each_on_one_plant(situations):
    """Return situations with plants, each situation on a plant in turn; on the other two in the slow session."""
    return [
        pytest.param(situation, plant, marks=() if (row - column) % len(PLANTS) == 0 else pytest.mark.slow)
        for row, situation in enumerate(situations)
        for column, plant in enumerate(PLANTS)
    ]


@pytest.mark.parametrize(("situation", "plant"), each_on_one_plant(SINGULAR))
def test_a_singular_situation_is_a_result_and_never_a_crash(measured, situation, plant):
    for damping in (0, 0.3):
        overrides = (f"plant={plant}", *SINGULAR[situation], f"controller.singularity_damping={damping}", "duration=2")
        trace, metrics = measured("robot=combined", *overrides)
        if trace.failure is None:
            assert len(trace.t) == 2001
            good = slice(None)
        else:
            assert metrics == {}
            assert trace.failure.reason
            assert trace.failure.time == trace.t[-1]
            assert trace.failure.joint in (None, *trace.joint_names)
            good = slice(0, -1)  # the last row is the one that left the domain
        for array in (trace.q, trace.dq, trace.tau, trace.error):
            assert np.isfinite(array[good]).all()
        assert all(value is None or np.isfinite(value) for value in metrics.values())


WITHOUT_STAGES = ("Mini folded, tracking", "all stretched out", "on the base axis")


@pytest.mark.parametrize(("situation", "plant"), each_on_one_plant(WITHOUT_STAGES))
def test_the_whole_body_has_a_result_in_a_singular_situation(measured, situation, plant):
    changes = [change for change in SINGULAR[situation] if not change.startswith("controller.macro_target")]
    trace, _ = measured("robot=combined", "controller=whole_body", f"plant={plant}", *changes, "duration=2")
    good = slice(None) if trace.failure is None else slice(0, -1)
    for array in (trace.q, trace.dq, trace.tau, trace.error):
        assert np.isfinite(array[good]).all()


def test_a_failed_run_is_stored_with_its_reason(cli):
    ending = cli("robot=combined", *SINGULAR["all stretched out"], "plant=rk4", "controller.period.macro=0.05")
    record = json.loads((ending.folder / "metrics.json").read_text())
    assert ending.code == (0 if record["status"] == "ok" else 1)
    if record["status"] == "failed":
        assert {"reason", "time", "joint", "repetition"} == set(record["failure"])
        assert all(value is None for metric in record["metrics"].values() for value in metric["values"])
