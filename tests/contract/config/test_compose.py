"""Composition: precedence, own config folders, and files that are no configs."""

import pytest

from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.base.paths import robots_dir
from runner.config.compose.compose import compose
from runner.config.compose.files import group_options

SMALL_ROBOT = """\
# @package _global_
# My arm
defaults:
  - override /controller: operational_space
  - override /trajectory: goal
robot:
  name: mine
  urdf: mine.urdf
  tip: tip
  home: [0.0, 0.0, 0.0]
  inertials: null
  masses: {link3: 2.0}
  armature: 0.0
  velocity_limits: {}
  start: null
  goal: [0.2, -0.7, 0.4]
  path_size: 0.2
  tool: null
  payload: {mass: 0.0, position: [0.0, 0.0, 0.0]}
  rated_payload: null
  natural_frequency: 20.0
  damping_ratio: 1.0
  period: 0.01
  joint_error_limit: 1e-3
  no_joint_error: 0.0
  torque_limit: [50.0, 50.0, 20.0]
  settling_band: 0.02
"""


def resolve(*overrides):
    return compose(overrides).resolved


def test_precedence_group_preset_robot_experiment_command_line():
    assert resolve("preset=as_reported")["controller"]["feedforward"] is False
    assert resolve("robot=mini")["controller"]["natural_frequency"] == 300.0
    experiment = resolve("experiment=thesis/figure_4_2")
    assert experiment["robot"]["name"] == "mini"
    assert experiment["torque_limits"]["max"] == 5.0
    assert resolve("experiment=thesis/figure_4_2", "robot=macro")["torque_limits"]["max"] == 50.0
    assert resolve("experiment=thesis/figure_4_2", "torque_limits.max=4")["torque_limits"]["max"] == 4
    assert resolve("preset=as_reported", "controller.feedforward=true")["controller"]["feedforward"] is True


def test_a_preset_leaves_noise_limits_and_times_alone():
    for robot in ("macro", "combined"):
        full_equations, as_reported = (
            resolve(f"preset={name}", f"robot={robot}") for name in ("full_equations", "as_reported")
        )
        changed = {key for key in full_equations if full_equations[key] != as_reported[key]}
        assert changed == {"preset", "controller", "plant"}
        assert {key for key, value in full_equations["plant"].items() if value != as_reported["plant"][key]} == {
            "dynamics",
            "wrist_rotation",
        }


def test_what_was_chosen_is_kept():
    composed = compose(["experiment=thesis/figure_3_9", "preset=as_reported"])
    assert composed.choices["experiment"] == "thesis/figure_3_9"
    assert composed.choices["preset"] == "as_reported"
    assert composed.choices["robot"] == "macro"
    assert composed.overrides == ("experiment=thesis/figure_3_9", "preset=as_reported")
    assert "experiment" not in compose([]).choices
    assert "hydra" not in composed.resolved


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("robot=makro", f"robot: no 'makro' (did you mean macro?); known: {', '.join(group_options('robot'))}"),
        ("noise=1", "noise: no '1'; known: none, thesis"),
        ("experiment=figure_3_5", "experiment: no 'figure_3_5' (did you mean thesis/figure_3_5?); known: "),
        ("trajectory.goal=${robot.nope}", "trajectory.goal: it refers to robot.nope, which the chosen robot lacks"),
        (
            "robot.friction=3",
            "robot.friction: must be a group of keys, such as robot.friction.viscous; found a single value",
        ),
        ("noise.position=[1,", "'noise.position=[1,' is not a valid override: "),
        ("foo", "'foo' is not a valid override: it must read KEY=VALUE; a value with signs such as"),
        ("foo\x1b]0;t\x07[", r"'foo\x1b]0;t\x07[' is not a valid override: "),
    ],
)
def test_what_does_not_compose_is_said_in_one_line(cli, tmp_path, override, message):
    ending = cli("robot=macro", override)
    assert ending.code == 2
    assert ending.err.startswith(f"runner: 1 problem in the config:\n  - {message}")
    assert ending.err.count("\n") == 2
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(ConfigError) as raised:
        compose([override])
    assert f"runner: {raised.value}\n" == ending.err


def test_all_options_that_do_not_exist_are_in_one_message(cli):
    ending = cli("robot=minni", "controller=computd", "noise=thesis", "trajectory=quintc", "repetitons=3")
    assert ending.code == 2
    head, *problems = ending.err.splitlines()
    assert head == "runner: 3 problems in the config:"
    assert [text.partition(";")[0] for text in problems] == [
        "  - robot: no 'minni' (did you mean mini?)",
        "  - controller: no 'computd' (did you mean computed_torque?)",
        "  - trajectory: no 'quintc' (did you mean quintic?)",
    ]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (
            b"position: 0.0\n  distribution: [\n",
            "noise/own.yaml, line 2, column 15: mapping values are not allowed in this context",
        ),
        (b"position: 0.0\nposition: 1.0\n", "noise/own.yaml, line 2, column 1: found duplicate key position"),
        (b"# \xff\xfe\nposition: 0.0\n", "noise/own.yaml: is not a text file: 'utf-8' codec can't decode byte 0xff"),
        (b"3\n", "noise/own.yaml: holds no mapping of keys"),
        (b"- 3\n", "noise: must be a group of keys; found [3]"),
        (b"position: ${robot.nope}\n", "noise.position: it refers to robot.nope, which the chosen robot lacks"),
        (b"defaults: [nope]\nposition: 0.0\n", "noise: no 'nope' (did you mean none?); known: none, own, thesis"),
        (b"", "noise.position: missing"),
        (b"position: 0.0\n1: 2\n", "noise/own.yaml, line 2: the key '1' is not a string"),
        (b"position: &a [*a]\n", "noise/own.yaml, line 1: *a stands inside of &a"),
        (b"position: " + b"[" * 900 + b"]" * 900, "noise/own.yaml, line 1: nested deeper than 30 levels"),
        (b"position: ${oc.env:HOME}\n", "noise/own.yaml, line 1: '${oc.env:HOME}' calls a function"),
        (b"position: ${noise.velocity}\nvelocity: ${.position}", "noise.position: refers to itself"),
        (b"# @package " + b"a." * 200 + b"a\nposition: 0.0\n", "nested or referred to deeper than 60 levels"),
        (b"defaults: [3]\n", "Unsupported type in defaults : int"),
    ],
    ids=[
        "syntax",
        "duplicate",
        "binary",
        "number",
        "list",
        "interpolation",
        "defaults",
        "empty",
        "key",
        "cycle",
        "deep",
        "function",
        "circle",
        "package",
        "odd",
    ],
)
# The command line prints what Python raises, which the next test shows: the same for each of these is slow.
@pytest.mark.parametrize("way", [pytest.param("command line", marks=pytest.mark.slow), "python"])
def test_an_own_file_that_is_no_config_is_named_with_its_line(cli, tmp_path, content, message, way):
    own = tmp_path / "own"
    (own / "noise").mkdir(parents=True)
    (own / "noise" / "own.yaml").write_bytes(content)
    if way == "python":
        with pytest.raises(ConfigError) as raised:
            validate(compose(["noise=own"], [own]))
        text = str(raised.value)
    else:
        ending = cli("--config-dir", own, "noise=own")
        assert ending.code == 2
        text = ending.err
    assert message in text
    assert [entry.name for entry in tmp_path.iterdir()] == ["own"]


@pytest.mark.parametrize("content", ["position: 0.0\n  distribution: [\n", "- 3\n"], ids=["read", "checked"])
def test_the_command_line_says_of_an_own_file_what_python_says(cli, tmp_path, content):
    (tmp_path / "own" / "noise").mkdir(parents=True)
    (tmp_path / "own" / "noise" / "own.yaml").write_text(content)
    with pytest.raises(ConfigError) as raised:
        validate(compose(["noise=own"], [tmp_path / "own"]))
    ending = cli("--config-dir", tmp_path / "own", "noise=own")
    assert (ending.code, ending.err) == (2, f"runner: {raised.value}\n")


def test_an_own_config_folder_that_does_not_exist_is_named(cli, tmp_path):
    ending = cli("--config-dir", tmp_path / "nowhere", "robot=macro")
    assert ending.code == 2
    assert ending.err == f"runner: --config-dir: no such folder ('{tmp_path}/nowhere').\n"


@pytest.mark.parametrize("place", [".", "robots"])
def test_an_own_robot_runs(cli, tmp_path, place):
    own = tmp_path / "own"
    (own / "robot").mkdir(parents=True)
    (own / place).mkdir(exist_ok=True)
    (own / "robot" / "mine.yaml").write_text(SMALL_ROBOT)
    (own / place / "mine.urdf").write_text((robots_dir() / "macro.urdf").read_text())
    ending = cli("--config-dir", own, "robot=mine", "torque_limits=thesis", "duration=0.05")
    assert ending.code == 0
    assert "warning" not in ending.err
    assert 'mass value="2.0"' in (ending.folder / "robot.urdf").read_text()
    again = compose(["robot=mine", "torque_limits=thesis"], [own])
    assert validate(again).torque_limits.max.tolist() == [50.0, 50.0, 20.0]


def test_an_own_robot_without_urdf_names_the_places_searched(cli, tmp_path):
    own = tmp_path / "own"
    (own / "robot").mkdir(parents=True)
    (own / "robot" / "mine.yaml").write_text(SMALL_ROBOT)
    ending = cli("--config-dir", own, "robot=mine")
    assert ending.code == 2
    assert f"robot.urdf: no file 'mine.urdf' (did you mean mini.urdf?); looked in {own}/robots, {own}, " in ending.err
