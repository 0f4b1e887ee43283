"""Sweeps as typed: each cell is the single run of its overrides, and no option, mapping or axis is left out."""

import pytest
from support.grids import plan_sweep

from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.config.compose.composer import Composer
from runner.sweeps.plan import Item, Listed
from runner.sweeps.typed import plan_typed

B = ("plant=rk4",)
LINES = [
    ("robot=mini", "robot={settling_band:0.002}", "seed=0,1"),
    ("robot={settling_band:0.002}", "robot=mini", "seed=0,1"),
    ("robot=mini,macro", "robot={settling_band:0.002}"),
    ("noise=thesis", "noise={bias:0.1},{bias:0.2}"),
    ("noise=thesis,{position:1e-4}", "seed=0,1"),
    ("noise.position=1e-3", "noise=none,{position:1e-4}", "noise.bias=1,2"),
    ("noise={position:1e-4},thesis", "noise=none"),
    ("noise={position:1e-4}", "noise={bias:0.1}", "seed=0,1"),
    ("robot.payload={mass:1},{mass:2}", "~robot.payload"),
    ("~robot.payload", "robot.payload={mass:1},{mass:2}"),
    ("noise.position=1e-4,1e-3", "~noise.position"),
    ("~noise.position", "noise.position=1e-4,1e-3"),
    ("noise.position=1e-4,1e-3", "noise={position:1.0}", "noise.position=2e-4,2e-3"),
    ("seed=0,1", "noise.bias=1", "~noise.bias", "noise.bias=2,3"),
    ("~notch", "notch.damping=0.1,0.2"),
]


@pytest.mark.costs(8)
@pytest.mark.parametrize("line", LINES, ids=" ".join)
def test_a_cell_is_the_single_run_of_its_overrides(line):
    plan = plan_sweep([*B, *line])
    for cell in range(len(plan)):
        assert repr(plan.composed(cell).resolved) == repr(compose(plan.overrides(cell)).resolved)


def cells(*line, config_dirs=()):
    plan, _ = plan_typed([*B, *line], Composer(config_dirs))
    return [plan.composed(cell) for cell in range(len(plan))]


@pytest.mark.parametrize(
    "given", [("robot=mini", "robot={settling_band:0.002}"), ("robot={settling_band:0.002}", "robot=mini")]
)
def test_an_option_and_a_mapping_of_its_group_both_count(given):
    for cell in cells(*given, "seed=0,1"):
        assert (cell.choices["robot"], cell.resolved["robot"]["settling_band"]) == ("mini", 0.002)


def test_each_option_has_the_mapping_of_its_group():
    found = cells("robot=mini,macro", "robot={settling_band:0.002},{settling_band:0.004}")
    assert [(cell.choices["robot"], cell.resolved["robot"]["settling_band"]) for cell in found] == [
        ("mini", 0.002), ("mini", 0.004), ("macro", 0.002), ("macro", 0.004),
    ]  # fmt: skip


def test_a_list_may_mix_options_and_mappings():
    thesis, none = cells("noise=thesis,{position:1e-4}")
    assert (thesis.choices["noise"], thesis.resolved["noise"]["position"]) == ("thesis", 1e-3)
    assert (none.choices["noise"], none.resolved["noise"]["position"]) == ("none", 1e-4)


def test_a_run_of_a_list_has_its_option_and_its_mapping():
    items = {"a": Item((*B, "robot=mini", "robot={settling_band:0.002}")), "b": Item((*B, "robot=mini"))}
    plan = Listed(items, [], Composer())
    for cell, item in enumerate(items.values()):
        assert plan.composed(cell).resolved == compose(item.overrides).resolved
        assert plan.composed(cell).choices["robot"] == "mini"


def test_deletions_act_in_the_order_of_the_line():
    deleted = cells("noise.position=1e-4,1e-3", "~noise.position")
    assert ["position" in cell.resolved["noise"] for cell in deleted] == [False, False]
    given = cells("~noise.position", "noise.position=1e-4,1e-3")
    assert [cell.resolved["noise"]["position"] for cell in given] == [1e-4, 1e-3]


@pytest.fixture
def own(tmp_path):
    """Return a function that writes an experiment with keys of hydra.sweeper.params into a config folder."""

    def write(name, params):
        (tmp_path / "experiment").mkdir(exist_ok=True)
        text = f"# @package _global_\nhydra: {{sweeper: {{params: {params}}}}}\n"
        (tmp_path / f"experiment/{name}.yaml").write_text(text)

    write("two_seeds", '{seed: "0,1"}')
    write("two_periods", '{controller.period: "10ms,20ms"}')
    (tmp_path / "experiment/no_axes.yaml").write_text("# @package _global_\nrepetitions: 2\n")
    return write


def test_axes_of_an_experiment_are_swept_over(own, tmp_path):
    for line in (["experiment=two_seeds"], ["experiment=choice(two_seeds)"]):
        assert [cell.resolved["seed"] for cell in cells(*line, config_dirs=[tmp_path])] == [0, 1]
    assert len(cells("experiment=[two_seeds,two_periods]", config_dirs=[tmp_path])) == 4
    assert len(cells("experiment=two_seeds", "seed=5", config_dirs=[tmp_path])) == 1
    assert len(cells("experiment=no_axes,thesis/figure_3_5", "seed=1,2,3", config_dirs=[tmp_path])) == 6


@pytest.mark.parametrize(
    "line", ["experiment=two_seeds,two_periods", "experiment=no_axes,two_seeds", "experiment=glob(two*)"]
)
def test_an_experiment_with_axes_is_no_value_of_a_list(own, tmp_path, line):
    with pytest.raises(ConfigError, match=r"experiment=two_seeds: brings axes \(seed\), which a list of options does"):
        cells(line, config_dirs=[tmp_path])


def test_axes_that_are_set_to_null_are_not_missed(own, tmp_path):
    given = [*B, "experiment=two_seeds,two_periods"]
    plan, _ = plan_typed(given, Composer([tmp_path]), ["hydra.sweeper.params=null"])
    assert len(plan) == 2


def test_two_ready_made_sweeps_at_once_are_refused(cli, tmp_path):
    ending = cli("-m", *B, "experiment=sweep/noise_torque_limit,sweep/frequency_period")
    assert (ending.code, ending.out) == (2, "")
    assert "experiment=sweep/noise_torque_limit: brings axes (noise.position, torque_limits.max)" in ending.err
    assert "experiment=[A,B]" in ending.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("params", "line", "expected"),
    [
        ("{duration: null, seed: '0,1'}", (), [("duration", None)]),
        ("{robot.inertials: null, seed: '0,1'}", (), [("robot.inertials", None)]),
        ("{noise: {position: '1e-4,1e-3', bias: 0.5}}", (), [("noise.bias", 0.5)]),
        ("{noise: 'none,thesis'}", ("noise={bias: 0.5}",), [("noise.bias", 0.5)]),
        ("{robot.goal: [0.5, 0.1, 1.0], seed: '0,1'}", (), [("robot.goal", [0.5, 0.1, 1.0])]),
        ("{preset.feedforward: true, seed: '0,1'}", (), [("preset.feedforward", True)]),
    ],
)
def test_params_are_values_of_yaml(own, tmp_path, params, line, expected):
    own("mine", params)
    found = cells("experiment=mine", *line, config_dirs=[tmp_path])
    assert len(found) == 2
    for key, value in expected:
        group, _, name = key.rpartition(".")
        assert {repr((cell.resolved[group] if group else cell.resolved)[name]) for cell in found} == {repr(value)}
