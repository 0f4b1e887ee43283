"""Caveats with a run: found, stored, printed."""

import subprocess
import sys
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from support.caveat_runs import signals, stacked
from support.engines import ASKED

from runner.caveats import plant_error, rounding
from runner.caveats.monitor import Watch, look_together
from runner.caveats.setting import RunSignals, setting_of, signals_of
from runner.caveats.setting_rules import SETTING_RULES
from runner.caveats.trace_rules import TRACE_RULES
from runner.caveats.versions import changes_since, our_thresholds, rules_digest
from runner.config.judgement import THRESHOLDS, CaveatsConfig
from runner.store import run_hash

ROBOTS = ("macro", "mini", "combined", "macro_mini_mini", "xarm7", "xarm7_mini", "meca500", "meca500_r4")


def test_every_rule_has_a_threshold_of_its_own():
    rules = [rule.name for rule in (*TRACE_RULES, *SETTING_RULES)] + [plant_error.NAME, rounding.NAME]
    keys = {name: tuple(values) for name, values in our_thresholds().items()}
    assert keys == {name: (key,) for name, (key, *_) in THRESHOLDS.items()}
    assert sorted(CaveatsConfig.model_fields) == sorted(rules)


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_robot_as_it_is_has_none(make_run, robot):
    run = make_run(f"robot={robot}", "duration=1")
    assert run.caveats == []
    assert changes_since(run.caveat_rules) == []


def test_runs_side_by_side_are_judged_as_one_after_another(checked_config):
    config = checked_config("robot=macro", ASKED, "torque_limits.max=10", "trajectory=quintic")
    generator = np.random.default_rng(0)
    runs = [
        signals(
            tau=np.clip(generator.normal(0.0, spread, (100, 3)), -10.0, 10.0),
            tip=generator.normal(0.0, 0.1 * spread, (101, 3)),
            q=generator.normal(0.0, 100.0 * spread, (101, 3)),
            dq=generator.normal(0.0, 10.0 * spread, (101, 3)),
            desired=np.linspace(0.0, 1.0, 101)[:, None] * np.ones(3),
        )
        for spread in (1.0, 5.0, 9.0, 40.0)
    ]
    setting = replace(setting_of(config), velocity_limits=np.full(3, 30.0))
    one, several = (Watch(setting, config.caveats) for _ in range(2))
    for run in runs:
        one.look(run)
    several.look(stacked(*runs))
    found = one.found()
    assert found == several.found()
    assert {caveat.rule for caveat in found.caveats} == {rule.name for rule in TRACE_RULES}


def some_signals(limit, seed=0):
    """Signals of a run that springs more rules the larger its seed."""
    generator, spread = np.random.default_rng(seed), (0.1, 1.0, 5.0, 9.0, 40.0)[seed % 5]
    limits = np.full(3, limit)
    return signals(
        tau=np.clip(generator.normal(0.0, spread, (100, 3)), -limits, limits),
        tip=generator.normal(0.0, 0.1 * spread, (101, 3)),
        q=generator.normal(0.0, 100.0 * spread, (101, 3)),
        dq=generator.normal(0.0, 10.0 * spread, (101, 3)),
        desired=np.linspace(0.0, 1.0, 101)[:, None] * np.ones(3),
        limits=limits,
    )


@pytest.mark.parametrize("trajectory", ["quintic", "goal"])
def test_runs_with_limits_and_thresholds_of_their_own_are_judged_as_each_alone(checked_config, trajectory):
    config = checked_config("robot=macro", f"trajectory={trajectory}", "noise.position=1e-3")
    limits = [2.0, np.inf, 10.0, 0.3, 8.0, 1.0, 20.0]
    speeds = {"velocity_limits": np.full(3, 30.0)}
    settings = [replace(setting_of(config), torque_limits=np.full(3, limit), **speeds) for limit in limits]
    thresholds = [
        config.caveats.model_copy(update={"saturation": config.caveats.saturation.model_copy(update={"share": share})})
        for share in (0.1, 0.0, 0.9, 0.5, 0.1, 0.1, 0.1)
    ]
    runs = [some_signals(limit, seed) for seed, limit in enumerate(limits)]
    alone = [Watch(*pair) for pair in zip(settings, thresholds, strict=True)]
    for watch, run in zip(alone, runs, strict=True):
        watch.look(run)
    expected = [watch.found() for watch in alone]
    for order in ([0, 1, 2, 3, 4, 5, 6], [6, 2, 0], [3], [1, 4]):
        watches = [Watch(settings[run], thresholds[run]) for run in order]
        look_together(watches, stacked(*(runs[run] for run in order)))
        assert [watch.found() for watch in watches] == [expected[run] for run in order]
    told = {caveat.rule for found in expected for caveat in found.caveats}
    assert told >= {rule.name for rule in TRACE_RULES}
    assert len({len(found.caveats) for found in expected}) > 2


def test_more_runs_than_caches_hold_are_looked_at_in_blocks(checked_config):
    config = checked_config("robot=macro", "trajectory=quintic", "torque_limits.max=5")
    runs = [some_signals(5.0, seed) for seed in range(140)]
    alone, together = ([Watch(setting_of(config), config.caveats) for _ in runs] for _ in range(2))
    for watch, run in zip(alone, runs, strict=True):
        watch.look(run)
    look_together(together, stacked(*runs))
    assert [watch.found() for watch in together] == [watch.found() for watch in alone]


def test_repetitions_of_many_runs_stand_behind_them(checked_config):
    config = checked_config("robot=macro", "trajectory=quintic", "torque_limits.max=5", "repetitions=3")
    each = [[some_signals(5.0, seed) for seed in seeds] for seeds in ((1, 2, 5), (0, 0, 10), (4, 0, 9))]
    alone, together = ([Watch(setting_of(config), config.caveats) for _ in each] for _ in range(2))
    for watch, repetitions in zip(alone, each, strict=True):
        for run in repetitions:
            watch.look(run)
    names = vars(each[0][0])
    look_together(together, RunSignals(*(np.array([[getattr(r, n) for r in own] for own in each]) for n in names)))
    found = [watch.found() for watch in alone]
    assert [watch.found() for watch in together] == found
    told = {caveat.text.rpartition(", in ")[2] for own in found for caveat in own.caveats}
    assert told >= {f"{count} of 3 repetitions" for count in (1, 2, 3)}


@pytest.mark.parametrize("cuts", [(64,), (1, 2), (0, 70), (139,)])
def test_watches_of_blocks_of_repetitions_join_to_that_of_all(checked_config, cuts):
    config = checked_config("robot=macro", "trajectory=quintic", "torque_limits.max=5", "repetitions=140")
    runs = [some_signals(5.0, seed) for seed in range(140)]
    whole, at_once = (Watch(setting_of(config), config.caveats) for _ in range(2))
    for run in runs:
        whole.look(run)
    at_once.look(stacked(*runs))
    blocks = [runs[first:last] for first, last in pairwise((0, *cuts, 140)) if last > first]
    joined, *later = [Watch(setting_of(config), config.caveats) for _ in blocks]
    for watch, block in zip((joined, *later), blocks, strict=True):
        watch.look(stacked(*block))
    for watch in later:
        joined.join(watch)
    assert joined.found() == at_once.found() == whole.found()
    assert "of 140 repetitions" in joined.found().caveats[0].text


def test_an_arm_that_gives_way_has_nothing_to_follow_among_others(checked_config):
    config = checked_config("robot=macro", ASKED, "trajectory=quintic")
    watches = [Watch(replace(setting_of(config), complies=True), config.caveats) for _ in range(3)]
    look_together(watches, stacked(*(some_signals(np.inf, 4) for _ in range(3))))
    assert [[caveat.rule for caveat in watch.found().caveats] for watch in watches] == [
        ["joint_limits", "joint_stops"]
    ] * 3


def test_the_signals_of_many_traces_are_those_of_each(hand_made_trace):
    t = np.arange(101) * 0.01
    traces = [hand_made_trace(t, q=run, tau=2.0 * run, tip=0.1 * run, desired=run, limits=run) for run in range(1, 4)]
    metrics = [{"saturation_fraction_q1": run / 10, "saturation_fraction_q2": run / 20} for run in range(3)]
    each = [signals_of(*pair) for pair in zip(traces, metrics, strict=True)]
    names = ("q", "dq", "tau", "limits", "desired")
    own = {name: np.array([getattr(trace, name) for trace in traces]) for name in names}
    end_points = np.array([trace.end_points for trace in traces]).swapaxes(0, 1)
    batch = replace(traces[0][None], **own, end_points=end_points)
    arrays = {name: np.array([own[name] for own in metrics]) for name in metrics[0]}
    found = signals_of(batch, arrays)
    for name in vars(found):
        np.testing.assert_array_equal(getattr(found, name), [getattr(own, name) for own in each], err_msg=name)
    shared = signals_of(replace(batch, desired=traces[1].desired), arrays).desired
    np.testing.assert_array_equal(shared, [each[1].desired] * 3)


def test_they_are_told_stored_and_found_again(cli):
    overrides = ("robot=macro", ASKED, "duration=0.1", "torque_limits.max=1", "noise.position=1e-3", "repetitions=2")
    first, again = cli(*overrides), cli(*overrides)
    assert first.code == 0
    told = [line for line in first.err.splitlines() if line.startswith("runner: caveat: ")]
    assert [line.split(": ")[2] for line in told] == ["did_not_follow", "saturation", "exact_velocity"]
    assert told[1].endswith("of the ticks, in 2 of 2 repetitions")
    assert again.err == first.err.replace(", stored in", ", stored before in")
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
    run = make_run("robot=macro", ASKED, "noise.position=3", "torque_limits.max=20", "duration=2", "plant.step=0.01")
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
    today = rules_digest()
    assert changes_since(None) == []
    stored = {"digest": "x", "thresholds": {**our_thresholds(), "chatter": {"share": 0.5}, "gone": {"key": 1.0}}}
    assert changes_since(stored) == [
        "other rules",
        "caveats.chatter.share 0.5, now 0.05",
        "caveats.gone.key 1, now none",
    ]
    assert changes_since({"digest": today, "thresholds": our_thresholds()}) == []
