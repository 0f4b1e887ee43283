"""What a config draws: nothing, noise, or models."""

import pytest

from runner.store.drawn import draws_model, draws_nothing

SILENT = {
    "noise": {"position": 0.0, "distribution": "uniform"},
    "mismatch": {"spread": 0.0, "link": {}},
    "environment": {"kind": "push", "noise": 0.0},
    "joint_torque_sensor": {"noise": None},
    "plant": {"computation": {"jitter": None, "miss": None}},
}


def test_without_any_amplitude_nothing_is_drawn():
    assert draws_nothing(SILENT)
    assert draws_nothing({**SILENT, "noise": {"position": [1e-3, 0.0], "distribution": "none"}})


@pytest.mark.parametrize(
    "changed",
    [
        {"noise": {"position": [0.0, 1e-4], "distribution": "gaussian"}},
        {"noise": {"position": {"macro": 1e-3, "mini": 0.0}, "distribution": "uniform"}},
        {"noise": {"kind": "mine"}},
        {"mismatch": {"spread": 0.1}},
        {"mismatch": {"link": {"link1": {"inertia_spread": 0.1}}}},
        {"mismatch": {"kind": "mine"}},
        {"environment": {"noise": 1.0}},
        {"joint_torque_sensor": {"noise": [0.0, 0.1]}},
        {"wrist_sensor": {"drift": [0.0, 0.1]}},
        {"plant": {"computation": {"jitter": [0.9, 0.1]}}},
        {"plant": {"computation": {"miss": 0.1}}},
    ],
    ids=str,
)
def test_each_amplitude_draws(changed):
    assert not draws_nothing({**SILENT, **changed})


def test_a_config_that_is_not_known_may_draw():
    assert not draws_nothing({})
    assert not draws_model({})
