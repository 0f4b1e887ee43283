"""Limits of memory and CPU time: runs and sweeps that cost too much are refused before they begin."""

import re

import pytest

from runner.assembly.run_cost import check_cpu_time, check_memory_together, memory_of_run
from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.base.ticks import counter
from runner.config.compose.compose import compose
from runner.config.limits import LimitsConfig
from runner.simulation.tick_time import seconds_per_tick
from runner.store import simulated_part


@pytest.fixture(autouse=True)
def memory(monkeypatch):
    """The same memory on every machine: half of it are 8 GB."""
    monkeypatch.setattr("runner.assembly.run_cost.half_of_memory", lambda: 8e9)


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (
            ("duration=90000",),
            r"limits.memory: a run of 9e\+04 s \(9e\+06 ticks of 0.01 s, .* 4.54 GB; allowed: 4",
        ),
        (
            ("repetitions=1000000000",),
            r"limits.memory: .* repetitions: 1000000000\) would take about 409 GB; allowed: 4 GB, in which 8\d{6} "
            "repetitions fit; shorten",
        ),
        (
            ("trajectory=joint_sinusoids", "trajectory.duration=6e6", "duration=0.02"),
            r"trajectory.duration: a motion of 6e\+06 s has 288,000,128 samples; allowed: up to 500,000; make",
        ),
        (("duration=4000", "limits.memory=0.1"), r"limits.memory: .* allowed: 0.1 GB; shorten duration"),
        (
            ("repetitions=500000", "limits.cpu_hours=0.001"),
            r"limits.cpu_hours: the run would take about .* allowed: 0.001;",
        ),
    ],
)
def test_a_run_that_costs_too_much_is_not_begun(cli, tmp_path, overrides, message):
    ending = cli("robot=macro", *overrides)
    assert ending.code == 2
    assert re.search(message, ending.err), ending.err
    assert not (tmp_path / "outputs").exists()


def test_a_sweep_that_costs_too_much_is_not_begun(cli, tmp_path):
    ending = cli("-m", "robot=macro", "seed=range(0,50)", "repetitions=100000", "limits.cpu_hours=0.01")
    assert ending.code == 2
    assert "limits.cpu_hours: 50 runs would take about " in ending.err
    assert not [*(tmp_path / "outputs" / "runs").iterdir()]


def test_null_allows_half_of_the_memory_and_any_time(checked_config, monkeypatch):
    asked = ("robot=macro", "duration=30000", "limits.memory=null", "limits.cpu_hours=null")
    config = checked_config(*asked)
    needed = memory_of_run(config.arm, config.timing.ticks, 1, config.has_contact)
    monkeypatch.setattr("runner.assembly.run_cost.half_of_memory", lambda: needed)
    check_cpu_time(checked_config(*asked).limits, 1e12, 1)
    monkeypatch.setattr("runner.assembly.run_cost.half_of_memory", lambda: needed - 1.0)
    with pytest.raises(ConfigError, match=r"would take about 1.51 GB; allowed: 1.51 GB, half of this machine's memory"):
        checked_config(*asked)


def test_runs_at_a_time_share_half_of_the_memory(monkeypatch):
    monkeypatch.setattr("runner.assembly.run_cost.half_of_memory", lambda: 6e9)
    check_memory_together(3e9, 2)
    with pytest.raises(ConfigError, match=r"workers: 3 runs at a time, .* 9 GB; allowed: 6 GB, .* in which 2 fit"):
        check_memory_together(3e9, 3)


def test_hours_are_compared():
    limits = LimitsConfig(cpu_hours=2.0, memory=None)
    check_cpu_time(limits, 7200.0, 3)
    with pytest.raises(
        ConfigError, match=r"limits.cpu_hours: 3 runs would take about 2.5 hours of CPU time; allowed: 2;"
    ):
        check_cpu_time(limits, 9000.0, 3)


def test_what_may_be_felt_takes_memory(macro, one_stage, macro_urdf):
    robot = one_stage(macro_urdf, macro)
    assert (
        memory_of_run(robot, 1000, 1, has_contact=True)
        > memory_of_run(robot, 1000, 1, has_contact=False)
        > 8 * 1000 * 50
    )


def test_limits_are_no_part_of_a_result(checked_config):
    assert "limits" not in simulated_part(checked_config("robot=macro").resolved)


@pytest.mark.parametrize(("plant", "most"), [("rk4", 200_000), ("mujoco", 200)])
def test_a_tick_is_timed_in_few_ticks(plant, most):
    composed = compose(["robot=macro", f"plant={plant}", "controller=operational_space"])
    config, ticks = validate(composed), counter()
    assert seconds_per_tick(config) > 0.0
    assert 0 < ticks() <= most
