"""Cells of a sweep pooled over seeds and other axes into rows of a table."""

from dataclasses import replace

import numpy as np
import pytest
from support.paper_sweep import by_hand

from runner.base.errors import RunnerError
from runner.reporting.export.pooling import pool
from runner.store.axes import Axis


def test_seeds_are_put_together_and_nothing_else():
    sweep = by_hand()
    pooled = pool(sweep)
    assert [axis.name for axis in pooled.measurements.axes] == ["controller", "robot.payload.mass"]
    assert [cells.tolist() for cells in pooled.cells] == [[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]]
    assert pooled.seeds == [3, 3, 3, 3]
    values = pooled.measurements.values["peak_torque"]
    assert values.shape == (4, 12)
    assert sorted(values[1]) == sorted(sweep.values["peak_torque"][3:6].ravel())


def test_seeds_may_be_rows_of_their_own():
    pooled = pool(by_hand(), ["seed", "controller", "robot.payload.mass"])
    assert len(pooled.cells) == 12
    assert pooled.seeds == [1] * 12


@pytest.mark.parametrize("value", ["2", "2.0", "2e0"])
def test_cells_can_be_limited_to_a_value(value):
    pooled = pool(by_hand(), ["controller"], [f"robot.payload.mass={value}"])
    assert [cells.tolist() for cells in pooled.cells] == [[3, 4, 5], [9, 10, 11]]
    assert f"robot.payload.mass={value}" in pooled.measurements.fixed


@pytest.mark.parametrize(
    ("by", "where", "message"),
    [
        (["controller"], [], "differ in robot.payload.mass; only seeds are put together: write "
         "--by controller,robot.payload.mass for a row each, or fix a value, as in --where robot.payload.mass=0.5"),
        (["controler"], [], "--by: unknown axis 'controler'. Allowed: "),
        (None, ["controller=pid"], "--where controller: unknown value 'pid'. Allowed: computed_torque"),
        (None, ["controller"], "--where controller: no value. Allowed: KEY=VALUE."),
        (None, ["load=1"], "--where: unknown axis 'load'"),
        (None, ["controller=computed_torque", "controller=operational_space"], "no cell of the sweep has "),
    ],
)  # fmt: skip
def test_what_cannot_be_is_told_with_what_can(by, where, message):
    with pytest.raises(RunnerError) as told:
        pool(by_hand(), by, where)
    assert message in str(told.value)


def test_a_run_behind_two_cells_counts_once():
    sweep = by_hand()
    twice = replace(sweep, hashes=[*sweep.hashes[:1], *sweep.hashes[:1], *sweep.hashes[2:]])
    assert len(pool(twice).cells[0]) == 2


def test_rows_with_fewer_values_have_none_in_their_place():
    sweep = by_hand()
    sweep.values["peak_torque"][0] = np.nan
    row = pool(sweep).measurements.values["peak_torque"][0]
    assert np.count_nonzero(~np.isnan(row)) == 8


def test_failed_cells_are_counted_by_row():
    sweep = replace(by_hand(), statuses=["failed", *["ok"] * 11], failures=["diverged", *[""] * 11])
    pooled = pool(sweep)
    assert pooled.failed == [1, 0, 0, 0]
    assert pooled.measurements.statuses == ["failed", "ok", "ok", "ok"]


def test_without_axes_all_is_one_row():
    sweep = by_hand()
    seeds = replace(sweep, axes=[Axis("seed", list(map(float, range(12))), np.arange(12))])
    assert [len(cells) for cells in pool(seeds).cells] == [12]
