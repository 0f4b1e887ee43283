"""Flipped bits and other damage to a store of every kind of file: never read as something else, never a crash."""

import pytest

from runner.cli.verify import verify
from tools.fuzz.stores import damage_files, files_of, flip_bits, make_store, read_all

CASES = 200  # `python -m tools.fuzz stores` takes thousands


@pytest.fixture(scope="module")
def outputs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("store")
    make_store(folder)
    return folder


def test_the_store_is_whole(outputs):
    assert not read_all(outputs).told
    kinds = {found.kind: found.state for found in verify(outputs)}
    assert kinds == dict.fromkeys(("runs", "shards", "sweeps", "tunings", "calibrations"), "good")
    names = {path.name for path in files_of(outputs)}
    assert {
        "config.yaml",
        "robot.urdf",
        "trace.parquet",
        "values.parquet",
        "metrics.json",
        "sweep.json",
        "progress.json",
    } <= names
    assert {"tuning.json", "journal.log", "result.json"} <= names
    assert any(path.parent.name == "shards" for path in files_of(outputs))


def test_no_flipped_bit_is_read_as_something_else(outputs):
    assert list(flip_bits(outputs, CASES, 1)) == []


def test_no_other_damage_is_read_as_something_else(outputs):
    assert list(damage_files(outputs, CASES, 2)) == []


@pytest.mark.costs(2)
def test_no_damage_ends_a_command_with_a_traceback(outputs):
    assert list(damage_files(outputs, CASES // 25, 3, commands=True)) == []
