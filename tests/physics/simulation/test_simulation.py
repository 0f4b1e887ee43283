"""Closed loop: ticks, held torques, noise, limits and failures, row by row of the trace."""

import dataclasses
import hashlib
import subprocess
import sys

import numpy as np
import pytest

from runner.assembly.assemble import assemble
from runner.controllers import Loop
from runner.plants import Plant
from runner.plants.motor_limits import TorqueLimits
from runner.sensing.encoders import EncoderNoise, JointEncoders
from runner.simulation.loop import ClosedLoop, simulate
from runner.simulation.sensors import make_encoders

NOISY = ("noise.position=1e-3", "duration=0.5")


class Integrator(Plant):
    """A plant of three unit masses, moved by semi-implicit Euler; it leaves the domain at the tick that a test sets."""

    def __init__(self, period, jump=None):
        self.q, self.dq = np.zeros(3), np.zeros(3)
        self.torques, self._period, self._jump = [], period, jump

    def reset(self, q, dq):
        self.q[:], self.dq[:] = q, dq
        self.torques = []

    def advance(self, tau):
        self.torques.append(tau.copy())
        self.dq += self._period * tau
        self.q += self._period * self.dq
        if self._jump is not None and len(self.torques) == self._jump[0]:
            self.dq[self._jump[1]] = self._jump[2]

    def close(self):
        pass


class Recorder:
    """A controller that keeps what it receives, and answers with what a function of the tick says."""

    def __init__(self, answer=lambda tick: np.zeros(3)):
        self.calls, self.resets, self._answer = [], 0, answer

    def reset(self):
        self.resets += 1
        self.calls = []

    def torque(self, time, q, dq, reference):
        self.calls.append((time, q.copy(), dq.copy(), reference.copy()))
        return self._answer(len(self.calls) - 1)


@pytest.fixture
def loop_of(closed_loop):
    """Make a closed loop of the macro's model and motion around a plant and a controller of a test's."""

    def make(controller, ticks=100, period=0.01, limits=np.inf, jump=None, trajectory="goal") -> ClosedLoop:
        real = closed_loop(f"trajectory={trajectory}")
        return dataclasses.replace(
            real,
            plant=Integrator(period, jump),
            loops=(Loop("arm", slice(0, 3), period, controller),),
            compiled=None,
            tick=period,
            ticks=ticks,
            limits=TorqueLimits.constant(np.zeros(3) + limits),
        )

    return make


def exact(loop):
    noise = EncoderNoise(np.zeros(3), np.zeros(3), np.zeros(3), "none", "exact")
    return [JointEncoders(loop.ticks + 1, loop.tick, noise, np.random.default_rng(0))]


def fingerprint(trace):
    """Every bit of a trace but the clock's."""
    digest = hashlib.sha256()
    for array in (trace.t, trace.q, trace.dq, trace.tau, trace.end_points, trace.desired):
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


# Ticks and rows.


def test_time_is_counted_in_whole_ticks(loop_of):
    loop = loop_of(Recorder(), ticks=1000, period=0.001)
    trace = simulate(loop, exact(loop))
    np.testing.assert_array_equal(trace.t, np.arange(1001) * 0.001)
    assert len(trace.q) == len(trace.tau) == len(trace.tip) == len(trace.desired) == 1001
    assert len(trace.tick_seconds) == 1000
    assert trace.tick_seconds.min() > 0.0
    assert [call[0] for call in loop.loops[0].controller.calls] == trace.t.tolist()


@pytest.mark.parametrize(
    ("duration", "period", "ticks"), [(4.0, 0.01, 400), (0.3, 0.1, 3), (0.35, 0.1, 4), (0.7, 0.001, 700)]
)
def test_a_run_lasts_whole_ticks_and_not_less_than_asked(closed_loop, duration, period, ticks):
    assert closed_loop(f"duration={duration}", f"controller.period={period}").ticks == ticks


def test_the_torque_of_a_row_is_held_until_the_next(loop_of):
    loop = loop_of(Recorder(lambda tick: np.array([1.0, tick, -tick])), ticks=20)
    trace = simulate(loop, exact(loop))
    np.testing.assert_allclose(np.diff(trace.dq, axis=0), 0.01 * trace.tau[:-1], atol=1e-15)
    assert len(loop.plant.torques) == 20


def test_the_last_row_holds_the_final_state_and_the_torque_asked_for_there(loop_of):
    loop = loop_of(Recorder(lambda tick: np.full(3, tick + 1.0)), ticks=7)
    trace = simulate(loop, exact(loop))
    np.testing.assert_array_equal(trace.tau[:, 0], np.arange(1.0, 9.0))
    np.testing.assert_array_equal(trace.q[-1], loop.plant.q)
    np.testing.assert_array_equal(trace.tip[-1], loop.robot.model.tip_position(loop.plant.q))


def test_the_arm_starts_at_rest_where_the_trajectory_starts(loop_of, closed_loop):
    loop = closed_loop("trajectory.start=[0.2,0.9,1.1]", "duration=0.02")
    trace = simulate(loop, exact(loop))
    np.testing.assert_allclose(trace.tip[0], [0.2, 0.9, 1.1], atol=1e-12)
    np.testing.assert_array_equal(trace.dq[0], 0.0)


def test_the_reference_is_the_motion_at_each_tick(loop_of):
    loop = loop_of(Recorder(), ticks=30, trajectory="quintic")
    trace = simulate(loop, exact(loop))
    np.testing.assert_array_equal(trace.desired, loop.trajectory.sample(trace.t))
    np.testing.assert_array_equal([call[3] for call in loop.loops[0].controller.calls], trace.desired)


def test_torques_are_clipped_joint_by_joint(loop_of):
    loop = loop_of(Recorder(lambda tick: np.array([30.0, -30.0, 3.0])), ticks=3, limits=np.array([10.0, 20.0, 40.0]))
    trace = simulate(loop, exact(loop))
    np.testing.assert_array_equal(trace.tau, np.tile([10.0, -20.0, 3.0], (4, 1)))
    np.testing.assert_array_equal(loop.plant.torques, trace.tau[:-1])


def test_a_limit_for_each_joint_comes_from_the_config(simulated):
    trace = simulated("torque_limits.max=[3,40,20]", "duration=1.0")
    np.testing.assert_array_equal(np.abs(trace.tau).max(axis=0), [3.0, 40.0, 20.0])
    np.testing.assert_array_equal(trace.limits, [3.0, 40.0, 20.0])


# Measurement.


@pytest.mark.parametrize("velocity", ["exact", "finite_difference"])
def test_the_controller_reads_noise_and_the_trace_the_truth(checked_config, velocity):
    config = checked_config("noise=thesis", f"noise.velocity={velocity}", "duration=0.3")
    recorder = Recorder(lambda tick: np.array([0.0, 9.0, -9.0]))
    loop = dataclasses.replace(assemble(config), loops=(Loop("arm", slice(0, 3), 0.01, recorder),), compiled=None)
    try:
        trace = simulate(loop, make_encoders(loop, config.noise, config.settings.seed, 0))
    finally:
        loop.plant.close()
    noise = np.random.default_rng([0, 0]).uniform(-1e-3, 1e-3, trace.q.shape)
    measured = np.array([call[1] for call in loop.loops[0].controller.calls])
    np.testing.assert_allclose(measured, trace.q + noise, atol=1e-15)
    told = np.array([call[2] for call in loop.loops[0].controller.calls])
    if velocity == "exact":
        np.testing.assert_array_equal(told, trace.dq)
    else:
        np.testing.assert_array_equal(told[0], 0.0)
        np.testing.assert_allclose(told[1:], np.diff(measured, axis=0) / 0.01, rtol=1e-12, atol=1e-12)
    np.testing.assert_array_equal(trace.tip, loop.robot.model.tip_positions(trace.q))
    np.testing.assert_array_equal(trace.error, trace.desired[:, 0] - trace.tip)


def test_differenced_velocities_settle_too(simulated):
    # The delay of half a period costs damping, not the goal.
    trace = simulated("noise.velocity=finite_difference", "trajectory.goal=[0.3,0.9,1.0]", "duration=2")
    assert trace.failure is None
    assert np.abs(trace.error[0]).max() > 0.05
    assert np.abs(trace.error[-1]).max() < 1e-9


def test_noise_is_drawn_from_seed_and_repetition_alone(checked_config):
    def noise(repetition, *overrides):
        config = checked_config("noise.position=1e-3", *overrides)
        loop = assemble(config)
        loop.plant.close()
        (encoders,) = make_encoders(loop, config.noise, config.settings.seed, repetition)
        return np.array([encoders.measure(tick, np.zeros(3), np.zeros(3))[0] for tick in range(20)])

    first = noise(3, "seed=5")
    for others in (
        ("plant=rk4",),
        ("robot=mini",),
        ("controller.feedforward=false",),
        ("repetitions=9",),
        ("duration=2",),
    ):
        np.testing.assert_array_equal(noise(3, "seed=5", *others), first)
    np.testing.assert_allclose(noise(3, "seed=5", "noise.position=1e-5"), 0.01 * first, rtol=1e-12)
    assert not np.array_equal(noise(4, "seed=5"), first)
    assert not np.array_equal(noise(3, "seed=6"), first)
    assert not np.array_equal(noise(5, "seed=3"), first)


# The same again.


@pytest.mark.parametrize("plant", ["bullet", "mujoco", "rk4"])
def test_the_same_config_and_seed_are_bit_identical(simulated, plant):
    overrides = (*NOISY, f"plant={plant}", "torque_limits=thesis")
    first = fingerprint(simulated(*overrides))
    assert fingerprint(simulated(*overrides)) == first
    assert fingerprint(simulated(*overrides, "seed=1")) != first


@pytest.mark.parametrize("plant", ["bullet", "mujoco", "rk4"])
def test_a_repetition_does_not_depend_on_those_before(checked_config, simulated, plant):
    overrides = (*NOISY, f"plant={plant}")
    config = checked_config(*overrides)
    loop = assemble(config)
    try:
        in_a_row = [
            fingerprint(simulate(loop, make_encoders(loop, config.noise, config.settings.seed, r))) for r in range(3)
        ]
    finally:
        loop.plant.close()
    assert [fingerprint(simulated(*overrides, repetition=r)) for r in range(3)] == in_a_row
    assert len(set(in_a_row)) == 3


@pytest.mark.costs(2)
def test_another_process_gives_the_same_bits(simulated):
    overrides = (*NOISY, "torque_limits=thesis")
    program = (
        "import sys; sys.path[:0] = sys.argv[1:3]\n"
        "import test_simulation as t\n"
        "from runner.config.compose.compose import compose\n"
        "from runner.assembly.validation import validate\n"
        "config = validate(compose(sys.argv[3:]))\n"
        "loop = t.assemble(config)\n"
        "print(t.fingerprint(t.simulate(loop, t.make_encoders(loop, config.noise, config.settings.seed, 1))))\n"
    )
    here = __file__.rpartition("/")[0]
    other = subprocess.run(
        [sys.executable, "-c", program, here, here.rpartition("/")[0], *overrides],
        check=True,
        capture_output=True,
        text=True,
    )
    assert other.stdout.split()[-1] == fingerprint(simulated(*overrides, repetition=1))


def test_the_controller_is_reset_before_each_run(loop_of):
    loop = loop_of(Recorder(), ticks=3)
    for count in (1, 2):
        simulate(loop, exact(loop))
        assert loop.loops[0].controller.resets == count


# Leaving the domain of the equations.


@pytest.mark.parametrize("value", [np.nan, np.inf, -2e6, 1e6])
@pytest.mark.parametrize(("tick", "joint"), [(1, 0), (64, 1), (70, 2), (128, 0), (199, 1), (200, 2)])
def test_divergence_is_a_failure_with_time_and_joint(loop_of, tick, joint, value):
    loop = loop_of(Recorder(), ticks=200, jump=(tick, joint, value))
    trace = simulate(loop, exact(loop))
    assert trace.failure is not None
    assert trace.failure.reason.startswith("diverged")
    assert trace.failure.time == trace.t[-1] == pytest.approx(0.01 * tick)
    assert trace.failure.joint == f"q{joint + 1}"
    assert len(trace.q) == len(trace.dq) == len(trace.tau) == len(trace.tip) == len(trace.desired) == tick + 1
    assert len(trace.tick_seconds) == tick


def test_a_speed_just_below_is_no_divergence(loop_of):
    loop = loop_of(Recorder(), ticks=100, jump=(50, 0, 0.999e6))
    assert simulate(loop, exact(loop)).failure is None


@pytest.mark.parametrize("plant", ["bullet", "mujoco", "rk4"])
def test_an_unstable_sampled_loop_ends_as_a_failure(simulated, plant):
    trace = simulated(f"plant={plant}", "controller.period=0.05", "duration=20")  # wn h = 1.5
    assert trace.failure is not None
    assert trace.failure.joint in ("q1", "q2", "q3")
    assert 0.0 < trace.failure.time < 20.0
    assert np.isfinite(trace.q[:-1]).all()


@pytest.mark.parametrize("limit", [np.inf, 10.0])
def test_a_controller_without_an_answer_is_a_failure(loop_of, limit):
    def answer(tick):
        if tick == 5:
            raise np.linalg.LinAlgError("no way out")
        return np.zeros(3)

    loop = loop_of(Recorder(answer), limits=limit)
    trace = simulate(loop, exact(loop))
    assert trace.failure is not None
    assert (trace.failure.reason, trace.failure.time, trace.failure.joint) == ("no way out", trace.t[5], None)
    assert len(trace.t) == len(trace.q) == len(trace.tau) == 6
    assert len(trace.tick_seconds) == 5


def test_a_law_without_an_answer_to_a_state_that_diverged_is_no_failure_of_its_own(loop_of):
    def answer(tick):
        if tick == 70:
            raise np.linalg.LinAlgError("no matrix of NaN can be solved")
        return np.zeros(3)

    loop = loop_of(Recorder(answer), ticks=100, jump=(68, 2, np.nan))
    failure = simulate(loop, exact(loop)).failure
    assert failure is not None
    assert (failure.reason.split(":")[0], failure.time, failure.joint) == ("diverged", pytest.approx(0.68), "q3")


def test_a_singular_start_is_a_failure_without_damping(closed_loop):
    loop = closed_loop("controller.singularity_damping=0")
    loop = dataclasses.replace(loop, q_start=np.array([0.0, 0.0, np.pi / 2]))
    failure = simulate(loop, exact(loop)).failure
    assert failure is not None
    assert "singular" in failure.reason
    assert failure.time == 0.0
