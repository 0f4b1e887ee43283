"""The motion that a run takes from a log: smooth, whatever the commands are, and without noise that starts it."""

import io

import numpy as np
import pytest

from runner.assembly.validation import validate
from runner.config.compose.compose import compose
from runner.doctor.log_motion import make_motion
from runner.recordings.columns_map import Signal
from runner.recordings.recording import Recording

PERIOD, LENGTH = 0.002, 6.0
T = np.arange(0.0, LENGTH, PERIOD)


@pytest.fixture(scope="module")
def arm():
    return validate(compose(["robot=macro"])).arm.model


def swing(t, rest=1.0):
    """Positions at rest in the first and the last second, and one swing between."""
    share = np.clip((t - rest) / (LENGTH - 2.0 * rest), 0.0, 1.0)
    return np.array([0.3, 0.6, 0.8]) + np.outer(np.sin(np.pi * share) ** 4, [0.5, -0.4, 0.3])


def motion(arm, q, kind="reference"):
    signals = {Signal(kind, joint): q[:, place] for place, joint in enumerate(arm.joint_names)}
    made = make_motion(arm, Recording(None, T, signals, {}, {}, False, []))
    rows = np.loadtxt(io.StringIO(made.text), delimiter=",", skiprows=1)
    return made, rows[:, 0], rows[:, 1:]


def accelerations(t, q):
    return np.gradient(np.gradient(q, t, axis=0), t, axis=0)


COMMANDS = {
    "smooth": lambda q: q,
    "rounded": lambda q: q.round(4),
    "held at 50 Hz": lambda q: q[np.arange(len(q)) // 10 * 10],
}


@pytest.mark.parametrize("kind", COMMANDS)
def test_commands_move_the_arm_without_steps(arm, kind):
    made, t, q = motion(arm, COMMANDS[kind](swing(T)))
    assert made.commanded
    wanted = accelerations(t, swing(t))
    assert np.abs(accelerations(t, q) - wanted).max() < 0.15 * np.abs(wanted).max()
    assert "smoothed at 10 Hz" in made.notes[0]


@pytest.mark.parametrize("noise", [0.0, 3e-4, 3e-3])
def test_noise_at_rest_is_no_start_in_motion(arm, noise):
    noisy = swing(T) + noise * np.random.default_rng(0).normal(size=(len(T), 3))
    made, t, _ = motion(arm, noisy, "position")
    assert not any("in motion" in note for note in made.notes)
    assert t[-1] == pytest.approx(T[-1], abs=0.02)


def test_a_log_that_is_cut_in_motion_begins_and_ends_at_rest(arm):
    made, t, _ = motion(arm, swing(T, rest=-1.0), "position")
    assert any("in motion: 0.5 s from or to rest are added" in note for note in made.notes)
    assert t[-1] == pytest.approx(T[-1] + 1.0, abs=0.02)
