"""Caveats with a run: found, stored, told."""

import subprocess
import sys

import numpy as np
import pytest
from caveat_runs import signals, stacked

from runner.caveats import Watch, changes_since, registry, setting_of
from runner.caveats.today import our_thresholds
from runner.config.caveats import CaveatsConfig
from runner.store import run_hash

ROBOTS = ("macro", "mini", "combined", "macro_mini_mini", "xarm7", "xarm7_mini", "meca500", "meca500_r4")


def test_every_rule_has_a_threshold_of_its_own():
    rules = {rule.name: rule.key for rule in (*registry.TRACE_RULES, *registry.SETTING_RULES)}
    keys = {name: tuple(values) for name, values in our_thresholds().items()}
    assert keys == {name: (key,) for name, key in rules.items()}
    assert set(CaveatsConfig.model_fields) == set(rules)


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_robot_as_it_is_has_none(make_run, robot):
    run = make_run(f"robot={robot}")
    assert list(run.caveats) == []
    assert changes_since(run.caveat_rules) == []


def test_runs_side_by_side_are_judged_as_one_after_another(checked_config):
    config = checked_config("robot=macro", "torque_limits.max=10", "trajectory=quintic")
    generator = np.random.default_rng(0)
    runs = [
        signals(
            tau=np.clip(generator.normal(0.0, spread, (100, 3)), -10.0, 10.0),
            tip=generator.normal(0.0, 0.1 * spread, (101, 3)),
            q=generator.normal(0.0, 100.0 * spread, (101, 3)),
            desired=np.linspace(0.0, 1.0, 101)[:, None] * np.ones(3),
        )
        for spread in (1.0, 5.0, 9.0, 40.0)
    ]
    one, several = (Watch(setting_of(config), config.caveats) for _ in range(2))
    for run in runs:
        one.look(run)
    several.look(stacked(*runs))
    found = one.found()
    assert found == several.found()
    assert {caveat.rule for caveat in found.caveats} == {rule.name for rule in registry.TRACE_RULES}


def test_they_are_told_stored_and_found_again(cli):
    overrides = ("robot=macro", "duration=0.1", "torque_limits.max=1", "noise.position=1e-3", "repetitions=2")
    first, again = cli(*overrides), cli(*overrides)
    assert first.code == 0
    told = [line for line in first.err.splitlines() if line.startswith("runner: caveat: ")]
    assert [line.split(": ")[2] for line in told] == ["did_not_follow", "saturation", "exact_velocity"]
    assert told[1].endswith("of the ticks, in 2 of 2 repetitions")
    assert again.err == first.err
    assert again.out == first.out


def test_other_thresholds_leave_a_run_as_it_is_and_are_told(cli):
    overrides = ("robot=macro", "duration=0.1", "noise.position=1e-3")
    assert "caveat: exact_velocity" in cli(*overrides).err
    again = cli(*overrides, "caveats.exact_velocity.noise=0.01")
    assert "runner: stored before; its caveats were looked for by caveats.exact_velocity.noise 0, now 0.01" in again.err


def test_a_store_is_read_without_rigid_body_models():
    light = "import sys, runner.store, runner.caveats; sys.exit('pinocchio' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", light], check=False).returncode == 0


def test_thresholds_are_no_part_of_a_result(checked_config):
    plain, other = checked_config("robot=macro"), checked_config("robot=macro", "caveats.chatter.share=1")
    assert run_hash(plain.resolved, "") == run_hash(other.resolved, "")


def test_a_failed_run_has_those_of_its_config_alone(make_run):
    run = make_run("robot=macro", "noise.position=5", "torque_limits.max=20", "duration=2", "plant.step=0.01")
    if run.status == "failed":
        assert [caveat["rule"] for caveat in run.caveats] == ["exact_velocity"]


@pytest.mark.parametrize(
    ("override", "problem"),
    [
        ("caveats.saturation.share=1.5", "caveats.saturation.share: must be 1 or less; found 1.5"),
        ("caveats.did_not_follow.share=0", "caveats.did_not_follow.share: must be above 0; found 0"),
        ("caveats.joint_limits.excess=-1", "caveats.joint_limits.excess: must be 0 or more; found -1"),
        ("caveats.chatter.share=much", "caveats.chatter.share: must be a number; found 'much'"),
        ("caveats.chater.share=0", "caveats.chater: unknown key (did you mean chatter?)"),
    ],
)
def test_a_threshold_out_of_range_is_refused(cli, override, problem):
    ending = cli("robot=macro", override)
    assert ending.code == 2
    assert problem in ending.err


def test_what_is_different_today_is_named():
    today = registry.rules_digest()
    assert changes_since(None) == ["no rules, as the run is from before there were any"]
    stored = {"digest": "x", "thresholds": {**our_thresholds(), "chatter": {"share": 0.5}, "gone": {"key": 1.0}}}
    assert changes_since(stored) == [
        "other rules",
        "caveats.chatter.share 0.5, now 0.05",
        "caveats.gone.key 1, now none",
    ]
    assert changes_since({"digest": today, "thresholds": our_thresholds()}) == []
