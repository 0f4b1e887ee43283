"""Stored axes of a sweep: order, reading back and damaged lists."""

import itertools
import json

import pytest

from runner.base.errors import StoreError
from runner.store import open_sweep, sweep, write_grid, write_sweep
from runner.store.axes import Counted, GridOverrides, read_axes
from runner.store.names import Names

AXES = (("robot=macro", "robot=mini"), ("",), Counted("seed=", range(4, -2, -2)), ("a=1", "a='x, \"y\"'"))


def combinations():
    return [tuple(text for text in texts if text) for texts in itertools.product(*AXES)]


def hashes(count):
    return Names.of([f"{number:024x}" for number in range(count)])


def test_the_last_axis_changes_fastest():
    grid = GridOverrides(AXES)
    assert len(grid) == 12
    assert list(grid) == combinations()
    assert grid[-1] == combinations()[-1]
    assert grid[2:4] == combinations()[2:4]
    with pytest.raises(IndexError):
        _ = grid[12]


def test_axes_are_read_as_they_were_stored():
    assert read_axes(json.loads(json.dumps(GridOverrides(AXES).content()))) == GridOverrides(AXES)
    assert read_axes([]) == GridOverrides([]) == [()]


@pytest.mark.parametrize(
    "content", [None, {}, [3], [["a", 3]], [{"start": "a"}], [{"start": "a", "range": [0, 1]}],
                [{"start": "a", "range": [0, 1, 0]}], [{"start": "a", "range": [0, 1.5, 1]}]],
)  # fmt: skip
def test_what_is_no_axis_is_said(content):
    with pytest.raises(StoreError, match=r"axis|axes"):
        read_axes(content)


@pytest.mark.parametrize("at_once", [1, 2, 100])
@pytest.mark.parametrize("axes", [AXES, AXES[:3], AXES[2:3], AXES[1:2], ()], ids=len)
def test_a_grid_has_the_folder_of_the_same_jobs_one_by_one(tmp_path, monkeypatch, axes, at_once):
    monkeypatch.setattr(sweep, "_AT_ONCE", at_once)
    grid = GridOverrides(axes)
    names = hashes(len(grid))
    folder = write_grid(tmp_path, grid, names, "runner -m ...")
    opened = open_sweep(folder)
    assert (opened.overrides, opened.hashes, opened.command) == (list(grid), list(names), "runner -m ...")
    assert write_sweep(tmp_path, list(zip(grid, names, strict=True)), "runner -m ...") == folder
    assert open_sweep(folder).overrides == opened.overrides


def test_a_million_cells_take_a_rule(tmp_path):
    grid = GridOverrides([("robot=macro",), Counted("seed=", range(10**5))])
    folder = write_grid(tmp_path, grid, hashes(10**5), "runner -m ...")
    assert (folder / "sweep.json").stat().st_size < 1000
    assert (folder / "runs.bin").stat().st_size == 12 * 10**5
    assert open_sweep(folder).overrides[99_999] == ("robot=macro", "seed=99999")


@pytest.mark.parametrize("damage", ["gone", "short", "other"])
def test_a_damaged_list_of_runs_is_named(tmp_path, damage):
    folder = write_grid(tmp_path, GridOverrides(AXES), hashes(12), "runner -m ...")
    path = folder / "runs.bin"
    content = path.read_bytes()
    path.unlink() if damage == "gone" else path.write_bytes(content[:-1] if damage == "short" else content[::-1])
    with pytest.raises(StoreError, match=r"cannot read .*runs\.bin"):
        open_sweep(folder)
