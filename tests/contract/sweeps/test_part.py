"""Parts of a sweep: their cells, and the whole that they make in any order."""

import itertools

import pytest
from support.grids import plan_sweep

from runner import store
from runner.base.errors import ConfigError
from runner.config.limits import split_part
from runner.store.sweep import without_keys
from runner.sweeps import part as parts_of_sweeps
from runner.sweeps.check import check
from runner.sweeps.part import GridPart, own_part

GRIDS = {
    "seeds": ("seed=range(0,7)",),
    "seeds first": ("seed=5,1,4,0", "controller=joint_pd,computed_torque", "noise.position=0,1e-3"),
    "seeds last": ("controller=joint_pd,computed_torque", "noise.position=0,1e-3", "seed=range(3,8)"),
    "no seeds": ("noise.position=0,1e-3,2e-3", "controller.period=10ms,20ms"),
}
SHORT = ("robot=macro", "duration=0.05")


@pytest.mark.parametrize("count", [1, 2, 3, 4, 6])
@pytest.mark.parametrize("grid", GRIDS.values(), ids=GRIDS)
def test_parts_have_each_cell_once_with_its_own_config(grid, count):
    whole = plan_sweep([*SHORT, *grid])
    parts = [GridPart(whole, number, count) for number in range(count)]
    assert sorted(itertools.chain.from_iterable(part.cells for part in parts)) == [*range(len(whole))]
    for part in parts:
        for cell, own in enumerate(part.cells):
            assert part.overrides(cell) == whole.overrides(own)
            assert part.composed(cell) == whole.composed(own)
        blocks = [*part.blocks()]
        assert sorted(cell for block in blocks for cell in block.cells) == [*range(len(part))]
        for block in blocks:
            seeds = [part.composed(cell).resolved["seed"] for cell in block.cells]
            assert block.seeds is None or list(block.seeds) == seeds
        alike = [pair for cells, configs in part.alike(range(len(part))) for pair in zip(cells, configs, strict=True)]
        assert all(composed == part.composed(cell) for cell, composed in alike)
        assert sorted(cell for cell, _ in alike) == [*range(len(part))]


@pytest.mark.costs(3)
@pytest.mark.parametrize("order", [(0, 1, 2), (2, 0, 1)])
@pytest.mark.parametrize("trace", ["all", "never"])
def test_parts_in_any_order_make_the_sweep_of_one_command(sweep, tmp_path, order, trace):
    grid = (*GRIDS["seeds last"], f"sweep.trace={trace}")
    parted = [sweep(*grid, f"sweep.part={number}/3", f"outputs={tmp_path}/parted") for number in order]
    whole = sweep(*grid, f"outputs={tmp_path}/whole")
    assert {each.folder for each in parted} == {tmp_path / "parted" / "sweeps" / whole.folder.name}
    assert [each.part for each in parted] == [f"{number}/3" for number in order]
    assert sum(len(each.names) for each in parted) == len(whole.names) == 20
    assert [each.stored for each in parted] == [0, 0, 0]
    for name in ("runs.bin", "sweep.json"):
        assert (parted[0].folder / name).read_bytes() == (whole.folder / name).read_bytes()
    for one, other in zip(
        store.open_sweep(parted[0].folder).runs(), store.open_sweep(whole.folder).runs(), strict=True
    ):
        assert (one.hash, one.metrics) == (other.hash, other.metrics)
        assert {**one.config, "outputs": ""} == {**other.config, "outputs": ""}
    again = sweep(*grid, f"outputs={tmp_path}/parted")
    assert (again.stored, again.part) == (20, "")


def test_only_the_first_part_names_the_cells_of_others(sweep, monkeypatch):
    sweep("seed=range(0,4)", "noise.position=0,1e-3", "sweep.part=0/4")
    monkeypatch.setattr(parts_of_sweeps, "_name_all", None)
    assert len(sweep("seed=range(0,4)", "noise.position=0,1e-3", "sweep.part=3/4").names) == 2
    with pytest.raises(TypeError):
        sweep("seed=range(0,4)", "noise.position=0,2e-3", "sweep.part=3/4")


def test_a_part_names_the_whole_as_the_check_does():
    for grid in GRIDS.values():
        whole = plan_sweep([*SHORT, *grid])
        assert parts_of_sweeps._name_all(whole) == check(whole).names


def test_a_part_keeps_traces_as_the_whole(sweep, monkeypatch):
    monkeypatch.setattr("runner.sweeps.run._ALL_TRACES_UP_TO", 4)
    ended = sweep("seed=range(0,6)", "sweep.part=1/2")
    assert len([*ended.outputs.glob("shards/*.parquet")]) >= 1
    assert len([*ended.outputs.glob("runs/*")]) < 3


@pytest.mark.parametrize("text", ["3/3", "1", "-1/2", "1/0", "a/b", "1.0/2"])
def test_what_is_no_part_is_told(sweep, text):
    with pytest.raises(ConfigError, match=r"sweep\.part: must be K/N, such as 0/40, .*; found "):
        sweep("seed=0,1", f"sweep.part={text}")
    with pytest.raises(ValueError, match="must be K/N"):
        split_part(text)


def test_more_parts_than_cells(sweep):
    with pytest.raises(ConfigError, match=r"sweep\.part: must have at most as many parts as cells, 2; found 3"):
        sweep("seed=0,1", "sweep.part=0/3")
    assert own_part(plan_sweep([*SHORT, "seed=0,1"])).axes() is not None


def test_a_problem_of_another_part_is_told(sweep):
    with pytest.raises(ConfigError, match=r"noise\.position=-1"):
        sweep("noise.position=0,-1", "sweep.part=0/2")


def test_a_tuning_has_no_parts(tuned):
    with pytest.raises(ConfigError, match=r"sweep\.part: a tuning has no parts"):
        tuned("controller.natural_frequency=interval(5,50)", "sweep.part=0/2", trials=1)


@pytest.mark.parametrize(
    ("command", "kept"),
    [
        ("runner -m seed=0,1 sweep.part=0/2 'a=b c'", "runner -m seed=0,1 'a=b c'"),
        ("runner -m ++sweep.part=0/2 seed=0", "runner -m seed=0"),
        ("runner -m ...", "runner -m ..."),
        ("it's", "it's"),
    ],
)
def test_the_stored_command_has_no_part(command, kept):
    assert without_keys(command, ("sweep.part",)) == kept
