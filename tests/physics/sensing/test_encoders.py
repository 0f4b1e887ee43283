"""Encoders: noise, steps and biases of readings against their stated distributions."""

import numpy as np
import pytest

from runner.sensing.encoders import EncoderNoise, JointEncoders
from runner.simulation.sensors import make_encoders

PERIOD = 0.01


def encoders(
    ticks=20_000, joints=3, amplitude=1e-3, distribution="uniform", velocity="exact", resolution=0.0, bias=0.0, seed=0
):
    generator = np.random.default_rng(seed)
    every = [np.full(joints, value) for value in (amplitude, bias, resolution)]
    noise = EncoderNoise(*every, distribution, velocity)
    return JointEncoders(ticks, PERIOD, noise, generator)


def read(sensor, q, dq=None):
    """Measure rows of true positions, and the true velocities 1, 2, 3 unless others are given."""
    dq = np.tile([1.0, 2.0, 3.0], (len(q), 1)) if dq is None else dq
    rows = [sensor.measure(tick, *state) for tick, state in enumerate(zip(q, dq, strict=True))]
    return np.array([q for q, _ in rows]), np.array([dq for _, dq in rows])


def noise(ticks=20_000, **config):
    return read(encoders(ticks, **config), np.zeros((ticks, 3)))[0]


def test_uniform_noise_keeps_its_half_width_and_variance():
    found = noise(amplitude=2e-3)
    assert np.abs(found).max() <= 2e-3
    assert np.abs(found).max() > 0.999 * 2e-3
    assert abs(found.mean()) < 4.0 * 2e-3 / np.sqrt(3.0 * found.size)  # four standard deviations of the mean
    assert found.std() == pytest.approx(2e-3 / np.sqrt(3.0), rel=0.01)


def test_gaussian_noise_has_the_amplitude_as_its_standard_deviation():
    found = noise(amplitude=2e-3, distribution="gaussian")
    assert found.std() == pytest.approx(2e-3, rel=0.02)
    assert abs(found.mean()) < 4.0 * 2e-3 / np.sqrt(found.size)
    assert np.mean(np.abs(found) > 2.0 * 2e-3) == pytest.approx(0.0455, abs=0.005)


@pytest.mark.parametrize("config", [{"distribution": "none"}, {"amplitude": 0.0}])
def test_without_noise_the_measurement_is_the_truth(config):
    q = np.random.default_rng(3).uniform(-2.0, 2.0, (10, 3))
    np.testing.assert_array_equal(read(encoders(**config), q)[0], q)


def test_noise_is_added_to_the_true_position():
    q = np.random.default_rng(3).uniform(-2.0, 2.0, (10, 3))
    np.testing.assert_allclose(read(encoders(), q)[0] - q, noise()[:10], atol=1e-15)


@pytest.mark.parametrize("distribution", ["uniform", "gaussian"])
def test_each_joint_and_tick_has_a_draw_of_its_own(distribution):
    found = noise(distribution=distribution)
    assert len(np.unique(found)) == found.size
    correlation = np.corrcoef(np.hstack([found[:-1], found[1:]]).T)  # joint to joint, and tick to tick
    assert np.abs(correlation - np.eye(6)).max() < 4.0 / np.sqrt(len(found))


@pytest.mark.parametrize("distribution", ["uniform", "gaussian"])
def test_the_generator_alone_decides_the_noise(distribution):
    first = noise(distribution=distribution)
    np.testing.assert_array_equal(noise(distribution=distribution), first)
    assert not np.array_equal(noise(distribution=distribution, seed=1), first)


@pytest.mark.parametrize("distribution", ["uniform", "gaussian"])
def test_the_amplitude_scales_the_same_draws(distribution):
    small, large = (noise(amplitude=amplitude, distribution=distribution) for amplitude in (1e-5, 1e-3))
    np.testing.assert_allclose(100.0 * small, large, rtol=1e-12)


@pytest.mark.parametrize("distribution", ["uniform", "gaussian"])
def test_a_longer_run_starts_with_the_noise_of_a_shorter_one(distribution):
    short, long = (noise(ticks, distribution=distribution) for ticks in (10, 500))
    np.testing.assert_array_equal(long[:10], short)


def test_exact_velocities_carry_no_noise():
    np.testing.assert_array_equal(read(encoders(), np.zeros((5, 3)))[1], np.tile([1.0, 2.0, 3.0], (5, 1)))


def test_differenced_velocities_start_from_the_first_measurement_and_use_the_period():
    q = np.random.default_rng(3).uniform(-2.0, 2.0, (10, 3))
    measured, velocity = read(encoders(velocity="finite_difference"), q)
    np.testing.assert_array_equal(velocity[0], np.zeros(3))
    np.testing.assert_allclose(velocity[1:], np.diff(measured, axis=0) / PERIOD, rtol=1e-12)
    assert np.abs(measured - q).max() > 1e-4  # noise included


def test_differenced_velocities_do_not_see_a_state_that_is_renewed_in_place():
    # Plants renew q in place; a sensor that kept it would find no difference.
    sensor, q = encoders(distribution="none", velocity="finite_difference"), np.zeros(3)
    sensor.measure(0, q, q)
    q += 0.5
    np.testing.assert_allclose(sensor.measure(1, q, q)[1], 0.5 / PERIOD)


def test_readings_are_whole_steps_off_by_at_most_half_a_step_with_its_variance():
    q = np.random.default_rng(3).uniform(-2.0, 2.0, (20_000, 3))
    measured, _ = read(encoders(distribution="none", resolution=1e-3), q)
    np.testing.assert_allclose(measured / 1e-3, np.round(measured / 1e-3), atol=1e-9)
    assert np.abs(measured - q).max() <= 0.5e-3 + 1e-15
    assert (measured - q).std() == pytest.approx(1e-3 / np.sqrt(12.0), rel=0.01)


def test_noise_is_rounded_with_the_position():
    measured, _ = read(encoders(amplitude=2e-3, resolution=1e-3), np.zeros((20_000, 3)))
    np.testing.assert_allclose(measured, np.round(noise(amplitude=2e-3) / 1e-3) * 1e-3, atol=1e-15)
    assert len(np.unique(np.round(measured / 1e-3))) == 5  # -2 to 2 steps


def test_differenced_velocities_come_in_steps_over_the_period():
    q = np.cumsum(np.full((50, 3), 0.3e-3), axis=0)
    _, velocity = read(encoders(distribution="none", velocity="finite_difference", resolution=1e-3), q)
    np.testing.assert_allclose(np.unique(np.round(velocity, 9)), [0.0, 1e-3 / PERIOD])


def test_a_bias_is_added_to_every_reading_beside_its_noise():
    q = np.random.default_rng(3).uniform(-2.0, 2.0, (10, 3))
    np.testing.assert_array_equal(read(encoders(distribution="none", bias=-0.25), q)[0], q - 0.25)
    np.testing.assert_allclose(read(encoders(bias=-0.25), q)[0], read(encoders(), q)[0] - 0.25, atol=1e-15)


def test_a_biased_reading_is_rounded():
    measured, _ = read(encoders(distribution="none", resolution=1e-3, bias=0.4e-3), np.full((1, 3), 2.2e-3))
    np.testing.assert_allclose(measured, 3e-3, atol=1e-15)


def test_differenced_velocities_do_not_see_a_bias():
    q = np.random.default_rng(3).uniform(-2.0, 2.0, (10, 3))
    biased, plain = (read(encoders(velocity="finite_difference", bias=bias), q)[1] for bias in (0.25, 0.0))
    np.testing.assert_allclose(biased, plain, atol=1e-12)


def test_each_stage_has_its_own_bias(closed_loop, checked_config):
    overrides = ("robot=combined", "noise.bias.macro=-1e-3", "noise.bias.mini=2e-3")
    for repetition in range(2):
        for sensor in make_encoders(closed_loop(*overrides), checked_config(*overrides).noise, 0, repetition):
            np.testing.assert_allclose(sensor.measure(0, np.zeros(6), np.zeros(6))[0], [-1e-3] * 3 + [2e-3] * 3)


def test_a_noise_without_bias_and_steps_does_for_an_arm_of_several_stages(checked_config):
    noise = checked_config("robot=combined", "~noise.bias", "~noise.resolution").noise
    np.testing.assert_array_equal([noise.bias, noise.resolution], np.zeros((2, 6)))


@pytest.mark.parametrize(("robot", "scale"), [("macro", 1.0), ("mini", 0.1)])
@pytest.mark.parametrize("plant", ["bullet", "rk4"])
def test_at_rest_the_tip_errs_by_what_the_bias_puts_it_elsewhere(simulated, request, robot, scale, plant):
    bias, model = 1e-4, request.getfixturevalue(robot)
    trace = simulated(f"robot={robot}", f"plant={plant}", f"duration={3.0 * scale}", f"noise.bias={bias}")
    assert np.abs(trace.dq[-1]).max() < 1e-6
    q, b = trace.q[-1], np.full(3, bias)
    J = model.tip_jacobian(q)[:3]
    np.testing.assert_allclose(trace.error[-1], J @ b, atol=0.03 * np.linalg.norm(J @ b))
    # The law's gravity is that of the biased posture, which its spring omega_n^2 carries: a hundredth of the error.
    wrong = np.linalg.solve(model.mass_matrix(q), model.gravity_torque(q + b) - model.gravity_torque(q))
    expected = J @ b - J @ wrong / (30.0 / scale) ** 2
    np.testing.assert_allclose(trace.error[-1], expected, atol=1e-3 * np.linalg.norm(expected))


def test_each_stage_reads_in_its_own_steps(closed_loop, checked_config):
    overrides = ("robot=combined", "noise.resolution.mini=1e-2")
    (macro, mini) = make_encoders(closed_loop(*overrides), checked_config(*overrides).noise, 0, 0)
    for sensor in (macro, mini):  # each loop reads every joint
        np.testing.assert_allclose(sensor.measure(0, np.full(6, 0.1234), np.zeros(6))[0], [0.1234] * 3 + [0.12] * 3)


def test_an_arm_at_rest_is_held_within_a_step_of_its_encoders(simulated):
    """Between two steps the loop sees no error: the joints wander by up to one, and no further."""
    trace = simulated(
        "robot=macro", "trajectory=quintic", "trajectory.duration=1", "noise.resolution=1e-3", "duration=3"
    )
    wandering = np.ptp(trace.q[trace.t > 2.0], axis=0)
    assert (wandering > 1e-7).any()
    assert (wandering < 2e-3).all()


@pytest.mark.parametrize(
    ("robot", "override", "message"),
    [
        ("macro", "noise.resolution=-1e-3", "noise.resolution: must be 0 or more; found -0.001"),
        (
            "combined",
            "noise.resolution=1e-3",
            "noise.resolution: needs a value for each stage (macro, mini)",
        ),
        ("combined", "noise.resolution.mimi=1", "noise.resolution.mimi: no such stage (did you mean mini?)"),
        ("macro", "noise.bias=inf", "noise.bias: must be a finite number; found inf"),
        ("macro", "noise.bias=wrong", "noise.bias: must be a number; found 'wrong'"),
        ("combined", "noise.bias.mini=nan", "noise.bias: mini must be a finite number; found"),
        ("combined", "noise.bias=-1e-3", "noise.bias: needs a value for each stage (macro, mini)"),
        ("combined", "noise.bias.mimi=1", "noise.bias.mimi: no such stage (did you mean mini?)"),
    ],
)
def test_steps_and_biases_that_cannot_be(cli, robot, override, message):
    ending = cli(f"robot={robot}", override)
    assert ending.code == 2
    assert message in ending.err


@pytest.mark.parametrize("distribution", ["uniform", "none"])
def test_the_true_state_is_only_read(distribution):
    q, dq = np.ones(3), np.ones(3)
    q.setflags(write=False)
    measured, _ = encoders(distribution=distribution).measure(0, q, dq)
    measured += 1.0
    np.testing.assert_array_equal(q, np.ones(3))
