"""Data of motions for the page: frames, ends, shapes, joints and several runs."""

import base64
import json

import numpy as np
import pytest
from support.sample_document import playback

from runner.reporting.document import PlaybackBody
from runner.reporting.playback import FRAME_RATE, FRAMES, frames, playback_spec


def unpacked(text, *shape):
    return np.frombuffer(base64.b64decode(text), dtype="<f4").reshape(*shape)


def test_shapes_are_where_the_poses_of_their_bodies_put_them():
    """The sample turns about -y by an angle, and so carries the end of its segment along its tip's path."""
    motion = playback()
    (run,) = playback_spec(motion)["runs"]
    segment, ball = run["shapes"]
    count = len(unpacked(run["times"], -1))
    ends = unpacked(segment["ends"], count, 2, 3)
    chosen = frames(motion)
    np.testing.assert_allclose(ends[:, 1], motion.path[chosen], atol=1e-6)
    np.testing.assert_allclose(ends[:, 0], 0.0, atol=1e-6)
    np.testing.assert_allclose(unpacked(ball["ends"], count, 1, 3)[:, 0], ends[:, 1], atol=1e-6)
    assert (segment["balls"], segment["radius"], ball["balls"], ball["radius"]) == (False, 0.05, True, 0.07)


def test_runs_are_given_one_by_one_with_their_tips_and_joints():
    times = np.linspace(0.0, 2.0, 60)
    tip = np.stack([times, times, times], axis=1)
    other = playback(30, name="B", ends="failed at 1 s")
    spec = playback_spec(playback(name="A", tip=tip, target=tip - 0.5, joints={"q1": tip}, others=[other]))
    first, second = spec["runs"]
    assert (first["name"], second["name"], second["ends"]) == ("A", "B", "failed at 1 s")
    chosen = frames(playback())
    np.testing.assert_allclose(unpacked(first["tip"], -1, 3), tip[chosen], atol=1e-6)
    np.testing.assert_allclose(unpacked(first["target"], -1, 3), tip[chosen] - 0.5, atol=1e-6)
    assert [joint["name"] for joint in first["joints"]] == ["q1"]
    assert (second["tip"], second["joints"]) == ("", [])
    json.dumps(spec)


def test_a_planar_motion_is_seen_across_its_plane_and_another_one_obliquely():
    planar = playback_spec(playback())
    assert abs(np.sin(planar["azimuth"])) > 0.9  # the sample moves in the plane of x and z
    ball = PlaybackBody(
        "b", [], [((0.0, 0.0, 0.0), 1.0)], np.eye(3)[[0, 1, 2] * 20] * 5.0, np.tile([1.0, 0, 0, 0], (60, 1))
    )
    assert playback_spec(playback(bodies=[ball]))["elevation"] == pytest.approx(np.arctan2(0.75, np.hypot(0.9, 1.3)))


@pytest.mark.parametrize("count", [2, 60, 5000])
def test_frames_are_few_and_keep_both_ends(count):
    motion = playback(count)
    chosen = frames(motion)
    assert chosen[0] == 0
    assert chosen[-1] == count - 1
    assert len(chosen) <= min(FRAMES, 2.0 * FRAME_RATE + 1)


def test_a_motion_that_diverges_ends_before_it_does():
    motion = playback()
    positions = np.zeros((60, 3))
    positions[30:] = np.inf
    body = motion.bodies[0]
    diverging = PlaybackBody("link", body.segments, body.balls, positions, body.rotations)
    assert frames(playback(bodies=[diverging]))[-1] < 30
    (run,) = playback_spec(playback(bodies=[diverging]))["runs"]
    assert np.isfinite(unpacked(run["shapes"][0]["ends"], -1)).all()


def test_a_motion_without_frames_paths_or_bodies_is_no_error():
    playback_spec(playback(bodies=[], path=np.zeros((0, 3)), desired=None))
    playback_spec(playback(path=np.full((4, 3), np.nan), desired=np.zeros((1, 3))))
    (run,) = playback_spec(playback(times=np.full(60, np.nan)))["runs"]
    assert run["times"] == ""
