"""Largest distance to the path of a long motion: equal to that of all points, bit for bit."""

import numpy as np
import pytest

from runner.assembly.long_motion import with_long_motion


@pytest.fixture(scope="module")
def motions(checked_config):
    plain = checked_config("robot=macro", "trajectory=joint_sinusoids", "trajectory.amplitude=0.4").path
    quick = with_long_motion(checked_config("robot=macro", "trajectory=joint_sinusoids", "trajectory.amplitude=0.4"))
    return plain, quick.path


@pytest.mark.costs(2)
@pytest.mark.parametrize("size", [0.0, 1e-6, 1e-3, 0.2])
def test_the_largest_distance_is_that_of_all_points(motions, size):
    plain, quick = motions
    random = np.random.default_rng(4)
    path = plain.sample(random.uniform(0.0, plain.duration, 600))[:, 0]
    points = path + size * random.normal(size=(2, 600, 3))
    exact, found = plain.distance_to_path(points), quick.distance_to_path(points)
    assert found.shape == exact.shape
    assert np.array_equal(found.max(axis=1), exact.max(axis=1))
    assert (found >= exact - 1e-12).all()


def test_few_points_need_their_own_distance(motions, monkeypatch):
    plain, quick = motions
    path = plain.sample(np.linspace(0.0, plain.duration, 5_000))[:, 0]
    points = path + 1e-4 * np.random.default_rng(5).normal(size=path.shape)
    asked = []
    own = type(plain).distance_to_path
    monkeypatch.setattr(type(plain), "distance_to_path", lambda self, some: asked.append(len(some)) or own(self, some))
    quick.distance_to_path(points)
    assert sum(asked) <= 256


def test_a_motion_of_the_tip_keeps_its_path(checked_config):
    config = checked_config("robot=macro", "trajectory=circle")
    assert with_long_motion(config) is config
