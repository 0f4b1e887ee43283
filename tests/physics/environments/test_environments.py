"""Environments: wrenches on the tip against closed forms."""

import numpy as np
import pytest
from pydantic import ValidationError

from runner.base.errors import ConfigError
from runner.environments import ENVIRONMENTS
from runner.environments.hand import HandConfig
from runner.environments.push import PushConfig
from runner.environments.wall import WallConfig

TIP, REST = np.array([0.3, 0.1, 0.2]), np.zeros(3)


def make(config):
    environment = ENVIRONMENTS.build(config)
    environment.reset(TIP)
    return environment


def push(**changes):
    values = {
        "force": [1.0, 0.0, -2.0],
        "moment": [0.0, 0.1, 0.0],
        "start_time": 0.5,
        "link": None,
        "duration": None,
        "frequency": 0.0,
        "impulse": [0.0, 0.0, 0.0],
        "noise": 0.0,
        "bandwidth": None,
    }
    return make(PushConfig(kind="push", **(values | changes)))


def test_a_push_sets_in_at_its_time_and_stays():
    steady = push()
    np.testing.assert_array_equal(steady.wrench(0.499, TIP, REST), np.zeros(6))
    for time in (0.5, 0.7, 99.0):
        np.testing.assert_array_equal(steady.wrench(time, TIP, REST), [1.0, 0.0, -2.0, 0.0, 0.1, 0.0])


def test_a_push_that_lasts_ends():
    short = push(duration=0.2)
    assert np.abs(short.wrench(0.69, TIP, REST)).max() == 2.0
    np.testing.assert_array_equal(short.wrench(0.7, TIP, REST), np.zeros(6))


def test_a_sine_starts_from_zero_with_its_frequency():
    sine = push(frequency=2.0)
    times = 0.5 + np.linspace(0.0, 1.0, 50)
    forces = [sine.wrench(time, TIP, REST)[2] for time in times]
    np.testing.assert_allclose(forces, -2.0 * np.sin(2.0 * np.pi * 2.0 * (times - 0.5)), atol=1e-12)


def forces(environment, ticks, seed=0):
    """Return the force on the tip in each tick of 10 ms."""
    environment.begin(0.01, np.random.default_rng(seed))
    return np.array([environment.wrench(0.01 * k, TIP, REST)[:3] for k in range(ticks)])


def test_an_impulse_acts_in_one_tick():
    found = forces(push(impulse=[0.0, 0.3, 0.0], start_time=0.495), 100)
    assert found[:, 1].sum() * 0.01 == pytest.approx(0.3)
    assert np.flatnonzero(found[:, 1]).tolist() == [50]


def test_a_random_force_has_its_deviation_and_keeps_each_value_for_its_time():
    white = {"force": [0.0, 0.0, 0.0], "start_time": 0.0, "noise": 2.0}
    found = forces(push(**white), 20_000)
    np.testing.assert_allclose(found.std(axis=0), 2.0, rtol=5.0 / np.sqrt(2 * 20_000))
    np.testing.assert_allclose(found.mean(axis=0), 0.0, atol=5.0 * 2.0 / np.sqrt(20_000))
    assert np.abs(np.corrcoef(found[:-1, 0], found[1:, 0])[0, 1]) < 5.0 / np.sqrt(20_000)
    slow = forces(push(**white, bandwidth=10.0), 400)  # a value for 50 ms
    assert (slow[:, 0].reshape(-1, 5) == slow[::5, :1]).all()
    np.testing.assert_array_equal(slow[::5], found[:80])
    np.testing.assert_array_equal(forces(push(**white), 30, seed=7), forces(push(**white), 50, seed=7)[:30])


def test_a_push_on_a_link_leaves_the_tip_alone():
    beside = push(link="link2", moment=[0.0, 0.0, 0.0], duration=0.2)
    assert list(beside.points) == ["link2"]
    np.testing.assert_array_equal(beside.link_forces(0.6, TIP[None], REST[None]), [[1.0, 0.0, -2.0]])
    np.testing.assert_array_equal(beside.link_forces(0.8, TIP[None], REST[None]), np.zeros((1, 3)))
    assert not beside.wrench(0.6, TIP, REST).any()


def test_a_moment_acts_on_the_tip_alone():
    with pytest.raises(ConfigError, match="a push on a link"):
        push(link="link2")


def wall(**changes):
    values = {"distance": 0.01, "normal": [-1.0, 0.0, 0.0], "stiffness": 1e4, "damping": 20.0}
    return make(WallConfig(kind="wall", **(values | changes)))


def test_a_wall_is_felt_behind_its_face_alone():
    face = wall()
    np.testing.assert_array_equal(face.wrench(0.0, TIP + np.array([0.0099, 0.0, 0.0]), REST), np.zeros(6))
    inside = face.wrench(0.0, TIP + np.array([0.011, 5.0, -5.0]), REST)
    np.testing.assert_allclose(inside, [-1e4 * 0.001, 0.0, 0.0, 0.0, 0.0, 0.0], atol=1e-9)


def test_a_wall_resists_being_entered_and_never_pulls():
    face, inside = wall(), TIP + np.array([0.0101, 0.0, 0.0])
    assert face.wrench(0.0, inside, np.array([0.1, 0.0, 0.0]))[0] == pytest.approx(-1.0 - 2.0)
    np.testing.assert_array_equal(face.wrench(0.0, inside, np.array([-1.0, 0.0, 0.0])), np.zeros(6))


def test_a_wall_without_direction_is_refused():
    with pytest.raises(ValidationError, match="must not be zero"):
        wall(normal=[0.0, 0.0, 0.0])


def test_a_normal_of_another_length_than_one_is_refused_with_the_unit_vector():
    with pytest.raises(ValidationError, match=r"its length is 5; take \[0, 0.6, -0.8\]"):
        wall(normal=[0.0, 3.0, -4.0])


def hand(**changes):
    values = {"displacement": [0.0, 0.05, 0.0], "start_time": 0.5, "duration": 2.0, "stiffness": 500.0, "damping": 20.0}
    return make(HandConfig(kind="hand_guiding", **(values | changes)))


def test_a_hand_holds_the_tip_where_it_took_it():
    np.testing.assert_allclose(hand().wrench(0.2, TIP, REST), np.zeros(6), atol=1e-12)
    np.testing.assert_allclose(
        hand().wrench(0.2, TIP + np.array([0.01, 0.0, 0.0]), REST)[:3], [-5.0, 0.0, 0.0], atol=1e-12
    )


def test_a_hand_ends_at_its_travel_and_damps_against_its_own_motion():
    np.testing.assert_allclose(hand().wrench(9.0, TIP, REST)[:3], [0.0, 25.0, 0.0], atol=1e-12)
    middle, speed = np.array([0.0, 0.025, 0.0]), np.array([0.0, 1.875 * 0.05 / 2.0, 0.0])
    np.testing.assert_allclose(hand().wrench(1.5, TIP + middle, speed), np.zeros(6), atol=1e-12)


def test_free_space_has_nothing_to_feel(checked_config):
    assert ENVIRONMENTS.build(checked_config("robot=macro").environment) is None
