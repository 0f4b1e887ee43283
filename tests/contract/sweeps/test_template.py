"""Cells made from a template are those that Hydra composes, whatever the keys do to each other."""

import random

import pytest
from support.grids import plan_sweep

from runner.base.errors import ConfigError
from runner.config.compose import unresolved
from runner.config.compose.compose import compose
from runner.sweeps import template

INDEPENDENT = [
    ("robot=macro,mini", "noise.position=1e-4,1e-3", "controller.period=0.01,0.02"),
    ("experiment=thesis/figure_3_5,thesis/figure_3_9", "noise.position=0,1e-3,2e-3"),
    (
        "robot=combined",
        "preset=full_equations,as_reported",
        "controller.period.macro=0.01,0.02",
        "robot.period.mini=1e-3,2e-3",
    ),
    (
        "robot.period=0.01,0.02",
        "noise=none,thesis",
        "torque_limits.max=null,40,[1,2,3]",
        "robot.goal=[0,0,1],[0,1,1]",
    ),
    ("preset.feedforward=true,false,true", "seed=range(0,2)", "+new.key=1,2", "~torque_limits"),
    ("noise.position=0,1,1.0,true", "robot.name='a b','c,d'", "seed=0"),
    ("robot.natural_frequency=1,2", "controller.natural_frequency=3,4", "controller.natural_frequency=5,6"),
]
ENTANGLED = [
    ("robot.period=0.01,0.02", "trajectory.duration=1,${robot.period}", "trajectory=quintic"),  # one takes the other
    ("robot=combined", "robot.period={macro:0.01},{macro:0.02}", "controller.period.mini=1,2"),  # mappings merge
    ("robot.masses={link2:1.5},{link3:0.5}", "robot.masses.link2=3,4"),  # one place
]


@pytest.fixture
def nothing_kept(monkeypatch):
    monkeypatch.setattr(template, "read_kept", lambda *_: None)


@pytest.mark.parametrize("kept", [False, True], ids=["new", "kept"])
@pytest.mark.parametrize("arguments", [*INDEPENDENT, *ENTANGLED], ids=" ".join)
def test_a_cell_is_what_hydra_composes(arguments, kept, monkeypatch):
    monkeypatch.setattr(unresolved, "read_kept", lambda *_: None)  # `compose` asks Hydra
    if not kept:
        monkeypatch.setattr(template, "read_kept", lambda *_: None)
    plan = plan_sweep(arguments)
    cells = range(len(plan))
    for cell in {0, random.Random(1).choice(cells), len(plan) - 1}:  # both ends change every key with two values
        ours, hydras = plan.composed(cell), compose(plan.overrides(cell))
        assert repr(ours.resolved) == repr(hydras.resolved)  # 1, 1.0 and True are three values
        assert ours.choices == hydras.choices
        assert list(ours.overrides) == [text.removeprefix("++") for text in hydras.overrides]


@pytest.mark.parametrize(("cases", "independent"), [(INDEPENDENT, True), (ENTANGLED, False)])
def test_keys_that_act_on_each_other_are_composed_cell_by_cell(cases, independent):
    for arguments in cases:
        plan = plan_sweep(arguments)
        plan.composed(0)
        assert [each._changes is not None for each in plan._templates.values()] == [independent], arguments


@pytest.mark.usefixtures("nothing_kept")
def test_hydra_composes_once_for_each_combination_of_options(monkeypatch):
    plan = plan_sweep(("robot=macro,mini", "noise=none,thesis", "seed=range(0,50)"))
    loaded = []
    load = plan._source.load
    monkeypatch.setattr(plan._source, "load", lambda *given: loaded.append(given) or load(*given))
    seeds = {plan.composed(cell).resolved["seed"] for cell in range(len(plan))}
    assert (len(plan), len(loaded), seeds) == (200, 4, {*range(50)})


def test_kept_options_need_no_composition(monkeypatch):
    arguments = ("robot=macro,mini", "noise=none,thesis", "seed=range(0,50)")
    for cell in range(4):
        compose(plan_sweep(arguments[:2]).overrides(cell))  # keeps the options
    plan = plan_sweep(arguments)
    monkeypatch.setattr(plan._source, "load", None)
    assert {plan.composed(cell).resolved["seed"] for cell in range(len(plan))} == {*range(50)}


def test_a_cell_does_not_change_its_neighbours():
    plan = plan_sweep(("noise.position=1,2",))
    one, two = plan.composed(0), plan.composed(1)
    assert (one.resolved["noise"]["position"], two.resolved["noise"]["position"]) == (1, 2)
    assert one.resolved["robot"] is two.resolved["robot"]  # what is the same is shared, as 10^5 cells need it


def test_what_does_not_compose_is_said():
    with pytest.raises(ConfigError, match=r"refers to robot\.nope, which the chosen robot lacks"):
        plan_sweep(("trajectory.goal=[0,0,1],${robot.nope}",)).composed(1)


@pytest.mark.parametrize(
    "values",
    ["1,1.0,2", "1.0,1,2.0", "1,2.0", "1,null", "range(1,4)", "1,2,3", "true,1,2"],
)
def test_numbers_of_a_float_key_are_what_hydra_composes(values):
    plan = plan_sweep((f"robot.payload.mass={values}",))
    for cell in range(len(plan)):
        assert repr(plan.composed(cell).resolved) == repr(compose(plan.overrides(cell)).resolved)


def test_lists_of_a_float_key_are_what_hydra_composes():
    plan = plan_sweep(("torque_limits.max=[1.5,2.0],[2.5,3.0],[4,5],[6,7.5]", "robot.goal=[0,0,1],[0,1,1]"))
    for cell in range(len(plan)):
        assert repr(plan.composed(cell).resolved) == repr(compose(plan.overrides(cell)).resolved)
