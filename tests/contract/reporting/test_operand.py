"""Stored sweeps and runs as sides of a comparison, with what is missing or damaged."""

import shutil

import pytest

from runner.base.errors import StoreError
from runner.reporting.comparison.operand import open_side, side_of_run


def test_what_is_stored_of_a_sweep_is_opened_and_what_is_missing_counted(copy_run, copy_sweep):
    folder = copy_sweep("goal", "other seed")
    whole = open_side("A", folder)
    assert (len(whole.measurements.hashes), whole.missing, whole.failed) == (2, 0, 0)
    gone = copy_run("other seed")
    shutil.rmtree(gone)
    part = open_side("A", folder)
    assert (part.measurements.hashes, part.missing) == ([copy_run("goal").name], 1)
    shutil.rmtree(gone.parent)
    with pytest.raises(StoreError, match="none of its 2 cells is stored; continue with: runner -m "):
        open_side("A", folder)


def test_a_damaged_cell_is_left_out_and_told(copy_run, copy_sweep):
    folder = copy_sweep("goal", "other seed")
    (copy_run("other seed") / "metrics.json").write_text("{")
    side = open_side("A", folder)
    assert side.missing == 1
    assert "metrics.json" in " ".join(side.damage)


def test_a_run_is_a_sweep_of_one_cell(runs):
    run = runs["goal"]
    side = side_of_run("B", run)
    assert (side.measurements.hashes, side.missing, side.folder) == ([run.hash], 0, run.folder)
    assert side.resolved("gravity") == [9.81]
    assert side.resolved("nothing.of.this") == [None]
