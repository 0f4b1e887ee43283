"""Stored axes of a sweep: order, values, reading back and damaged lists."""

import itertools
import json

import pytest
from hydra.core.override_parser.overrides_parser import OverridesParser

from runner.base.errors import StoreError
from runner.store import open_sweep, write_grid
from runner.store.axes import Axes, SweepAxis, override_value, read_axes
from runner.store.names import Names

SEEDS = SweepAxis("seed", range(4, -2, -2))
AXES = (SweepAxis("robot", ["macro", "mini"]), "b=[1, 2]", SEEDS, SweepAxis("a", [1, 'x, "y"', None]))


def combinations():
    values = itertools.product(("macro", "mini"), (4, 2, 0), ("1", "'x, \"y\"'", "null"))
    return [(f"robot={robot}", "b=[1, 2]", f"seed={seed}", f"a={a}") for robot, seed, a in values]


def hashes(count):
    return Names.of([f"{number:024x}" for number in range(count)])


def test_the_last_axis_changes_fastest():
    axes = Axes(AXES)
    assert len(axes) == 18
    assert list(axes) == combinations()
    assert axes[-1] == combinations()[-1]
    assert axes[2:4] == combinations()[2:4]
    with pytest.raises(IndexError):
        _ = axes[18]


def test_how_a_sweep_is_run_is_no_override_of_a_cell():
    assert list(Axes([SweepAxis("sweep.trace", ["all", "all"]), "outputs=a", "seed=1"])) == [("seed=1",)] * 2


def test_axes_are_read_as_they_were_stored():
    assert read_axes(json.loads(json.dumps(Axes(AXES).content()))) == Axes(AXES)
    assert read_axes([]) == Axes([]) == [()]


@pytest.mark.parametrize(
    "content", [None, {}, [3], [["a"]], [{"key": "a"}], [{"key": "a", "values": []}], [{"key": 3, "values": [1]}],
                [{"key": "a", "range": [0, 1]}], [{"key": "a", "range": [0, 1, 0]}],
                [{"key": "a", "range": [0, 1.5, 1]}]],
)  # fmt: skip
def test_what_is_no_axis_is_said(content):
    with pytest.raises(StoreError, match=r"axis|axes"):
        read_axes(content)


@pytest.mark.parametrize(
    "value",
    [None, True, 3, -0.5, 1e-300, "macro", "3", "1e-4", "true", "NULL", "inf", "", "a b", "it's", "a,b", "5 mm", "a\\",
     "${robot.goal}", "${robot.goal} b", r"\${x}", [1, [2.5, None], "x y"], {"a": 1, "b": [True, "false"]}],
    ids=repr,
)  # fmt: skip
def test_hydra_reads_an_override_as_the_value(value):
    (override,) = OverridesParser.create().parse_overrides([f"key={override_value(value)}"])
    assert override.value() == value
    assert type(override.value()) is type(value)


@pytest.mark.parametrize("axes", [AXES, AXES[:3], AXES[2:3], AXES[1:2], ()], ids=len)
def test_a_grid_opens_with_the_overrides_and_runs_of_its_cells(tmp_path, axes):
    grid = Axes(axes)
    names = hashes(len(grid))
    folder = write_grid(tmp_path, grid, names, "runner -m ...")
    opened = open_sweep(folder)
    assert (opened.overrides, opened.hashes, opened.command) == (list(grid), list(names), "runner -m ...")


def test_a_short_range_and_its_numbers_are_one_sweep(tmp_path):
    folders = {
        write_grid(tmp_path, Axes([SweepAxis("seed", values)]), hashes(2), "runner -m ...")
        for values in ([0, 1], range(2))
    }
    assert len(folders) == 1
    assert write_grid(tmp_path, Axes([SweepAxis("seed", [0, 2])]), hashes(2), "runner -m ...") not in folders


def test_a_million_cells_take_a_rule(tmp_path):
    axes = Axes(["robot=macro", SweepAxis("seed", range(10**5))])
    folder = write_grid(tmp_path, axes, hashes(10**5), "runner -m ...")
    assert (folder / "sweep.json").stat().st_size < 1000
    assert (folder / "runs.bin").stat().st_size == 12 * 10**5
    assert open_sweep(folder).overrides[99_999] == ("robot=macro", "seed=99999")


@pytest.mark.parametrize("damage", ["gone", "short", "other"])
def test_a_damaged_list_of_runs_is_named(tmp_path, damage):
    folder = write_grid(tmp_path, Axes(AXES), hashes(18), "runner -m ...")
    path = folder / "runs.bin"
    content = path.read_bytes()
    path.unlink() if damage == "gone" else path.write_bytes(content[:-1] if damage == "short" else content[::-1])
    with pytest.raises(StoreError, match=r"cannot read .*runs\.bin"):
        open_sweep(folder)
