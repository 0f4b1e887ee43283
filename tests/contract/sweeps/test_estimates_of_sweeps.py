"""Estimate of a sweep: the words on standard error, and the measurement of ticks by a clock that a test sets."""

import contextlib
from types import SimpleNamespace

import pytest
from support.engines import ASKED
from support.grids import plan_sweep

from runner.assembly.validation import validate
from runner.config.compose.compose import compose
from runner.simulation import tick_time
from runner.simulation.tick_time import PROBED_TICKS, seconds_per_tick, seconds_together, warm_time
from runner.sweeps import run
from runner.sweeps.engine import in_process
from runner.sweeps.estimate import START_UP, Estimate
from runner.sweeps.run import Engine, run_sweep

SHORT = ("robot=macro", "duration=0.05", "noise=none")
EXPECTED = 40.0


@pytest.mark.parametrize(
    ("known", "workers", "words"),
    [
        ("about", 0, f"about {EXPECTED:.0f} s on 1 process"),
        ("up to", 0, f"up to {EXPECTED:.0f} s on 1 process"),
        ("more than", 0, f"more than {EXPECTED:.0f} s on 1 process"),
        ("about", 1, f"about {EXPECTED + START_UP:.0f} s on 1 process"),
        ("up to", 4, f"up to {EXPECTED / 2 + 2 * START_UP:.0f} s on 4 processes"),
    ],
)
def test_an_estimate_and_a_bound_are_told_with_the_start_of_processes_on_two_cores(
    tmp_path, monkeypatch, capsys, known, workers, words
):
    monkeypatch.setattr(run, "local_processes", lambda *_: contextlib.nullcontext())
    monkeypatch.setattr(run, "on_processes", lambda queue, _: in_process(queue))
    monkeypatch.setattr(run, "estimate", lambda *_: Estimate(EXPECTED, known))
    monkeypatch.setattr(run.os, "cpu_count", lambda: 2)
    plan = plan_sweep([*SHORT, "plant=rk4", f"outputs={tmp_path}", "seed=range(0,4)"])
    run_sweep(plan, Engine(workers, None), "runner -m ...")
    assert f"runner: {words}\n" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("seconds", "known", "overrides", "started"),
    [
        (6 * START_UP, "about", [], []),  # two processes would take 3, after 1 of their start, and cost 2
        (6.1 * START_UP, "about", [], [2]),
        (0.1, "more than", [], [2]),
        (0.1, "up to", [], [2]),
        (0.1, "about", ["sweep.time_limit=60"], [2]),
    ],
)
def test_workers_start_only_where_they_pay_or_protect(tmp_path, monkeypatch, seconds, known, overrides, started):
    workers = []
    monkeypatch.setattr(run, "local_processes", lambda count, _: contextlib.nullcontext(workers.append(count)))
    monkeypatch.setattr(run, "on_processes", lambda queue, _: in_process(queue))
    monkeypatch.setattr(run, "estimate", lambda *_: Estimate(seconds, known))
    monkeypatch.setattr(run.os, "cpu_count", lambda: 2)
    monkeypatch.setattr(run, "time", SimpleNamespace(monotonic=lambda: 0.0))
    plan = plan_sweep([*SHORT, "plant=rk4", f"outputs={tmp_path}", "seed=0,1", *overrides])
    assert len(run_sweep(plan, Engine(2, None), "runner -m ...").ends) == 2
    assert workers == started


def test_workers_take_the_rest_of_what_takes_longer_than_expected(tmp_path, monkeypatch):
    workers, clock = [], Steps(2.4 * START_UP)
    monkeypatch.setattr(run, "local_processes", lambda count, _: contextlib.nullcontext(workers.append(count)))
    monkeypatch.setattr(run, "on_processes", lambda queue, _: in_process(queue))
    monkeypatch.setattr(run, "estimate", lambda *_: Estimate(0.1))
    monkeypatch.setattr(run.os, "cpu_count", lambda: 2)
    monkeypatch.setattr(run, "time", SimpleNamespace(monotonic=clock))
    monkeypatch.setattr("runner.sweeps.queue._SECONDS_PER_CHUNK", 1e-9)  # each run is a chunk
    plan = plan_sweep([*SHORT, f"outputs={tmp_path}", ASKED, "controller.period=0.005,0.01,0.02,0.025,0.05"])
    ended = run_sweep(plan, Engine(4, None), "runner -m ...")
    assert len(ended.ends) == 5
    assert 0 < workers[0] < 5


class Steps:
    """A clock that moves on by a step each time it is read."""

    def __init__(self, step):
        self.now, self.step = 0.0, step

    def __call__(self):
        self.now += self.step
        return self.now


@pytest.mark.parametrize(("first", "made"), [(0.49, 2), (0.5, 1), (0.51, 1)])
def test_what_is_quick_is_timed_the_second_time(first, made):
    took, now, calls = [first, 0.25], [0.0], []

    def make():
        now[0] += took[len(calls)]
        calls.append(1)

    assert warm_time(make, lambda: now[0]) == pytest.approx(took[made - 1])
    assert len(calls) == made


def together(config, within, clock):
    return seconds_together(config, 15, within, clock)


@pytest.mark.parametrize(
    ("measure", "plant", "duration", "before", "ticks"),
    [
        (together, "rk4", 0.05, ["repetitions asked for"], 15),
        (together, "rk4", 1.0, ["repetitions asked for"], 15),
        (seconds_per_tick, "mujoco", 0.05, ["repetitions asked for", "assembled"], 6),
        (seconds_per_tick, "mujoco", 1.0, ["repetitions asked for", "assembled"], PROBED_TICKS + 1),
    ],
)
def test_assembly_is_outside_the_deadline_and_the_ticks_within(monkeypatch, measure, plant, duration, before, ticks):
    events = []

    @contextlib.contextmanager
    def within():
        events.append("deadline")
        yield
        events.append("end")

    def noted(owner, name, event):
        plain = getattr(owner, name)
        monkeypatch.setattr(owner, name, lambda *args, **options: (events.append(event), plain(*args, **options))[1])

    noted(tick_time.BatchSimulator, "repetitions", "repetitions asked for")
    noted(tick_time.BatchSimulator, "simulate", "ticks")
    noted(tick_time, "assemble", "assembled")
    noted(tick_time, "simulate_assembled", "ticks")
    config = validate(compose([*SHORT, f"plant={plant}", f"duration={duration}"]))
    per_tick = measure(config, within(), Steps(0.25))
    assert events == [*before, "deadline", "ticks", "ticks", "end"]
    assert per_tick == pytest.approx(0.25 / ticks)
