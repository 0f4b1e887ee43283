"""Cells whose configs differ in only the seed."""

import pickle

import pytest
from support.grids import plan_sweep

from runner.sweeps.plan import Alike

SHORT = ("robot=macro", "duration=0.05", "outputs=somewhere")


@pytest.mark.parametrize(
    ("overrides", "parts"),
    [
        (["seed=range(0,20)", "controller.natural_frequency=8,10"], 2),
        (["controller.natural_frequency=8,10", "sweep.trace=never", "seed=3,1,2", "noise.position=1e-4,1e-3"], 4),
        (["controller=operational_space,whole_body", "seed=1,2,3"], 2),
        (["seed=1,2", "+robot.note=${seed}"], 2),  # the seed is in two places
        (["seed=4", "controller.natural_frequency=8,10"], 2),
        (["controller.natural_frequency=8,10"], 2),
    ],
)
def test_cells_have_the_configs_that_they_have_one_by_one(overrides, parts):
    plan = plan_sweep([*SHORT, *overrides])
    found = list(plan.alike(range(len(plan))))
    assert len(found) == parts
    assert sorted(cell for cells, _ in found for cell in cells) == [*range(len(plan))]
    for cells, configs in pickle.loads(pickle.dumps(found)):
        assert list(configs) == [plan.composed(cell) for cell in cells]
    for cells, configs in plan.alike([1]):
        assert (list(cells), list(configs)) == ([1], [plan.composed(1)])


def test_a_thousand_seeds_are_sent_as_one_config():
    plan = plan_sweep([*SHORT, "seed=range(0,1000)"])
    ((_, configs),) = plan.alike(range(1000))
    assert isinstance(configs, Alike)
    assert len(pickle.dumps(configs)) < 2 * len(pickle.dumps(plan.composed(0))) + 20_000
    assert configs[0].resolved["robot"] is configs[999].resolved["robot"]
