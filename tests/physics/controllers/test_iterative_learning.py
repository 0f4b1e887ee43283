"""Iterative learning: contraction by frequency, limits, a prototype's iterations and refusals."""

from dataclasses import replace

import numpy as np
import pytest
from support import strangers
from support.motions import to_and_fro, write_joints

from runner.assembly.assemble import assemble
from runner.base.errors import ConfigError
from runner.controllers.joint_space.iterative_learning import IterativeLearning, IterativeLearningConfig
from runner.robots.model import RobotModel
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_encoders
from runner.sweeps.job import run

H, OMEGA, GAIN = 0.001, 30.0, 0.8
CIRCLE = ("robot=macro", "controller=iterative_learning", "trajectory=circle", "trajectory.easing=none",
          "trajectory.duration=2")  # fmt: skip
TO_AND_FRO = ("robot=macro", "controller=iterative_learning", "controller.period=0.002", "plant=rk4",
              "controller.natural_frequency=30", "controller.repeats_every=3", "controller.cutoff=null",
              "trajectory=from_file", "mismatch.mass=0.8", "plant.friction.viscous=0.2",
              "plant.friction.coulomb=0.5")  # fmt: skip


def slider(**changes):
    """Return the law of one prismatic joint without weight, period 4 s, and its mass: an exactly linear arm."""
    model = RobotModel(strangers.chain("slider", [("prismatic", strangers.X)]), "tip", gravity=0.0)
    values = {
        "kind": "iterative_learning",
        "task": "position",
        "natural_frequency": OMEGA,
        "damping_ratio": 1.0,
        "period": H,
        "gravity_compensation": True,
        "feedforward": True,
        "singularity_damping": 0.0,
        "null_space_frequency": 0.0,
        "repeats_every": 4.0,
        "learning_gain": GAIN,
        "cutoff": None,
        **changes,
    }
    law = IterativeLearning(model, IterativeLearningConfig(**values), np.zeros(1), True)
    return law, model.mass_matrix(np.zeros(1))[0, 0]


def driven(law, mass, force, periods, limit=np.inf):
    """Return feedback and learned force by period, shapes (periods, N), of the slider under a force, shape (N,).

    Commands are held for a tick, which an integrator of constant forces takes exactly.
    """
    law = law.with_limits(np.full(1, limit))
    q, dq, reference, n = np.zeros(1), np.zeros(1), np.zeros((3, 1)), len(force)
    feedback, learned = np.empty((periods, n)), np.empty((periods, n))
    for k in range(periods * n):
        asked = law.torque(k * H, q, dq, reference)
        held = np.clip(asked, -limit, limit)
        j, i = divmod(k, n)
        learned[j, i] = law.learned[i, 0]
        feedback[j, i] = asked[0] - learned[j, i]
        ddq = (held + force[i]) / mass
        q, dq = q + H * dq + 0.5 * H**2 * ddq, dq + H * ddq
    return feedback, learned


@pytest.mark.parametrize("cycles", [1, 10, 40])  # of 2 s: 0.5, 5 and 20 Hz, below and above omega_n
def test_feedback_shrinks_from_period_to_period_by_the_closed_form(cycles):
    law, mass = slider()
    w = 2.0 * np.pi * cycles / 2.0
    t = H * np.arange(4000)
    feedback, _ = driven(law, mass, np.cos(w * t), 4)
    # the second half of a period: the torque's jump at its start has died away
    parts = feedback[:, 2000:] @ np.exp(-1j * w * t[2000:])
    s = 1j * w
    T = (2.0 * OMEGA * s + OMEGA**2) / (s**2 + 2.0 * OMEGA * s + OMEGA**2)
    ratios = np.abs(parts[2:] / parts[1:-1])
    np.testing.assert_allclose(ratios, abs(1.0 - GAIN * T), rtol=0.05)


def test_a_limit_bounds_what_is_learned():
    """A constant force of 2 N against a limit of 1 N: u goes to the limit by 1 - gamma a period, and not above."""
    law, mass = slider(repeats_every=0.4)
    _, learned = driven(law, mass, np.full(400, -2.0), 12, limit=1.0)
    left = 1.0 - learned[2:, -1]
    np.testing.assert_allclose(left[1:5] / left[:4], 1.0 - GAIN, rtol=1e-6)
    assert np.abs(learned).max() < 1.0 + 1e-9


def test_a_run_tells_the_law_what_its_limits_left(checked_config):
    """The Macro cannot hold its links up with 15 N m: the learned torque converges to limit minus feedforward."""
    config = checked_config(*CIRCLE, "duration=20", "plant=rk4", "torque_limits.max=15", "mismatch.mass=0.8")
    closed = assemble(config)
    law = closed.loops[0].controller
    simulate(closed, make_encoders(closed, config.noise, 0, 0))
    closed.plant.close()
    assert np.abs(law.learned).max() < 15.0  # 8.7 kN m if the law does not know the limit


def test_the_low_pass_ends_learning_above_its_cut_off_and_has_no_phase():
    law, _ = slider(cutoff=1.0)
    w = 2.0 * np.pi * 10.0
    t = H * np.arange(4000)
    law._feedback[:, 0] = np.cos(w * t)
    law._learn()
    np.testing.assert_allclose(law.learned[:, 0], GAIN * np.cos(w * t) / (1.0 + (w / OMEGA) ** 4), atol=1e-12)


def test_reset_forgets():
    law, mass = slider(repeats_every=0.4)
    first = driven(law, mass, np.ones(400), 3)
    law.reset()
    np.testing.assert_array_equal(driven(law, mass, np.ones(400), 3), first)
    assert first[1][2].any()


@pytest.fixture
def prototype(tmp_path):
    """Choose a file with the motion of test_joint_laws for 18 s; and its joints q_d."""
    q_d = to_and_fro([0.8, -0.5, 0.6], 0.002, 18.0)[:, 0]
    return f"trajectory.file={write_joints(tmp_path / 'to_and_fro.csv', q_d, 0.002)}", q_d


def rms(trace, q_d):
    """Return the rms of the norm of the joint errors by period of 3 s, in mrad."""
    n = len(trace.q) // 1500 * 1500
    error = np.sum((trace.q[:n] - q_d[:n]) ** 2, axis=1).reshape(-1, 1500)
    return 1e3 * np.sqrt(error.mean(axis=1))


def test_iterations_from_rest_are_those_of_the_prototype(checked_config, prototype):
    """The prototype resets the arm to rest at the start before each iteration, like Arimoto."""
    file, q_d = prototype
    config = checked_config(*TO_AND_FRO, file, "duration=6.002")
    closed = replace(assemble(config), ticks=1499)
    law, found, forget = closed.loops[0].controller, [], closed.loops[0].controller.reset
    learned = np.zeros((1500, 3))

    def put_back():
        forget()
        law.learned = learned

    law.reset = put_back
    for _ in range(5):
        trace = simulate(closed, make_encoders(closed, config.noise, 0, 0))
        found.append(rms(trace, q_d)[0])
        law._learn()
        learned = law.learned
    closed.plant.close()
    np.testing.assert_allclose(found, [3.63, 0.745, 0.160, 0.043, 0.020], rtol=0.1)


def test_the_error_shrinks_from_period_to_period_of_one_run(simulated, prototype):
    file, q_d = prototype
    found = rms(simulated(*TO_AND_FRO, file, "duration=18"), q_d)
    ratios = found[2:] / found[1:-1]
    assert (ratios[:2] < 0.3).all()
    assert found[-1] < 0.02 * found[1]


@pytest.mark.parametrize("robot", ["macro", "xarm7"])
def test_it_learns_a_circle_of_the_tip(simulated, robot):
    """Every joint of the Macro repeats; those of the xArm7 do once home's posture has drawn its null space."""
    trace = simulated(f"robot={robot}", *CIRCLE[1:], "duration=12", "mismatch.mass=0.8", "plant=rk4")
    error = np.linalg.norm(trace.tip - trace.desired[:, 0], axis=1)
    n = round(2.0 / (trace.t[1] - trace.t[0]))
    by_period = np.sqrt(np.mean(error[: 6 * n].reshape(6, n) ** 2, axis=1))
    assert by_period[5] < 0.1 * by_period[1]


def test_it_is_not_compiled(checked_config):
    closed = assemble(checked_config(*CIRCLE, "duration=5", "plant=rk4"))
    assert closed.compiled is None
    closed.plant.close()


def test_a_stored_run_is_the_same_twice(tmp_path):
    made = [run(*CIRCLE, "duration=5", "noise.position=1e-4", f"outputs={tmp_path / name}") for name in "ab"]
    assert made[0].status == "ok"
    assert made[0].metrics == made[1].metrics


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (("trajectory=circle",), r"repeats_every: 6 s, but the desired motion is not the same that time later"),
        (("trajectory=goal",), r"repeats_every: it refers to trajectory.duration, which the chosen trajectory lacks"),
        (("trajectory=goal", "controller.repeats_every=1"), r"the desired motion rests; allowed: trajectory=circle or"),
        (("trajectory=joint_quintic",), r"allowed: trajectory=circle or lissajous with trajectory.easing=none"),
        (("duration=4",), r"duration: 4 s is no longer than two of controller.repeats_every, 2 s"),
        (("controller.repeats_every=1.5",), r"repeats_every: 1.5 s, but the desired motion .* first at 0 s"),
        (("controller.repeats_every=2.005",), r"2.005 s is not a multiple of controller.period, 0.01 s; such as 2"),
        (("controller.repeats_every=1e9",), r"1e\+09 s are 1e\+11 of controller.period, 0.01 s; allowed: up to"),
        (("controller.repeats_every=null",), r"repeats_every: null; allowed: the time in s"),
        (("controller.learning_gain=2",), r"controller.learning_gain"),
    ],
)
def test_what_does_not_repeat_is_refused(checked_config, overrides, message):
    chosen = CIRCLE[:2] if overrides[0].startswith("trajectory=") else CIRCLE
    with pytest.raises(ConfigError, match=message):
        checked_config(*chosen, *(() if "duration=4" in overrides else ("duration=20",)), *overrides)
