"""Recordings of motions for the player: frames, ends, no socket."""

import base64
import socket
import threading

import numpy as np
import pytest
import zstandard
from support.sample_document import playback

from runner.reporting.document import Body
from runner.reporting.playback import FRAME_RATE, FRAMES, frames, player, record


def test_a_recording_opens_no_socket_and_prints_nothing(monkeypatch, capsys):
    def refuse(*_):
        raise AssertionError("a playback is made without a network")

    monkeypatch.setattr(socket.socket, "bind", refuse)
    monkeypatch.setattr(socket.socket, "connect", refuse)
    before = threading.active_count()
    recording = record(playback())
    assert threading.active_count() == before
    assert capsys.readouterr() == ("", "")
    assert len(recording) > 1000


def test_playbacks_share_the_player_and_repeat_exactly():
    one, same, other = record(playback()), record(playback()), record(playback(90))
    assert one == same
    assert other != one
    assert player().count("__VISER_EMBED_DATA__=frameElement.dataset.scene;") == 1


def test_the_scene_lasts_as_long_as_the_motion():
    scene = base64.b64decode(record(playback()))
    content = zstandard.ZstdDecompressor().decompress(scene[8:], max_output_size=10_000_000)
    assert b"SetPositionMessage" in content
    assert b"CylinderMessage" in content
    assert b"durationSeconds" in content


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
    diverging = Body("link", body.segments, body.balls, positions, body.rotations)
    assert frames(playback(bodies=[diverging]))[-1] < 30
    record(playback(bodies=[diverging]))


def test_a_motion_without_frames_paths_or_bodies_is_no_error():
    record(playback(bodies=[], path=np.zeros((0, 3)), desired=None))
    record(playback(path=np.full((4, 3), np.nan), desired=np.zeros((1, 3))))
