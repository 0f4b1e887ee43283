"""Trajectories of every kind: starts, rests, derivatives and distance against dense samples."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from runner.config.compose.compose import compose
from runner.config.compose.files import group_options
from runner.trajectories import TRAJECTORIES
from runner.trajectories.shaped import Shifted

START = np.array([0.3, -0.2, 0.4])
CONFIGS = {
    "quintic": {"goal": [0.5, 0.1, 0.2], "duration": 2.0},
    "line": {"goal": [0.5, 0.1, 0.2], "duration": 2.0},
    "circle": {
        "radius": 0.1,
        "normal": [1.0, 2.0, 2.0],
        "centre_direction": [0.0, 1.0, -1.0],
        "turns": 2,
        "easing": "quintic",
        "duration": 2.0,
    },
    "lissajous": {
        "amplitudes": [0.1, 0.2, 0.05],
        "frequencies": [1, 2, 3],
        "phases": [0.3, 0.0, -1.0],
        "easing": "quintic",
        "duration": 2.0,
    },
    "square": {"half_edge": 0.1, "normal": [0.0, 3.0, 4.0], "edge_direction": [1.0, 0.0, 0.0], "duration": 2.0},
    "waypoints": {
        "origin": None,
        "scale": 0.1,
        "points": [[1.0, 0.0, 0.0], [1.0, 2.0, 0.0], [0.0, 1.0, 1.0]],
        "time_shares": None,
        "duration": 2.0,
    },
}
PERIODIC = {
    "line": ("line", {}),
    "steady circle": ("circle", {"easing": "none"}),
    "steady lissajous": ("lissajous", {"easing": "none"}),
}
RESTING = {kind: (kind, {}) for kind in CONFIGS if kind != "line"}
CASES = RESTING | PERIODIC
ROBOTS = group_options("robot")


def make(case):
    kind, changes = CASES[case]
    config = TRAJECTORIES.config_model(kind)(kind=kind, start=None, **(CONFIGS[kind] | changes))
    return TRAJECTORIES.build(config, START)


@pytest.fixture(params=CASES)
def trajectory(request):
    return make(request.param)


def test_velocity_and_acceleration_are_the_derivatives(trajectory):
    h = 1e-5
    t = np.random.default_rng(0).uniform(h, trajectory.duration - h, 200)
    here, before, after = trajectory.sample(t), trajectory.sample(t - h), trajectory.sample(t + h)
    largest = np.abs(here).max(axis=(0, 2))
    np.testing.assert_allclose((after[:, 0] - before[:, 0]) / (2.0 * h), here[:, 1], atol=1e-7 * largest[1])
    np.testing.assert_allclose((after[:, 1] - before[:, 1]) / (2.0 * h), here[:, 2], atol=1e-7 * largest[2])


def test_position_velocity_and_acceleration_are_continuous(trajectory):
    t = np.linspace(0.0, trajectory.duration, 20_001)
    motion = trajectory.sample(t)
    jump = np.abs(np.diff(motion, axis=0)).max(axis=(0, 2))
    assert (jump < 5e-3 * np.abs(motion - motion.mean(axis=0)).max(axis=(0, 2))).all()


def test_it_starts_where_the_arm_stands(trajectory):
    np.testing.assert_array_equal(trajectory.start, START)
    np.testing.assert_allclose(trajectory.sample(np.zeros(1))[0, 0], START, atol=1e-15)
    assert trajectory.tracked


@pytest.mark.parametrize("case", RESTING)
def test_from_rest_to_rest(case):
    trajectory = make(case)
    t_f = trajectory.duration
    first, last, later = trajectory.sample(np.array([0.0, t_f, 5.0 * t_f]))
    np.testing.assert_allclose(first[1:], 0.0, atol=1e-12)
    for motion in (last, later):
        np.testing.assert_allclose(motion, [trajectory.goal, np.zeros(3), np.zeros(3)], atol=1e-12)
    assert trajectory.run_duration == t_f + 1.0


@pytest.mark.parametrize("case", PERIODIC)
def test_a_periodic_motion_comes_again_without_a_goal(case):
    trajectory = make(case)
    assert trajectory.goal is None
    assert trajectory.run_duration == trajectory.duration
    t = np.linspace(0.0, trajectory.duration, 50)
    once, again = trajectory.sample(t), trajectory.sample(t + trajectory.duration)
    np.testing.assert_allclose(again, once, atol=1e-12 * np.abs(once).max())
    np.testing.assert_allclose(once[-1], once[0], atol=1e-12 * np.abs(once).max())


def test_its_own_path_has_no_distance(trajectory):
    path = trajectory.sample(np.linspace(0.0, trajectory.duration, 3_001))[:, 0]
    assert trajectory.distance_to_path(path).max() < 1e-14


def test_the_distance_to_the_path_is_the_smallest_there_is(trajectory):
    t = np.linspace(0.0, trajectory.duration, 2_001)
    path = trajectory.sample(t)[:, 0]
    random = np.random.default_rng(1)
    points = path[random.integers(len(path), size=12)] + random.normal(size=(12, 3)) * np.logspace(-6, 0, 12)[:, None]

    def nearest(point):
        def distance(time):
            return np.linalg.norm(trajectory.sample(np.array([time]))[0, 0] - point)

        order = np.argsort(np.linalg.norm(path - point, axis=1))[:12]
        bounds = [(t[max(i - 1, 0)], t[min(i + 1, len(t) - 1)]) for i in order]
        return min(minimize_scalar(distance, bounds=b, method="bounded", options={"xatol": 1e-12}).fun for b in bounds)

    np.testing.assert_allclose(trajectory.distance_to_path(points), [nearest(p) for p in points], atol=1e-9)


def test_of_no_points_there_are_no_distances(trajectory):
    assert trajectory.distance_to_path(np.zeros((0, 3))).shape == (0,)


def test_it_can_be_seen_from_elsewhere_and_stays_as_it_was(trajectory):
    t, offset = np.linspace(0.0, trajectory.duration, 7), np.array([1.0, 2.0, 3.0])
    before = trajectory.sample(t)
    np.testing.assert_allclose(Shifted(trajectory, offset).sample(t)[:, 0], before[:, 0] - offset, atol=1e-15)
    np.testing.assert_array_equal(trajectory.sample(t), before)


@pytest.mark.parametrize(("robot", "kind"), [
    pytest.param(robot, kind, marks=() if (place - number) % len(CONFIGS) == 0 else pytest.mark.slow)
    for number, robot in enumerate(ROBOTS) for place, kind in enumerate(sorted(CONFIGS))
])  # fmt: skip  # a robot gives its start and size to all kinds alike: each session takes one for each robot
def test_every_kind_has_values_for_every_robot_and_starts_where_that_starts(robot, kind):
    resolved = compose([f"robot={robot}", f"trajectory={kind}"]).resolved
    config = TRAJECTORIES.config_model(kind).model_validate(resolved["trajectory"])
    assert config.start == resolved["robot"]["start"]
    start = np.zeros(3) if config.start is None else np.array(config.start)
    path = TRAJECTORIES.build(config, start).sample(np.linspace(0.0, config.duration, 4_001))[:, 0]
    if kind in ("circle", "lissajous", "square"):
        size = resolved["robot"]["path_size"]
        np.testing.assert_allclose(np.ptp(path, axis=0), [2.0 * size, 2.0 * size, 0.0], rtol=1e-5, atol=1e-12)


@pytest.mark.parametrize(
    ("kind", "change", "message"),
    [
        ("quintic", {"start": [1.0, 2.0]}, "start"),
        ("line", {"duration": 0.0}, "greater than 0"),
        ("circle", {"radius": 0.0}, "greater than 0"),
        ("circle", {"normal": [0.0, 0.0, 0.0]}, "must have a direction, so not all zero"),
        ("circle", {"centre_direction": [0.0, 0.0, 0.0]}, "must have a direction, so not all zero"),
        (
            "circle",
            {"normal": [0.0, 0.0, 1.0], "centre_direction": [1.0, 0.0, 1.0]},
            r"must be perpendicular to normal \[0.0, 0.0, 1.0\], which is 45 deg away",
        ),
        ("circle", {"turns": 0}, "greater than 0"),
        ("circle", {"turns": 1.5}, "integer"),
        ("circle", {"easing": "cubic"}, "'quintic' or 'none'"),
        ("lissajous", {"amplitudes": [0.0, 0.0, 0.0]}, "must be above 0 along one axis at least"),
        ("lissajous", {"amplitudes": [-0.1, 0.0, 0.0]}, "greater than or equal to 0"),
        ("lissajous", {"frequencies": [1, 0, 1]}, "must be 1 or more along y, where the amplitude is 0.2 m"),
        ("lissajous", {"frequencies": [1, 2.5, 1]}, "integer"),
        ("lissajous", {"frequencies": [1, 101, 1]}, "less than or equal to 100"),
        ("square", {"half_edge": -1.0}, "greater than 0"),
        ("square", {"edge_direction": [0.0, 1.0, 0.0]}, "perpendicular to normal"),
        ("waypoints", {"points": []}, "must have one way-point or more besides the start"),
        ("waypoints", {"points": [[1.0, 2.0]]}, "at least 3"),
        ("waypoints", {"scale": 0.0}, "greater than 0"),
        ("waypoints", {"time_shares": [0.5, 1.0]}, "must be 3 ascending numbers, one for each of the points"),
        ("waypoints", {"time_shares": [0.5, 0.4, 1.0]}, "ascending"),
        ("waypoints", {"time_shares": [0.2, 0.5, 0.9]}, "the last of them 1"),
    ],
)
def test_what_makes_no_motion_is_refused(kind, change, message):
    with pytest.raises(ValueError, match=message):
        TRAJECTORIES.config_model(kind)(**({"kind": kind, "start": None} | CONFIGS[kind] | change))
