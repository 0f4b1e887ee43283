"""Caveat of runs that end before their law has done its work, on both sides of three time constants."""

import pytest
from support.caveat_runs import found

OBSERVED = ("robot=macro", "controller=computed_torque", "disturbance_observer=momentum")
SLOW = (*OBSERVED, "disturbance_observer.bandwidth=1.5")


def test_a_run_of_less_than_three_time_constants_is_told(checked_config):
    told = found(checked_config(*SLOW, "duration=1.6"))["short_horizon"]
    assert told.value == pytest.approx(2.0 / 1.6)
    assert told.text == (
        "the law's disturbance observer has a time constant of 0.667 s, and the run ends after 1.6 s: it is judged "
        "before it has done its work, which takes 3 time constants; take duration=2 or more"
    )


QUIET = [
    (*SLOW, "duration=2"),
    (*SLOW, "duration=1.6", "caveats.short_horizon.share=1.3"),
    (*OBSERVED, "duration=0.1"),  # three times 1 / 30 s
    ("robot=macro", "controller=impedance", "duration=0.01"),  # says no time constant
]


@pytest.mark.parametrize("overrides", QUIET)
def test_others_are_not(checked_config, overrides):
    assert "short_horizon" not in found(checked_config(*overrides))


def test_the_duration_that_is_named_is_enough(checked_config):
    short = ("robot=macro", "controller=adaptive", "trajectory=circle", "trajectory.duration=2")
    text = found(checked_config(*short, "controller.adaptation_gain=0.1"))["short_horizon"].text
    duration = text.partition("take duration=")[2].split()[0]
    longer = found(checked_config(*short, "controller.adaptation_gain=0.1", f"duration={duration}"))
    assert "short_horizon" not in longer


def test_a_run_stores_it_and_its_threshold(make_run):
    run = make_run("robot=macro", "duration=0.05", "caveats.short_horizon.share=1.5")
    assert {caveat["rule"]: caveat["value"] for caveat in run.caveats}["short_horizon"] == pytest.approx(2.0)
    assert run.caveat_rules["thresholds"]["short_horizon"] == {"share": 1.5}
