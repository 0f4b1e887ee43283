"""Motions of a recording: cut at rests, and the accuracy in each."""

from types import SimpleNamespace

import numpy as np
import pytest

from runner.recordings.columns_map import Signal
from runner.recordings.compare import Residual
from runner.recordings.motions import accuracies, cut_at_rests

T = 0.01 * np.arange(2000)


def comparison(moves, off=0.001, torque=10.0, torque_off=1.0):
    """Return a comparison whose joint moves as a raised cosine during each of `moves`, (start, duration, distance)."""
    q = np.zeros(len(T))
    for start, duration, distance in moves:
        share = np.clip((T - start) / duration, 0.0, 1.0)
        q += 0.5 * distance * (1.0 - np.cos(np.pi * share))
    size = np.full(len(T), torque)
    return SimpleNamespace(
        follows_measured=False,
        model=SimpleNamespace(joint_names=("q1", "q2")),
        residuals=[
            Residual(Signal("position", "q1"), "rad", T, q + off, q),
            Residual(Signal("torque", "q1"), "N m", T, size, size - torque_off),
        ],
    )


def test_a_motion_lies_between_two_rests():
    parts = cut_at_rests(comparison([(1.0, 2.0, 1.0), (5.0, 3.0, -1.0), (12.0, 1.0, 0.5)]))
    ends = [(T[part.start], T[part.stop - 1]) for part in parts]
    np.testing.assert_allclose(ends, [(1.0, 3.0), (5.0, 8.0), (12.0, 13.0)], atol=0.1)


def test_a_short_stop_parts_no_motion():
    assert len(cut_at_rests(comparison([(1.0, 2.0, 1.0), (3.05, 2.0, -1.0)]))) == 1


def test_a_constant_difference_is_the_accuracy():
    (motion,), groups = accuracies(comparison([(1.0, 2.0, 1.0)], off=0.003, torque=10.0, torque_off=2.5))
    assert motion.position == pytest.approx(0.003)
    assert (motion.joint, motion.unit, motion.motions) == ("q1", "rad", 1)
    assert motion.torque == pytest.approx(0.25)
    assert np.isnan(motion.tip)  # q2 is not recorded
    assert motion.speeds == (1.0, 1.0)
    assert groups == []


def test_six_motions_are_grouped_by_speed():
    durations = (3.0, 1.0, 2.0, 1.5, 2.5, 0.8)
    starts = np.cumsum([0.5, *(duration + 0.5 for duration in durations[:-1])])
    each, groups = accuracies(comparison([(s, d, 1.0) for s, d in zip(starts, durations, strict=True)]))
    assert len(each) == 6
    assert [(group.name, group.motions) for group in groups] == [("slow", 2), ("medium", 2), ("fast", 2)]
    peaks = [group.speeds for group in groups]
    assert peaks == sorted(peaks)
    assert peaks[-1][1] == pytest.approx(1.0)
