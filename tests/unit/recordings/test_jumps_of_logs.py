"""Jumps of a joint between two rows of a log: what is one, and what only looks like one."""

from pathlib import Path

import numpy as np
import pytest

from runner.recordings.columns_map import Signal
from runner.recordings.equations import find_jumps
from runner.recordings.recording import Recording
from runner.robots.description import find_urdf, read_urdf
from runner.robots.model import RobotModel

H = 0.002
T = np.arange(0.0, 10.0, H)
SWING = 0.3 * np.sin(2.0 * T)


@pytest.fixture(scope="module")
def limited():
    """An arm whose joints move at up to 3.14 rad/s."""
    return RobotModel(read_urdf(find_urdf("ur5e.urdf"), {}), "tool0")


@pytest.fixture(scope="module")
def unlimited():
    return RobotModel(read_urdf(find_urdf("macro.urdf"), {}), "tip")


def recorded(model, q, t=T):
    signal = Signal("position", model.joint_names[1])
    return Recording(Path("a.csv"), t, {signal: q}, {signal: "actual_q_1"}, {}, False, [])


def changed(rows, by, q=SWING):
    q = q.copy()
    q[rows] += by
    return q


@pytest.mark.parametrize("model", ["limited", "unlimited"])
def test_a_single_bad_sample_is_named_with_column_time_and_size(model, request):
    model = request.getfixturevalue(model)
    (told,) = find_jumps(model, recorded(model, changed(2500, -1.42)))
    assert told.startswith("actual_q_1 jumps by 1.42 rad within 2 ms at 5 s after the first row")
    assert told.endswith("Correct or cut that row.")


def test_the_limit_is_named_where_there_is_one(limited, unlimited):
    wanted = f"times the speed limit of {limited.joint_names[1]}"
    assert wanted in next(find_jumps(limited, recorded(limited, changed(2500, 1.42))))
    assert "limit" not in next(find_jumps(unlimited, recorded(unlimited, changed(2500, 1.42))))


def test_a_step_that_stays_is_cut_and_places_are_counted(limited):
    (text,) = find_jumps(limited, recorded(limited, changed(slice(2500, None), 0.4)))
    assert text.endswith("Cut the log there, or correct the column.")
    (text,) = find_jumps(limited, recorded(limited, changed([500, 2500, 4000], 0.4)))
    assert "(and at 2 more times)" in text


def test_a_step_is_a_jump_from_five_times_the_limit_on(limited):
    at_limit = 5.0 * float(limited.velocity_limits[1]) * H
    still = np.zeros_like(T)
    for size, many in ((0.99 * at_limit, 0), (1.01 * at_limit, 1)):
        assert len(list(find_jumps(limited, recorded(limited, changed(2500, size, still))))) == many


@pytest.mark.parametrize("model", ["limited", "unlimited"])
@pytest.mark.parametrize(
    "q",
    [
        SWING,
        np.zeros_like(T),
        SWING[np.arange(len(T)) // 50 * 50],  # positions of 10 Hz, held
        2e-3 * np.random.default_rng(0).standard_normal(len(T)),  # noise of a joint at rest
        0.5 * np.clip((T - 5.0) / 0.2, 0.0, 1.0),  # it moves in 2 % of the log
        np.round(SWING, 2),  # a coarse encoder
    ],
)
def test_motion_steps_and_noise_are_no_jumps(model, q, request):
    model = request.getfixturevalue(model)
    assert list(find_jumps(model, recorded(model, q))) == []


def test_a_bad_sample_in_a_short_log_is_found(unlimited):
    assert list(find_jumps(unlimited, recorded(unlimited, changed(30, 1.0)[:60], T[:60])))
