"""The check of a plan in blocks gives what each cell by itself does."""

import pytest
from support.grids import plan_sweep

from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.store import run_hash
from runner.sweeps.check import check

SHORT = ("robot=macro", "duration=0.05")


@pytest.mark.parametrize(
    ("arguments", "blocks"),
    [
        ((*SHORT, "seed=range(0,4)", "noise.position=1e-4,1e-3"), 2),
        (("duration=0.05", "robot=macro,mini", "seed=3,1,2", "repetitions=1,2"), 4),
        ((*SHORT, "noise.position=1e-4,1e-3"), 2),
        ((*SHORT, "seed=1,1"), 2),
    ],
)
def test_cells_are_named_as_one_by_one(arguments, blocks):
    plan = plan_sweep(arguments)
    found = list(plan.blocks())
    assert len(found) == blocks
    assert sorted(cell for block in found for cell in block.cells) == [*range(len(plan))]
    checked = check(plan)
    for cell in range(len(plan)):
        composed = plan.composed(cell)
        config = validate(composed)
        assert checked.names[cell] == run_hash(composed.resolved, config.arm.urdf)
        assert checked.costs[cell] == config.timing.ticks * config.settings.repetitions


def test_seeds_that_another_key_takes_make_no_block():
    assert [block.seeds for block in plan_sweep([*SHORT, "seed=1,2", "+robot.note=${seed}"]).blocks()] == [None, None]


def test_a_problem_names_its_first_cell_and_counts_all(tmp_path):
    with pytest.raises(ConfigError) as raised:
        check(plan_sweep([*SHORT, "seed=5,-1,-2", "noise.position=1e-4,-1", f"outputs={tmp_path}"]))
    problems = list(raised.value.problems)
    assert [problem.partition("]")[0] for problem in problems] == [
        "[robot=macro duration=0.05 seed=5 noise.position=-1",
        "[robot=macro duration=0.05 seed=-1 noise.position=0.0001",
        "[robot=macro duration=0.05 seed=-2 noise.position=0.0001",
    ]
    assert "and 2 other cells: noise.position" in problems[0]
    with pytest.raises(ConfigError, match=r"seed=0 noise.position=-1\] and 2 other cells: noise"):
        check(plan_sweep([*SHORT, "seed=range(0,3)", "noise.position=1e-4,-1"]))


def test_cells_that_share_a_group_share_the_object():
    plan = plan_sweep([*SHORT, "noise.position=1e-4,1e-3", "seed=range(0,3)"])
    cells = [plan.composed(cell).resolved for cell in range(len(plan))]
    assert len({id(config["noise"]) for config in cells}) == 2
    assert len({id(config["controller"]) for config in cells}) == 1


@pytest.mark.parametrize("values", ["1,1.0,2", "range(1,3)", "1,2"])
def test_an_integer_of_a_float_key_is_the_run_of_its_float(values):
    plan = plan_sweep([*SHORT, f"robot.payload.mass={values}"])
    floats = [repr(plan.composed(cell).resolved["robot"]["payload"]["mass"]) for cell in range(len(plan))]
    names = check(plan).names
    assert floats == (["1.0", "1.0", "2.0"] if len(plan) == 3 else ["1.0", "2.0"])
    assert list(names) == list(check(plan_sweep([*SHORT, f"robot.payload.mass={','.join(floats)}"])).names)
    assert (
        plan_sweep([*SHORT, "repetitions=1,1.0"]).composed(1).resolved["repetitions"] == 1.0
    )  # reported as no integer
