"""Motions of the joints of every kind, and the tip's motion that follows: derivatives and distance."""

import numpy as np
import pytest
from scipy.interpolate import BPoly
from support.arms import checked

from runner.base.errors import ConfigError
from runner.robots.robot import end_points
from runner.trajectories.joint_motion import SampledCurve

KINDS = ("joint_quintic", "joint_waypoints", "joint_sinusoids")
ROBOTS = {
    "macro": ("robot=macro",),
    "xarm7": ("robot=xarm7", "trajectory.start_configuration=[0.1,0.6,-0.1,1.4,0.2,0.7,-0.2]"),
    "parallel": ("robot=combined", "plant=rk4", "plant.wrist_rotation=parallel"),
}


def path_of(*overrides):
    return checked(*overrides).path


@pytest.fixture(params=[(kind, robot) for kind in KINDS for robot in ROBOTS], ids="-".join)
def path(request):
    kind, robot = request.param
    return path_of(*ROBOTS[robot][:1], f"trajectory={kind}", *ROBOTS[robot][1:])


def derivative(sample, t, order):
    h = 1e-5
    return (sample(t + h)[:, order] - sample(t - h)[:, order]) / (2.0 * h)


def test_velocities_and_accelerations_are_derivatives(path):
    t = np.random.default_rng(0).uniform(1e-5, path.duration - 1e-5, 60)
    for sample in (path.sample_joints, path.sample):
        motion = sample(t)
        for order in (0, 1):
            size = np.abs(motion[:, order + 1]).max()
            np.testing.assert_allclose(derivative(sample, t, order), motion[:, order + 1], atol=2e-7 * size + 1e-10)


def test_it_goes_from_rest_to_rest(path):
    ends = np.array([0.0, path.duration, 3.0 * path.duration])
    for sample in (path.sample_joints, path.sample):
        np.testing.assert_allclose(sample(ends)[:, 1:], 0.0, atol=1e-11)
    np.testing.assert_allclose(path.sample_joints(ends)[0, 0], path.q_start, atol=1e-15)
    np.testing.assert_array_equal(path.sample(ends)[0, 0], path.start)
    np.testing.assert_allclose(path.sample(ends)[1:, 0], [path.goal, path.goal], atol=1e-12)
    assert path.run_duration == path.duration + 1.0


def test_the_tip_is_where_the_joints_bring_it(path):
    t = np.linspace(0.0, path.duration, 20)
    q = path.sample_joints(t)[:, 0]
    np.testing.assert_allclose(
        path.sample(t)[:, 0], end_points(path.robot, q, path.ignore_base_rotation)[-1], atol=1e-14
    )


def test_its_own_path_has_no_distance_and_points_beside_it_have(path):
    t = np.linspace(0.0, path.duration, 150)
    points = path.sample(t)[:, 0]
    assert path.distance_to_path(points).max() < 1e-8
    beside = points[::4] + np.array([0.0, 0.0, 0.3])
    fine = path.sample(np.linspace(0.0, path.duration, 8001))[:, 0]
    nearest = [np.linalg.norm(fine - point, axis=1).min() for point in beside]
    np.testing.assert_allclose(path.distance_to_path(beside), nearest, atol=1e-5)


def test_the_tip_s_own_trajectories_lead_no_joints():
    assert path_of("robot=macro", "trajectory=quintic").sample_joints(np.zeros(1)) is None


def test_a_quintic_peaks_at_half_time():
    path = path_of("robot=macro", "trajectory=joint_quintic", "trajectory.start_configuration=0.1")
    motion = path.sample_joints(np.array([0.5 * path.duration]))[0]
    np.testing.assert_allclose(motion[0], 0.5 * (0.1 + 0.5) * np.ones(3), rtol=1e-14)
    np.testing.assert_allclose(motion[1], 1.875 * 0.4 / 3.0 * np.ones(3), rtol=1e-14)
    np.testing.assert_allclose(motion[2], 0.0, atol=1e-14)


def test_way_points_are_passed_at_their_times():
    path = path_of("robot=macro", "trajectory=joint_waypoints", "trajectory.time_shares=[0.2,0.7,1]")
    motion = path.sample_joints(path.duration * np.array([0.2, 0.7, 1.0]))[:, 0]
    np.testing.assert_allclose(motion, np.outer([0.5, 0.2, 0.6], np.ones(3)), atol=1e-12)


def test_sinusoids_are_those_given_between_the_ramps():
    given = "[[[0.1,0.0],[0.0,0.05]],[[0.0,0.2],[0.0,0.0]],[[0.0,0.0],[-0.1,0.1]]]"
    path = path_of(
        *("robot=macro", "trajectory=joint_sinusoids", "trajectory.harmonics=2", f"trajectory.coefficients={given}"),
        *(
            "trajectory.frequency=0.5",
            "trajectory.ramp=1",
            "trajectory.duration=8",
            "trajectory.start_configuration=0.3",
        ),
    )
    t = np.linspace(1.0, 7.0, 50)
    omega = np.pi * (t - 1.0)
    expected = 0.3 + np.array(
        [
            0.1 * np.sin(omega) + 0.05 * np.cos(2.0 * omega),
            0.2 * np.cos(omega),
            -0.1 * np.sin(2.0 * omega) + 0.1 * np.cos(2.0 * omega),
        ]
    )
    np.testing.assert_allclose(path.sample_joints(t)[:, 0], expected.T, atol=1e-14)
    np.testing.assert_allclose(path.sample_joints(t + 2.0)[:-17], path.sample_joints(t)[:-17], atol=1e-12)


def test_drawn_sinusoids_keep_within_their_amplitude_and_follow_from_the_seed():
    one, again, other = (
        path_of("robot=xarm7", "trajectory=joint_sinusoids", "trajectory.amplitude=[0.1,0.2,0.3,0.2,0.1,0.2,0]", more)
        for more in ("seed=0", "seed=1", "trajectory.seed=1")
    )
    t = np.linspace(0.0, one.duration, 400)
    swing = np.abs(one.sample_joints(t)[:, 0] - one.q_start).max(axis=0)
    assert (swing <= [0.1, 0.2, 0.3, 0.2, 0.1, 0.2, 0.0]).all()
    assert (swing[:6] > 0.02).all()
    np.testing.assert_array_equal(again.sample_joints(t), one.sample_joints(t))
    assert np.abs(other.sample_joints(t) - one.sample_joints(t)).max() > 0.05


@pytest.mark.parametrize(
    ("overrides", "problem"),
    [
        (
            ["joint_quintic", "goal_configuration=[0.1,0.2]"],
            r"goal_configuration: 2 values for 3 joints \(q1, q2, q3\)",
        ),
        (["joint_quintic", "goal_configuration=fast"], "goal_configuration: must be a number, or a list of numbers"),
        (["joint_quintic", "start_configuration=[1]"], "start_configuration: 1 values for 3 joints"),
        (["joint_waypoints", "configurations=[]"], "configurations: must have one configuration or more"),
        (
            ["joint_waypoints", "configurations=[0.2,0.2]"],
            "configurations.1: is the same as trajectory.configurations.0",
        ),
        (["joint_waypoints", "time_shares=[0.5,1]"], "time_shares: must be 3 ascending numbers"),
        (["joint_sinusoids", "duration=1"], "duration: must have room for both ramps, 2 s or more; found 1"),
        (["joint_sinusoids", "coefficients=[[[0,1]]]"], "coefficients: 1 lists for 3 joints"),
        (["joint_sinusoids", "coefficients=[[[0,1]],[[0,1]],[[0,1]]]"], "coefficients.0: 1 pairs for"),
    ],
)
def test_what_does_not_fit_is_told(overrides, problem):
    kind, *values = overrides
    with pytest.raises(ConfigError, match=f"trajectory.{problem}"):
        path_of("robot=macro", f"trajectory={kind}", *(f"trajectory.{value}" for value in values))


def test_a_polynomial_of_fifth_order_is_kept_with_its_derivatives():
    motion = np.polynomial.Polynomial([0.3, -1.0, 0.5, 2.0, -0.7, 0.2])
    orders = [motion, motion.deriv(1), motion.deriv(2)]
    times, between = np.array([0.0, 0.4, 1.5]), np.linspace(0.0, 1.5, 41)
    samples, expected = (np.stack([order(t) for order in orders], axis=1)[:, :, None] for t in (times, between))
    assert SampledCurve(times, samples).sample(between) == pytest.approx(expected, rel=1e-12, abs=1e-12)


def test_it_is_the_curve_of_scipy_at_samples_and_between_them():
    rng = np.random.default_rng(0)
    times, samples = np.cumsum(rng.uniform(0.1, 1.0, 20)), rng.normal(size=(20, 3, 3))
    curve = BPoly.from_derivatives(times, samples)
    at = np.concatenate([times, rng.uniform(times[0], times[-1], 200)])
    expected = np.stack([curve(at), curve.derivative(1)(at), curve.derivative(2)(at)], axis=1)
    for order in range(3):
        size = np.abs(expected[:, order]).max()
        assert SampledCurve(times, samples).sample(at)[:, order] == pytest.approx(expected[:, order], abs=1e-13 * size)
