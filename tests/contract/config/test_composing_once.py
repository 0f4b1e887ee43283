"""Configs of tests are those that Hydra alone composes."""

import pytest
import yaml
from omegaconf import OmegaConf
from omegaconf._utils import get_yaml_loader
from support import composing

from runner.config.compose import compose
from runner.errors import ConfigError
from runner.paths import conf_dir


@pytest.mark.parametrize(
    "overrides",
    [
        (),
        ("robot=combined",),
        ("experiment=thesis/figure_5_8", "preset=as_reported", "controller.period.macro=0.03", "repetitions=1"),
        ("experiment=xarm7/three_joints", "plant=bullet", "plant.step=1e-3", "trajectory.goal=[0.3,0.1,0.2]"),
        ("robot=meca500", "controller.mass=[2,2,2,1,1,1]", "robot.tool.mass=0.3", "outputs=/some/where else"),
        ("robot=combined", "noise.position={macro: 1e-3, mini: 0}", "controller.period.mini=2e-3", "seed=7"),
        ("robot=macro", "controller.natural_frequency=${robot.torque_limit}", "noise.position='1e-3'"),
        ("robot=macro", "noise.positon=1", "nonsense=3", "controller.period=null"),
        ("robot=macro", "noise=thesis", "noise.position=1e-4", "noise.position=1e-5", "noise=none"),
        ("robot=macro", "+new.key=[1,{a: b}]", "~torque_limits"),
        ("robot=macro", "hydra.verbose=true"),
    ],
    ids=" ".join,
)
def test_both_ways_give_the_same(overrides):
    quick = [compose(overrides) for _ in range(2)]
    with composing.plainly():
        plain = compose(overrides)
    assert quick == [plain, plain]


@pytest.mark.parametrize("shown", ["job", "hydra"])
def test_the_command_composes_the_same(cli, shown):
    command = ("--cfg", shown, "robot=combined", "noise=thesis", "controller.period.macro=0.03", "seed=5")
    quick = [cli(*command).out for _ in range(2)]
    with composing.plainly():
        plain = cli(*command).out
    assert "seed" in plain
    assert quick == [plain, plain]


@pytest.mark.parametrize(
    "overrides",
    [("robot=makro", "seed=1"), ("noise.position=[1,", "robot=macro"), ("seed=1,2",), ("robot=macro,mini",), ("foo",)],
    ids=" ".join,
)
def test_both_ways_refuse_the_same(overrides):
    def refusal():
        with pytest.raises(ConfigError) as raised:
            compose(overrides)
        return str(raised.value)

    quick = refusal()
    with composing.plainly():
        assert quick == refusal()


def test_what_is_changed_in_one_config_is_in_no_other():
    first = compose(["robot=combined"])
    first.resolved["robot"]["stages"].clear()
    first.resolved["noise"]["position"] = 5.0
    with composing.plainly():
        assert compose(["robot=combined"]).resolved == compose(["robot=combined"]).resolved
    assert compose(["robot=combined"]).resolved["robot"]["stages"]
    assert compose(["robot=combined"]).resolved["noise"]["position"] != 5.0


def test_a_folder_of_ones_own_is_read_as_it_is(tmp_path):
    (tmp_path / "noise").mkdir()
    for position in (1e-3, 2e-3):
        (tmp_path / "noise/own.yaml").write_text(f"defaults: [thesis]\nposition: {position}\n")
        quick = [compose(["robot=macro", "noise=own"], [tmp_path]) for _ in range(2)]
        with composing.plainly():
            assert quick == 2 * [compose(["robot=macro", "noise=own"], [tmp_path])]
        assert quick[0].resolved["noise"]["position"] == position


@pytest.mark.parametrize("path", sorted(conf_dir().glob("r*/*.yaml")), ids=lambda path: path.stem)
def test_a_file_is_parsed_as_ever(path):
    with path.open() as stream:
        again = [OmegaConf.load(stream), OmegaConf.load(path)]
    assert again == 2 * [OmegaConf.create(composing._parse(path.read_text(), get_yaml_loader()))]


def test_a_parsed_text_is_nobody_else_s(tmp_path):
    path = tmp_path / "list.yaml"
    path.write_text("- {a: 1}\n")
    with path.open() as first, path.open() as second:
        one, other = (yaml.safe_load(stream) for stream in (first, second))
    one[0]["a"] = 2
    assert other == yaml.safe_load("- {a: 1}\n") == [{"a": 1}]
