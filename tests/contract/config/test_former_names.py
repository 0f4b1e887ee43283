"""Former names of keys and options are rejected with the present name, and each present name exists."""

import pytest

import runner
from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.base.former_names import KEYS, VALUES
from runner.config.compose.compose import compose
from runner.config.compose.files import group_options

OPTIONS = [(group, former, present) for group, names in VALUES.items() for former, present in names.items()]
# A config that has the present key; one key is in two kinds.
OWNERS = {
    "plant.segments": ("plant=rk4_flexible_links",),
    "plant.min_inertia": ("plant=mujoco",),
    "plant.flexible_joints.brake_time": ("plant=rk4_flexible",),
    "trajectory.start_configuration": ("trajectory=joint_quintic",),
    "trajectory.goal_configuration": ("trajectory=joint_quintic",),
    "trajectory.configurations": ("trajectory=joint_waypoints",),
    "controller.actuated_stages": ("controller=impedance",),
    "controller.wrench_frame": ("robot=meca500", "controller=admittance"),
    "controller.force_source": ("controller=hybrid_force",),
    "controller.switching_gain": ("controller=sliding_mode",),
    "controller.boundary_layer": ("controller=sliding_mode",),
    "controller.adaptation_gain": ("controller=adaptive",),
    "controller.cutoff": ("controller=iterative_learning", "trajectory=circle"),
    "environment.duration": ("environment=push",),
    "environment.start_time": ("environment=push",),
    "environment.displacement": ("environment=hand_guiding",),
}


def value_at(resolved, key):
    for name in key.split("."):
        resolved = resolved[name]
    return resolved


def nested(key, value):
    for name in reversed(key.split(".")):
        value = {name: value}
    return value


@pytest.mark.parametrize(("former", "present"), KEYS.items())
def test_a_former_key_is_rejected_with_its_present_name(former, present):
    with pytest.raises(ConfigError) as raised:
        validate(compose([*OWNERS[present], f"{former}=1"]))
    assert raised.value.problems == (f"{former}: this key is now called {present}.",)


@pytest.mark.parametrize("present", KEYS.values())
def test_the_present_key_exists(present):
    assert value_at(compose(OWNERS[present]).resolved, present) != {None: None}


@pytest.mark.parametrize(("former", "present"), KEYS.items())
def test_a_group_that_has_the_former_key_instead_of_the_present_one_has_one_problem(former, present):
    composed = compose(OWNERS[present])
    group = value_at(composed.resolved, former.rpartition(".")[0])
    group[former.rpartition(".")[2]] = group.pop(present.rpartition(".")[2])
    with pytest.raises(ConfigError) as raised:
        validate(composed)
    assert raised.value.problems == (f"{former}: this key is now called {present}.",)


def test_a_former_key_of_another_kind_is_unknown():
    with pytest.raises(ConfigError, match=r"controller.layer: unknown key; keys: task, "):
        validate(compose(["controller=computed_torque", "controller.layer=1"]))


@pytest.mark.parametrize(("group", "former", "present"), OPTIONS)
def test_a_former_option_is_rejected_with_its_present_name(group, former, present):
    with pytest.raises(ConfigError) as raised:
        compose([f"{group}={former}"])
    assert raised.value.problems == (f"{group}: '{former}' is now called '{present}'.",)
    assert present in group_options(group)


def test_a_former_kind_is_rejected_with_its_present_name():
    with pytest.raises(ConfigError) as raised:
        validate(compose(["environment=hand_guiding", "environment.kind=hand"]))
    assert raised.value.problems == ("environment.kind: 'hand' is now called 'hand_guiding'.",)


def test_a_command_line_ends_with_exit_code_2(cli):
    for override, problem in (
        ("preset=sound", "preset: 'sound' is now called 'full_equations'."),
        ("plant.least_inertia=1e-9", "plant.least_inertia: this key is now called plant.min_inertia."),
    ):
        ending = cli("robot=macro", "plant=mujoco", "duration=0.01", override)
        assert (ending.code, ending.out) == (2, "")
        assert ending.err == f"runner: 1 problem in the config:\n  - {problem}\n"
        swept = cli("-m", "robot=macro", "plant=mujoco", "seed=0,1", override)
        assert (swept.code, swept.out) == (2, "")
        assert f" {problem}\n" in swept.err


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        (
            "defaults:\n  - override /environment: push\nenvironment: {begin: 2.0}\n",
            "environment.begin: this key is now called environment.start_time.",
        ),
        ("defaults:\n  - override /preset: sound\n", "preset: 'sound' is now called 'full_equations'."),
    ],
)
def test_a_file_is_rejected_as_the_command_line_is(tmp_path, text, problem):
    (tmp_path / "experiment").mkdir()
    (tmp_path / "experiment" / "own.yaml").write_text(f"# @package _global_\n{text}")
    with pytest.raises(ConfigError) as raised:
        validate(compose(["experiment=own"], [tmp_path]))
    assert raised.value.problems == (problem,)


def test_a_call_from_python_is_rejected_as_the_command_line_is():
    with pytest.raises(ConfigError, match=r"environment.lasts: this key is now called environment.duration\."):
        runner.run("robot=macro", "environment=push", "environment.lasts=1")
