"""Whole runs as compiled code against the same runs through Pinocchio, single and together."""

from dataclasses import replace

import numpy as np
import pytest
from support.arms import checked
from support.physics import assert_same_motion

from runner.assembly.assemble import assemble, assemble_program
from runner.assembly.compiled import commands
from runner.assembly.compiled.loop_program import run_all
from runner.simulation.batch import BatchSimulator
from runner.simulation.loop import simulate
from runner.simulation.run import simulate_repetition
from runner.simulation.sensors import make_encoders

NOISY = "noise=thesis", "torque_limits=thesis"
RUNS = [
    ("robot=macro", "controller=operational_space", *NOISY),
    ("robot=macro", "controller=computed_torque", "controller.integral_gain=500", *NOISY),
    ("robot=mini", "controller=operational_space", *NOISY),
    ("robot=combined", "controller=whole_body", *NOISY),
    ("robot=xarm7", "controller=operational_space", "noise.position=1e-5", "torque_limits.max=20"),
    ("robot=xarm7", "controller=computed_torque", "controller.task=pose", "noise.distribution=gaussian"),
    ("robot=macro", "controller=operational_space", "mismatch.mass=1.1", *NOISY),
    ("robot=macro", "controller=operational_space", *NOISY, "noise.velocity=finite_difference"),
    ("robot=macro", "controller=operational_space", *NOISY, "noise.velocity=low_pass"),
    ("robot=macro", "controller=operational_space", *NOISY, "noise.velocity=luenberger", "noise.resolution=1e-4"),
    ("robot=combined", "controller=macro_mini", "noise.velocity=luenberger", "noise.velocity_bandwidth=5000"),
    ("robot=macro", "controller=operational_space", *NOISY, "noise.resolution=1e-4", "noise.bias=1e-3"),
    ("robot=macro", "controller=operational_space", *NOISY, "plant.computation.delay=2"),
    ("robot=macro", "controller=operational_space", *NOISY, "plant.step=0.0025"),
    ("robot=macro", "controller=operational_space", *NOISY, "plant.friction.viscous=[3,0,0.5]"),
    ("robot=macro", "controller=operational_space", *NOISY, "plant.friction.coulomb=[0,8,1]"),
    ("robot=xarm7", "controller=operational_space", "plant.friction.viscous=1", "plant.friction.coulomb=2"),
    (
        "robot=macro",
        "controller=operational_space",
        *NOISY,
        "plant.friction.coulomb=[0,3,1]",
        "plant.friction.viscous=1",
        "plant.friction.static=[2,5,1]",
        "plant.friction.stribeck_speed={q1: 0.02}",
        "plant.friction.asymmetry={q2: -1}",
        "plant.friction.sigmoid={level: 1, steepness: [8,8,0], shift: [0.03,0,1]}",
    ),
    ("robot=xarm7", "controller=operational_space", "plant.friction.coulomb=2", "plant.friction.static=3"),
    (
        "robot=combined",
        "controller=whole_body",
        "plant.dynamics=decoupled",
        *NOISY,
        "plant.friction.coulomb=1",
        "plant.friction.static={mini_q1: 2}",
        "plant.friction.stribeck_speed=0.1",
        "plant.friction.stribeck_curve=exponential",
    ),
    ("robot=combined", "controller=whole_body", "plant.dynamics=decoupled", *NOISY),
    ("robot=combined", "controller=whole_body", "plant.dynamics=decoupled", "plant.wrist_rotation=parallel"),
    *(
        ("robot=combined", "controller=macro_mini", *NOISY, *(f"controller.{text}" for text in how))
        for how in (
            ["coupling=one_way"],
            ["coupling=two_way", "period={macro: 0.01, mini: 0.001}"],
            ["coupling=independent"],
            ["coupling=independent_base", "mini_reference_velocity=full"],
            ["coupling=mini_held"],
            ["schedule=turns"],
            ["beyond_reach=stretch", "mini_reference_velocity=full"],
            ["wrist_rotation=parallel"],
        )
    ),
]


def run(*overrides, seed=0):
    return simulate_repetition(checked(*overrides, "plant=rk4", f"seed={seed}"))


def run_both(monkeypatch, *overrides, seed=0):
    ours = run(*overrides, seed=seed)
    with monkeypatch.context() as without:
        without.setattr(commands, "evaluator", dict)
        theirs = run(*overrides, seed=seed)
    assert (ours.law_seconds is None, theirs.law_seconds is None) == (True, False)  # compiled as a whole, interpreted
    return ours, theirs


@pytest.mark.parametrize(
    ("seed", "overrides"),
    list(enumerate(RUNS)),
    ids=lambda part: f"seed={part}" if isinstance(part, int) else " ".join(part),
)
def test_whole_runs_are_those_of_pinocchio(monkeypatch, overrides, seed):
    horizon = 0.6 if "robot=combined" in overrides else 1.2  # s; the combined arm has ten times as many ticks
    ours, theirs = run_both(monkeypatch, *overrides, "trajectory=quintic", f"duration={horizon}", seed=seed)
    assert_same_motion(ours, theirs)
    assert len(ours.tick_seconds) == len(ours.t) - 1
    assert (ours.tick_seconds > 0.0).all()


def test_torques_stop_at_their_limits():
    trace = run("robot=macro", "controller=operational_space", "trajectory=goal", "torque_limits.max=30")
    assert np.abs(trace.tau).max() == 30.0


def test_the_same_run_has_the_same_bits():
    first, second = (run(*RUNS[0], "duration=0.5") for _ in range(2))
    np.testing.assert_array_equal(first.q, second.q)
    np.testing.assert_array_equal(first.tau, second.tau)


def test_divergence_ends_a_run_at_the_same_tick_and_joint(monkeypatch):
    wild = "robot=macro", "controller=operational_space", "trajectory=goal", "controller.natural_frequency=900"
    ours, theirs = run_both(monkeypatch, *wild, "controller.singularity_damping=0")
    assert "diverged" in ours.failure.reason
    assert (ours.failure.joint, ours.failure.reason) == (theirs.failure.joint, theirs.failure.reason)
    assert ours.failure.time == pytest.approx(theirs.failure.time, abs=0.05)
    assert len(ours.t) == round(ours.failure.time / 0.01) + 1


def test_a_law_without_an_answer_ends_a_run_with_its_reason():
    config = checked("robot=macro", "controller=operational_space", "controller.singularity_damping=0", "plant=rk4")
    (spec,) = BatchSimulator().repetitions(config)
    ((_, trace),) = BatchSimulator().simulate([replace(spec, q_start=np.array([0.0, 0.0, np.pi / 2]))])
    assert (trace.failure.reason, trace.failure.time) == ("the tip's Jacobian is singular", 0.0)
    assert len(trace.t) == 1


def times_of(config):
    return np.arange(config.timing.ticks + 1) * config.timing.tick


def together(config, errors):
    """Return the signals of runs of a closed loop that differ in the errors of their encoders."""
    (whole, q_start), times = assemble_program(config), times_of(config)
    return run_all(
        whole,
        np.repeat([whole.values], len(errors), axis=0),
        whole.commands.shared(times, config.path.sample(times)),
        [np.array(of_loop) for of_loop in zip(*errors, strict=True)],
        np.concatenate([whole.commands.start(q_start[None], [each[:1] for each in own]) for own in errors]),
    )


@pytest.mark.parametrize("overrides", [RUNS[1], RUNS[3], RUNS[12], RUNS[14]], ids=" ".join)
def test_a_run_has_the_same_bits_alone_and_at_any_place_among_others(overrides):
    config = checked(*overrides, "plant=rk4", "trajectory=quintic", "duration=0.5")
    closed = assemble(config)
    errors = [[each.errors for each in make_encoders(closed, config.noise, seed, 0)] for seed in range(21)]
    alone = [together(config, [own]) for own in errors]
    assert np.abs(alone[0].q - alone[1].q).max() > 0.0 or not config.noise.position.any()
    for count in (2, 7, 8, 21):
        found = together(config, errors[:count][::-1])
        for place, single in enumerate(alone[:count][::-1]):
            for name in ("q", "dq", "command", "fault"):
                np.testing.assert_array_equal(getattr(found, name)[place], getattr(single, name)[0])
            np.testing.assert_array_equal(found.end_points[:, place], single.end_points[:, 0])


def test_runs_on_several_paths_are_computed_together():
    config = checked("robot=macro", "controller=operational_space", "plant=rk4", "duration=0.5")
    (whole, q_start), times = assemble_program(config), times_of(config)
    paths = config.path.sample(times) + 0.01 * np.arange(11)[:, None, None, None] * np.array([[1.0], [0], [0]])
    start = whole.commands.start(q_start[None], [np.zeros((1, 3))])
    still = [np.zeros((11, len(times), 3))]
    values = np.repeat([whole.values], 11, axis=0)
    found = run_all(whole, values, whole.commands.shared(times, paths), still, np.repeat(start, 11, axis=0))
    for place, path in enumerate(paths):
        single = run_all(whole, values[:1], whole.commands.shared(times, path), [still[0][:1]], start)
        np.testing.assert_array_equal(found.q[place], single.q[0])
    assert np.abs(np.diff(found.q[:, -1], axis=0)).min() > 0.0


def test_a_run_that_diverges_leaves_those_beside_it_alone():
    config = checked("robot=macro", "controller=operational_space", "plant=rk4", "duration=1")
    rows = config.timing.ticks + 1
    good, wild = [np.zeros((rows, 3))], [np.full((rows, 3), 1e200)]
    found = together(config, [wild, good, wild])
    np.testing.assert_array_equal(found.q[1], together(config, [good]).q[0])
    assert not np.isfinite(found.q[[0, 2]]).all()


@pytest.mark.bullet
def test_bullet_gets_its_torques_from_compiled_laws(monkeypatch):
    overrides = "robot=combined", "controller=whole_body", "plant=bullet", "duration=0.2", *NOISY
    traces = []
    for library in (commands.evaluator, dict):
        monkeypatch.setattr(commands, "evaluator", library)
        config = checked(*overrides)
        closed = assemble(config)
        assert (closed.compiled is not None) == (library is not dict)
        traces.append(simulate(closed, make_encoders(closed, config.noise, 0, 0)))
        closed.close()
    np.testing.assert_allclose(traces[0].q, traces[1].q, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(traces[0].end_points, traces[1].end_points, rtol=0.0, atol=1e-11)
