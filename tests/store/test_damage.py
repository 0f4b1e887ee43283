"""Flipped bits and other damage to a store of every kind of file: never read as something else, never a crash."""

import random

import pytest

from bench.damaged_stores import damage, files_of, flip, read_all
from runner.commands.verify import verify

CASES = 200
SHORT = ("robot=macro", "duration=0.03")


@pytest.fixture(scope="module")
def outputs(tmp_path_factory):
    """A store with every kind of file: runs, shards, a sweep, a tuning, calibrations, notes of progress."""
    from runner.calibration_job import calibrate
    from runner.store.atomic import write_atomically
    from runner.store.seal import sealed_json
    from runner.sweeps.grid import plan_sweep
    from runner.sweeps.run import Engine, run_sweep
    from runner.tuning.objective import Objective
    from runner.tuning.run import tune

    folder = tmp_path_factory.mktemp("store")
    given, here = (*SHORT, f"outputs={folder}"), Engine(0, None)
    for more in (("seed=0,1",), ("seed=2,3,4", "sweep.trace=never", "noise=thesis", "repetitions=3")):
        swept = run_sweep(plan_sweep([*given, *more]), here, "runner -m").folder
        write_atomically(swept / "progress.json", sealed_json({"seconds_per_run": 0.5}))
    key = "controller.damping_ratio=interval(0.5,1.5)"
    tune([*given, key, "hydra.sweeper.workers=0"], [Objective("peak_torque", "minimize")], 3, 2, "runner tune")
    calibrate("calibration=tool_direction", "repetitions=2", f"outputs={folder}")
    return folder


def test_the_store_is_whole(outputs):
    assert not read_all(outputs).told
    kinds = {found.kind: found.state for found in verify(outputs)}
    assert kinds == dict.fromkeys(("runs", "shards", "sweeps", "tunings", "calibrations"), "good")
    names = {path.name for path in files_of(outputs)}
    assert {"config.yaml", "robot.urdf", "trace.parquet", "metrics.json", "sweep.json", "progress.json"} <= names
    assert {"tuning.json", "journal.log", "result.json"} <= names
    assert any(path.parent.name == "shards" for path in files_of(outputs))


def test_no_flipped_bit_is_read_as_something_else(outputs):
    draw, whole = random.Random(1), read_all(outputs)
    kinds = {}
    for path in files_of(outputs):
        kinds.setdefault("shards" if path.parent.name == "shards" else path.name, []).append(path)
    for _ in range(CASES):
        path = draw.choice(kinds[draw.choice(sorted(kinds))])
        content = flip(path, draw)
        found = read_all(outputs, path)
        path.write_bytes(content)
        assert found.told, path
        assert found.values.items() <= whole.values.items(), path
        assert all(path.name in told for told in found.told.values()), found.told


def test_no_damage_is_read_as_something_else_and_verify_names_it(outputs):
    draw, whole, files = random.Random(2), read_all(outputs), files_of(outputs)
    for case in range(CASES):
        path = draw.choice(files)
        content = damage(path, files, draw)
        changed = path.read_bytes() != content
        found = read_all(outputs, path)
        told = (
            [each.problem for each in verify(outputs) if each.state == "damaged"]
            if case % 5 == 0
            else [*found.told.values()]
        )
        path.write_bytes(content)
        assert all(whole.values[place] == value for place, value in found.values.items()), path
        assert bool(told) == changed, path
        assert all(str(path.parent) in problem for problem in told)  # of a swapped record its neighbours do not fit
