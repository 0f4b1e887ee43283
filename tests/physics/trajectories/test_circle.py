"""Circle: radius, plane, speed and distance against geometry."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runner.trajectories.circle import CircleConfig, build

START = np.array([0.3, -0.2, 0.4])
NORMAL, TO_CENTRE = np.array([1.0, 2.0, 2.0]) / 3.0, np.array([0.0, 1.0, -1.0]) / np.sqrt(2.0)


def circle(normal=NORMAL, to_centre=TO_CENTRE, turns=1, easing="none", duration=3.0):
    directions = {"normal": [float(x) for x in normal], "centre_direction": [float(x) for x in to_centre]}
    config = CircleConfig(
        kind="circle", start=None, radius=0.1, **directions, turns=turns, easing=easing, duration=duration
    )
    return build(config, START)


@pytest.mark.parametrize("easing", ["quintic", "none"])
@pytest.mark.parametrize("scale", [1.0, 1e-3, 50.0])
def test_it_stays_at_its_radius_in_its_plane(easing, scale):
    path = circle(scale * NORMAL, scale * TO_CENTRE, easing=easing).sample(np.linspace(0.0, 3.0, 101))[:, 0]
    from_centre = path - (START + 0.1 * TO_CENTRE)
    np.testing.assert_allclose(np.linalg.norm(from_centre, axis=1), 0.1, atol=1e-15)
    np.testing.assert_allclose(from_centre @ NORMAL, 0.0, atol=1e-15)


def test_it_turns_counter_clockwise_about_its_normal():
    motion = circle().sample(np.linspace(0.0, 3.0, 50))
    turning = np.cross(motion[:, 0] - (START + 0.1 * TO_CENTRE), motion[:, 1])
    np.testing.assert_allclose(turning, np.tile(0.1**2 * 2.0 * np.pi / 3.0 * NORMAL, (50, 1)), atol=1e-15)


def test_a_quarter_turn_about_z():
    motion = circle([0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]).sample(3.0 * np.array([0.25, 0.5, 0.75]))
    np.testing.assert_allclose(
        motion[:, 0] - START, [[-0.1, 0.1, 0.0], [-0.2, 0.0, 0.0], [-0.1, -0.1, 0.0]], atol=1e-15
    )


@pytest.mark.parametrize("turns", [1, 3])
def test_without_easing_speed_and_acceleration_are_steady(turns):
    motion = circle(turns=turns).sample(np.linspace(0.0, 6.0, 301))
    omega = 2.0 * np.pi * turns / 3.0
    np.testing.assert_allclose(np.linalg.norm(motion[:, 1], axis=1), 0.1 * omega, rtol=1e-12)
    np.testing.assert_allclose(motion[:, 2], -(omega**2) * (motion[:, 0] - START - 0.1 * TO_CENTRE), atol=1e-12)


@pytest.mark.parametrize("turns", [1, 3])
def test_with_easing_it_turns_whole_turns_with_the_quintic_s_peak_speed(turns):
    times = np.linspace(0.0, 3.0, 4_001)
    motion = circle(turns=turns, easing="quintic").sample(times)
    speed = np.linalg.norm(motion[:, 1], axis=1)
    assert speed.max() == pytest.approx(1.875 * 2.0 * np.pi * 0.1 * turns / 3.0, rel=1e-12)
    assert np.trapezoid(speed, times) == pytest.approx(2.0 * np.pi * 0.1 * turns, rel=1e-7)


@given(st.floats(0.0, 6.28), st.floats(-0.09, 1.0), st.floats(-1.0, 1.0))
def test_the_distance_is_that_of_right_angled_triangles(angle, beyond, height):
    across = np.cross(NORMAL, TO_CENTRE)
    outward = np.cos(angle) * TO_CENTRE + np.sin(angle) * across
    point = START + 0.1 * TO_CENTRE + (0.1 + beyond) * outward + height * NORMAL
    assert circle().distance_to_path(point[None])[0] == pytest.approx(np.hypot(beyond, height), abs=1e-14)


def test_from_its_axis_every_place_is_equally_far():
    assert circle().distance_to_path((START + 0.1 * TO_CENTRE + NORMAL)[None])[0] == pytest.approx(np.hypot(0.1, 1.0))
